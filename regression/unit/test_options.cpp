// Options to Config. What wrong input is answered is in ../wrong_input.

#include <unistd.h>

#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "common/f_bar.hpp"
#include "common/text.hpp"
#include "input/deck/deck.hpp"
#include "input/deck/suggest.hpp"
#include "input/options/options.hpp"
#include "output/frames.hpp"
#include "step/stepper.hpp"

using namespace mpm;

namespace {

const std::string k_deck =
    "-mesh_lower 0,0 -mesh_upper 8,6 -mesh_spacing 0.5 -time_end 10 -materials clay -clay_model von_mises "
    "-clay_density 1500 -clay_young 1e6 -clay_poisson 0.3 -clay_su 1000 -bodies soil -soil_material clay "
    "-soil_shape box "
    "-soil_lower 0,0 -soil_upper 8,2 ";

struct Read {
  Config config;
  InputReport report;
};

/// Reads these options alone.
Read read(const std::string& options, const char* prefix = nullptr) {
  Read result;
  REQUIRE(PetscOptionsClear(nullptr) == PETSC_SUCCESS);
  REQUIRE(PetscOptionsInsertString(nullptr, options.c_str()) == PETSC_SUCCESS);
  REQUIRE(read_options(prefix, {Backend::serial, Backend::openmp}, result.config, result.report) ==
          PETSC_SUCCESS);
  REQUIRE(PetscOptionsClear(nullptr) == PETSC_SUCCESS);
  return result;
}

Config config_of(const std::string& options) {
  const Read result = read(options);
  INFO(join(result.report.errors, "\n"));
  REQUIRE(result.report.errors.empty());
  return result.config;
}

}  // namespace

TEST_CASE("the least deck gives the documented defaults", "[options]") {
  const Config config = config_of(k_deck);
  CHECK(config.dim == 2);
  CHECK(config.backend == Backend::openmp);  // the fastest of those compiled in
  CHECK(config.precision == Precision::double_);
  CHECK(config.p2g.strategy == P2G::automatic);
  CHECK(config.p2g.margin == 0.5);
  CHECK(config.p2g.mosaic_cells == 3);
  CHECK_FALSE(config.p2g.rebuild_interval);
  CHECK(config.mesh.cells == std::array{16, 12, 1});
  for (const auto& sides : config.mesh.walls) CHECK((sides[0] == Wall::roller && sides[1] == Wall::roller));
  CHECK(config.gravity == Vec3{});
  CHECK(config.time.courant == 0.5);
  CHECK_FALSE(config.time.step);
  CHECK(config.flip_fraction == 1);
  CHECK(config.damping == 0);
  CHECK(config.output.directory == "out/mpm");
  CHECK(config.output.interval == 10.0 / 50);
  CHECK(config.output.history_interval == 10.0 / 500);
  CHECK(config.bodies.at(0).shape.particles_per_cell == 2);
  CHECK(config.rigids.empty());
}

TEST_CASE("a material has its model's parameters in the order of the model's table", "[options]") {
  const Config config = config_of(k_deck + "-clay_su_gradient 2000 -clay_su_datum 1.5");
  const auto& clay = config.materials.at(0);
  CHECK(clay.name == "clay");
  CHECK(clay.model == "von_mises");
  CHECK(clay.density == 1500);
  CHECK(clay.parameters == std::vector<double>{1e6, 0.3, 1000, 2000, 1.5, 0, 0, 0, 0, 1});
}

TEST_CASE("rigidity takes the place of Young's modulus", "[options]") {
  std::string deck = k_deck;
  deck.erase(deck.find("-clay_young 1e6 "), std::string("-clay_young 1e6 ").size());
  CHECK(config_of(deck + "-clay_rigidity 500").materials.at(0).parameters ==
        std::vector<double>{0, 0.3, 1000, 0, 0, 500, 0, 0, 0, 1});
  CHECK(read(deck).report.errors.at(0) ==
        "mpm: -clay_young: not given, takes a number in Pa from 0.001 to 1e+15, or field, or -clay_rigidity "
        "in its "
        "place");
  CHECK(read(k_deck + "-clay_rigidity 500").report.errors.at(0) ==
        "mpm: -clay_young: given \"1e6\", takes nothing here: -clay_rigidity is in its place");
  CHECK(read(deck + "-clay_rigidity 500 -clay_su 0").report.errors.size() == 1);
}

