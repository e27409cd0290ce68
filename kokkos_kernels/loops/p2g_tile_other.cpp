// The strategy `tile` for the other sources.

#include "loops/reduce_by_tile.hpp"

namespace mpm {

#define MPM_STRATEGY reduce_by_tile
#define MPM_INSTANTIATE(Space, T, Dim) MPM_FOR_EACH_OTHER_SOURCE(MPM_INSTANTIATE_SOURCE, Space, T, Dim)
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
