// Persistent steps of the program: on GPUs.

#include "functions/persistent_launch.hpp"

namespace mpm {

MPM_FOR_CUDA(MPM_INSTANTIATE_PERSISTENT)

}  // namespace mpm