TEST_CASE("a material has the run's fraction of F-bar, but its own where that is given or it dilates",
          "[options]") {
  const std::string deck = k_deck.substr(0, k_deck.find("-materials")) + "-materials clay,sand " +
                           k_deck.substr(k_deck.find("-clay_model")) +
                           "-sand_model mohr_coulomb -sand_density 1800 -sand_young 1e7 -sand_poisson 0.3 "
                           "-sand_cohesion 100 -sand_friction_deg 35 ";
  const auto fractions = [&](const std::string& more) {
    const Config config = config_of(deck + more);
    return std::array{f_bar_fraction(config, config.materials.at(0)),
                      f_bar_fraction(config, config.materials.at(1))};
  };
  CHECK(fractions("") == std::array{0.98, 0.98});
  CHECK(fractions("-sand_dilation_deg 0") == std::array{0.98, 0.98});
  CHECK(fractions("-sand_dilation_deg 5") == std::array{0.98, 0.});
  CHECK(fractions("-sand_dilation_deg 5 -f_bar_fraction 0.5") == std::array{0.5, 0.5});
  CHECK(fractions("-sand_dilation_deg 5 -sand_f_bar_fraction 0.3") == std::array{0.98, 0.3});
  CHECK(fractions("-sand_dilation_deg 5 -clay_f_bar_fraction 0.3") == std::array{0.3, 0.});
  CHECK(fractions("-f_bar_fraction 0.5 -sand_f_bar_fraction 1") == std::array{0.5, 1.});
  const auto noted = [&](const std::string& more) {
    for (const auto& option : read(deck + more).report.options)
      if (option.name == "-sand_f_bar_fraction") return option.value + (option.standard ? " by default" : "");
    return std::string();
  };
  CHECK(noted("-sand_dilation_deg 5") == "0 by default");
  CHECK(noted("-f_bar_fraction 0.5") == "0.5 by default");
  CHECK(noted("-sand_f_bar_fraction 1") == "1");
}

TEST_CASE("a rigid body has its motion and interface", "[options]") {
  const Config config = config_of(
      k_deck +
      "-rigid_bodies pipe,wall -pipe_shape disc -pipe_centre 4,3.5 -pipe_radius 0.5 -pipe_motion dynamic "
      "-pipe_density 3000 -pipe_force 10,0 -pipe_shear_limit 500 -wall_shape box -wall_lower 0,2 "
      "-wall_upper 1,5 "
      "-wall_friction 0.3 -wall_particles_per_cell 2");
  const auto &pipe = config.rigids.at(0), &wall = config.rigids.at(1);
  CHECK(pipe.motion == Motion::dynamic);
  CHECK(pipe.force == Vec3{10, 0, 0});
  CHECK(pipe.shape.particles_per_cell == 4);
  CHECK((pipe.has_shear_limit && pipe.shear_limit == 500 && !pipe.friction));
  CHECK(wall.motion == Motion::fixed);
  CHECK((!wall.has_shear_limit && wall.friction == 0.3));
  CHECK(wall.shape.particles_per_cell == 2);
}

TEST_CASE("3D takes three components and a ball", "[options]") {
  const Config config = config_of(
      "-dim 3 -mesh_lower 0,0,-1 -mesh_upper 2,2,1 -mesh_spacing 0.25 -mesh_zmin fixed -gravity 0,0,-9.81 "
      "-time_end 1 "
      "-materials rock -rock_model linear_elastic -rock_density 2500 -rock_young 1e7 -rock_poisson 0.2 "
      "-bodies stone "
      "-stone_material rock -stone_shape ball -stone_centre 1,1,0 -stone_radius 0.5 -stone_velocity 0,0,-2");
  CHECK(config.mesh.cells == std::array{8, 8, 8});
  CHECK(config.mesh.walls[2][0] == Wall::fixed);
  CHECK(config.gravity[2] == -9.81);
  CHECK(config.bodies.at(0).shape.kind == ShapeKind::disc);
  CHECK(config.bodies.at(0).velocity == Vec3{0, 0, -2});
}

