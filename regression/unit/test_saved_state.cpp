// A state that is saved and put into another one goes on as if nothing had happened.

#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <cstring>
#include <random>

#include "compare.hpp"
#include "transfer/restore_state.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Whether a strategy sums in the same order every time.
template <class B>
bool gives_same_bits(P2G how) {
  return B::backend() == Backend::serial || how == P2G::gather || how == P2G::sequential;
}

/// Whether both have the same bits: where a test's cloud has burst, not-a-numbers too.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

bool same(const SavedPoints& a, const SavedPoints& b) {
  if (a.id != b.id || a.address != b.address || a.fields.size() != b.fields.size()) return false;
  for (std::size_t k = 0; k < a.fields.size(); ++k)
    if (a.fields[k].name != b.fields[k].name || !same(a.fields[k].values, b.fields[k].values)) return false;
  return true;
}

/// Everything, bit for bit, and the order of the particles on the device too.
bool same(const SavedState& a, const SavedState& b) {
  bool equal = a.bound == b.bound && a.increment == b.increment && same(a.soil, b.soil) &&
               a.impulse.address == b.impulse.address && a.impulse.values == b.impulse.values &&
               a.rigids == b.rigids;
  return equal;
}

/// Points as another number of ranks would have left them.
void shuffle(SavedPoints& points, int seed) {
  std::vector<std::size_t> order(points.id.size());
  for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  const SavedPoints former = points;
  for (std::size_t n = 0; n < order.size(); ++n) {
    points.id[n] = former.id[order[n]], points.address[n] = former.address[order[n]];
    for (std::size_t f = 0; f < points.fields.size(); ++f)
      for (int k = 0; k < points.fields[f].components; ++k)
        points.fields[f].values[n * points.fields[f].components + k] =
            former.fields[f].values[order[n] * former.fields[f].components + k];
  }
}

/// Moving bodies with friction; every particle feels the rebuilds by F-bar.
template <int Dim>
Cloud moving_cloud(int seed) {
  Cloud cloud = random_cloud<Dim>(seed, Wall::roller);
  for (BodyInput& body : cloud.bodies)
    for (double& stress : body.stress) stress *= 0.01;
  cloud.f_bar_fraction = 0.9, cloud.materials[1].f_bar_share = 0.4;
  cloud.p2g.margin = 0.1;
  cloud.gravity = {0, -10, -5};
  return cloud;
}

}  // namespace

TEST_CASE("a run from a saved state has the bits of the run that was saved", "[saved_state]") {
  constexpr double dt = 1e-4;
  for_each_build([&](auto build) {
    using B = decltype(build);
    for (const P2G how : k_strategies) {
      Cloud cloud = moving_cloud<B::dim>(5);
      give_own_domains<B::dim>(cloud, 5);
      auto whole = state_of<B>(cloud, how);
      run_steps(whole, dt, 37);
      SavedState saved = save_state(whole);
      REQUIRE(saved.bound > 0);  // particles have drifted
      shuffle(saved.soil, 3);
      auto again = state_of<B>(cloud, how);
      REQUIRE(restore_state(again, saved).empty());
      INFO(B::name() << " " << word_of(how));
      CHECK(same(save_state(again), save_state(whole)));
      if (!gives_same_bits<B>(how)) continue;
      run_steps(whole, dt, 120), run_steps(again, dt, 120);
      if (read_control(whole).fault_count >
          0) {  // the cloud has burst in the same step; which of its particles a thread met first is open
        CHECK(read_control(again).fault_count == read_control(whole).fault_count);
        CHECK(read_control(again).fault.kind == read_control(whole).fault.kind);
        if (B::backend() == Backend::serial)
          CHECK(read_control(again).fault.particle == read_control(whole).fault.particle);
        CHECK(read_control(again).steps + 37 == read_control(whole).steps);
        continue;
      }
      CHECK(same(save_state(again), save_state(whole)));
    }
  });
}

TEST_CASE("a state of one real type goes on in another", "[saved_state]") {
  constexpr double dt = 1e-4;
  for_each_build([&](auto build) {
    using B = decltype(build);
    const Cloud cloud = moving_cloud<B::dim>(4);
    auto reference = state_of<Reference<B::dim>>(cloud);
    run_steps(reference, dt, 20);
    auto other = state_of<B>(cloud);
    REQUIRE(restore_state(other, save_state(reference)).empty());
    run_steps(reference, dt, 5), run_steps(other, dt, 5);
    INFO(B::name());
    const SavedState a = save_state(reference), b = save_state(other);
    CHECK(a.soil.id == b.soil.id);
    double largest = 0;
    for (std::size_t n = 0; n < a.soil.fields[0].values.size(); ++n)
      largest = std::max(largest, std::abs(a.soil.fields[0].values[n] - b.soil.fields[0].values[n]));
    CHECK(largest < B::of(1e-12, 1e-4));
  });
}

TEST_CASE("a state that lacks a field or a rigid is refused by its name", "[saved_state]") {
  const Cloud cloud = moving_cloud<2>(5);
  auto s = state_of<Reference<2>>(cloud);
  const SavedState whole = save_state(s);
  for (const SavedField& field : whole.soil.fields) {
    SavedState lacking = whole;
    std::erase_if(lacking.soil.fields, [&](const SavedField& f) { return f.name == field.name; });
    CHECK(restore_state(s, lacking) == field.name);
    SavedState narrow = whole;
    for (SavedField& f : narrow.soil.fields)
      if (f.name == field.name) f.components += 1;
    CHECK(restore_state(s, narrow) == field.name);
  }
  SavedState one_rigid = whole;
  one_rigid.rigids.pop_back();
  CHECK(!restore_state(s, one_rigid).empty());
  CHECK(restore_state(s, whole).empty());
}
