// Particles before the first step.

#include <unistd.h>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <cmath>
#include <filesystem>
#include <limits>

#include "checkpoint/checkpoint.hpp"
#include "input/files/particle_file.hpp"
#include "mesh/background.hpp"
#include "output/frame_fields.hpp"
#include "output/frames.hpp"
#include "step/stepper.hpp"

using namespace mpm;

namespace {

constexpr Vec3 k_lower = {1, -2, 3};  // m, of the mesh

/// A mesh of 8 cells a side, clay and one body.
Config config_of(int dim) {
  Config config;
  config.dim = dim;
  config.mesh.spacing = 1;
  config.mesh.lower = k_lower;
  for (int d = 0; d < dim; ++d) config.mesh.upper[d] = k_lower[d] + 8;
  config.mesh.cells = {8, 8, dim == 3 ? 8 : 1};
  config.materials = {{"clay", "von_mises", 2000, {1e6, 0.3, 1e3}}};
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

/// Particles of the device at the start of a run with these particles.
ParticleSnapshot start_of(const Config& config, BodyParticles particles) {
  const auto stepper = make_stepper(config);
  const int patch = patch_edge(config.dim);
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
  /// Fault of a file of these particles; empty where there is none.
  std::string fault(const ParticleSnapshot& particles, int dim = 2) {
    ParticleTable table;
    return fault(particles, table, dim);
  }
  /// Fault of the file, and its table; a frame has the dimension of its run.
  std::string fault(const ParticleSnapshot& particles, ParticleTable& table, int dim, int dim_of_frame = 0,
                    const FrameStyle& style = {}) {
    REQUIRE(write_frame(path, {0.5, 12, {particles}, {}, {}, dim_of_frame}, Precision::double_, style) ==
            PETSC_SUCCESS);
    return read_particles({path, "soil", true, true, {"plastic_strain"}, {"su"}}, config_of(dim).mesh, dim,
                          table);
  }
};

/// Three particles of which no two numbers are the same; in 2D as a frame has them, with zeros.
ParticleSnapshot three(int dim) {
  ParticleSnapshot p;
  p.name = "soil", p.state = {{"plastic_strain", {}}};
  for (int n = 0; n < 3; ++n) {
    for (int d = 0; d < 3; ++d) p.position.push_back(d < dim ? k_lower[d] + 1 + n + d / 8. : 0);
    for (int d = 0; d < 3; ++d) p.velocity.push_back(d < dim ? 1 + n + d / 4. : 0);
    for (int k = 0; k < 6; ++k) p.stress.push_back(k < 4 || dim == 3 ? -1000 * (n + 1) + k : 0);
    p.state[0].values.push_back(0.25 * n);
    p.volume.push_back(0.125 + n / 64.);
    p.mass.push_back(250 + n / 3.), p.reference_height.push_back(k_lower[dim - 1] + n / 7.);
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
    CHECK(file.fault(expected, table, dim, dim).empty());
    CHECK(table.origin == "frame of step 12, 0.5 s");
    BodyParticles particles;
    particles.position = table.position, particles.velocity = table.velocity;
    particles.stress = table.stress, particles.state = table.state;
    particles.volume = table.volume, particles.mass = table.mass, particles.least_mass = 250;
    particles.reference_height = table.reference_height, particles.spacing = 0.5;
    for (std::size_t k = 0; k < particles.position.size(); ++k) particles.position[k] -= k_lower[k % dim];
    const ParticleSnapshot start = start_of(config, particles);
    CHECK(start.position == expected.position);
    CHECK(start.velocity == expected.velocity);
    CHECK(start.stress == expected.stress);
    CHECK(start.volume == expected.volume);
    REQUIRE((start.state.size() == 1 && start.state[0].name == "plastic_strain"));
    CHECK(start.state[0].values == expected.state[0].values);
    CHECK(start.mass == expected.mass);
    CHECK(start.reference_height == expected.reference_height);
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
  CHECK_THAT(spoilt([](auto& p) { p.volume[1] *= 2; }), Equals(""));
  CHECK_THAT(spoilt([](auto& p) { p.volume[1] = 0; }),
             Equals("particles whose volume is greater than 0; that of particle 1 is 0"));
  CHECK_THAT(spoilt([](auto& p) { p.mass[2] = -1; }),
             Equals("particles whose mass is greater than 0; that of particle 2 is -1"));
  CHECK_THAT(spoilt([](auto& p) { p.position[3] = 9; }),  // the upper side is not in a cell
             Equals("particles inside the mesh, 1,-2 to 9,6; particle 1 is at 9,0.125"));
  CHECK_THAT(spoilt([](auto& p) { p.position[7] = -2.1; }), StartsWith("particles inside the mesh"));
  CHECK_THAT(spoilt([](auto& p) { p.stress[6] = std::numeric_limits<double>::quiet_NaN(); }),
             Equals("a file whose soil/stress is finite; that of particle 1 is not"));
  CHECK_THAT(spoilt([](auto& p) { p.name = "clay"; }), Equals("a file with the group soil"));
  CHECK_THAT(spoilt([](auto& p) { p = {}, p.name = "soil"; }),
             Equals("a file whose soil/position is N x 3 numbers"));
}

TEST_CASE("a frame that lacks what a start needs is refused by the field's name, a file of one's own not",
          "[start]") {
  File file;
  for (const char* left_out :
       {"velocity", "stress", "volume", "plastic_strain", "mass", "reference_height"}) {
    FrameStyle style;
    for (const std::string& name : frame_field_names())
      if (name != left_out) style.fields.push_back(name);
    ParticleTable table;
    const std::string fault = file.fault(three(2), table, 2, 2, style);
    CHECK(fault.find("soil/" + std::string(left_out)) != std::string::npos);
    const bool required = std::string(left_out) == "volume";
    CHECK(file.fault(three(2), table, 2, 0, style).empty() == !required);
  }
  ParticleTable table;
  FrameStyle still{{"volume", "plastic_strain", "mass", "reference_height"}, 0};
  CHECK(!file.fault(three(2), table, 2, 2, still).empty());
  CHECK(read_particles({file.path, "soil", false, false}, config_of(2).mesh, 2, table).empty());
  CHECK((table.velocity.empty() && table.stress.empty() && table.mass.size() == 3));
  CHECK(file.fault(three(2), table, 3, 2) == "a frame of a run in 3D");

  ParticleSnapshot beyond = three(2);  // as a run may leave them between two rebuilds
  beyond.position[0] = k_lower[0] - 0.4, beyond.position[4] = k_lower[1] + 8;
  CHECK(!file.fault(beyond, table, 2).empty());
  CHECK(file.fault(beyond, table, 2, 2).empty());
  CHECK((table.put_inside == 2 && table.position[0] > k_lower[0] && table.position[0] < k_lower[0] + 1e-5));
  CHECK((table.position[3] < k_lower[1] + 8 && table.position[3] > k_lower[1] + 8 - 1e-5));
  CHECK(table.position[1] == beyond.position[1]);
  beyond.position[0] = k_lower[0] - 0.6;
  CHECK(!file.fault(beyond, table, 2, 2).empty());
}

TEST_CASE("a strength follows the height where the particle was created", "[start]") {
  for (int dim : {2, 3}) {
    Config config = config_of(dim);
    if (!make_stepper(config)) continue;
    config.materials = {{"clay", "von_mises", 2000, {1e6, 0.3, 1000, 500, 6}}};
    BodyParticles particles = pair_of(dim);
    particles.reference_height = {4.5, 3.25};
    const auto stepper = make_stepper(config);
    Model model;
    for (int d = 0; d < 3; ++d) model.patches[d] = d < dim ? 8 / (patch_edge(dim)) + 2 : 1;
    model.bodies.push_back(particles);
    Failure failure;
    REQUIRE(stepper->set_up(std::move(model), &failure) == PETSC_SUCCESS);
    SavedState saved;
    REQUIRE(stepper->save(&saved) == PETSC_SUCCESS);
    for (const SavedField& field : saved.soil.fields)
      for (std::size_t p = 0; p < 2; ++p) {
        const double height = particles.reference_height[saved.soil.id[p]];
        if (field.name == "strength") CHECK(field.values[p] == 1000 + 500 * (6 - height));
        if (field.name == "reference_height") CHECK(field.values[p] == height);
        if (field.name == "mass") CHECK(field.values[p] == 2000 * std::pow(0.5, dim));
      }
    CHECK(saved.soil.fields.back().name == "reference_height");
  }
}

TEST_CASE("a strength that a file gives each particle is in the state, the frames and the checkpoints",
          "[start]") {
  const std::vector<double> own = {1234.5, 99.25};
  for (const char* model : {"von_mises", "tresca", "softening_clay", "mohr_coulomb", "drucker_prager"})
    for (int dim : {2, 3}) {
      const bool rubs = std::string(model).find("_coulomb") != std::string::npos || model[0] == 'd';
      const std::string key = rubs ? "cohesion" : "su";
      Config config = config_of(dim);
      if (!make_stepper(config)) continue;
      config.materials = {{"clay", model, 2000,
                           rubs ? std::vector{1e6, 0.3, 500., 20.} : std::vector{1e6, 0.3, 500., 50., 9.}}};
      if (key == "cohesion" && model[0] == 'd')
        config.materials[0].parameters = {1e6, 0.3, 500, 20, 0, -1, 0, 0, 2};
      if (model[0] == 's') config.materials[0].parameters = {1e6, 0.3, 500, 50, 9, 0, 1};
      BodyParticles particles = pair_of(dim);
      particles.own_parameters = {{key, own}};
      config.bodies[0].largest_own[0] = own[0];
      const auto stepper = make_stepper(config);
      Model start;
      for (int d = 0; d < 3; ++d) start.patches[d] = d < dim ? 8 / patch_edge(dim) + 2 : 1;
      start.bodies = {particles};
      Failure failure;
      REQUIRE(stepper->set_up(std::move(start), &failure) == PETSC_SUCCESS);
      Snapshot frame;
      Checkpoint c;
      REQUIRE(stepper->snapshot(&frame) == PETSC_SUCCESS);
      REQUIRE(stepper->save(&c.state) == PETSC_SUCCESS);
      frame.dim = dim;
      CHECK(frame.bodies[0].own_names == std::vector{key});
      c.version = "1", c.dim = dim, c.backend = "serial", c.precision = "double", c.strategy = "tile";
      c.options = {{"-bodies", "soil", "", false},
                   {"-soil_material", "clay", "", false},
                   {"-soil_file", "a file" + own_parameter_words(key), "", false},
                   {"-clay_model", model, "", false},
                   {"-mesh_lower", dim == 2 ? "1,-2" : "1,-2,3", "m", false},
                   {"-mesh_upper", dim == 2 ? "9,6" : "9,6,11", "m", false},
                   {"-mesh_spacing", "1", "m", false}};
      Checkpoint without = c;
      without.options[2].value = "a file";
      File file;
      REQUIRE(write_checkpoint(PETSC_COMM_SELF, file.path, std::move(c)) == PETSC_SUCCESS);
      REQUIRE(write_checkpoint(PETSC_COMM_SELF, file.path + ".without", std::move(without)) == PETSC_SUCCESS);
      REQUIRE(write_frame(file.path + ".frame", frame, Precision::double_) == PETSC_SUCCESS);
      const auto read = [&](const std::string& path, const std::string& parameter) {
        ParticleTable table;
        INFO(model << " " << path);
        std::vector<std::string> keys;
        if (!parameter.empty()) keys.push_back(parameter);
        CHECK(read_particles({path, "soil", true, true, {}, keys}, config.mesh, dim, table) == "");
        return table.own_parameters.empty() ? std::vector<double>{} : table.own_parameters[0].values;
      };
      CHECK(read(file.path, key) == own);
      CHECK(read(file.path + ".frame", key) == own);
      CHECK(read(file.path + ".without", key).empty());
      CHECK(read(file.path, key == "su" ? "cohesion" : "su").empty());
      CHECK(read(file.path + ".frame", "").empty());
    }
}

TEST_CASE("a frame whose -output_fields left out the particles' own strength is refused", "[start]") {
  File file;
  ParticleSnapshot particles = three(2);
  particles.state.push_back({"su", {3, 2, 1}});
  ParticleTable table;
  const auto own = [](const ParticleTable& of) {
    return of.own_parameters.empty() ? std::vector<double>{} : of.own_parameters[0].values;
  };
  CHECK(file.fault(particles, table, 2, 2) == "");  // copied to the frame by the user
  CHECK(own(table) == std::vector<double>{3, 2, 1});
  FrameStyle style;
  for (const std::string& name : frame_field_names())
    if (name != "su") style.fields.push_back(name);
  CHECK(file.fault(particles, table, 2, 2, style) == "");
  CHECK(own(table).empty());
  particles.own_names = {"su"};
  CHECK(file.fault(particles, table, 2, 2) == "");
  CHECK(own(table) == std::vector<double>{3, 2, 1});
  CHECK(file.fault(particles, table, 2, 2, style) ==
        "a frame with soil/su, which -output_fields of its run left out");
  particles.own_names = {"cohesion", "young"};  // of another law
  CHECK(file.fault(particles, table, 2, 2, style) == "");
}

TEST_CASE("particles of a checkpoint are those of its frame, by the body's name", "[start]") {
  for (int dim : {2, 3}) {
    Config config = config_of(dim);
    config.bodies.insert(config.bodies.begin(), BodyConfig{});
    config.bodies[0].name = "fill";
    config.velocity_update = VelocityUpdate::apic;
    if (!make_stepper(config)) continue;
    const auto stepper = make_stepper(config);
    Model model;
    for (int d = 0; d < 3; ++d) model.patches[d] = d < dim ? 8 / (patch_edge(dim)) + 2 : 1;
    model.bodies = {pair_of(dim), pair_of(dim)};
    BodyParticles& soil = model.bodies[1];
    for (double& x : soil.position) x += 1.0 / 3;
    for (std::size_t k = 0; k < soil.position.size(); ++k) soil.velocity.push_back(1 + 0.1 * k);
    soil.mass = {240, 260.125}, soil.least_mass = 240, soil.volume = {0.12, 0.13};
    soil.reference_height = {2.5, -1}, soil.state = {{"plastic_strain", {0.5, 0}}};
    Failure failure;
    REQUIRE(stepper->set_up(std::move(model), &failure) == PETSC_SUCCESS);
    Batch batch;
    REQUIRE(stepper->advance({.count = 3, .dt = 1e-3}, &batch) == PETSC_SUCCESS);
    Snapshot frame;
    Checkpoint c;
    REQUIRE(stepper->snapshot(&frame) == PETSC_SUCCESS);
    REQUIRE(stepper->save(&c.state) == PETSC_SUCCESS);
    c.version = "1", c.dim = dim, c.backend = "serial", c.precision = "double", c.strategy = "tile";
    c.options = {{"-bodies", "fill,soil", "", false},
                 {"-soil_material", "clay", "", false},
                 {"-clay_model", "von_mises", "", false},
                 {"-mesh_lower", dim == 2 ? "1,-2" : "1,-2,3", "m", false},
                 {"-mesh_upper", dim == 2 ? "9,6" : "9,6,11", "m", false},
                 {"-mesh_spacing", "1", "m", false}};
    File file;
    REQUIRE(write_checkpoint(PETSC_COMM_SELF, file.path, std::move(c)) == PETSC_SUCCESS);
    REQUIRE(write_frame(file.path + ".frame", frame, Precision::double_) == PETSC_SUCCESS);

    MeshConfig finer = config.mesh;  // and larger
    finer.spacing = 0.5, finer.lower[0] = 0, finer.cells = {18, 16, dim == 3 ? 16 : 1};
    ParticleTable from_frame, from_checkpoint;
    const std::vector<std::string> state = {"plastic_strain"};
    REQUIRE(
        read_particles({file.path + ".frame", "soil", true, true, state}, finer, dim, from_frame).empty());
    REQUIRE(read_particles({file.path, "soil", true, true, state}, finer, dim, from_checkpoint).empty());
    for (const auto& table : {from_frame, from_checkpoint}) {
      REQUIRE((table.state.size() == 1 && table.state[0].name == state[0]));
      CHECK(table.state[0].values == from_frame.state[0].values);
      CHECK(table.state[0].values.at(0) == 0.5);
    }
    for (auto values : {&ParticleTable::position, &ParticleTable::velocity, &ParticleTable::stress,
                        &ParticleTable::volume, &ParticleTable::mass, &ParticleTable::reference_height}) {
      const std::vector<double>&a = from_frame.*values, &b = from_checkpoint.*values;
      REQUIRE((a.size() == b.size() && !a.empty()));
      for (std::size_t k = 0; k < a.size(); ++k) CHECK(std::fabs(a[k] - b[k]) <= 1e-14 * std::fabs(a[k]));
    }
    CHECK(from_checkpoint.mass == std::vector<double>{240, 260.125});
    CHECK(from_checkpoint.reference_height == std::vector<double>{2.5, -1});
    CHECK(from_frame.velocity_gradient.empty());
    CHECK(static_cast<int>(from_checkpoint.velocity_gradient.size()) == 2 * dim * dim);

    ParticleTable table;
    CHECK(read_particles({file.path, "rock"}, finer, dim, table) ==
          "a checkpoint with the body rock; it has fill, soil");
    CHECK(read_particles({file.path, "soil"}, finer, 5 - dim, table) ==
          "a checkpoint of a run in " + std::to_string(5 - dim) + "D");
    finer.lower[1] = 5, finer.cells[1] = 2;
    CHECK(read_particles({file.path, "soil"}, finer, dim, table).starts_with("particles inside the mesh"));
  }
}
