#pragma once
#include <string>
#include <vector>

namespace mpm {

/// Faults of the command line's --kokkos-... words and of the environment (OMP_NUM_THREADS, KOKKOS_...), a
/// whole line each. Kokkos would abort over it, and a runtime of threads crash. Call it before
/// Kokkos::initialize. `devices` is how many GPUs there are.
std::vector<std::string> launch_faults(int argc, char** argv, int devices);

}  // namespace mpm
