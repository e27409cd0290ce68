#include "step/stepper.hpp"

#include <cstring>
#include <limits>

#include "copy_bandwidth.hpp"
#include "step/typed_stepper.hpp"

namespace mpm {

int model_index(const std::string& name) {
  const auto models = material_models();
  for (std::size_t k = 0; k < models.size(); ++k)
    if (name == models[k]) return static_cast<int>(k);
  return -1;
}

std::vector<Backend> available_backends() {
  return {
      Backend::serial,
#ifdef KOKKOS_ENABLE_OPENMP
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

std::unique_ptr<Stepper> make_stepper(const Config& config, MPI_Comm comm) {
#define MPM_CHOOSE(Space, T, Dim)                                              \
  if (config.backend == backend_of<Space> && config.dim == Dim &&              \
      (config.precision == Precision::single) == (sizeof(T) == sizeof(float))) \
    return std::make_unique<TypedStepper<Space, T, Dim>>(config, comm);
  MPM_FOR_EACH(MPM_CHOOSE)
#undef MPM_CHOOSE
  return nullptr;
}

double critical_time_step(const Config& config) {
  double step = std::numeric_limits<double>::infinity();
  for (const BodyConfig& body : config.bodies) {
    const MaterialConfig& material = config.materials[body.material];
    const double modulus =
        wave_modulus(make_material<double>(model_index(material.model), material.parameters));
    step = std::min(step, config.mesh.spacing / std::sqrt(modulus / material.density));
  }
  return step;
}

std::string kokkos_version() {
  return std::to_string(KOKKOS_VERSION / 10000) + "." + std::to_string(KOKKOS_VERSION / 100 % 100) + "." +
         std::to_string(KOKKOS_VERSION % 100);
}

std::string device_name(Backend backend) {
#ifdef KOKKOS_ENABLE_CUDA
  if (backend == Backend::cuda) return Kokkos::Cuda().cuda_device_prop().name;
#endif
#ifdef KOKKOS_ENABLE_OPENMP
  if (backend == Backend::openmp) return std::to_string(Kokkos::OpenMP().concurrency()) + " threads";
#endif
  return backend == Backend::serial ? "1 thread" : "";
}

double copy_bandwidth(Backend backend) {
#ifdef KOKKOS_ENABLE_CUDA
  if (backend == Backend::cuda) return copy_bandwidth(Kokkos::Cuda());
#endif
#ifdef KOKKOS_ENABLE_OPENMP
  if (backend == Backend::openmp) return copy_bandwidth(Kokkos::OpenMP());
#endif
  return copy_bandwidth(Kokkos::Serial());
}

}  // namespace mpm
