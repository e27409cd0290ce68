#pragma once
// update_particles on a processor, and the sums of the next step while the particles of a patch are in the
// cache.

#include "loops/cpu/host_particles.hpp"
#include "loops/cpu/host_soil.hpp"

namespace mpm {

/// Moves the soil; if `sums`, it goes on to the windows, with its boundary, and to the nodes where they are
/// not to take from these.
template <ParticleDomain domain, class Space, class T, int Dim>
void move_on_host(ContactCore<Space, T, Dim>& s, const UpdateScalars<T>& by, bool sums) {
  const auto& bins = s.soil.bins;
  const HostParticles<Space, T, Dim, domain> particles{
      s.soil.points, bins.begin,       s.patches.neighbours, s.patches.origin,  s.nodes.kinematics,
      s.control,     s.grid,           s.strays.alone,       s.strays.put_back, by,
      s.spacing,     dilatations_of(s)};
  const HostSoil<Space, T, Dim, domain> soil(s);
  const bool gives = sums && !s.summed.in_windows;
  const Shared phases[] = {slots_held<Dim>(bins), gives ? slots_about<Dim>(bins, s.patches.slots) : Shared{}};
  for_each_shared("mpm::update_particles", s.space, phases, [&](int phase, int n) {
    if (s.control().paused) return;
    if (phase == 0) {
      const int slot = bins.active_slots(n);
      if (n + 1 < phases[0].last) particles.fetch_nodes(bins.active_slots(n + 1));
      const T moved = particles(slot);
      s.movements.of(0).note(slot, moved);
      if (sums) soil.sum(slot);
    } else {
      soil.give_nodes(n);
    }
  });
}

}  // namespace mpm