TEST_CASE("a cylinder and a cone have the height that was given, or that of their apex angle", "[options]") {
  const std::string deck =
      k_deck +
      "-dim 3 -mesh_lower 0,0,0 -mesh_upper 8,6,6 -soil_lower 0,0,0 -soil_upper 8,6,2 -rigid_bodies pile "
      "-pile_centre 4,3,2 -pile_radius 0.5 ";
  const auto shape_of = [&](const std::string& more) { return config_of(deck + more).rigids.at(0).shape; };
  const Shape pile = shape_of("-pile_shape cylinder -pile_height 3");
  CHECK((pile.kind == ShapeKind::cylinder && pile.height == 3 && pile.tip_height == 0));
  const Shape probe = shape_of("-pile_shape cylinder -pile_height 3 -pile_tip_angle_deg 90");
  CHECK(std::abs(probe.tip_height - 0.5) < 1e-12);
  const Shape cone = shape_of("-pile_shape cone -pile_tip_angle_deg 90");
  CHECK((cone.kind == ShapeKind::cone && !cone.tip_up && std::abs(cone.height - 0.5) < 1e-12));
  CHECK(shape_of("-pile_shape cone -pile_height 1.5 -pile_tip up").tip_up);
}

TEST_CASE("the shear limit may be a fraction of the strength", "[options]") {
  const std::string deck = k_deck + "-rigid_bodies wall -wall_shape box -wall_lower 0,2 -wall_upper 1,5 ";
  CHECK_FALSE(config_of(deck).rigids.at(0).shear_fraction);
  CHECK(config_of(deck + "-wall_shear_fraction 0.4").rigids.at(0).shear_fraction == 0.4);
}

TEST_CASE("an initial stress has four components in 2D, six in 3D", "[options]") {
  CHECK(config_of(k_deck).bodies.at(0).stress == Sym6{});
  CHECK(config_of(k_deck + "-soil_stress -2e3,-4e3,-3e3,500").bodies.at(0).stress ==
        Sym6{-2e3, -4e3, -3e3, 500, 0, 0});
  const std::string deep =
      k_deck + "-dim 3 -mesh_lower 0,0,0 -mesh_upper 8,6,2 -soil_lower 0,0,0 -soil_upper 8,2,2 ";
  CHECK(config_of(deep + "-soil_stress 1,2,3,4,5,6").bodies.at(0).stress == Sym6{1, 2, 3, 4, 5, 6});
}

TEST_CASE("particles of a file are those of a body there, and options take the place of what it gives",
          "[options]") {
  const auto path =
      std::filesystem::temp_directory_path() / ("mpm_options_" + std::to_string(::getpid()) + ".h5");
  ParticleSnapshot clay;
  clay.name = "clay", clay.position = {1, 1, 0}, clay.volume = {0.0625},
  clay.state = {{"plastic_strain", {0}}};
  clay.velocity = clay.grid_velocity = {0, 0, 0}, clay.stress.assign(6, 0);
  clay.mass = {93.75}, clay.reference_height = {1};
  REQUIRE(write_frame(path.string(), {0, 0, {clay}, {}}, Precision::single) == PETSC_SUCCESS);
  const std::string deck = k_deck.substr(0, k_deck.find("-soil_shape")) +
                           "-soil_shape particles -soil_file_body clay -soil_file " + path.string();
  const BodyConfig body = config_of(deck + " -soil_velocity 1,0").bodies.at(0);
  CHECK((body.shape.kind == ShapeKind::particles && body.shape.file == path.string()));
  CHECK((body.shape.file_body == "clay" && body.velocity_given && !body.stress_given));
  CHECK(config_of(deck).bodies.at(0).velocity_given == false);
  const std::string given = "mpm: -soil_file: given \"" + path.string() + "\", takes ";
  const auto error_of = [&](const std::string& more) {
    const auto errors = read(deck + more).report.errors;
    return errors.size() == 1 ? errors[0] : std::to_string(errors.size()) + " errors";
  };
  CHECK(error_of(" -mesh_lower 1.5,0 -mesh_upper 3.5,2") ==
        given + "particles inside the mesh, 1.5,0 to 3.5,2; particle 0 is at 1,1");
  CHECK(error_of(" -soil_file_body soil") == given + "a file with the group soil");
  std::filesystem::remove(path);
}

