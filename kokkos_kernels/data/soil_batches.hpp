#pragma once
// More soil than the device's memory holds (-device_memory_limit). Its particles live in memory of the host
// that the device reaches, so that every kernel works on them where they are, if slowly. Only the update of
// the particles, in which a step takes nearly all of its time, works on copies: a batch is a range of
// patches, and as particles are sorted by patch, a range of particles. Some batches stay on the device; the
// others take turns in the places that are left, copied in, updated and copied out on streams of their own,
// so that the copies of one overlap with the other copies and the kernels of others.

#include <vector>

#include "base/spaces.hpp"
#include "data/particles.hpp"

namespace mpm {

/// Memory of the host that a kernel reads and writes, and that is copied while others run.
template <class Space>
using HostMemory = std::conditional_t<is_device<Space>, Kokkos::SharedHostPinnedSpace, Kokkos::HostSpace>;

/// Places that batches share: one is copied in, one updated, one copied out.
inline constexpr int k_turns = 3;

/// A range of patches whose particles are on the device together.
template <class Space, class T, int Dim>
struct SoilBatch {
  int first = 0, last = 0;                      // particles [first, last)
  int place = 0;                                // on the device
  bool stays = false;                           // no other batch has this place
  ParticleSet<Space, Soil<Space, T, Dim>> set;  // the place, by the particles' own numbers; its patches
  Kokkos::View<char*, typename Space::memory_space> scratch;  // dilatations, by these numbers too
};

/// Calls f(home, there, use) for the fields that the update of the particles reads.
template <class Home, class There, class F>
void for_each_of_step(Home& home, There& there, F&& f) {
  for_each_field_of(
      [&](const ParticleField& row, auto& at_home, auto& in_batch) {
        if (row.use != Use::none) f(at_home, in_batch, row.use);
      },
      home, there);
  f(home.cell, there.cell, Use::reads);
}

/// Cost of the batches, summed over the steps that were done. In sampled steps the host waits for each copy
/// and kernel, which gives the time of each alone.
struct BatchCost {
  long steps = 0, sampled = 0;
  double copied_in = 0, copied_out = 0;                        // bytes, in all steps
  double seconds = 0;                                          // of the updates that were not sampled
  double in_seconds = 0, kernel_seconds = 0, out_seconds = 0;  // of those that were
};

template <class Space, class T, int Dim>
struct Batches {
  using Memory = typename Space::memory_space;
  double limit = 0;  // bytes on the device; 0: none, and nothing of this is in use
  double least = 0;  // bytes, the lowest limit that the soil as it is would take
  Kokkos::View<char*, HostMemory<Space>> store;  // all of the soil, and what sorts it
  Kokkos::View<char*, Memory> room;              // the places, one after the other
  Kokkos::View<int*, Memory> slots;              // Bins::active_slots of the batches, one after the other
  int places = 0;
  std::vector<SoilBatch<Space, T, Dim>> all;  // in the order of the patches
  std::vector<Space> streams;                 // of the places that batches share
  bool loaded = false;                        // what stays on the device is there, and newer than the store
  BatchCost cost;

  bool in_use() const { return limit > 0; }
};

}  // namespace mpm
