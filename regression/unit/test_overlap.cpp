// Bodies in the place of others, and inputs that are likely to be mistakes.

#include <unistd.h>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <filesystem>
#include <numbers>

#include "check/alike.hpp"
#include "check/overlap.hpp"
#include "check/warnings.hpp"
#include "common/text.hpp"
#include "input/files/particle_file.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"
#include "output/frames.hpp"

using namespace mpm;

namespace {

/// Cells of 0.1 m in 4 m x 3 m (x 4 m), clay, and no body.
Config empty_config(int dim) {
  Config config;
  config.dim = dim;
  config.mesh.spacing = 0.1;
  config.mesh.upper = dim == 2 ? Vec3{4, 3, 0} : Vec3{4, 3, 4};
  config.mesh.cells = {40, 30, dim == 2 ? 1 : 40};
  config.time.end = 1;
  config.materials = {{"clay", "von_mises", 1800, {2e6, 0.49, 5000, 0, 0, 0}}};
  return config;
}

Shape box(const Vec3& lower, const Vec3& upper, int particles = 2) {
  Shape shape;
  shape.lower = lower, shape.upper = upper, shape.particles_per_cell = particles;
  return shape;
}

Shape disc(const Vec3& centre, double radius, int particles = 2) {
  Shape shape;
  shape.kind = ShapeKind::disc, shape.centre = centre, shape.radius = radius;
  shape.particles_per_cell = particles;
  return shape;
}

BodyConfig& add_body(Config& config, const std::string& name, const Shape& shape) {
  BodyConfig& body = config.bodies.emplace_back();
  body.name = name, body.shape = shape;
  return body;
}

RigidConfig& add_rigid(Config& config, const std::string& name, const Shape& shape) {
  RigidConfig& rigid = config.rigids.emplace_back();
  rigid.name = name, rigid.shape = shape, rigid.shape.particles_per_cell = 4;
  return rigid;
}

/// The volume of each overlap.
std::vector<double> overlaps(const Config& config) {
  std::vector<Overlap> found;
  REQUIRE(find_overlaps(PETSC_COMM_WORLD, config, &found) == PETSC_SUCCESS);
  std::vector<double> volumes;
  for (const Overlap& overlap : found) volumes.push_back(overlap.volume);
  return volumes;
}

/// Whether one of the lines has the text.
bool any_has(const std::vector<std::string>& lines, const std::string& text) {
  return std::any_of(lines.begin(), lines.end(),
                     [&](const auto& line) { return line.find(text) != std::string::npos; });
}

TEST_CASE("warnings of many rigid bodies that are alike are one line", "[warnings]") {
  std::vector<std::string> lines{"warning: -gravity: 0", "warning: rigid far is held"};
  for (int n = 0; n < 5; ++n)
    lines.push_back("warning: rigid b" + std::to_string(n) + " is 0." + std::to_string(n + 1) + " m across");
  const std::vector<std::string> few = without_alike(lines);
  CHECK(few == std::vector<std::string>{lines[0], lines[1], lines[2] + "; and so for 4 other rigid bodies"});
  lines.resize(5);
  CHECK(without_alike(lines) == lines);
}

}  // namespace

TEST_CASE("boxes overlap by what is common to them, if it is thicker than half a particle", "[overlap]") {
  for (const int dim : {2, 3}) {
    Config config = empty_config(dim);
    const double depth = dim == 2 ? 1 : 2;
    add_body(config, "soil", box({0, 0, 0}, {4, 1, 2}));
    add_body(config, "bank", box({1, 1, 0}, {2, 2, 2}));
    CHECK(overlaps(config).empty());
    config.bodies[1].shape.lower[1] = 1 - 0.024;  // half a particle: 0.025 m
    CHECK(overlaps(config).empty());
    config.bodies[1].shape.lower[1] = 1 - 0.026;
    REQUIRE(overlaps(config).size() == 1);
    CHECK(overlaps(config)[0] == Catch::Approx(0.026 * depth).epsilon(1e-6));
    config.bodies[1].shape.lower[1] = 0.5;
    CHECK(overlaps(config)[0] == Catch::Approx(0.5 * depth).epsilon(1e-6));
    config.bodies[0].cut_out_bodies = {1};
    CHECK(overlaps(config).empty());
  }
}