TEST_CASE("strengths that a file gives each particle are those that the material takes", "[options]") {
  const auto path =
      std::filesystem::temp_directory_path() / ("mpm_strengths_" + std::to_string(::getpid()) + ".h5");
  const std::string head = k_deck.substr(0, k_deck.find("-clay_model")),
                    body = k_deck.substr(k_deck.find("-bodies"),
                                         k_deck.find("-soil_shape") - k_deck.find("-bodies"));
  const std::string rest = "-clay_density 1500 -clay_poisson 0.3 " + body +
                           "-soil_shape particles -soil_file " + path.string() + " ";
  const auto with = [&](const char* key, std::vector<double> values) {
    ParticleSnapshot soil;
    soil.name = "soil", soil.position = {1, 1, 0, 2, 1, 0}, soil.volume = {0.0625, 0.0625};
    soil.state = {{"plastic_strain", {0, 0}}, {key, std::move(values)}};
    soil.velocity = soil.grid_velocity = {0, 0, 0, 0, 0, 0}, soil.stress.assign(12, 0);
    soil.mass = {93.75, 93.75}, soil.reference_height = {1, 1};
    REQUIRE(write_frame(path.string(), {0, 0, {soil}, {}}, Precision::double_) == PETSC_SUCCESS);
  };
  const auto error_of = [&](const std::string& law) {
    const auto errors = read(head + rest + law).report.errors;
    const std::string given = "mpm: -soil_file: given \"" + path.string() + "\", takes particles whose ";
    if (errors.empty()) return std::string();
    return errors[0].starts_with(given) ? errors[0].substr(given.size()) : join(errors, "; ");
  };
  const auto largest = [&](const std::string& law) {
    return config_of(head + rest + law).bodies.at(0).largest_own[0];
  };
  const std::string clay = "-clay_model von_mises -clay_su 1000 ", young = "-clay_young 1e6 ",
                    sand = "-clay_model mohr_coulomb -clay_cohesion 9 -clay_young 1e6 -clay_friction_deg ";
  with("su", {300, 700});
  CHECK(largest(clay + young) == 700);
  CHECK_FALSE(largest(sand + "30"));  // it has no su
  const Config stiff = config_of(head + rest + clay + "-clay_rigidity 500");
  const MaterialConfig twice{"clay", "von_mises", 1500, {500 * 700., 0.3, 1, 0, 0, 0}};
  Config plain = stiff;
  plain.materials = {twice}, plain.bodies[0].largest_own = {};
  CHECK(std::fabs(wave_speed(stiff, stiff.bodies[0]) / wave_speed(plain, plain.bodies[0]) - 1) < 1e-12);

  with("su", {0, 700});
  CHECK(largest(clay + young) == 700);
  CHECK(error_of(clay + "-clay_rigidity 500") ==
        "su is a strength in Pa greater than 0 where -clay_rigidity is given; the least of this file is 0");
  with("su", {300, -1});
  CHECK(error_of(clay + young) == "su is a number in Pa from 0 to 1e+12; the least of this file is -1");
  with("su", {2e12, 300});
  CHECK(error_of(clay + young) == "su is a number in Pa from 0 to 1e+12; the largest of this file is 2e+12");
  with("su", {300, 9e5});  // too brittle for its stiffness
  const std::string soft = "-clay_model softening_clay -clay_su 1000 -clay_remoulded_ratio 0.2 -clay_xi95 1 ";
  CHECK(read(head + rest + soft + young)
            .report.errors.at(0)
            .starts_with("mpm: -clay_xi95: given \"1\", takes more than"));
  with("cohesion", {0, 5});
  CHECK(largest(sand + "30") == 5);
  CHECK(error_of(sand + "0") ==
        "cohesion is a cohesion in Pa greater than 0 where -clay_friction_deg is 0; the least of this file "
        "is 0");
  CHECK_FALSE(largest(clay + young));
  std::filesystem::remove(path);
}

TEST_CASE("a prism, a half plane and a turned box have their geometry", "[options]") {
  const Config config = config_of(
      k_deck +
      "-dim 3 -mesh_lower 0,0,0 -mesh_upper 8,6,2 -soil_lower 0,0,0 -soil_upper 8,2,2 -rigid_bodies "
      "ramp,floor,plate "
      "-ramp_shape polygon -ramp_polygon 0,0,4,0,0,2 -ramp_width 1,3 -floor_shape half_plane -floor_point "
      "0,0,0.5 "
      "-floor_normal 3,0,4 -plate_shape box -plate_lower 6,0,0 -plate_upper 7,1,0.5 -plate_angle_deg 90");
  CHECK(config.rigids[0].shape.polygon.at(2) == std::array{0., 2.});
  CHECK(config.rigids[0].shape.width == std::array{1., 3.});
  CHECK(config.rigids[1].shape.point == Vec3{0, 0, 0.5});
  CHECK(config.rigids[1].shape.normal == Vec3{0.6, 0, 0.8});
  CHECK(config.rigids[2].shape.angle == std::numbers::pi / 2);
}

