#include "step/stepper.hpp"

#include <cstring>
#include <limits>

#include "device/copy_bandwidth.hpp"
#include "step/typed_stepper.hpp"

namespace mpm {

std::vector<Backend> available_backends() {
  return {
#ifndef MPM_ONLY_CUDA
    Backend::serial,
#endif
#if defined(MPM_WITH_OPENMP) && !defined(MPM_ONLY_CUDA)
        Backend::openmp,
#endif
#ifdef KOKKOS_ENABLE_CUDA
        Backend::cuda,
#endif
  };
}

const char* word_of(Backend backend) {
  switch (backend) {
    case Backend::serial: return "serial";
    case Backend::openmp: return "openmp";
    default: return "cuda";
  }
}

const char* word_of(Precision precision) { return precision == Precision::single ? "single" : "double"; }

std::unique_ptr<Stepper> make_stepper(const Config& config, MPI_Comm comm) {
#define MPM_CHOOSE(Space, T, Dim)                                              \
  if (runs_on<Space>(config.backend) && config.dim == Dim &&                   \
      (config.precision == Precision::single) == (sizeof(T) == sizeof(float))) \
    return std::make_unique<TypedStepper<Space, T, Dim>>(config, comm);
  MPM_FOR_EACH(MPM_CHOOSE)
#undef MPM_CHOOSE
  return nullptr;
}

std::string kokkos_version() {
  return std::to_string(KOKKOS_VERSION / 10000) + "." + std::to_string(KOKKOS_VERSION / 100 % 100) + "." +
         std::to_string(KOKKOS_VERSION % 100);
}

std::string device_name(Backend backend) {
#ifdef KOKKOS_ENABLE_CUDA
  if (backend == Backend::cuda) return Kokkos::Cuda().cuda_device_prop().name;
#endif
  if (backend == Backend::openmp) return std::to_string(thread_count(backend)) + " threads";
  return backend == Backend::serial ? "1 thread" : "";
}

int thread_count(Backend backend) {
  return backend == Backend::openmp ? space_of<Processor>(backend).concurrency() : 1;
}

double copy_bandwidth(Backend backend) {
#ifdef KOKKOS_ENABLE_CUDA
  if (backend == Backend::cuda) return copy_bandwidth(Kokkos::Cuda());
#endif
  return copy_bandwidth(space_of<Processor>(backend));
}

}  // namespace mpm