TEST_CASE("a buried rigid overlaps the soil until it is cut out", "[overlap]") {
  for (const int dim : {2, 3}) {
    Config config = empty_config(dim);
    BodyConfig& soil = add_body(config, "soil", box({0, 0, 0}, {4, 2, 4}));
    add_rigid(config, "pipe", disc({2, 1, 2}, 0.53));
    const double r = 0.53, pi = std::numbers::pi;
    REQUIRE(overlaps(config).size() == 1);
    CHECK(overlaps(config)[0] == Catch::Approx(dim == 2 ? pi * r * r : 4 * pi / 3 * r * r * r).epsilon(0.01));
    soil.cut_out = {0};
    CHECK(overlaps(config).empty());
  }
}

TEST_CASE("shapes that touch along slopes and curves do not overlap", "[overlap]") {
  Config config = empty_config(2);
  Shape lower, upper;
  lower.kind = upper.kind = ShapeKind::polygon;
  lower.polygon = {{0, 0}, {4, 0}, {4, 0.5}, {0, 2.1}};
  upper.polygon = {{0, 2.1}, {4, 0.5}, {4, 2.9}, {0, 2.9}};
  add_body(config, "bed", lower), add_body(config, "cover", upper);
  CHECK(overlaps(config).empty());
  config.bodies[1].shape.polygon[0][1] = 1.9;
  REQUIRE(overlaps(config).size() == 1);
  CHECK(overlaps(config)[0] == Catch::Approx(0.4).epsilon(0.02));  // a triangle 0.2 high, 4 wide

  Config ball = empty_config(2);
  add_body(ball, "soil", box({0, 0, 0}, {4, 1, 0}));
  add_rigid(ball, "pipe", disc({2, 1.5, 0}, 0.5));  // on the soil
  Shape ramp;
  ramp.kind = ShapeKind::half_plane, ramp.point = {0, 0, 0}, ramp.normal = {0, 1, 0};
  add_rigid(ball, "base", ramp);
  CHECK(overlaps(ball).empty());
}

TEST_CASE("a thin plate in soil is an overlap, and so is a body of whole cells", "[overlap]") {
  Config config = empty_config(2);
  add_body(config, "soil", box({0, 0, 0}, {4, 2, 0}));
  add_rigid(config, "sheet", box({2, 0.5, 0}, {2.02, 3, 0}));
  REQUIRE(overlaps(config).size() == 1);
  CHECK(overlaps(config)[0] == Catch::Approx(0.02 * 1.5).epsilon(0.05));

  Config cells = empty_config(2);
  Shape slab = disc({2, 1, 0}, 0.5);
  slab.fill = Fill::cell;
  add_body(cells, "soil", box({0, 0, 0}, {1.55, 2, 0}));  // 0.05 m into the disc, in no whole cell of it
  add_body(cells, "slab", slab);
  CHECK(overlaps(cells).empty());
  cells.bodies[0].shape.upper[0] = 1.8;
  CHECK(overlaps(cells).size() == 1);
}

