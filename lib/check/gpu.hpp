#pragma once
#include <string>

namespace mpm {

/// The GPUs that Kokkos can use; 0 without CUDA, a GPU or a driver.
int gpu_count();

/// Why there are none, in CUDA's words; empty where CUDA has nothing to say.
std::string why_no_gpu();

/// Place on PCI of the GPU that Kokkos uses, as 0000:1B:00.0; empty where the program has no CUDA. Called
/// where the back end is cuda.
std::string gpu_bus();

}  // namespace mpm
