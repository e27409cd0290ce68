#pragma once
// Sums of the soil at the nodes on a processor with many threads: its terms in each patch's window, and its
// boundary near a rigid.

#include "loops/cpu/host_sums.hpp"
#include "loops/interpolation.hpp"

namespace mpm {

/// The sums of a slot's nodes, row by row, as UpdateNodes asks for them.
template <class Space, class T, int Dim>
struct SlotSums {
  static constexpr int edge = Patch<Dim>::edge, rows = Patch<Dim>::cells / edge;
  using Row = Lanes<T, edge>;
  Row of_soil[rows][SoilTerms<Dim>::size], of_boundary[rows][BoundaryTerms<Dim>::size];
  const decltype(NodeSums<Space, T, Dim>::rigid)* of_rigids;  // a view copied would be counted by all threads

  KOKKOS_INLINE_FUNCTION T soil(int i, int n) const { return of_soil[i / edge % rows][n][i % edge]; }
  KOKKOS_INLINE_FUNCTION T boundary(int i, int n) const { return of_boundary[i / edge % rows][n][i % edge]; }
  KOKKOS_INLINE_FUNCTION T rigid(int r, int i, int n) const { return (*of_rigids)(r, i, n); }
};

/// domain: that of the particles, where they are summed.
template <class Space, class T, int Dim, ParticleDomain domain = ParticleDomain::fixed>
struct HostSoil {
  HostSums<SoilSource<Space, T, Dim, domain>> soil;
  HostSums<BoundarySource<Space, T, Dim, domain>> boundary;
  ContactPlaces<Space> contact;
  decltype(NodeSums<Space, T, Dim>::rigid) rigid;
  bool has_boundary;

  explicit HostSoil(const ContactCore<Space, T, Dim>& s)
      : soil(interpolation_of(s, s.soil.bins,
                              SoilSource<Space, T, Dim, domain>{s.soil.points, s.grid.inv_spacing},
                              s.nodes.soil, s.space)),
        boundary(interpolation_of(
            s, s.soil.bins,
            BoundarySource<Space, T, Dim, domain>{s.soil.points, s.grid.inv_spacing, s.contact.place},
            s.nodes.boundary, s.space)),
        contact(s.contact.place),
        rigid(s.nodes.rigid),
        has_boundary(s.soil_boundary) {}

  /// The particles of a slot, which holds some, to its window.
  void sum(int slot) const {
    soil.sum(slot);
    if (has_boundary) boundary.sum(slot);
  }
  bool has_boundary_at(int slot) const { return has_boundary && contact(slot) != 0; }
  /// From the windows to the nodes of a slot, any one.
  void give_nodes(int slot) const {
    soil.give_nodes(slot);
    if (has_boundary_at(slot)) boundary.give_nodes(slot);
  }
  /// Takes the sums of a slot, which are still in the windows or already at the nodes.
  void take(int slot, bool in_windows, SlotSums<Space, T, Dim>& sums) const {
    const auto take = [&](const auto& nodes, auto& to) {
      in_windows ? void(nodes.take(slot, to)) : nodes.load(slot, to);
    };
    take(soil.nodes, sums.of_soil);
    if (has_boundary_at(slot)) take(boundary.nodes, sums.of_boundary);
    sums.of_rigids = &rigid;
  }
};

}  // namespace mpm
