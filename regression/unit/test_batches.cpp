// The soil in batches gives what it gives at once.

#include <catch2/catch_test_macros.hpp>

#include <cstring>
#include <set>

#include "compare.hpp"
#include "data/state_memory.hpp"
#include "rebuild/batches.hpp"
#include "transfer/download.hpp"
#include "transfer/restore_state.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Two bodies that fill most of the mesh, each particle with a velocity and a stress of its own, and two
/// rigids with friction, of which one takes a fraction of the strength if the seed is odd; with F-bar.
template <int Dim>
Cloud busy_cloud(int seed) {
  Cloud cloud = random_cloud<Dim>(seed, Wall::roller);
  Dice dice{std::mt19937_64(seed)};
  const auto& cells = cloud.grid.cells;
  const double spacing = cloud.grid.spacing, middle = cells[0] / 2;
  cloud.bodies.clear();
  for (const auto& [from, to] : {std::pair{1.0, middle}, std::pair{middle, cells[0] - 1.0}}) {
    cloud.bodies.push_back(body_of<Dim>(
        lattice<Dim>({from, 1, 1}, {to, cells[1] - 1.0, cells[2] - 1.0}, 2, spacing), 2, spacing, from < 2));
    BodyInput& body = cloud.bodies.back();
    for (std::size_t n = 0; n < body.position.size(); ++n) body.velocity.push_back(dice.uniform(-9, 9));
    for (std::size_t n = 0; n < strength_of(body).size() * sym_size<Dim>; ++n)
      body.stress.push_back(dice.uniform(-300, 300));
  }
  if (seed % 2 == 1) cloud.rigids[0].shear_limit = 0, cloud.rigids[0].shear_fraction = 0.4;
  cloud.f_bar_fraction = 0.9, cloud.materials[1].f_bar_share = 0.4;
  cloud.p2g.margin = 0.05;
  cloud.gravity = {0, -10, -5};
  return cloud;
}

/// A state whose batches have room on the device for about this share of the soil, or for the least.
template <class B>
StateOf<B> state_in_batches(Cloud cloud, double share) {
  cloud.memory_limit = 1e15;
  const auto roomy = state_of<B>(cloud, P2G::tile);
  const double room = roomy.batches.room.extent(0), beside = memory_of(roomy) - room;
  cloud.memory_limit = std::max(roomy.batches.least, beside * 17 / 16 + share * room);
  return state_of<B>(cloud, P2G::tile);
}

template <class Space, class T, int Dim>
SavedState saved(const State<Space, T, Dim>& s) {
  collect_soil(s);
  return save_state(s);
}

/// Largest difference of the particles' fields over the largest value of each; 0 only where all bits are
/// alike.
double difference(const SavedState& a, const SavedState& b) {
  if (a.soil.id != b.soil.id || a.soil.address != b.soil.address) return 1;
  double largest = 0;
  for (std::size_t f = 0; f < a.soil.fields.size(); ++f)
    largest = std::max(
        largest, largest_difference(Table{1, a.soil.fields[f].values}, Table{1, b.soil.fields[f].values}));
  return largest;
}

}  // namespace

TEST_CASE("steps in batches give what steps at once give, bit by bit on the host", "[batches]") {
  constexpr double dt = 1e-4;
  for_each_build([&](auto build) {
    using B = decltype(build);
    std::set<int> batches;
    for (const double share : {0.6, 0.3, 0.0}) {
      const Cloud cloud = busy_cloud<B::dim>(share > 0.5 ? 4 : 5);
      auto whole = state_of<B>(cloud, P2G::tile);
      auto parts = state_in_batches<B>(cloud, share);
      INFO(B::name() << ", room for " << share << " of the soil");
      const auto& all = parts.batches.all;
      const int places = parts.batches.places;
      REQUIRE(places >= 3);
      REQUIRE(static_cast<int>(all.size()) > places);  // some take turns
      CHECK(all.front().stays == (places > 3));
      CHECK(!all.back().stays);
      batches.insert(static_cast<int>(all.size()));
      CHECK(memory_of(parts) <= parts.batches.limit);
      const int rebuilds = run_steps(whole, dt, 40);
      CHECK(run_steps(parts, dt, 40) == rebuilds);
      CHECK(rebuilds > 0);
      CHECK(memory_of(parts) <= parts.batches.limit);
      const SavedState a = saved(parts), b = saved(whole);
      CHECK(difference(a, b) <= (is_device<typename B::Space> ? B::of(1e-9, 1e-2) : 0));
      if (!is_device<typename B::Space>) CHECK(a.impulse.values == b.impulse.values);
      CHECK(parts.batches.cost.copied_out > 0);
    }
    CHECK(batches.size() > 1);
  });
}

TEST_CASE("what goes in batches covers each patch once, and leaves the rest of it at home", "[batches]") {
  for_each_build([&](auto build) {
    using B = decltype(build);
    const auto s = state_in_batches<B>(busy_cloud<B::dim>(7), 0.3);
    const auto active_slots = on_host(s.soil.bins.active_slots);
    std::multiset<int> expected, got;
    for (int n = 0; n < s.soil.bins.last_active; ++n) expected.insert(active_slots(n));
    int particles = 0;
    for (const auto& batch : s.batches.all) {
      const auto slots = on_host(batch.set.bins.active_slots);
      for (int n = 0; n < batch.set.bins.last_active; ++n) got.insert(slots(n));
      CHECK(batch.first == particles);
      particles = batch.last;
    }
    INFO(B::name());
    CHECK(got == expected);
    CHECK(particles == s.soil.points.count);
  });
}

TEST_CASE("a state goes on in batches to the same bits, wherever it was saved", "[batches]") {
  constexpr double dt = 1e-4;
  for_each_reference([&](auto build) {
    using B = decltype(build);
    const Cloud cloud = busy_cloud<B::dim>(5);
    auto whole = state_of<B>(cloud, P2G::tile);
    auto parts = state_in_batches<B>(cloud, 0.3);
    run_steps(whole, dt, 21), run_steps(parts, dt, 21);
    auto again = state_in_batches<B>(cloud, 0.5);
    REQUIRE(restore_state(again, saved(parts)).empty());
    CHECK(memory_of(again) <= again.batches.limit);
    run_steps(whole, dt, 21), run_steps(again, dt, 21);
    CHECK(difference(saved(again), saved(whole)) == 0);
  });
}

TEST_CASE("the lowest limit is reported, and it does", "[batches]") {
  for_each_build([&](auto build) {
    using B = decltype(build);
    Cloud cloud = busy_cloud<B::dim>(5);
    cloud.memory_limit = 1;
    const double least = state_of<B>(cloud, P2G::tile).batches.least;
    INFO(B::name());
    cloud.memory_limit = least - 1;
    CHECK(state_of<B>(cloud, P2G::tile).batches.all.empty());
    cloud.memory_limit = least;
    const auto s = state_of<B>(cloud, P2G::tile);
    CHECK(s.batches.all.size() > 3);
    CHECK(memory_of(s) <= least);
  });
}
