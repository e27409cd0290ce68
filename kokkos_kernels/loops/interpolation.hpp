#pragma once
// Interface of an interpolation to the step.

#include "data/contact_core.hpp"
#include "loops/particle_to_node.hpp"

namespace mpm {

/// The points of `source`, which `bins` orders, to the nodes' sums `out`, on a stream.
template <class Source, class Space, class T, int Dim>
Interpolation<Source> interpolation_of(const ContactCore<Space, T, Dim>& s, const Bins<Space>& bins,
                                       const Source& source, const NodeField<Space, T, Source::size>& out,
                                       const Space& stream) {
  constexpr bool boundary = std::is_same_v<Source, BoundarySource<Space, T, Dim>> ||
                            std::is_same_v<Source, StretchedBoundarySource<Space, T, Dim>> ||
                            std::is_same_v<Source, RingBoundarySource<Space, T, Dim>>;
  constexpr bool strength = std::is_same_v<Source, StrengthSource<Space, T, Dim>> ||
                            std::is_same_v<Source, RingStrengthSource<Space, T, Dim>>;
  constexpr bool load = std::is_same_v<Source, LoadSource<Space, T, Dim>>;
  constexpr bool rigid = std::is_same_v<Source, RigidSource<Space, T, Dim>>;
  Interpolation<Source> it{stream, s.grid, s.patches, bins, source, out, s.control, s.p2g.mosaic_cells};
  it.windows = boundary ? s.contact.boundary : strength ? s.contact.strength : bins.windows;
  if constexpr (load) it.windows = source.windows;
  it.adds = load || !s.plan.writes_sums;
  if (rigid) it.some_slots = s.contact.slots, it.some_count = s.contact.count;
  return it;
}

/// Interpolation of one source by the strategy that the user chose.
template <class Source, class Space, class T, int Dim>
void interpolate(const ContactCore<Space, T, Dim>& s, P2G strategy, const Bins<Space>& bins,
                 const Source& source, const NodeField<Space, T, Source::size>& out, const Space& space) {
  particle_to_node(strategy, interpolation_of(s, bins, source, out, space));
}
template <class Source, class Space, class T, int Dim>
void interpolate(const ContactCore<Space, T, Dim>& s, P2G strategy, const Bins<Space>& bins,
                 const Source& source, const NodeField<Space, T, Source::size>& out) {
  interpolate(s, strategy, bins, source, out, s.space);
}

}  // namespace mpm
