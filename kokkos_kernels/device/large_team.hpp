#pragma once
// Teams with more fast scratch memory than Kokkos' TeamPolicy gives: CUDA lends a team over 48 KiB only where
// the launch asks for it.

#include <Kokkos_Core.hpp>

#include "device/warp.hpp"

namespace mpm {

/// The threads of such a team, as one of them sees it.
struct LargeTeam {
  int rank;

  KOKKOS_INLINE_FUNCTION void barrier() const { KOKKOS_IF_ON_DEVICE((__syncthreads();)) }
  /// For how many threads of the team this holds; a barrier too.
  KOKKOS_INLINE_FUNCTION int count(bool holds) const {
    KOKKOS_IF_ON_DEVICE((return __syncthreads_count(holds);))
    KOKKOS_IF_ON_HOST((return holds;))
  }
  /// Number of the thread's warp, which the compiler then knows to be the same for all of its lanes.
  KOKKOS_INLINE_FUNCTION int warp() const {
    KOKKOS_IF_ON_DEVICE((return __shfl_sync(0xffffffffu, rank / k_warp, 0);))
    KOKKOS_IF_ON_HOST((return rank / k_warp;))
  }
};

#ifdef KOKKOS_ENABLE_CUDA
namespace large_team {

template <class Functor>
__global__ void __launch_bounds__(Functor::threads, Functor::teams) run(const __grid_constant__ Functor f) {
  extern __shared__ __align__(16) unsigned char scratch[];
  f(LargeTeam{static_cast<int>(threadIdx.x)}, scratch, static_cast<int>(blockIdx.x));
}

}  // namespace large_team

/// Launches so many teams of Functor::threads on a stream. Functor: has f(team, scratch, number of the team),
/// bytes() of scratch memory, which begins at a multiple of 16, and `teams` that are to share a
/// multiprocessor.
template <class Functor>
void launch_large_teams(const Kokkos::Cuda& space, int count, const Functor& f) {
  const int bytes = static_cast<int>(Functor::bytes());
  KOKKOS_IMPL_CUDA_SAFE_CALL(
      cudaFuncSetAttribute(large_team::run<Functor>, cudaFuncAttributeMaxDynamicSharedMemorySize, bytes));
  KOKKOS_IMPL_CUDA_SAFE_CALL(cudaFuncSetAttribute(large_team::run<Functor>,
                                                  cudaFuncAttributePreferredSharedMemoryCarveout,
                                                  cudaSharedmemCarveoutMaxShared));
  large_team::run<<<count, Functor::threads, bytes, space.cuda_stream()>>>(f);
  KOKKOS_IMPL_CUDA_SAFE_CALL(cudaGetLastError());
}
#endif

}  // namespace mpm
