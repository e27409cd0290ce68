// What the particles hold before the first step.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "step/stepper.hpp"

using namespace mpm;

namespace {

constexpr Vec3 k_lower = {1, -2, 3};  // m, of the mesh

/// A mesh of 8 cells a side, one linear elastic material and one body.
Config config_of(int dim) {
  Config config;
  config.dim = dim;
  config.mesh.spacing = 1;
  config.mesh.lower = k_lower;
  for (int d = 0; d < dim; ++d) config.mesh.upper[d] = k_lower[d] + 8;
  config.mesh.cells = {8, 8, dim == 3 ? 8 : 1};
  config.materials = {{"rock", "linear_elastic", 2000, {1e6, 0.3}}};
  config.bodies.emplace_back().name = "soil";
  return config;
}

/// Two particles.
BodyParticles pair_of(int dim) {
  BodyParticles particles;
  for (double x : {2.25, 2.75})
    for (int d = 0; d < dim; ++d) particles.position.push_back(x + d);
  particles.spacing = 0.5;
  particles.particle_volume = std::pow(0.5, dim);
  return particles;
}

/// What they hold on the device.
ParticleSnapshot start_of(const Config& config, BodyParticles particles) {
  const auto stepper = make_stepper(config);
  const int patch = config.dim == 2 ? 8 : 4;
  Model model;
  for (int d = 0; d < 3; ++d) model.patches[d] = d < config.dim ? 8 / patch + 2 : 1;
  model.bodies.push_back(std::move(particles));
  Failure failure;
  REQUIRE(stepper->set_up(std::move(model), &failure) == PETSC_SUCCESS);
  REQUIRE(failure.what.empty());
  Snapshot snapshot;
  stepper->snapshot(&snapshot);
  return snapshot.bodies.at(0);
}

}  // namespace

TEST_CASE("a body starts with its stress and velocity, of which each dimension has its components",
          "[start]") {
  for (int dim : {2, 3}) {
    Config config = config_of(dim);
    if (!make_stepper(config)) continue;  // built without this dimension
    config.bodies[0].stress = {-1, -2, -3, 4, dim == 3 ? 5. : 0, dim == 3 ? 6. : 0};
    config.bodies[0].velocity = {7, 8, dim == 3 ? 9. : 0};
    const ParticleSnapshot start = start_of(config, pair_of(dim));
    for (int p = 0; p < 2; ++p) {
      for (int k = 0; k < 6; ++k) CHECK(start.stress[6 * p + k] == config.bodies[0].stress[k]);
      for (int d = 0; d < 3; ++d) CHECK(start.velocity[3 * p + d] == config.bodies[0].velocity[d]);
      for (int d = 0; d < dim; ++d)
        CHECK(start.position[3 * p + d] == Catch::Approx(2.25 + 0.5 * p + d + k_lower[d]));
    }
  }
}
