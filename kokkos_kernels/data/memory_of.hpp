#pragma once
// Device memory that a ContactCore holds; data/state_memory.hpp adds the top floor.

#include <cstddef>

#include "base/spaces.hpp"
#include "data/contact_core.hpp"

namespace mpm {

/// Bytes of a view; 0 of memory of Batches::store, which is at the host.
template <class View>
std::size_t bytes_of(const View& view) {
  return view.use_count() == 0 ? 0 : view.span() * sizeof(*view.data());
}

/// Bytes of device memory that the two lower floors hold. uses: the nodal fields of the run.
template <class Space, class T, int Dim>
std::size_t memory_of(const ContactCore<Space, T, Dim>& s, const NodeUses& uses);

}  // namespace mpm
