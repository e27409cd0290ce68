#pragma once
// How a team of a launch learns what another team of the same launch has done.

#include <Kokkos_Core.hpp>

namespace mpm {

/// A value that other teams of the same launch may write, as it is now in the memory that all of them see.
/// Everything that a team wrote before this value and before fence_of_teams is then visible to this thread,
/// and to the threads that wait for it.
KOKKOS_INLINE_FUNCTION unsigned acquire_of_others(const unsigned* value) {
  KOKKOS_IF_ON_DEVICE((unsigned seen; asm volatile("ld.acquire.gpu.u32 %0, [%1];"
                                                   : "=r"(seen)
                                                   : "l"(value)
                                                   : "memory");
                       return seen;))
  KOKKOS_IF_ON_HOST((const unsigned seen = Kokkos::atomic_load(value); Kokkos::memory_fence(); return seen;))
}
KOKKOS_INLINE_FUNCTION long long acquire_of_others(const long long* value) {
  KOKKOS_IF_ON_DEVICE((long long seen; asm volatile("ld.acquire.gpu.s64 %0, [%1];"
                                                    : "=l"(seen)
                                                    : "l"(value)
                                                    : "memory");
                       return seen;))
  KOKKOS_IF_ON_HOST((const long long seen = Kokkos::atomic_load(value); Kokkos::memory_fence(); return seen;))
}

/// Writes a value that other teams of the same launch wait for.
KOKKOS_INLINE_FUNCTION void store_for_others(long long* value, long long to) {
  KOKKOS_IF_ON_DEVICE((*static_cast<volatile long long*>(value) = to;))
  KOKKOS_IF_ON_HOST((Kokkos::atomic_store(value, to);))
}

}  // namespace mpm
