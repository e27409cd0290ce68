#pragma once
// The window of a patch: the nodes that its particles reach while they drift, in a team's scratch memory.

#include "loops/particle_to_node.hpp"

namespace mpm {

/// Threads of a team that works on a patch.
template <class Space>
inline constexpr int team_threads = is_device<Space> ? 128 : 1;
/// Teams that share a multiprocessor: the registers of a thread are limited to what so many leave it.
/// Measured on an H200: more teams hide more latency, until registers spill.
template <class T, int Dim>
inline constexpr int teams_at_once = sizeof(T) == sizeof(float) ? (Dim == 2 ? 9 : 7) : (Dim == 2 ? 5 : 4);
template <class Space, class T, int Dim>
using PatchTeam = Kokkos::TeamPolicy<Space, Kokkos::LaunchBounds<team_threads<Space>, teams_at_once<T, Dim>>>;

/// Place in the window of the node k steps from the first one that a particle reaches.
template <class Weights, int Dim>
KOKKOS_INLINE_FUNCTION int window_place(const Coord<Dim>& cell, const Weights& a, const Vector<int, Dim>& k) {
  int n = 0;
  for (int d = Dim - 1; d >= 0; --d) n = n * Patch<Dim>::window_edge + cell[d] + a[d].first + k[d] + 1;
  return n;
}

/// The weights along every axis of a particle that is near the cell where it was binned.
template <class T, int Dim, class Domain, class F>
KOKKOS_INLINE_FUNCTION void with_weights_near(const Vector<T, Dim>& x, const Domain& domain, F&& f) {
  AxisWeights<T> a[Dim];
  for (int d = 0; d < Dim; ++d) a[d] = axis_weights_near(x[d], domain[d]);
  f(a);
}

/// Bytes that the first of a team's scratch memory may have to move up, to a place for groups of 16 bytes.
inline constexpr int k_scratch_slack = 16;
/// Bytes that a team can have, of which Kokkos takes 8 a thread and two.
template <class Space>
inline constexpr std::size_t k_team_bytes = (is_device<Space> ? 48 : 32) * 1024;
/// Whether a team can have so much, so that this many share a multiprocessor of a GPU: one of Hopper has
/// 227 KiB, of which 1 KiB a team is the driver's.
template <class Space, class T, int Dim>
constexpr bool scratch_fits(std::size_t bytes, int teams = teams_at_once<T, Dim>) {
  constexpr int kib = 1024;
  const std::size_t all = bytes + k_scratch_slack + 8 * (team_threads<Space> + 2);
  return all <= k_team_bytes<Space> && (!is_device<Space> || (all + kib) * teams <= 227 * kib);
}

/// Bytes of scratch memory for so many values.
template <class T>
constexpr std::size_t scratch_bytes(int values) {
  return (values * sizeof(T) + 15) / 16 * 16;
}
/// Scratch memory of a team, taken piece by piece; each begins at a multiple of 16 bytes. All pieces are
/// taken at once, so that the compiler computes their places.
class Scratch {
 public:
  template <class Team>
  KOKKOS_INLINE_FUNCTION Scratch(const Team& team, std::size_t bytes)
      : next_(static_cast<char*>(team.team_scratch(0).get_shmem_aligned(bytes, 16))) {}
  template <class T>
  KOKKOS_INLINE_FUNCTION T* take(int values) {
    T* const piece = reinterpret_cast<T*>(next_);
    next_ += scratch_bytes<T>(values);
    return piece;
  }

 private:
  char* next_;
};
/// The next of it, for so many values; level 1 is in the device's memory, slow and large.
template <class T, class Team>
KOKKOS_INLINE_FUNCTION T* scratch(const Team& team, int values, int level = 0) {
  return static_cast<T*>(team.team_scratch(level).get_shmem_aligned(scratch_bytes<T>(values), 16));
}

}  // namespace mpm
