#pragma once
// Sites of contact in a step (docs/method.md, "Contact at sites"), and the nodes round them, for the loops
// that find, solve and end them. Each method of these loops is the work of one index of a pass
// (functions/contact_sites.cpp).

#include "data/state.hpp"
#include "loops/node_update.hpp"
#include "physics/contact_site.hpp"

namespace mpm {

/// The sites of all rigid bodies with `at_sites` in a step of dt [s], behind update_nodes.
template <class Space, class T, int Dim>
struct Sites {
  using Terms = SiteTerms<Dim>;
  using Site = ContactSite<T, Dim>;
  static constexpr int cells = Patch<Dim>::cells, corners = k_sites<Dim>;
  static constexpr int momentum = SiteSums<Dim>::momentum, given = SiteSums<Dim>::given;
  static constexpr double k_faster = 3;      // the mean is of a third of the time at nodes: contact moves on
  static constexpr double k_whole = 0x1p50;  // of a site in SiteSums::sites

  UpdateNodes<Space, T, Dim> update;
  Soil<Space, T, Dim> soil;
  decltype(Bins<Space>::begin) begin;
  ContactPlaces<Space> contact_place;
  Kokkos::View<int*, typename Space::memory_space> contact_slots;
  SiteList<Space> list;
  Kokkos::View<Site*, typename Space::memory_space> sites;
  Kokkos::View<std::uint64_t*, typename Space::memory_space> gaps;
  decltype(ContactSites<Space, T, Dim>::sums) sums;
  int rank;     // this one
  int count;    // slots where a contact may be
  double unit;  // kg m/s, of SiteSums::momentum
  T fresh;      // -, weight of a step in the mean normal impulse

  Sites(const State<Space, T, Dim>& s, double dt)
      : update(node_update_of(s, dt)),
        soil(s.soil.points),
        begin(s.soil.bins.begin),
        contact_place(s.contact.place),
        contact_slots(s.contact.slots),
        list(s.at_sites.list),
        sites(s.at_sites.sites),
        gaps(s.at_sites.gaps),
        sums(s.at_sites.sums),
        rank(s.at_sites.rank),
        count(s.contact.count),
        unit(s.at_sites.mass * s.spacing / dt * 0x1p-52),
        fresh(static_cast<T>(-std::expm1(-k_faster * dt / s.friction_time))) {}

  /// A site: its body, number `near` of those near the slot, and its node by slot and place.
  struct Place {
    int rigid, near, slot, k, corner;  // corner: bit d, half a cell along d from the node
  };
  KOKKOS_INLINE_FUNCTION Place place_of_site(int n) const {
    const int at = list.node(n / corners), group = at / cells, near = group / count;
    const int slot = contact_slots(group % count);
    return {update.near_bodies.body(slot, near), near, slot, at % cells, n % corners};
  }
  /// Number in the list of a node of a contact slot, with the sites of a body near it, by the place of the
  /// slot from 1 on; -1: it is not there.
  KOKKOS_INLINE_FUNCTION int node_in_list(int near, int place, int k) const {
    return list.number(near * count + place - 1, k);
  }
  /// Number of the sums of a node; negative where no contact may be.
  KOKKOS_INLINE_FUNCTION int sums_of(int node) const {
    return node < 0 ? -1 : (contact_place(node / cells) - 1) * cells + node % cells;
  }
  /// Number of the node at c of a slot, where c may reach into the slots around it; -1: there is none.
  KOKKOS_INLINE_FUNCTION int node_number(int slot, const Coord<Dim>& c) const {
    return number_at<decltype(update.places.neighbours), Dim>(update.places.neighbours, slot, c);
  }
  KOKKOS_INLINE_FUNCTION const Rigid<Dim>& body(int r) const { return update.rigids(r); }
  KOKKOS_INLINE_FUNCTION Coord<Dim> node_at(const Place& of) const {
    Coord<Dim> at = coord_of<Dim>(of.k);
    for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(of.slot)[d];
    return at;
  }

  /// Whether the soil is in touch with a site, on whichever rank it is.
  KOKKOS_INLINE_FUNCTION bool touches(int rigid, int n) const {
    if (gaps(n) == GapKey::none || gaps(n) == GapKey::open) return false;
    return body(rigid).law.separates || GapKey::gap(gaps(n)) < SiteReach::cling;
  }
  /// Whether a site has a contact in this step, for which this rank is responsible.
  KOKKOS_INLINE_FUNCTION bool acts(int n) const {
    return gaps(n) != GapKey::none && gaps(n) != GapKey::open && GapKey::rank(gaps(n)) == rank &&
           sites(n).inverse_mass > 0;
  }

  /// Calls f(node, weight [-]) for the nodes round a site's place.
  template <class F>
  KOKKOS_INLINE_FUNCTION void for_each_hat(const Place& of, const Site& site, F&& f) const {
    Coord<Dim> first = coord_of<Dim>(of.k);
    Vector<T, Dim> upper;
    for (int d = 0; d < Dim; ++d) {
      const T below = Kokkos::floor(site.place[d]);
      first[d] += static_cast<int>(below);
      upper[d] = site.place[d] - below;
    }
    for (int m = 0; m < corners; ++m) {
      Coord<Dim> c = first;
      T weight = 1;
      for (int d = 0; d < Dim; ++d) {
        c[d] += m >> d & 1;
        weight *= m >> d & 1 ? upper[d] : 1 - upper[d];
      }
      f(m, node_number(of.slot, c), weight);
    }
  }
  KOKKOS_INLINE_FUNCTION void add(int node, int term, double value) const {
    Kokkos::atomic_add(&sums(sums_of(node), term), static_cast<std::int64_t>(Kokkos::round(value)));
  }

  KOKKOS_INLINE_FUNCTION T& kept(int near, int node, int corner, int term) const {
    return update.nodes.impulse(update.impulse_stride * near + corner * Terms::size + term, node);
  }
  struct NodeAndVelocity {
    typename UpdateNodes<Space, T, Dim>::Node node;
    Vector<T, Dim> v_old;
  };
  /// Node number k of the contact slots, and its velocity before the step.
  KOKKOS_INLINE_FUNCTION NodeAndVelocity node_and_velocity(int k) const {
    const int i = contact_slots(k / cells) * cells + k % cells;
    Coord<Dim> at = coord_of<Dim>(i);
    for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(i / cells)[d];
    NodeAndVelocity of{update.node_of(update.nodes, i, at, true), {}};
    Vector<T, Dim> a;
    if (of.node.inv_m > 0) update.accelerate(of.node.soil, of.node.inv_m, of.v_old, a);
    return of;
  }
};

}  // namespace mpm
