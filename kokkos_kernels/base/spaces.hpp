#pragma once
// The execution spaces, real types and dimensions that the kernels are built for, in one list.

#include <Kokkos_Core.hpp>

#include "base/choices.hpp"

namespace mpm {

/// True where the threads of a team share scratch memory and run at once (GPU).
template <class Space>
inline constexpr bool is_device =
    !Kokkos::SpaceAccessibility<Kokkos::HostSpace, typename Space::memory_space>::accessible;

template <class Space>
inline constexpr Backend backend_of = Backend::serial;
#ifdef KOKKOS_ENABLE_OPENMP
template <>
inline constexpr Backend backend_of<Kokkos::OpenMP> = Backend::openmp;
#endif
#ifdef KOKKOS_ENABLE_CUDA
template <>
inline constexpr Backend backend_of<Kokkos::Cuda> = Backend::cuda;
#endif

/// The same policy, for a kernel of a time step: its functor travels as an argument of the launch. Without
/// the hint Kokkos sends a large functor through constant memory on CUDA, where each launch waits for the one
/// before it.
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

#if defined(KOKKOS_ENABLE_OPENMP) && !defined(MPM_NO_OPENMP)
#define MPM_WITH_OPENMP
#define MPM_FOR_OPENMP(X) MPM_FOR_EACH_REAL_DIM(X, Kokkos::OpenMP)
#else
#define MPM_FOR_OPENMP(X)
#endif
#ifdef KOKKOS_ENABLE_CUDA
#define MPM_FOR_CUDA(X) MPM_FOR_EACH_REAL_DIM(X, Kokkos::Cuda)
#else
#define MPM_FOR_CUDA(X)
#endif

/// Applies X(Space, T, Dim) to everything that is built: explicit instantiation, run-time choice, tests.
#define MPM_FOR_EACH(X) MPM_FOR_EACH_REAL_DIM(X, Kokkos::Serial) MPM_FOR_OPENMP(X) MPM_FOR_CUDA(X)
