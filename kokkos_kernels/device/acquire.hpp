#pragma once
// How a team of a launch learns what another team of the same launch has done.

#include <Kokkos_Core.hpp>

namespace mpm {

/// A value that other teams of the same launch may write, as it is now in the memory that all of them see.
/// What a team wrote before it, and before fence_of_teams, is there for this thread then, and for the threads
/// that wait for this one.
KOKKOS_INLINE_FUNCTION int acquire_of_others(const int* value) {
  KOKKOS_IF_ON_DEVICE((int seen; asm volatile("ld.acquire.gpu.s32 %0, [%1];"
                                              : "=r"(seen)
                                              : "l"(value)
                                              : "memory");
                       return seen;))
  KOKKOS_IF_ON_HOST((const int seen = Kokkos::atomic_load(value); Kokkos::memory_fence(); return seen;))
}
KOKKOS_INLINE_FUNCTION long long acquire_of_others(const long long* value) {
  KOKKOS_IF_ON_DEVICE((long long seen; asm volatile("ld.acquire.gpu.s64 %0, [%1];"
                                                    : "=l"(seen)
                                                    : "l"(value)
                                                    : "memory");
                       return seen;))
  KOKKOS_IF_ON_HOST((const long long seen = Kokkos::atomic_load(value); Kokkos::memory_fence(); return seen;))
}

}  // namespace mpm
