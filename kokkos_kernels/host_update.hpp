#pragma once
// update_particles on a processor, and the sums of the next step while the particles of a patch are in the
// cache.

#include "host_particles.hpp"
#include "host_sums.hpp"
#include "interpolation.hpp"

namespace mpm {

/// Moves the soil; if `sums`, it goes on to the nodes, with its boundary.
template <class Space, class T, int Dim>
void move_on_host(State<Space, T, Dim>& s, const UpdateScalars<T>& by, bool sums) {
  const auto& set = s.soil;
  const auto& bins = set.bins;
  const HostParticles<Space, T, Dim> particles{
      set.points, bins.begin, s.patches.around, s.patches.origin, s.nodes.motion, s.control, by, s.spacing};
  const SoilSource<Space, T, Dim> soil_source{set.points, s.grid.inv_spacing};
  const BoundarySource<Space, T, Dim> boundary_source{set.points, s.grid.inv_spacing, s.near_rigid};
  const HostSums soil(interpolation_of(s, bins, soil_source, s.nodes.soil, s.space));
  const HostSums boundary(interpolation_of(s, bins, boundary_source, s.nodes.boundary, s.space));
  const bool has_boundary = s.soil_boundary;
  const Shared phases[] = {slots_held<Dim>(bins),
                           sums && soil.apart ? slots_about<Dim>(bins, s.patches.slots) : Shared{}};
  for_each_shared("mpm::update_particles", s.space, phases, [&](int phase, int n) {
    if (s.control().paused) return;
    if (phase == 0) {
      const int slot = bins.by_colour(n);
      const T moved = particles(slot);
      s.movements.note(slot, moved);
      if (sums) soil.sum(slot);
      if (sums && has_boundary) boundary.sum(slot);
    } else {
      soil.give_nodes(n);
      if (has_boundary && s.near_rigid(n) != 0) boundary.give_nodes(n);
    }
  });
}

}  // namespace mpm
