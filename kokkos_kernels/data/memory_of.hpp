#pragma once
// Device memory that a State holds.

#include <cstddef>

#include "base/spaces.hpp"
#include "data/state.hpp"

namespace mpm {

/// Bytes of device memory that the state holds.
template <class Space, class T, int Dim>
std::size_t memory_of(const State<Space, T, Dim>& s);

}  // namespace mpm
