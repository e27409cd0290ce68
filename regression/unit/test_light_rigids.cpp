// Light rigid bodies: contact takes them with the velocity that its impulses leave them.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "functions/light_rigids.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// A block of soil in free space, and above it a light plate that goes into it.
template <int Dim>
Cloud hit_block(double density) {
  const double spacing = 0.1;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({20, 18, 12}, spacing, Wall::free);
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>(lattice<Dim>({6, 5, 3}, {14, 9, 8}, 2, spacing), 2, spacing, 1)};
  cloud.rigids = {rigid_of<Dim>(lattice<Dim>({8, 9, 4}, {12, 11, 7}, 4, spacing), 4, spacing)};
  RigidInput& plate = cloud.rigids[0];
  plate.velocity = {0.3, -0.5, 0.1};
  plate.density = density;
  plate.dynamic = plate.light = true;
  plate.surface_normal = true;
  plate.surface.kind = SurfaceKind::box;
  plate.surface.centre = {1.0, 1.0, Dim == 3 ? 0.55 : 0};
  plate.surface.half = {0.2, 0.1, Dim == 3 ? 0.15 : 0};
  plate.shear_limit = std::numeric_limits<double>::infinity();
  return cloud;
}

}  // namespace

TEST_CASE("contact leaves a light body the velocity with which it stopped the soil", "[light_rigids]") {
  struct Interface {
    double friction, shear_limit;  // -, Pa
  };
  const double rough = std::numeric_limits<double>::infinity();
  for_each_build([&](auto build) {
    using B = decltype(build);
    for (const Interface& interface : {Interface{-1, rough}, Interface{0.3, rough}, Interface{-1, 1e3}})
      for (const double density : {1e-2, 1., 30.}) {
        Cloud cloud = hit_block<B::dim>(density);
        cloud.rigids[0].friction = interface.friction;
        cloud.rigids[0].shear_limit = interface.shear_limit;
        auto s = state_of<B>(cloud, P2G::tile);
        run_steps(s, 1e-4, 1);
        const auto motion = on_host(s.light_rigids.motions)(0);
        const auto rigid = on_host(s.rigids)(0);
        INFO(build.name() << " density " << density << " friction " << interface.friction << " shear limit "
                          << interface.shear_limit);
        if (interface.friction < 0) CHECK(!motion.open);  // else all rounds may be needed
        CHECK(rigid.motion.velocity[1] > -0.1);           // much heavier soil has stopped it
        for (int d = 0; d < B::dim; ++d)
          CHECK(std::fabs(rigid.motion.velocity[d] - motion.end.velocity[d]) < B::of(1e-9, 1e-3));
      }
  });
}

TEST_CASE("a light body and the soil that it hits keep their momentum and gain no energy", "[light_rigids]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const double density : {1e-2, 1., 30.}) {
      auto s = state_of<B>(hit_block<B::dim>(density), P2G::tile);
      s.scheme.mass_cut = 0;  // a node of hardly any mass drops its force
      const auto before = total_momentum(s);
      const double mass = on_host(s.rigids)(0).inertia.mass;
      double fastest = 0;
      for (int n = 0; n < 100; ++n) {
        run_steps(s, 1e-4, 1);
        const auto rigid = on_host(s.rigids)(0);
        double square = 0;
        for (int d = 0; d < B::dim; ++d) square += rigid.motion.velocity[d] * rigid.motion.velocity[d];
        fastest = std::max(fastest, std::sqrt(square));
      }
      const auto after = total_momentum(s);
      INFO(build.name() << " density " << density << " fastest " << fastest);
      CHECK(read_control(s).fault_count == 0);
      CHECK(fastest < 0.2);  // it came with 0.59 m/s
      for (int d = 0; d < B::dim; ++d)
        CHECK(std::fabs(after[d] - before[d]) < B::of(1e-11, 1e-4) * mass + B::of(1e-14, 1e-5));
    }
  });
}

TEST_CASE("a rehearsal of contact changes nothing but the velocity of light bodies", "[light_rigids]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = hit_block<B::dim>(1);
    cloud.rigids[0].friction = 0.3;
    auto s = state_of<B>(cloud, P2G::tile);
    run_steps(s, 1e-4, 3);
    interpolate(s);
    const auto impulse = on_host(s.nodes.impulse);
    const auto soil = on_host(s.nodes.soil);
    begin_light_rigids(s, 1e-4, false, s.space);
    sum_light_rigids(s, 1e-4, false, s.space);
    solve_light_rigids(s, 1e-4, false, s.space);
    const auto impulse_after = on_host(s.nodes.impulse);
    const auto soil_after = on_host(s.nodes.soil);
    INFO(build.name());
    bool same = true;
    for (std::size_t n = 0; n < impulse.span(); ++n)
      same = same && impulse.data()[n] == impulse_after.data()[n];
    for (std::size_t n = 0; n < soil.span(); ++n) same = same && soil.data()[n] == soil_after.data()[n];
    CHECK(same);
  });
}