TEST_CASE("what is cut out of a body are rigids by their place in the list", "[options]") {
  const Config config =
      config_of(k_deck +
                "-rigid_bodies wall,pipe -wall_shape half_plane -wall_point 7,0 -wall_normal -1,0 "
                "-pipe_shape disc -pipe_centre 3,1 -pipe_radius 0.5 -soil_cut_out pipe,wall");
  CHECK(config.bodies.at(0).cut_out == std::vector<int>{1, 0});
  CHECK(config_of(k_deck).bodies.at(0).cut_out.empty());
}

TEST_CASE("pic is a FLIP fraction of 0", "[options]") {
  CHECK(config_of(k_deck + "-velocity_update pic").flip_fraction == 0);
  CHECK(config_of(k_deck + "-velocity_update apic").flip_fraction == 0);
  CHECK(config_of(k_deck + "-velocity_update xpic").flip_fraction == 0);
  const Config xpic = config_of(k_deck + "-velocity_update xpic -xpic_order 5 -flip_fraction 0.9");
  CHECK(xpic.velocity_update == VelocityUpdate::xpic);
  CHECK(xpic.xpic_order == 5);
  CHECK(xpic.flip_fraction == 0.9);
  CHECK(config_of(k_deck + "-flip_fraction 0.99").flip_fraction == 0.99);
}

TEST_CASE("the last of an option given twice holds", "[options]") {
  CHECK(config_of(k_deck + "-mesh_spacing 1").mesh.spacing == 1);
}

TEST_CASE("all mistakes are reported together, each in a line of one form", "[options]") {
  const auto errors =
      read(k_deck + "-time_end -1 -soil_upper 9,2 -mesh_xmax fixed -claz_su 1 -damping x").report.errors;
  REQUIRE(errors.size() == 4);
  CHECK(errors[0] == "mpm: -time_end: given \"-1\", takes a time in s greater than 0");
  CHECK(errors[1] == "mpm: -damping: given \"x\", takes a number of 0 or more and less than 1");
  CHECK(errors[2] ==
        "mpm: -soil_upper: given \"9,2\", takes a shape wholly inside the mesh, 0,0 to 8,6, or cut "
        "by a side that is a roller");
  CHECK(errors[3] == "mpm: -claz_su: given \"1\", takes nothing: no such option, the nearest is -clay_su");
}

TEST_CASE("the known name that is most like another is one of the same thing", "[options]") {
  const std::vector<std::string> owners = {"soil", "clay", "clay_2"},
                                 known = {"time_end",      "gravity",    "soil_particles_per_cell",
                                          "soil_velocity", "clay_young", "clay_density",
                                          "clay_2_young",  "clay_2_su",  "Clay_poisson"};
  const auto meant = [&](const std::string& name) { return most_like(name, known, owners); };
  CHECK(meant("tiem_end") == "time_end");
  CHECK(meant("soil_cells_of_particles") == "soil_particles_per_cell");
  CHECK(meant("soil_initial_velocity") == "soil_velocity");
  CHECK(meant("clay_elastic_young_modulus") == "clay_young");
  CHECK(meant("clay_2_elastic_young_modulus") == "clay_2_young");
  CHECK(meant("clay_ratio_of_poisson") == "Clay_poisson");
  CHECK(meant("simulation_time_end") == "time_end");
  CHECK(!meant("x").empty());
}

TEST_CASE("a backend that is not compiled in is refused with those that are", "[options]") {
  const auto errors = read(k_deck + "-backend cuda").report.errors;
  REQUIRE(errors.size() == 1);
  CHECK(errors[0] == "mpm: -backend: given \"cuda\", takes serial or openmp, which are compiled in");
}

TEST_CASE("a name's number does not make it inherit the options of the name without", "[options]") {
  const auto errors =
      read(k_deck + "-rigid_bodies pile,pile_1 -pile_shape box -pile_lower 0,4 -pile_upper 1,5")
          .report.errors;
  REQUIRE(errors.size() == 1);
  CHECK(errors[0] ==
        "mpm: -pile_1_shape: not given, takes box, polygon, disc, ball, cylinder, cone, half_plane, stl or "
        "layer");
}

