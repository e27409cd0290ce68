// What the particles hold before the first step.

#include <unistd.h>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <cmath>
#include <filesystem>
#include <limits>

#include "input/particle_file.hpp"
#include "output/frames.hpp"
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

/// A file in a folder of its own, which goes with its scope.
struct File {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("mpm_start_" + std::to_string(::getpid()));
  std::string path = (folder / "particles.h5").string();
  File() { std::filesystem::create_directories(folder); }
  ~File() { std::filesystem::remove_all(folder); }
  /// What is wrong with a file of these particles; empty where nothing is.
  std::string fault(const ParticleSnapshot& particles, int dim = 2) {
    REQUIRE(write_frame(path, {0, 0, {particles}, {}}, Precision::double_) == PETSC_SUCCESS);
    ParticleTable table;
    return read_particles(path, "soil", config_of(dim).mesh, dim, table);
  }
};

/// Three particles of which no two numbers are the same; in 2D as a frame has them, with zeros.
ParticleSnapshot three(int dim) {
  ParticleSnapshot p;
  p.name = "soil";
  for (int n = 0; n < 3; ++n) {
    for (int d = 0; d < 3; ++d) p.position.push_back(d < dim ? k_lower[d] + 1 + n + d / 8. : 0);
    for (int d = 0; d < 3; ++d) p.velocity.push_back(d < dim ? 1 + n + d / 4. : 0);
    for (int k = 0; k < 6; ++k) p.stress.push_back(k < 4 || dim == 3 ? -1000 * (n + 1) + k : 0);
    p.plastic_strain.push_back(0.25 * n);
    p.volume.push_back(0.125);
  }
  p.grid_velocity = p.velocity;
  return p;
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

TEST_CASE("a body whose particles a frame lists starts as the frame's did", "[start]") {
  for (int dim : {2, 3}) {
    const Config config = config_of(dim);
    if (!make_stepper(config)) continue;
    File file;
    const ParticleSnapshot expected = three(dim);
    REQUIRE(file.fault(expected, dim).empty());
    ParticleTable table;
    CHECK(read_particles(file.path, "soil", config.mesh, dim, table).empty());
    BodyParticles particles;
    particles.position = table.position, particles.velocity = table.velocity;
    particles.stress = table.stress, particles.plastic_strain = table.plastic_strain;
    particles.spacing = 0.5, particles.particle_volume = table.particle_volume;
    for (std::size_t k = 0; k < particles.position.size(); ++k) particles.position[k] -= k_lower[k % dim];
    const ParticleSnapshot start = start_of(config, particles);
    CHECK(start.position == expected.position);
    CHECK(start.velocity == expected.velocity);
    CHECK(start.stress == expected.stress);
    CHECK(start.volume == expected.volume);
    CHECK(start.plastic_strain == expected.plastic_strain);
  }
}

TEST_CASE("a file of particles is refused for the first thing that is wrong with it", "[start]") {
  using Catch::Matchers::Equals, Catch::Matchers::StartsWith;
  File file;
  const auto spoilt = [&](auto&& spoil) {
    ParticleSnapshot particles = three(2);
    spoil(particles);
    return file.fault(particles);
  };
  CHECK_THAT(spoilt([](auto&) {}), Equals(""));
  CHECK_THAT(spoilt([](auto& p) { p.volume[1] *= 1 + 5e-7; }), Equals(""));
  CHECK_THAT(spoilt([](auto& p) { p.volume[1] *= 1 + 2e-6; }), StartsWith("particles whose volumes are"));
  CHECK_THAT(spoilt([](auto& p) { p.volume = {0, 0, 0}; }), StartsWith("particles whose volumes are"));
  CHECK_THAT(spoilt([](auto& p) { p.position[3] = 9; }),  // the upper side is not in a cell
             Equals("particles inside the mesh, 1,-2 to 9,6; particle 1 is at 9,0.125"));
  CHECK_THAT(spoilt([](auto& p) { p.position[7] = -2.1; }), StartsWith("particles inside the mesh"));
  CHECK_THAT(spoilt([](auto& p) { p.stress[6] = std::numeric_limits<double>::quiet_NaN(); }),
             Equals("a file whose soil/stress is finite; that of particle 1 is not"));
  CHECK_THAT(spoilt([](auto& p) { p.name = "clay"; }), Equals("a file with the group soil"));
  CHECK_THAT(spoilt([](auto& p) { p = {}, p.name = "soil"; }),
             Equals("a file whose soil/position is N x 3 numbers"));
}
