// Persistent steps on processors, for the tests alone: the program does not have them.

#include "clouds.hpp"
#include "functions/persistent_launch.hpp"

namespace mpm {

MPM_FOR_TESTED_ON_PROCESSOR(MPM_INSTANTIATE_PERSISTENT)

}  // namespace mpm