TEST_CASE("a prefix keeps two simulations apart", "[options]") {
  std::string deck;
  for (const auto& word : split(k_deck, ' '))
    deck += (word.rfind('-', 0) == 0 ? "-a_" + word.substr(1) : word) + " ";
  const Read result = read(deck + " -time_end 3 -b_time_end 4", "a_");
  CHECK(result.report.errors.empty());
  CHECK(result.config.time.end == 10);
  CHECK(read(deck + " -a_time_ned 3", "a_").report.errors.at(0) ==
        "mpm: -a_time_ned: given \"3\", takes nothing: no such option, the nearest is -a_time_end");
}

TEST_CASE("every option in force is listed with its unit and whether it is the default", "[options]") {
  const Read result = read(k_deck);
  const auto find = [&](const std::string& name) {
    for (const auto& option : result.report.options)
      if (option.name == name) return option;
    return EffectiveOption{};
  };
  const auto spacing = find("-mesh_spacing"), share = find("-flip_fraction"), step = find("-time_step");
  CHECK((spacing.value == "0.5" && spacing.unit == "m" && !spacing.standard));
  CHECK((share.value == "1" && share.unit == "-" && share.standard));
  CHECK((step.value == "none" && step.unit == "s" && step.standard));
}

TEST_CASE("help lists every option that a deck may give", "[options]") {
  Config config;
  InputReport report, listed;
  listed.help = true;
  REQUIRE(read_options(nullptr, {Backend::serial}, config, listed) == PETSC_SUCCESS);
  report =
      read(k_deck +
           "-rigid_bodies plate -plate_shape box -plate_lower 0,4 -plate_upper 1,5 -plate_motion dynamic "
           "-plate_density 1")
          .report;
  CHECK(report.options.size() > 50);
  for (const auto& option : report.options) {
    std::string name = option.name;
    for (const char* owner : {"clay", "soil", "plate"})
      if (name.rfind(std::string("-") + owner + "_", 0) == 0)
        name = "-NAME" + name.substr(1 + std::string(owner).size());
    INFO(name);
    CHECK(listed.help_text.find("  " + name + "\n") != std::string::npos);
  }
}

TEST_CASE("numbers are read strictly", "[options]") {
  CHECK(parse_number("1e-3") == 1e-3);
  CHECK(parse_number("+2.5") == 2.5);
  for (const char* text :
       {"", " 1", "1 ", "0.5x", "nan", "inf", "-inf", "1e999", "0x1p3", "1,5", "+-1", "--1"})
    CHECK_FALSE(parse_number(text));
  CHECK(parse_integer("12") == 12);
  for (const char* text : {"", "1.0", "1e3", "99999999999999999999"}) CHECK_FALSE(parse_integer(text));
  for (const double value : {0.1, 6e-5, 1.0 / 3, 1e300}) CHECK(parse_number(text_of(value)) == value);
}

TEST_CASE("the nearest word is the one meant", "[options]") {
  const std::vector<std::string> words = {"mesh_lower", "mesh_upper", "mesh_spacing", "soil_velocity"};
  CHECK(edit_distance("kitten", "sitting") == 3);
  CHECK(edit_distance("form", "from") == 1);
  CHECK(nearest("mesh_spaceing", words) == "mesh_spacing");
  CHECK(nearest("Soli_velocity", words) == "soil_velocity");
  CHECK_FALSE(nearest("zzz", words));
}

namespace {

/// A folder of its own with decks, which goes with its scope.
struct Decks {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("mpm_decks_" + std::to_string(::getpid()));
  Decks() { std::filesystem::create_directories(folder); }
  ~Decks() { std::filesystem::remove_all(folder); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
    return (folder / name).string();
  }
};

/// Words that read_options takes from a command line. It leaves none of them for PETSc.
std::string prepared(std::vector<std::string> words, InputReport& report) {
  words.insert(words.begin(), "mpm");
  std::vector<char*> pointers;
  for (auto& word : words) pointers.push_back(word.data());
  int argc = static_cast<int>(words.size());
  pointers.push_back(nullptr);
  char** argv = pointers.data();
  prepare_arguments(PETSC_COMM_SELF, &argc, &argv, report);
  CHECK(std::string(argv[0]) == "mpm");
  CHECK(argv[argc] == nullptr);
  CHECK(argc == 1 + static_cast<int>(report.petsc_words.size()));
  return join(report.words, " ");
}

}  // namespace

TEST_CASE("arguments that PETSc would pass over or die of are taken out and reported", "[options]") {
  InputReport report;
  CHECK(prepared({"-help", "-time_end", "2", "s", "-options_file", "/nowhere/none.opts", "-dim", "2"},
                 report) == "");
  CHECK(report.help);
  CHECK(report.file_unread);
  CHECK(report.errors.size() == 2);
}

