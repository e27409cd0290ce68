// Whether there is a GPU, in a program that must start where there is none.

#include "check/gpu.hpp"

#include <Kokkos_Core.hpp>

#ifdef KOKKOS_ENABLE_CUDA
#include <cuda.h>
#include <dlfcn.h>

// Kokkos calls these functions of the driver by name. Linked to libcuda.so.1, the program could not even be
// loaded on a machine without a driver, such as a login node. Defined here, before the linker comes to
// libcuda, they find the driver's own when they are called. CUDA's runtime, which is linked statically, does
// the same for all others.
namespace {

template <class StepPhase>
StepPhase* of_driver(const char* name) {
  static void* const driver = dlopen("libcuda.so.1", RTLD_NOW);
  return driver != nullptr ? reinterpret_cast<StepPhase*>(dlsym(driver, name)) : nullptr;
}

}  // namespace

CUresult cuStreamGetCtx(CUstream stream, CUcontext* context) {
  static const auto call = of_driver<decltype(cuStreamGetCtx)>("cuStreamGetCtx");
  return call != nullptr ? call(stream, context) : CUDA_ERROR_NOT_INITIALIZED;
}

CUresult cuCtxPushCurrent_v2(CUcontext context) {
  static const auto call = of_driver<decltype(cuCtxPushCurrent_v2)>("cuCtxPushCurrent_v2");
  return call != nullptr ? call(context) : CUDA_ERROR_NOT_INITIALIZED;
}

CUresult cuCtxGetDevice(CUdevice* device) {
  static const auto call = of_driver<decltype(cuCtxGetDevice)>("cuCtxGetDevice");
  return call != nullptr ? call(device) : CUDA_ERROR_NOT_INITIALIZED;
}
#endif

namespace mpm {

int gpu_count() {
#ifdef KOKKOS_ENABLE_CUDA
  int count = 0;
  if (cudaGetDeviceCount(&count) != cudaSuccess || count == 0)
    return 0;  // of which Kokkos would make an abort
  return Kokkos::num_devices();
#else
  return 0;
#endif
}

std::string why_no_gpu() {
#ifdef KOKKOS_ENABLE_CUDA
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  if (error != cudaSuccess) return cudaGetErrorString(error);
#endif
  return "";
}

std::string gpu_bus() {
#ifdef KOKKOS_ENABLE_CUDA
  char bus[32] = "";
  if (cudaDeviceGetPCIBusId(bus, sizeof bus, Kokkos::Cuda().cuda_device()) == cudaSuccess) return bus;
#endif
  return "";
}

}  // namespace mpm
