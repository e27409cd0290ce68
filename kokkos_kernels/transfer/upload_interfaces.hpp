#pragma once
// Laws of contact between the velocity fields of deformable bodies, to the device.

#include <vector>

#include "data/contact_core.hpp"

namespace mpm {

/// Laws of all pairs of velocity fields, a * fields + b, and the number of pairs of bodies that have sums; no
/// laws where no body has a field of its own.
struct InterfaceInput {
  int fields = 1, rows = 0;
  std::vector<InterfaceLaw> laws;
};

/// Puts the laws on the device. After upload(), before lists are made.
template <class Space, class T, int Dim>
void upload_interfaces(ContactCore<Space, T, Dim>& s, const InterfaceInput& in);

}  // namespace mpm
