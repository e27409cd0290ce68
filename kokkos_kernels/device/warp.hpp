#pragma once
// Functions of the GPU itself: the lanes of a warp, values that other teams wrote, the cache. On the host
// most of them only compile.

#include <Kokkos_Core.hpp>

namespace mpm {

inline constexpr int k_warp = 32;  // lanes

/// The largest of the values of all lanes, each >= 0.
KOKKOS_INLINE_FUNCTION float largest_of_warp(float value) {
  KOKKOS_IF_ON_DEVICE((return __uint_as_float(__reduce_max_sync(0xffffffffu, __float_as_uint(value)));))
  KOKKOS_IF_ON_HOST((return value;))
}
KOKKOS_INLINE_FUNCTION double largest_of_warp(double value) {
  // Bit patterns of such numbers order like the numbers: the upper half decides, then the lower one.
  KOKKOS_IF_ON_DEVICE(
      (const unsigned upper = static_cast<unsigned>(__double2hiint(value)),
       most = __reduce_max_sync(0xffffffffu, upper);
       const unsigned lower = upper == most ? static_cast<unsigned>(__double2loint(value)) : 0u;
       return __hiloint2double(static_cast<int>(most),
                               static_cast<int>(__reduce_max_sync(0xffffffffu, lower)));))
  KOKKOS_IF_ON_HOST((return value;))
}

/// The sum of the values of all lanes, in an order that is always the same.
KOKKOS_INLINE_FUNCTION double sum_of_warp(double value) {
  KOKKOS_IF_ON_DEVICE(
      (for (int mask = k_warp / 2; mask > 0; mask /= 2) value += __shfl_xor_sync(0xffffffffu, value, mask);))
  return value;
}

/// A value that other teams of the same launch may write, as it is now in the memory that all of them see.
template <class T>
KOKKOS_INLINE_FUNCTION T load_of_others(const T* value) {
  KOKKOS_IF_ON_DEVICE((return *static_cast<const volatile T*>(value);))  // __ldcg is moved out of loops
  KOKKOS_IF_ON_HOST((return Kokkos::atomic_load(value);))
}

/// Makes what this thread wrote, or read from teams that it waited for, visible to teams that wait for its
/// next write.
KOKKOS_INLINE_FUNCTION void fence_of_teams() {
  KOKKOS_IF_ON_DEVICE((asm volatile("fence.acq_rel.gpu;" ::: "memory");))  // Kokkos' fence orders more
  KOKKOS_IF_ON_HOST((Kokkos::memory_fence();))
}

/// Makes the lanes' writes to scratch memory visible to all of them.
KOKKOS_INLINE_FUNCTION void sync_warp() { KOKKOS_IF_ON_DEVICE((__syncwarp();)) }

/// Asks a GPU to fetch what p points at into its second cache.
KOKKOS_INLINE_FUNCTION void prefetch([[maybe_unused]] const void* p) {
  KOKKOS_IF_ON_DEVICE((asm volatile("prefetch.global.L2 [%0];" ::"l"(p));))
}

}  // namespace mpm
