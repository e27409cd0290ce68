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
  Interpolation<Source> it{stream, s.grid, s.patches, bins, source, out, s.control, s.p2g.mosaic_cells};
  it.windows = bins.windows;
  bool near_contact = false;  // points elsewhere give nothing
  if constexpr (requires { source.windows; })
    if (source.windows.place.extent(0) > 0) it.windows = source.windows, near_contact = true;
  if constexpr (requires { source.contact; }) it.windows = s.contact.boundary, near_contact = true;
  const Bins<Space>& soil = s.soil.bins;
  const bool whole = bins.active_slots.data() == soil.active_slots.data() &&
                     bins.first_active == soil.first_active && bins.last_active == soil.last_active;
  if (near_contact) it.giving = s.contact.count;
  if (near_contact && whole) it.giving_slots = s.contact.slots;
  if constexpr (requires { source.rigid; }) it.some_slots = s.contact.slots, it.some_count = s.contact.count;
  it.adds = !s.plan.writes_sums;
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
