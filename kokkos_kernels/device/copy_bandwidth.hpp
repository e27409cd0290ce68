#pragma once
// The bandwidth that a plain copy reaches where the kernels run: the measure for the bytes that they move
// themselves.

#include "base/spaces.hpp"

namespace mpm {

/// Bytes read and written per second [bytes/s] by a kernel that copies one array to another, both far larger
/// than caches; the best of a few. Zero where there is no memory for the arrays.
template <class Space>
double copy_bandwidth(const Space& space);

}  // namespace mpm
