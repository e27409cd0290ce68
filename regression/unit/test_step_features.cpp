// Features of a run against ways of doing a step: the plan follows the table, which is asked by all.

#include <catch2/catch_test_macros.hpp>

#include "clouds.hpp"
#include "data/features_of.hpp"
#include "functions/step_kernels.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr int k_features = static_cast<int>(Feature::count), k_ways = static_cast<int>(StepWay::count);

/// Gives a state this feature alone.
template <class State_>
void put(State_& s, Feature f) {
  using Memory = typename State_::Memory;
  switch (f) {
    case Feature::other_strategy: s.p2g.strategy = P2G::atomic; break;
    case Feature::xpic: s.scheme.xpic_order = 2; break;
    case Feature::apic: s.soil.points.has_affine = true; break;
    case Feature::splits: s.soil.points.splits = true; break;
    case Feature::correction: s.correction.on = true; break;
    case Feature::saturated: s.flow.pores = decltype(s.flow.pores)("pores", 1); break;
    case Feature::submerged: s.water.density = 1000; break;
    case Feature::energy: s.energy.on = true; break;
    case Feature::loads: s.loads.now = decltype(s.loads.now)("loads", 1); break;
    case Feature::rayleigh: s.scheme.rayleigh = true; break;
    case Feature::damping: s.scheme.damping = 0.5; break;
    case Feature::shear_fraction: s.shear_fraction = true; break;
    case Feature::friction: s.has_friction = true; break;
    case Feature::acting_sides: s.sides.mask = 1; break;
    case Feature::columns: s.sides.columns = decltype(s.sides.columns)("columns", 1); break;
    case Feature::gravity_table: s.timed.moves_gravity = true; break;
    case Feature::side_table: s.timed.moves_sides = true; break;
    case Feature::contact_sites: s.at_sites.in_use = true; break;
    case Feature::interfaces:
      s.interfaces.fields = 2;
      s.interfaces.laws = decltype(s.interfaces.laws)("laws", 4);
      break;
    case Feature::pushed_mass_normals: s.rigid_dynamic = s.mass_normals = true; break;
    case Feature::turning_rigids: s.rigid_turns = true; break;
    case Feature::many_rigids: s.contact.near.listed = true; break;
    case Feature::rigid_pairs: s.pairs.count = 1; break;
    case Feature::linked_rigids: s.links.supports = decltype(s.links.supports)("supports", 1); break;
    case Feature::light_rigids: s.light_rigids.in_use = true; break;
    case Feature::united_rigids: s.vertices.parts = decltype(s.vertices.parts)("parts", 1); break;
    case Feature::revolved: s.soil.points.rings = true; break;
    case Feature::ranks: s.owned_nodes = Kokkos::View<std::uint64_t*, Memory>("owned", 1); break;
    case Feature::batches: s.batches.limit = 1; break;
    case Feature::count: break;
  }
}

template <class B>
auto small_state(Dice& dice) {
  Cloud cloud;
  cloud.grid = grid_of<B::dim>({12, 8, 8}, 0.1, Wall::free);
  cloud.materials = clays();
  cloud.bodies = {random_body<B::dim>(dice, {2, 2, 2}, {8, 6, 6}, 0.8, 2, 0.1)};
  return state_of<B>(cloud, P2G::tile);
}

}  // namespace

TEST_CASE("two features exclude what either excludes", "[step]") {
  for (int a = 0; a < k_features; ++a)
    for (int b = 0; b < k_features; ++b)
      for (int w = 0; w < k_ways; ++w) {
        const auto way = static_cast<StepWay>(w);
        const Feature one{a}, other{b};
        CHECK(can(way, {one, other}) == (can(way, {one}) && can(way, {other})));
      }
}

TEST_CASE("every feature of a state is found, and alone", "[step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Dice dice{std::mt19937_64(3)};
    const Features bare = features_of(small_state<B>(dice));
    CHECK(bare.bits == 0);
    for (int f = 0; f < k_features; ++f) {
      auto s = small_state<B>(dice);
      put(s, Feature{f});
      INFO("feature " << f);
      CHECK(features_of(s).bits == Features{Feature{f}}.bits);
    }
  });
}

TEST_CASE("the plan of the steps does nothing that a pair of features excludes", "[step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Dice dice{std::mt19937_64(3)};
    for (int a = 0; a < k_features; ++a)
      for (int b = a; b < k_features; ++b) {
        auto s = small_state<B>(dice);
        const bool ahead = plan_step(s).sums_ahead;
        put(s, Feature{a}), put(s, Feature{b});
        const Features features{Feature{a}, Feature{b}};
        const StepPlan plan = plan_step(s);
        INFO("features " << a << ", " << b);
        CHECK(plan.sums_ahead == (ahead && can(StepWay::sums_ahead, features)));
        CHECK((!plan.nodes_apart || can(StepWay::nodes_apart, features)));
        CHECK((!plan.nodes_aside || (plan.nodes_apart && can(StepWay::nodes_aside, features))));
        CHECK((plan.form != StepForm::persistent || can(StepWay::one_launch, features)));
        CHECK((plan.form == StepForm::out_of_core) == features.has(Feature::batches));
      }
  });
}
