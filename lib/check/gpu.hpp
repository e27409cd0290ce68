#pragma once
#include <string>

namespace mpm {

/// The GPUs that Kokkos can use; 0 without CUDA, a GPU or a driver.
int gpu_count();

/// Why there are none, in CUDA's words; empty where CUDA has nothing to say.
std::string why_no_gpu();

}  // namespace mpm
