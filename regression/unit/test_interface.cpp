// The interface of a rigid and the soil: shear as a fraction of the strength, and planes of symmetry.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A plate that rubs soil, whose strength at a height [cells] is strength(height) [Pa].
template <int Dim, class Strength>
Cloud rubbed_soil(double spacing, Strength&& strength) {
  Cloud cloud;
  cloud.grid = grid_of<Dim>({20, 20, 20}, spacing, Wall::roller);
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, {20, 12, 12}, 2, spacing), 2, spacing, 1)};
  BodyInput& body = cloud.bodies[0];
  for (std::size_t p = 0; p < strength_of(body).size(); ++p)
    strength_of(body)[p] = strength(body.position[p * Dim + Dim - 1] / spacing);
  // OverlapStream the lattice, where round-off would decide which nodes have a normal.
  std::array<double, 3> low{5.07, 5.11, 5.16}, high{13.07, 13.11, 13.16};
  low[Dim - 1] = 11.8, high[Dim - 1] = 13;
  RigidInput plate = rigid_of<Dim>(lattice<Dim>(low, high, 4, spacing), 4, spacing);
  plate.surface_normal = true;
  plate.velocity = {1, -0.5, -0.5};
  plate.reach = 0.15 * spacing;
  for (int d = 0; d < 3; ++d) {
    plate.surface.half[d] = (high[d] - low[d]) * spacing / 2;
    plate.surface.centre[d] = (high[d] + low[d]) * spacing / 2;
  }
  plate.surface.radius = spacing / 2;
  cloud.rigids = {plate};
  return cloud;
}

}  // namespace

TEST_CASE("a fraction of one strength is the limit that it comes to", "[interface]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const bool surface : {true, false})
      for (P2G how : k_strategies) {
        Cloud cloud = rubbed_soil<B::dim>(0.1, [](double) { return 3000.; });
        cloud.rigids[0].surface_normal = surface;
        if (!surface) cloud.rigids[0].reach = 0;
        cloud.rigids[0].shear_limit = 0.4 * 3000;
        auto limited = state_of<B>(cloud, how);
        cloud.rigids[0].shear_limit = 0;
        auto smooth = state_of<B>(cloud, how);
        cloud.rigids[0].shear_fraction = 0.4;
        auto shared = state_of<B>(cloud, how);
        // A node that was in contact has no relative velocity but round-off, which then decides whether it
        // still touches. With mass gradients and sums of threads or teams in any order, only the first step
        // is the same twice.
        const bool any_order = how == P2G::atomic ||
                               (is_device<typename B::Space> && how != P2G::gather && how != P2G::sequential);
        const int steps = any_order && !surface ? 1 : 6;
        for (auto* s : {&limited, &smooth, &shared}) run_steps(*s, 1e-4, steps);
        INFO(build.name() << ' ' << word_of(how) << (surface ? " surface" : " gradient"));
        CHECK(largest_difference(soil_fields(shared), soil_fields(limited)) < B::of(1e-11, 1e-3));
        CHECK(largest_difference(soil_fields(shared), soil_fields(smooth)) > (steps == 1 ? 3e-3 : 1e-2));
      }
  });
}

TEST_CASE("a strength that grows with depth is that of the depth at each node near a rigid", "[interface]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const auto strength = [](double height) { return 5000 - 300 * height; };
    for (P2G how : k_strategies) {
      Cloud cloud = rubbed_soil<Dim>(0.1, strength);
      cloud.rigids[0].shear_fraction = 1;
      auto s = state_of<B>(cloud, how);
      for (int n = 0; n < 2; ++n) {  // the second finds the sums of the first
        interpolate(s);
        REQUIRE(strength_to_nodes<typename B::Space, typename B::real, Dim>(s, nullptr) == PETSC_SUCCESS);
      }
      const Table field = nodes_of(s, s.nodes.strength);
      double largest = 0;
      for (int z = 8; z <= 11; ++z)
        for (int x = 7; x <= 11; ++x) {
          Coord<Dim> node{x, z};
          if constexpr (Dim == 3) node = {x, 8, z};
          const double* value = &field.value[s.grid.address_of(node) * field.width];
          const double got = value[StrengthTerms::strength] / value[StrengthTerms::volume];
          largest = std::max(largest, std::fabs(got / strength(z) - 1));
        }
      INFO(build.name() << ' ' << word_of(how));
      CHECK(largest < B::of(1e-12, 1e-5));
    }
  });
}

TEST_CASE("a rigid that a plane of symmetry cuts does not move across it by force", "[interface]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (const bool held : {false, true}) {
      Cloud cloud = rubbed_soil<Dim>(0.1, [](double) { return 3000.; });
      RigidInput& plate = cloud.rigids[0];
      plate.dynamic = true, plate.velocity = {}, plate.force = {1e3, 2e3, 3e3};
      plate.held[0] = held;
      auto s = state_of<B>(cloud, P2G::tile);
      run_steps(s, 1e-4, 20);
      const auto rigid = on_host(s.rigids)(0);
      INFO(build.name());
      CHECK((rigid.motion.pose.displacement[0] == 0) == held);
      CHECK((rigid.motion.velocity[0] == 0) == held);
      for (int d = 1; d < Dim; ++d) CHECK(rigid.motion.pose.displacement[d] > 0);
    }
  });
}
