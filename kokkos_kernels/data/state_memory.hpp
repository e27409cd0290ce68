#pragma once
// Device memory that a State holds.

#include "data/memory_of.hpp"
#include "data/state.hpp"

namespace mpm {

/// Bytes of device memory that the state holds.
template <class Space, class T, int Dim>
std::size_t memory_of(const State<Space, T, Dim>& s) {
  const ContactCore<Space, T, Dim>& lower = s;
  return memory_of(lower, uses_of_nodes(s)) + bytes_of(s.timed.loads) + bytes_of(s.timed.points) +
         bytes_of(s.sides.nodes) + bytes_of(s.sides.columns) + bytes_of(s.loads.loaded) +
         bytes_of(s.loads.windows.sums) + bytes_of(s.loads.coordinate) + bytes_of(s.loads.force) +
         bytes_of(s.loads.half_length) + bytes_of(s.loads.pore_load) + bytes_of(s.energy.stress) +
         bytes_of(s.energy.strain) + bytes_of(s.energy.volume);
}

}  // namespace mpm
