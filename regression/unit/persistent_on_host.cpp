// Persistent steps on processors, for the tests alone: the program does not have them.

#include "functions/persistent_launch.hpp"

namespace mpm {

MPM_FOR_EACH_REAL_DIM(MPM_INSTANTIATE_PERSISTENT, Processor)

}  // namespace mpm