TEST_CASE("particles of a file overlap a rigid, which can cut them", "[overlap]") {
  const auto path =
      std::filesystem::temp_directory_path() / ("mpm_overlap_" + std::to_string(::getpid()) + ".h5");
  ParticleSnapshot soil;
  soil.name = "soil", soil.state = {{"plastic_strain", {}}};
  for (double y = 0.025; y < 1; y += 0.05)
    for (double x = 0.025; x < 2; x += 0.05) {
      soil.position.insert(soil.position.end(), {x, y, 0});
      soil.volume.push_back(0.0025), soil.state[0].values.push_back(0);
      soil.mass.push_back(4.5), soil.reference_height.push_back(y);
      soil.velocity.insert(soil.velocity.end(), {0, 0, 0});
      soil.stress.insert(soil.stress.end(), {0, -y, 0, 0, 0, 0});
    }
  soil.grid_velocity = soil.velocity;
  REQUIRE(write_frame(path.string(), {0, 0, {soil}, {}}, Precision::double_) == PETSC_SUCCESS);
  Config config = empty_config(2);
  Shape listed;
  listed.kind = ShapeKind::particles, listed.file = path.string(), listed.file_body = "soil";
  BodyConfig& body = add_body(config, "soil", listed);
  body.velocity_given = body.stress_given = true;
  RigidConfig& pile = add_rigid(config, "pile", box({1, 1, 0}, {1.5, 2, 0}));
  CHECK(overlaps(config).empty());
  pile.shape.lower[1] = 0.5;
  REQUIRE(overlaps(config).size() == 1);
  CHECK(overlaps(config)[0] == Catch::Approx(0.25).epsilon(0.02));
  body.cut_out = {0};
  CHECK(overlaps(config).empty());

  ParticleTable table;
  REQUIRE(read_particles(source_of(body), config.mesh, 2, table) == "");
  const auto before = table.volume.size();
  CHECK(cut_particles(cut_out_of(config, body), config.mesh, 2, table) == 100);
  CHECK(table.volume.size() == before - 100);
  CHECK(table.position.size() == 2 * table.volume.size());
  for (std::size_t p = 0; p < table.volume.size(); ++p)
    CHECK_FALSE(
        (table.position[2 * p] > 1 && table.position[2 * p] < 1.5 && table.position[2 * p + 1] > 0.5));
  std::filesystem::remove(path);
}

TEST_CASE("an overlap is reported with its volume and the option that cuts", "[overlap]") {
  Config config = empty_config(2);
  add_body(config, "small", box({1, 0.5, 0}, {2, 1.5, 0}));
  BodyConfig& large = add_body(config, "large", box({0, 0, 0}, {4, 1, 0}));
  add_rigid(config, "pipe", disc({3.5, 2.5, 0}, 0.2));
  std::vector<Overlap> found;
  REQUIRE(find_overlaps(PETSC_COMM_WORLD, config, &found) == PETSC_SUCCESS);
  REQUIRE(describe(found, config).size() == 1);
  CHECK(describe(found, config)[0] ==
        "mpm: -large_cut_out: not given, takes small, or shapes that do not overlap: large and small have "
        "0.5 m2 "
        "in common");
  large.cut_out = {0};
  CHECK(describe(found, config)[0].find("-large_cut_out: given \"pipe\", takes small too") !=
        std::string::npos);
}

TEST_CASE("sound input gives no warning", "[warnings]") {
  Config config = empty_config(2);
  config.gravity = {0, -9.81, 0};
  BodyConfig& soil = add_body(config, "soil", box({0, 0, 0}, {4, 2, 0}));
  soil.stress = {-1000, -2000, -1000, 300, 0, 0};
  RigidConfig& plate = add_rigid(config, "plate", box({0, 2, 0}, {0.5, 2.4, 0}));  // half of it
  plate.motion = Motion::prescribed, plate.velocity = {0, -0.1, 0};
  CHECK(warnings_of(config, 2).empty());
  config.materials[0].parameters = {0, 0.49, 5000, 1000, 2, 500};  // rigidity
  CHECK(warnings_of(config, 2).empty());
}

