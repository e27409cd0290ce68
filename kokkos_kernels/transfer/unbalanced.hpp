#pragma once
// How far the soil is from equilibrium.

#include "data/state.hpp"

namespace mpm {

/// Sums over nodes of sizes of forces [N].
struct UnbalancedForces {
  double force = 0;   // internal force, weight and reactions together
  double weight = 0;  // weight alone
};

/// The sums over the nodes that hold soil, from their present sums and the soil's boundary
/// (sum_present_soil). Reactions of rigid bodies and of sides that act are those of a step of dt [s] from now
/// on. Components that walls hold are left out. Of several ranks: of the nodes for which this one answers.
template <class Space, class T, int Dim>
UnbalancedForces unbalanced_forces(const State<Space, T, Dim>& s, double dt);

}  // namespace mpm