TEST_CASE("PETSc's start sees none but its own options, and of these only those that are passed on",
          "[options]") {
  const Decks decks;
  const auto deck =
      decks.write("a.opts", "-malloc_debug\n-dim 2\n-history h.txt\n-log_view :l.txt:ascii_xml\n");
  InputReport report;
  CHECK(
      prepared({"-options_file", deck, "-dll_append", "x.so", "-sf_type", "window", "-memory_view", "maybe"},
               report) == "-dim 2");
  CHECK(report.petsc_words == std::vector<std::string>{"-skip_petscrc", "true", "-options_left", "false",
                                                       "-malloc_debug", "-log_view", ":l.txt:ascii_xml"});
  REQUIRE(report.errors.size() == 4);
  CHECK(report.errors[0] ==
        "mpm: -history: given \"h.txt\", takes nothing: this option of PETSc is not passed on");
  CHECK(report.errors[3] == "mpm: -memory_view: given \"maybe\", takes true or false");
}

TEST_CASE("the command line wins over decks, decks over what they include before", "[options]") {
  const Decks decks;
  const auto inner = decks.write("inner.opts", "-a 1\n-b 1 # one\n-c 1\nalias -d -e\n");
  const auto outer = decks.write("outer.opts", "-options_file " + inner + "\n-b 2\n-c 2\n-d \"4 5\"\n-f\n");
  InputReport report;
  CHECK(prepared({"-c", "3", "-options_file", outer, "-prefix_push", "p_", "-g", "-1", "-prefix_pop"},
                 report) == "-a 1 -b 1 -c 1 -b 2 -c 2 -e 4 5 -f -c 3 -p_g -1");
  CHECK(report.errors.empty());
  CHECK(report.options_file == outer);
  CHECK(report.replaced == std::vector<std::string>{"b", "1", "c", "1", "c", "2"});
}

TEST_CASE("a deck's mistakes are reported by file and line, and no option of it is left", "[options]") {
  const Decks decks;
  const auto path = decks.write("a.opts", "-dim 2\n-options_file " + decks.write("b.opts", "-x 1\n-y 1 2\n") +
                                              "\n-options_file none.opts\n-prefix_pop\n");
  InputReport report;
  CHECK(prepared({"-options_file", path}, report) == "");
  REQUIRE(report.errors.size() == 3);
  CHECK(report.errors[0].find("b.opts:2: given \"-y 1 2\", takes -NAME VALUE") != std::string::npos);
  CHECK(
      report.errors[1].find("a.opts:3: -options_file: given \"none.opts\", takes a file that can be read") !=
      std::string::npos);
  CHECK(report.errors[2].find("a.opts:4: -prefix_pop: given without") != std::string::npos);
}

TEST_CASE("a deck that includes itself, another form or an endless file ends in one line", "[options]") {
  const Decks decks;
  const auto self = (decks.folder / "self.opts").string();
  decks.write("self.opts", "-dim 2\n-options_file " + self + "\n");
  const auto yaml = decks.write("deck.txt", "a:\n  b: 1\n  c: 2\n  d: 3\n");
  for (const auto& [file, says] : {std::pair{self, "self.opts:2: -options_file: given"},
                                   std::pair{yaml, "given 4 lines of another form"},
                                   std::pair{std::string("/dev/zero"), "takes a deck of at most 64 MiB"}}) {
    InputReport report;
    prepared({"-options_file", file}, report);
    REQUIRE(report.errors.size() == 1);
    CHECK(report.errors[0].find(says) != std::string::npos);
  }
}

TEST_CASE("what a shorter list leaves out is one warning", "[options]") {
  const std::string rigids =
      "-pipe_shape disc -pipe_centre 3,4 -pipe_radius 0.5 -plate_shape box -plate_lower 5,4 -plate_upper "
      "6,5 ";
  InputReport report;
  Config config;
  report.replaced = {"rigid_bodies", "pipe,plate"};
  REQUIRE(PetscOptionsInsertString(nullptr,
                                   (k_deck + rigids + "-rigid_bodies plate -soil_cut_out pipe").c_str()) ==
          PETSC_SUCCESS);
  REQUIRE(read_options(nullptr, {Backend::serial}, config, report) == PETSC_SUCCESS);
  REQUIRE(PetscOptionsClear(nullptr) == PETSC_SUCCESS);
  CHECK(join(report.errors, "\n") == "");
  CHECK(config.rigids.size() == 1);
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0] == "warning: -rigid_bodies: given \"plate\", so 3 options of pipe are not used");
}