TEST_CASE("each mistake that is likely has a warning of its own", "[warnings]") {
  Config sound = empty_config(2);
  sound.gravity = {0, -9.81, 0};
  add_body(sound, "soil", box({0, 0, 0}, {4, 2, 0}));
  RigidConfig& pile = add_rigid(sound, "pile", box({1.75, 2, 0}, {2.25, 2.4, 0}));
  pile.motion = Motion::prescribed, pile.velocity = {0, -0.01, 0};
  REQUIRE(warnings_of(sound).empty());
  const auto warns = [&](const std::string& text, auto&& spoil) {
    Config config = sound;
    spoil(config);
    const auto lines = warnings_of(config);
    INFO(text << " among: " << join(lines, "; "));
    CHECK(lines.size() == 1);
    CHECK(any_has(lines, text));
  };
  warns("points upward", [](Config& c) { c.gravity[1] = 9.81; });
  warns("is tensile", [](Config& c) { c.bodies[0].stress[1] = 10; });
  warns("2 times a cell", [](Config& c) { c.rigids[0].shape.upper[1] = 2.2; });
  warns("of the speed of waves", [](Config& c) { c.rigids[0].velocity[1] = -2; });
  warns("from the wall mesh_xmax",
        [](Config& c) { c.rigids[0].shape.lower[0] = 2.6, c.rigids[0].shape.upper[0] = 3.1; });
  warns("times the strength", [](Config& c) { c.materials[0].parameters[2] = 3e5; });
  warns("times the strength", [](Config& c) { c.materials[0].parameters[2] = 10; });
  warns("looks like t/m3", [](Config& c) { c.materials[0].density = 1.8; });
  warns("is it given in kPa?", [](Config& c) { c.materials[0].parameters = {3000, 0.49, 20, 0, 0, 0}; });
  warns("is below all soil", [](Config& c) { c.water.level = -5; });
  warns("rises", [](Config& c) { c.water.level = 1, c.materials[0].density = 999; });
  warns("-halo_path", [](Config& c) { c.partition.halo_path = HaloPath::host; });

  // Choices of cells, particles, precision and output.
  warns("-f_bar_fraction: given \"0\", lets clay lock", [](Config& c) { c.f_bar_fraction = 0; });
  warns("-clay_f_bar_fraction", [](Config& c) { c.materials[0].f_bar_fraction = 0.1; });
  warns("-clay_poisson: 0.3 lets", [](Config& c) { c.materials[0].parameters = {4e7, 0.3, 40000, 0, 0, 0}; });
  warns("-soil_particles_per_cell", [](Config& c) { c.bodies[0].shape.particles_per_cell = 1; });
  warns("body soil is 2 cells across along x", [](Config& c) { c.bodies[0].shape.upper[0] = 0.2; });
  warns("fall out", [](Config& c) { c.mesh.walls[1][0] = Wall::free; });
  warns("begins without stress", [](Config& c) { c.materials[0].parameters[0] = 3e5; });
  warns("frames of all particles", [](Config& c) { c.output.interval = 1e-3; });
  warns("-precision: given \"single\"",
        [](Config& c) { c.precision = Precision::single, c.rigids[0].velocity[1] = -1e-4; });
  warns("-time_end: 0.01 s are over", [](Config& c) { c.time.end = 0.01; });
  warns("-mesh_ymin_friction: 30 looks like an angle",
        [](Config& c) { c.mesh.walls[1][0] = Wall::friction, c.mesh.sides[1][0].numbers.friction = 30; });

  const auto silent = [&](auto&& change) {
    Config config = sound;
    change(config);
    CHECK(warnings_of(config) == std::vector<std::string>{});
  };
  silent([](Config& c) { c.water.level = 1, c.materials[0].density = 1800; });
  silent([](Config& c) {
    c.f_bar_fraction = 0, c.bodies[0].shape.upper[0] = 4, c.materials[0].f_bar_fraction = 0.98;
  });
  silent([](Config& c) { c.materials[0].parameters[1] = 0.3, c.materials[0].pore_stiffness = 1e8; });
  silent([](Config& c) { c.mesh.walls[1][0] = Wall::free, c.bodies[0].shape.lower[1] = 0.5; });
  silent([](Config& c) { c.materials[0].parameters[0] = 3e5, c.bodies[0].k0 = true; });
  silent([](Config& c) { c.output.interval = 1e-3, c.output.frames = false; });
  silent([](Config& c) { c.precision = Precision::single; });
  silent([](Config& c) { c.bodies.push_back(c.bodies[0]), c.bodies[1].shape = box({0, 2, 0}, {1, 2.1, 0}); });
  silent([](Config& c) {
    c.mesh.walls[0] = {Wall::free, Wall::free}, c.rigids[0].shape.lower[0] = 2.6,
    c.rigids[0].shape.upper[0] = 3.1;
  });
  silent([](Config& c) {
    c.rigids[0].velocity = {0, 0.1, 0};
    c.rigids[0].shape.lower[0] = 0.1;
  });  // goes out
}
