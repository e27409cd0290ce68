#pragma once
// Whether host and device agree on views.

#include "base/spaces.hpp"

namespace mpm {

/// Whether a kernel reads from views what the host wrote there: false where the host compiler and the device
/// compiler lay out Kokkos' views differently.
template <class Space>
bool device_agrees(const Space& space);

}  // namespace mpm
