#pragma once
// Number of velocity fields that kernels have room for.

namespace mpm {

/// Most velocity fields of a run.
inline constexpr int k_most_fields = 8;

}  // namespace mpm
