// Persistent steps on processors, for the tests alone: the program does not have them.

#include "functions/persistent_launch.hpp"

namespace mpm {

MPM_FOR_EACH_REAL_DIM(MPM_INSTANTIATE_PERSISTENT, Kokkos::Serial)
MPM_FOR_OPENMP(MPM_INSTANTIATE_PERSISTENT)

}  // namespace mpm
