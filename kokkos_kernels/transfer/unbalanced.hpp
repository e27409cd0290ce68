#pragma once
// How far the soil is from equilibrium.

#include "data/state.hpp"

namespace mpm {

/// Sums over nodes of sizes of forces [N].
struct UnbalancedForces {
  double force = 0;   // internal force and weight together
  double weight = 0;  // weight alone
};

/// The sums over the nodes that hold soil, from their present sums (sum_present_soil). Components that walls
/// hold are left out, and so are nodes that a rigid may touch, whose contact forces are not in the sums. Of
/// several ranks: of the nodes for which this one answers.
template <class Space, class T, int Dim>
UnbalancedForces unbalanced_forces(const State<Space, T, Dim>& s);

}  // namespace mpm
