#pragma once
// Features of a run that limit how its steps may be done: one table, which the plan of the steps, the halo
// exchange, the launch of many steps and the options ask.

#include <cstdint>
#include <initializer_list>

namespace mpm {

/// Features of a run that some way of doing a step cannot serve.
enum class Feature {
  other_strategy,  // from particles to nodes, than `tile`
  xpic,            // asks for the nodal sums again
  apic,            // likewise
  splits,          // particles with long domains are split
  correction,      // of particles' positions
  submerged,       // soil displaces water, whose weight nodes carry
  energy,          // the balance reads nodal sums between functions 4 and 5
  loads,           // on surfaces, which read them too
  rayleigh,        // damping forces need the sums of all the soil before any node moves
  damping,         // local: computes contact twice
  shear_fraction,  // contact by the soil's strength, whose sums are made before the nodes move
  friction,        // of rigid bodies: changes what a node keeps of the normal impulse whenever it is read
  acting_sides,    // of the mesh: likewise
  columns,         // of free-field sides, which move beside the sides on the main stream
  gravity_table,   // set where the rigid bodies move, when no node may be updated
  side_table,      // likewise
  pushed_mass_normals,  // a rigid body that forces move, with normals of its mass gradient
  revolved,             // particles are rings
  ranks,                // several
  batches,              // of soil that the device's memory does not hold
  count
};

/// A set of features.
struct Features {
  std::uint32_t bits = 0;

  constexpr Features() = default;
  constexpr Features(std::initializer_list<Feature> all) {
    for (Feature f : all) put(f);
  }
  constexpr void put(Feature f, bool on = true) { bits |= std::uint32_t(on) << static_cast<int>(f); }
  constexpr bool has(Feature f) const { return (bits >> static_cast<int>(f) & 1u) != 0; }
  friend constexpr Features operator|(Features a, Features b) {
    a.bits |= b.bits;
    return a;
  }
};
static_assert(static_cast<int>(Feature::count) <= 32);

/// Ways in which a step, or a part of it, may be done.
enum class StepWay {
  sums_ahead,   // function 5 goes on to functions 1 and 3 of the next step
  nodes_apart,  // function 4 has a kernel of its own for the nodes near rigid bodies
  overlapped,   // sums at nodes that ranks share travel while inner patches are computed
  in_batches,   // the soil passes through the device's memory in batches
  one_launch,   // the end of a step goes with function 5
  many_steps,   // a launch does many steps
  count
};

/// Features that exclude a way of doing a step.
constexpr Features excluding(StepWay way) {
  using F = Feature;
  switch (way) {
    case StepWay::sums_ahead:
      return {F::other_strategy, F::xpic, F::apic, F::submerged, F::energy, F::loads, F::rayleigh};
    case StepWay::nodes_apart: return {F::gravity_table, F::side_table, F::columns, F::rayleigh};
    case StepWay::overlapped: return {F::other_strategy, F::submerged, F::energy, F::loads, F::rayleigh};
    case StepWay::in_batches:
      return {F::other_strategy, F::xpic,   F::apic,  F::splits,  F::correction,
              F::submerged,      F::energy, F::loads, F::rayleigh};
    case StepWay::one_launch:
      return excluding(StepWay::sums_ahead) | Features{F::revolved, F::ranks, F::batches};
    case StepWay::many_steps:
      return excluding(StepWay::one_launch) |
             Features{F::damping, F::shear_fraction, F::friction, F::acting_sides, F::pushed_mass_normals};
    case StepWay::count: break;
  }
  return {};
}

/// Whether a run with these features may do its steps so.
constexpr bool can(StepWay way, Features of) { return (excluding(way).bits & of.bits) == 0; }

}  // namespace mpm
