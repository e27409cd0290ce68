#pragma once
// Values of the sites of contact that ranks share, node by node (functions/shared_words.hpp).

#include "loops/sites.hpp"

namespace mpm {

/// Number in the list of sites of a node and body number `near` of those near its slot; -1: it is not there.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION int listed(const Sites<Space, T, Dim>& sites, int near, int node) {
  const int place = sites.contact_place(node / Patch<Dim>::cells);
  return place == 0 ? -1 : sites.node_in_list(near, place, node % Patch<Dim>::cells);
}

/// The least gaps of the sites.
template <class Space, class T, int Dim>
struct SharedGaps {
  using Value = std::uint64_t;
  Sites<Space, T, Dim> sites;
  int size = sites.update.near_bodies.widest * k_sites<Dim>;

  KOKKOS_INLINE_FUNCTION Value load(int node, int k) const {
    const int n = number(node, k);
    return n < 0 || sites.gaps(n) == GapKey::none ? GapKey::open : sites.gaps(n);
  }
  KOKKOS_INLINE_FUNCTION void store(int node, int k, Value value) const {
    const int n = number(node, k);
    if (n >= 0 && sites.gaps(n) != GapKey::none) sites.gaps(n) = value;
  }
  KOKKOS_INLINE_FUNCTION static Value combine(Value a, Value b) { return a < b ? a : b; }

 private:
  KOKKOS_INLINE_FUNCTION int number(int node, int k) const {
    const int near = k / k_sites<Dim>;
    const int first = near < sites.update.near_bodies.width ? listed(sites, near, node) : -1;
    return first < 0 ? -1 : first * k_sites<Dim> + k % k_sites<Dim>;
  }
};

/// Sums over sites (SiteSums), `size` of them from the first on.
template <class Space, class T, int Dim>
struct SharedSums {
  using Value = std::int64_t;
  Sites<Space, T, Dim> sites;
  int first, size;

  KOKKOS_INLINE_FUNCTION Value load(int node, int k) const {
    return is_there(node) ? sites.sums(sites.sums_of(node), first + k) : 0;
  }
  KOKKOS_INLINE_FUNCTION void store(int node, int k, Value value) const {
    if (is_there(node)) sites.sums(sites.sums_of(node), first + k) = value;
  }
  KOKKOS_INLINE_FUNCTION static Value combine(Value a, Value b) { return a + b; }

 private:
  KOKKOS_INLINE_FUNCTION bool is_there(int node) const {
    return sites.contact_place(node / Patch<Dim>::cells) > 0;
  }
};

/// Numbers that sites keep for the next step, which the rank that is responsible for a site has. Where a node
/// is not in the list of this rank they are those of other ranks.
template <class Space, class T, int Dim>
struct SharedKept {
  using Value = T;
  Sites<Space, T, Dim> sites;
  int size = sites.update.near_bodies.widest * sites.update.impulse_stride;

  KOKKOS_INLINE_FUNCTION Value load(int node, int k) const {
    const bool own = is_there(node, k) && listed(sites, k / sites.update.impulse_stride, node) >= 0;
    return own ? sites.update.nodes.impulse(k, node) : T(0);
  }
  KOKKOS_INLINE_FUNCTION void store(int node, int k, Value value) const {
    if (is_there(node, k)) sites.update.nodes.impulse(k, node) = value;
  }
  KOKKOS_INLINE_FUNCTION static Value combine(Value a, Value b) { return a + b; }

 private:
  /// Whether the number is one of a site: with contact at nodes all ranks have it already.
  KOKKOS_INLINE_FUNCTION bool is_there(int node, int k) const {
    const auto& near = sites.update.near_bodies;
    const int slot = node / Patch<Dim>::cells, n = k / sites.update.impulse_stride;
    const int body = n < near.width ? near.body(slot, n) : -1;
    return body >= 0 && sites.body(body).law.at_sites && sites.contact_place(slot) > 0;
  }
};

}  // namespace mpm
