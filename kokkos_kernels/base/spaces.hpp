#pragma once
// The execution spaces, real types and dimensions that the kernels are built for, in one list.

#include <Kokkos_Core.hpp>

#include "base/choices.hpp"

namespace mpm {

/// True where the threads of a team share scratch memory and run at once (GPU).
template <class Space>
inline constexpr bool is_device =
    !Kokkos::SpaceAccessibility<Kokkos::HostSpace, typename Space::memory_space>::accessible;

#if defined(KOKKOS_ENABLE_OPENMP) && !defined(MPM_NO_OPENMP)
#define MPM_WITH_OPENMP
/// The execution space of processors. The kernels of `serial` are those of `openmp`, on one thread, so that
/// the kernels are compiled once for processors.
using Processor = Kokkos::OpenMP;
#else
using Processor = Kokkos::Serial;
#endif

/// Whether a backend runs on Space.
template <class Space>
constexpr bool runs_on(Backend backend) {
  return is_device<Space> == (backend == Backend::cuda);
}
/// The instance of Space on which a backend runs.
template <class Space>
Space space_of([[maybe_unused]] Backend backend) {
#ifdef MPM_WITH_OPENMP
  if constexpr (!is_device<Space>)
    if (backend == Backend::serial) return Space(1);
#endif
  return Space();
}
/// Whether several threads of a processor run the kernels of this instance.
template <class Space>
bool has_threads(const Space& space) {
  return !is_device<Space> && space.concurrency() > 1;
}

/// Policy for a kernel of a time step: the functor travels as an argument of the launch. Without the hint
/// Kokkos sends a large functor through constant memory on CUDA, where each launch waits for the one before
/// it.
template <class Policy>
auto light(const Policy& policy) {
  return Kokkos::Experimental::require(policy, Kokkos::Experimental::WorkItemProperty::HintLightWeight);
}

}  // namespace mpm

#ifdef MPM_ONLY_2D
#define MPM_FOR_EACH_DIM(X, Space, T) X(Space, T, 2)
#else
#define MPM_FOR_EACH_DIM(X, Space, T) X(Space, T, 2) X(Space, T, 3)
#endif

#ifdef MPM_ONLY_DOUBLE
#define MPM_FOR_EACH_REAL_DIM(X, Space) MPM_FOR_EACH_DIM(X, Space, double)
#else
#define MPM_FOR_EACH_REAL_DIM(X, Space) MPM_FOR_EACH_DIM(X, Space, double) MPM_FOR_EACH_DIM(X, Space, float)
#endif

#ifdef KOKKOS_ENABLE_CUDA
#define MPM_FOR_CUDA(X) MPM_FOR_EACH_REAL_DIM(X, Kokkos::Cuda)
#else
#define MPM_FOR_CUDA(X)
#endif

#ifdef MPM_ONLY_CUDA
#define MPM_FOR_PROCESSOR(X)
#else
#define MPM_FOR_PROCESSOR(X) MPM_FOR_EACH_REAL_DIM(X, mpm::Processor)
#endif

/// Applies X(Space, T, Dim) to everything that is built: explicit instantiation, run-time choice, tests.
#define MPM_FOR_EACH(X) MPM_FOR_PROCESSOR(X) MPM_FOR_CUDA(X)