TEST_CASE("a former name of an option is that of today, with one note for each", "[options]") {
  DeckReader reader;
  reader.read_words({"-p2g_margin",
                     "0.2",
                     "-flip_share",
                     "0.9",
                     "-f_bar_share",
                     "0",
                     "-rigids",
                     "Plate",
                     "-Plate_shear_share",
                     "0.5",
                     "-Plate_contact_penalty",
                     "none",
                     "-Plate_penalty_reach",
                     "0.1",
                     "-Plate_penalty_exponent",
                     "2",
                     "-Plate_shape",
                     "box",
                     "-flip_share",
                     "0.8"},
                    Source::command_line, "");
  CHECK(reader.errors.empty());
  const std::vector<std::string> notes = {
      "mpm: note: -p2g_margin is now -rebuild_margin",
      "mpm: note: -flip_share is now -flip_fraction",
      "mpm: note: -f_bar_share is now -f_bar_fraction",
      "mpm: note: -rigids is now -rigid_bodies",
      "mpm: note: -Plate_shear_share is now -Plate_shear_fraction",
      "mpm: note: -Plate_contact_penalty is now -Plate_contact_gap_scaling",
      "mpm: note: -Plate_penalty_reach is now -Plate_contact_gap_reach",
      "mpm: note: -Plate_penalty_exponent is now -Plate_contact_gap_exponent"};
  CHECK(reader.notes == notes);
  const auto options = reader.take();
  REQUIRE(options.size() == 10);
  CHECK((options[0].name == "-rebuild_margin" && options[0].former == "-p2g_margin"));
  CHECK((options[8].name == "-Plate_shape" && options[8].former.empty()));
  CHECK((options[9].name == "-flip_fraction" && options[9].value == "0.8"));
}

TEST_CASE("precedence does not depend on which name of an option is used", "[options]") {
  const std::pair<const char*, const char*> orders[] = {{"-rigids", "-rigid_bodies"},
                                                        {"-rigid_bodies", "-rigids"}};
  for (const auto& [in_deck, on_line] : orders) {
    DeckReader reader;
    reader.read_words({on_line, "b"}, Source::command_line, "");
    reader.read_words({in_deck, "a"}, Source::deck, "");
    CHECK(reader.errors.empty());
    const auto options = reader.take();
    REQUIRE(options.size() == 2);
    CHECK((options[1].name == "-rigid_bodies" && options[1].value == "b"));
  }
}

TEST_CASE("both names of an option in one place are an error that names both", "[options]") {
  DeckReader reader;
  reader.read_words({"-flip_share", "0.9", "-FLIP_fraction", "0.8"}, Source::command_line, "");
  REQUIRE(reader.errors.size() == 1);
  CHECK(
      reader.errors[0] ==
      "mpm: -FLIP_fraction: given \"0.8\", takes its place without -flip_share, which is another name of the "
      "same option");
}

TEST_CASE("an error has the name that was given", "[options]") {
  InputReport report;
  report.renamed = {"flip_fraction", "flip_share"};
  REQUIRE(PetscOptionsClear(nullptr) == PETSC_SUCCESS);
  REQUIRE(PetscOptionsInsertString(nullptr, (k_deck + "-flip_fraction 2").c_str()) == PETSC_SUCCESS);
  Config config;
  REQUIRE(read_options(nullptr, {Backend::serial}, config, report) == PETSC_SUCCESS);
  REQUIRE(PetscOptionsClear(nullptr) == PETSC_SUCCESS);
  CHECK(report.errors ==
        std::vector<std::string>{"mpm: -flip_share: given \"2\", takes a number from 0 to 1"});
}

TEST_CASE("new names of options take no name from bodies", "[options]") {
  const std::string shape = "_shape box -NAME_lower 0,4 -NAME_upper 1,5";
  for (const std::string name : {"rigid", "rebuild"}) {
    std::string deck = k_deck + "-rigid_bodies NAME -NAME" + shape;
    for (std::size_t at; (at = deck.find("NAME")) != std::string::npos;) deck.replace(at, 4, name);
    CHECK(config_of(deck).rigids.at(0).name == name);
  }
}
