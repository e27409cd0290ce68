#pragma once
// The step's part of what soil_batches.hpp is about. In words of the host: store, plan, update, collect.

#include "base/spaces.hpp"
#include "data/contact_core.hpp"

namespace mpm {

/// Gives the soil, of `count` particles, its fields in memory of the host. needed_scratch: the least that
/// sorting the rigids needs of s.scratch.
template <class Space, class T, int Dim>
void store_soil(Core<Space, T, Dim>& s, int count, std::size_t needed_scratch);

/// Drops the batches of the lists before, and makes room for the slots of the new ones.
template <class Space, class T, int Dim>
void drop_batches(Core<Space, T, Dim>& s);

/// Cuts the soil into batches that fit beside all else under the limit. held: bytes that the run holds on the
/// device without batches (drop_batches). To be called after a rebuild. Where the limit is below the lowest
/// possible one, s.batches.least, there are no batches.
template <class Space, class T, int Dim>
void plan_batches(Core<Space, T, Dim>& s, std::size_t held);

/// update_particles, batch by batch. Waits for the device, before and after.
template <class Space, class T, int Dim>
void update_by_batches(ContactCore<Space, T, Dim>& s, double dt);

/// Brings what stays on the device home, so that the soil is as it is now wherever it is looked for.
template <class Space, class T, int Dim>
void collect_soil(const Core<Space, T, Dim>& s);

/// Calls f(set) for the soil where it is newest: once, or once a batch. Sums to the nodes come in the order
/// that one set would give them on the host.
template <class Space, class T, int Dim, class F>
void for_all_soil(const Core<Space, T, Dim>& s, F&& f) {
  const auto& b = s.batches;
  if (!b.in_use()) return f(s.soil);
  for (const auto& batch : b.all) {
    auto set = batch.stays && b.loaded ? batch.set : s.soil;
    set.bins = batch.set.bins;
    f(set);
  }
}

}  // namespace mpm
