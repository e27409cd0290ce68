#pragma once
// Features of a run that limit how its steps may be done: one table, which the plan of the steps, the halo
// exchange, the launch of many steps and the options ask.

#include <cstdint>
#include <initializer_list>

namespace mpm {

/// Features of a run that some way of doing a step cannot serve.
enum class Feature {
  other_strategy,       // strategy from particles to nodes other than `tile`
  xpic,                 // XPIC, which reads the nodal sums again
  apic,                 // APIC, which has sums of its own
  splits,               // particles that are split where their domains are long
  correction,           // correction of the particles' positions
  saturated,            // water that flows in pores, with sums and fluxes of its own at the nodes
  submerged,            // soil that displaces water, whose weight goes to the nodes
  energy,               // energy balance, which reads nodal sums between functions 4 and 5
  loads,                // loads on surfaces, which read nodal sums between functions 4 and 5
  rayleigh,             // Rayleigh damping, whose forces need the sums of all soil before any node moves
  damping,              // local damping, which computes contact twice
  shear_fraction,       // contact by the soil's strength, whose sums are made before the nodes move
  friction,             // friction of rigid bodies, which changes a node's normal impulses when it reads them
  acting_sides,         // sides that act, which change what their nodes keep when they read it
  columns,              // free-field columns, which move beside the sides on the main stream
  gravity_table,        // gravity by a table, set where rigid bodies move, when no node may be updated
  side_table,           // motion of a side by a table, set likewise
  contact_sites,        // contact at sites, which reads nodal sums between functions 4 and 5
  interfaces,           // contact of deformable bodies, which changes nodal sums before function 4
  pushed_mass_normals,  // rigid body that forces move, with normals of its mass gradient
  turning_rigids,       // rigid bodies that may turn, which steps in one launch do not move
  many_rigids,          // lists of the rigid bodies near slots, which steps in one launch do not have
  rigid_pairs,          // rigid bodies near each other, whose contact goes before their movement
  linked_rigids,        // rigid bodies with joints or springs, likewise
  light_rigids,         // rigid bodies light against soil, whose velocity is solved for before the nodes move
  united_rigids,        // rigid bodies of several parts, whose surfaces UpdateNodes without `acts` lacks
  revolved,             // body of revolution, whose particles are rings
  ranks,                // several ranks
  batches,              // soil that goes through the device's memory in batches
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
  nodes_aside,  // this kernel runs on the overlap stream
  overlapped,   // sums at nodes that ranks share travel while inner patches are computed
  in_batches,   // the soil passes through the device's memory in batches
  one_launch,   // the end of a step goes with function 5
  many_steps,   // a launch does many steps
  about_nodes,  // bins about nodes in place of cells (P2GPlan::about_nodes)
  count
};

/// Features that need the sums of function 3 in a launch of their own.
inline constexpr Features k_sum_apart{Feature::other_strategy, Feature::xpic,      Feature::apic,
                                      Feature::saturated,      Feature::submerged, Feature::energy,
                                      Feature::loads,          Feature::rayleigh,  Feature::contact_sites};

/// Features that exclude a way of doing a step.
constexpr Features excluding(StepWay way) {
  using F = Feature;
  switch (way) {
    case StepWay::sums_ahead: return k_sum_apart | Features{F::interfaces};
    case StepWay::nodes_apart:
      return {F::gravity_table, F::side_table, F::columns, F::rayleigh, F::saturated};
    case StepWay::nodes_aside: return excluding(StepWay::nodes_apart) | Features{F::shear_fraction};
    case StepWay::overlapped:
      return {F::other_strategy, F::saturated, F::submerged,     F::energy,
              F::loads,          F::rayleigh,  F::contact_sites, F::interfaces};
    case StepWay::in_batches:
      return {F::other_strategy, F::xpic,   F::apic,  F::splits,   F::correction,    F::saturated,
              F::submerged,      F::energy, F::loads, F::rayleigh, F::contact_sites, F::interfaces};
    case StepWay::one_launch:
      return excluding(StepWay::sums_ahead) | Features{F::turning_rigids, F::many_rigids,  F::rigid_pairs,
                                                       F::linked_rigids,  F::light_rigids, F::united_rigids,
                                                       F::revolved,       F::ranks,        F::batches};
    case StepWay::many_steps:
      return excluding(StepWay::one_launch) |
             Features{F::damping, F::shear_fraction, F::friction, F::acting_sides, F::pushed_mass_normals};
    case StepWay::about_nodes:
      return k_sum_apart | Features{F::splits,   F::correction, F::acting_sides, F::columns,
                                    F::revolved, F::ranks,      F::batches};
    case StepWay::count: break;
  }
  return {};
}

/// Whether a run with these features may do its steps so.
constexpr bool can(StepWay way, Features of) { return (excluding(way).bits & of.bits) == 0; }

}  // namespace mpm
