// Checkpoint files: what goes in comes out, on any number of ranks, and what is not whole is refused.

#include <unistd.h>

#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "checkpoint/checkpoint.hpp"
#include "checkpoint/earlier.hpp"
#include "checkpoint/folder.hpp"
#include "checkpoint/id_blocks.hpp"
#include "checkpoint/sealed_file.hpp"
#include "data/side_terms.hpp"
#include "input/options/change_rules.hpp"
#include "run/changes.hpp"

using namespace mpm;
namespace fs = std::filesystem;

namespace {

int rank_of_this() {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  return rank;
}
int ranks_of_all() {
  int ranks = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  return ranks;
}

/// A folder that all ranks share, empty at first.
std::string folder_of(const std::string& test) {
  const char* job = std::getenv("OMPI_MCA_ess_base_jobid");
  const fs::path folder =
      fs::temp_directory_path() / ("mpm_" + test + (job ? job : std::to_string(::getpid())));
  if (rank_of_this() == 0) {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  return folder.string();
}

/// The value of a field of a point, the same whoever has it.
double value_of(long id, int field, int component) { return 1.0 / (1 + id) + 100 * field + component / 7.0; }

/// Points of which this rank has every so-many-th, the last first.
SavedPoints some_points(long total) {
  SavedPoints points;
  for (long id = total - 1; id >= 0; --id)
    if (id % ranks_of_all() == rank_of_this()) points.id.push_back(id);
  for (const long id : points.id) points.address.push_back(1000 + 3 * id);
  int number = 0;
  for (const auto& [name, components, bytes] :
       {std::tuple{"coordinate", 2, 8}, {"stress", 4, 8}, {"body", 1, 2}}) {
    SavedField field{name, components, bytes, {}};
    for (const long id : points.id)
      for (int k = 0; k < components; ++k)
        field.values.push_back(bytes == 2 ? double(id % 3) : value_of(id, number, k));
    points.fields.push_back(field);
    ++number;
  }
  return points;
}

constexpr long k_soil = 1003;

Checkpoint some_checkpoint() {
  Checkpoint c{"0.9",
               2,
               3,
               "serial",
               "double",
               "gather",
               {{"-gravity", "0,-10", "m/s2", false}, {"-dim", "2", "", true}},
               {},
               {},
               12,
               {}};
  c.run = {1234, 0.1 + 0.2, 1e-4, 1220, 0.1 + 0.19, 9e-5, 0.3, 17.5, 16.5, {3, 4, 5, 6}};
  c.run.waves = {.due = 1250, .every = 16, .speed = 37.5};
  c.history = {4096, 0xdeadbeef};
  c.state.bound = 0.1, c.state.increment = 1.0 / 3, c.state.margin = 0.25, c.state.due_in = 2;
  c.state.soil = some_points(k_soil);
  c.state.particles = k_soil;
  c.state.lost = {0, 1.5, 2.5, 3, 4, 5, 0, 0.5, 6};
  c.state.alone_known = 1, c.state.alone = {17, 23};
  c.state.rigids = {{1, 2, 0, 3, 4, 0, 5, 6, 0, 0, 0, 0, 7, 8, 0},
                    {-1, -2, 0, -3, -4, 0, -5, -6, 0, 0, 0, 9, -7, -8, 0, 0.5}};
  c.state.bounds = {0.25, 0.5, 0.75}, c.state.owners = {0, 2, 1, 0};
  if (rank_of_this() == 0) c.state.impulse = {{7, 5}, {70, 71, 72, 73, 74, 75, 50, 51, 52, 53, 54, 55}};
  return c;
}

void check_points(const SavedPoints& points, long total) {
  const IdBlock block = block_of(total, rank_of_this(), ranks_of_all());
  REQUIRE(points.id.size() == std::size_t(block.count));
  REQUIRE(points.fields.size() == 3);
  for (std::size_t p = 0; p < points.id.size(); ++p) {
    const long id = block.first + long(p);
    REQUIRE(points.id[p] == id);
    REQUIRE(points.address[p] == 1000 + 3 * id);
    for (const SavedField& field : points.fields)
      for (int k = 0; k < field.components; ++k) {
        const int number = field.name == "coordinate" ? 0 : 1;
        const double wanted = field.name == "body" ? double(id % 3) : value_of(id, number, k);
        REQUIRE(field.values[p * field.components + k] == wanted);
      }
  }
}

std::string text_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}
void write_text(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
}

/// Fault that reading a file reports.
std::string fault_of(const std::string& path) {
  Checkpoint read;
  std::string fault;
  REQUIRE(read_checkpoint(PETSC_COMM_SELF, path, read, &fault) == PETSC_SUCCESS);
  return fault;
}

}  // namespace

TEST_CASE("blocks by number hold every number once", "[checkpoint]") {
  for (const long total : {0L, 1L, 5L, 64L, 1000003L})
    for (const int ranks : {1, 2, 3, 7, 64}) {
      long next = 0;
      for (int rank = 0; rank < ranks; ++rank) {
        const IdBlock block = block_of(total, rank, ranks);
        REQUIRE(block.first == next);
        next += block.count;
      }
      REQUIRE(next == total);
    }
}

TEST_CASE("a checkpoint reads as it was written, whichever rank had which point", "[checkpoint]") {
  const std::string path = folder_of("checkpoint") + "/checkpoint_1234.h5";
  REQUIRE(write_checkpoint(PETSC_COMM_WORLD, path, some_checkpoint()) == PETSC_SUCCESS);
  Checkpoint read;
  std::string fault;
  REQUIRE(read_checkpoint(PETSC_COMM_WORLD, path, read, &fault) == PETSC_SUCCESS);
  REQUIRE(fault.empty());
  const Checkpoint wanted = some_checkpoint();
  CHECK(read.version == "0.9");
  CHECK((read.dim == 2 && read.ranks == 3 && read.backend == "serial" && read.precision == "double"));
  CHECK((read.strategy == "gather" && read.frames == 12 && read.history == wanted.history));
  CHECK((read.run.step == 1234 && read.run.time == 0.1 + 0.2 && read.run.rebuilds.since == 3 &&
         read.run.last_dt == 9e-5 && read.run.rebuilds.shortest == 6));
  CHECK((read.run.waves.due == 1250 && read.run.waves.every == 16 && read.run.waves.speed == 37.5));
  CHECK((read.state.bound == 0.1 && read.state.increment == 1.0 / 3));
  CHECK((read.state.margin == 0.25 && read.state.due_in == 2));
  REQUIRE(read.options.size() == 2);
  CHECK((read.options[0].name == "-gravity" && read.options[0].value == "0,-10" && read.options[1].standard));
  check_points(read.state.soil, k_soil);
  REQUIRE(read.state.rigids.size() == 2);
  CHECK((read.state.rigids[0][MotionTerms::velocity + 1] == 4 &&
         read.state.rigids[1][MotionTerms::impulse] == -5));
  CHECK(read.state.rigids[1][MotionTerms::binned + 1] == -8);
  CHECK((read.state.rigids[1][MotionTerms::moment + 2] == 9 &&
         read.state.rigids[1][MotionTerms::rotation] == 0.5));
  CHECK((read.state.particles == k_soil && read.state.lost == wanted.state.lost));
  CHECK((read.state.alone_known == 1 && read.state.alone == wanted.state.alone));
  CHECK(read.state.bounds == std::vector<double>{0.25, 0.5, 0.75});
  CHECK(read.state.owners == std::vector<long>{0, 2, 1, 0});
  CHECK(read.state.impulse.address == std::vector<long>{5, 7});
  CHECK(read.state.impulse.values == std::vector<double>{50, 51, 52, 53, 54, 55, 70, 71, 72, 73, 74, 75});
  CHECK(!fs::exists(path + ".tmp"));
}

TEST_CASE("a checkpoint lists the particles that have left the run", "[checkpoint]") {
  const std::string path = folder_of("lost") + "/checkpoint_1.h5";
  const auto has_left = [](long id) { return id % 10 == 3 || id == k_soil - 1; };
  Checkpoint c = some_checkpoint();
  SavedPoints& soil = c.state.soil;
  std::size_t kept = 0;
  for (std::size_t p = 0; p < soil.id.size(); ++p) {
    if (has_left(soil.id[p])) continue;
    soil.id[kept] = soil.id[p], soil.address[kept] = soil.address[p];
    for (SavedField& field : soil.fields)
      for (int k = 0; k < field.components; ++k)
        field.values[kept * field.components + k] = field.values[p * field.components + k];
    ++kept;
  }
  soil.id.resize(kept), soil.address.resize(kept);
  for (SavedField& field : soil.fields) field.values.resize(kept * field.components);
  for (long id = 0; id < k_soil; ++id) c.state.lost[0] += has_left(id);
  REQUIRE(write_checkpoint(PETSC_COMM_WORLD, path, std::move(c)) == PETSC_SUCCESS);
  Checkpoint read;
  std::string fault;
  REQUIRE(read_checkpoint(PETSC_COMM_WORLD, path, read, &fault) == PETSC_SUCCESS);
  REQUIRE(fault.empty());
  const IdBlock block = block_of(k_soil, rank_of_this(), ranks_of_all());
  std::size_t p = 0;
  for (long id = block.first; id < block.first + block.count; ++id) {
    if (has_left(id)) continue;
    REQUIRE(p < read.state.soil.id.size());
    CHECK((read.state.soil.id[p] == id && read.state.soil.address[p] == 1000 + 3 * id));
    for (const SavedField& field : read.state.soil.fields)
      CHECK(field.values.size() == field.components * read.state.soil.id.size());
    ++p;
  }
  CHECK(p == read.state.soil.id.size());
}

TEST_CASE("a checkpoint in which anything changed is refused", "[checkpoint]") {
  if (ranks_of_all() > 1) return;
  const std::string folder = folder_of("damage"), path = folder + "/sound.h5", other = folder + "/damaged.h5";
  REQUIRE(write_checkpoint(PETSC_COMM_SELF, path, some_checkpoint()) == PETSC_SUCCESS);
  const std::string sound = text_of_file(path);
  REQUIRE(fault_of(path).empty());
  std::mt19937 chance(11);
  for (int n = 0; n < 300; ++n) {
    std::string text = sound;
    text[chance() % text.size()] ^= char(1 << chance() % 8);
    write_text(other, text);
    REQUIRE(!fault_of(other).empty());
    write_text(other, sound.substr(0, chance() % sound.size()));
    REQUIRE(!fault_of(other).empty());
    write_text(other, sound + std::string(1 + chance() % 100, '\0'));
    REQUIRE(!fault_of(other).empty());
  }
}

TEST_CASE("what is sealed but no checkpoint is refused without harm", "[checkpoint]") {
  if (ranks_of_all() > 1) return;
  const std::string folder = folder_of("sealed"), path = folder + "/text.h5";
  REQUIRE(replace_sealed(path, "no HDF5 at all") == PETSC_SUCCESS);
  CHECK(!fault_of(path).empty());
  REQUIRE(replace_sealed(path, "") == PETSC_SUCCESS);
  CHECK(!fault_of(path).empty());
}

TEST_CASE("only what contradicts the state is refused at a restart", "[checkpoint]") {
  Config config;
  config.rigids.resize(1);
  config.rigids[0].name = "plate";
  Checkpoint c;
  c.options = {{"-gravity", "0,-10", "m/s2", false},
               {"-time_end", "2", "s", false},
               {"-damping", "0", "-", true},
               {"-backend", "serial", "", true},
               {"-plate_friction", "0.3", "-", false}};
  const auto refused = [&](std::vector<EffectiveOption> now) {
    return compare_options(c, now, config, "FILE").lines.size();
  };
  CHECK(refused(c.options) == 0);
  auto same = c.options;
  same[0].value = "0,-1e1", same[2] = {"-damping", "0.0", "-", false}, same[4].value = ".3";
  CHECK(refused(same) == 0);
  auto allowed = c.options;
  allowed[1].value = "3", allowed[3] = {"-backend", "openmp", "", false};
  allowed.push_back({"-output_compression", "3", "", false});
  CHECK(refused(allowed) == 0);
  auto wrong = c.options;
  wrong[0].value = "0,-9", wrong[2].value = "0.1";
  wrong.pop_back();
  wrong.push_back({"-stone_shape", "disc", "", false});
  const auto lines = compare_options(c, wrong, config, "FILE").lines;
  REQUIRE(lines.size() == 4);
  CHECK(lines[0].starts_with("mpm: -gravity: given \"0,-9\", takes \"0,-10\""));
  CHECK(lines[3].find("-plate_friction") != std::string::npos);
}

TEST_CASE("a load changes at a restart where it is named, and is reported", "[checkpoint]") {
  Config config;
  config.rigids.resize(2);
  config.rigids[0].name = "plate", config.rigids[1].name = "pile";
  config.rigids[0].motion = Motion::prescribed, config.rigids[0].velocity = {0, -2, 0};
  config.rigids[1].motion = Motion::dynamic, config.rigids[1].velocity = {7, 0, 0};
  Checkpoint c;
  c.options = {{"-gravity", "0,-10", "m/s2", false},
               {"-mesh_xmin", "roller", "", true},
               {"-plate_velocity", "0,-1", "m/s", false},
               {"-pile_force", "5,0", "N", false},
               {"-mesh_spacing", "0.1", "m", false}};
  auto now = c.options;
  now[0].value = "0,-5", now[1] = {"-mesh_xmin", "fixed", "", false}, now[2].value = "0,-2";
  now.erase(now.begin() + 3);
  now.push_back({"-pile_density", "3", "kg/m3", false});
  CHECK(compare_options(c, now, config, "FILE").lines.size() == 5);
  CHECK(compare_options(c, now, config, "FILE", {"GRAVITY", "plate_velocity"}).lines.size() == 3);
  const std::vector<std::string> all = {"gravity", "mesh_xmin", "plate_velocity", "pile_force",
                                        "pile_density"};
  const Comparison found = compare_options(c, now, config, "FILE", all);
  CHECK(found.lines.empty());
  REQUIRE(found.changes.size() == 5);
  CHECK((found.changes[0].name == "-gravity" && found.changes[0].before == "0,-10" &&
         found.changes[0].after == "0,-5"));
  CHECK((found.changes[3].name == "-pile_density" && found.changes[3].before == "none"));
  CHECK((found.changes[4].name == "-pile_force" && found.changes[4].after == "none"));

  SavedState state;
  state.rigids.resize(2);
  const int velocity = MotionTerms::velocity;
  set_vector(state.rigids[0], velocity, {0, -1, 0}), set_vector(state.rigids[1], velocity, {0.5, 0, 0});
  apply_changes(found.changes, config, state);
  CHECK(vector_of(state.rigids[0], velocity) == std::array<double, 3>{0, -2, 0});
  CHECK(vector_of(state.rigids[1], velocity) ==
        std::array<double, 3>{0.5, 0, 0});  // its force changed, no more
  config.rigids[1].motion = Motion::fixed;
  apply_changes({{"-pile_motion", "dynamic", "fixed"}}, config, state);
  CHECK(vector_of(state.rigids[1], velocity) == std::array<double, 3>{});

  for (const std::string& name : all) CHECK(change_rule(name, config).listed);
  for (const char* name :
       {"mesh_spacing", "mesh_zmin", "plate_shape", "stone_velocity", "time_step", "gravit"})
    CHECK(!change_rule(name, config).listed);
}

TEST_CASE("the last two checkpoints are kept, and what is later goes at a restart", "[checkpoint]") {
  if (ranks_of_all() > 1) return;
  const std::string folder = folder_of("kept");
  fs::create_directories(folder + "/frames");
  for (const char* name :
       {"checkpoint_9.h5", "checkpoint_100.h5", "checkpoint_20.h5", "checkpoint_x.h5", "checkpoint_1",
        "checkpoint_300.h5.tmp", "frames/frame_00001.h5", "frames/frame_00007.h5", "frames/mine.h5"})
    write_text(folder + "/" + name, "\x89HDF\r\n\x1a\n cut short");
  for (const char* name : {"checkpoint_8.h5", "checkpoint_500.h5", "frames/frame_00009.h5"})
    write_text(folder + "/" + name, "of another program");
  CHECK(checkpoint_steps(folder) == std::vector<long>{8, 9, 20, 100, 500});
  int removed = 0;
  REQUIRE(remove_unfinished(folder, &removed) == PETSC_SUCCESS);
  CHECK((removed == 1 && !fs::exists(folder + "/checkpoint_300.h5.tmp")));
  REQUIRE(keep_last_checkpoints(folder) == PETSC_SUCCESS);
  CHECK(checkpoint_steps(folder) == std::vector<long>{8, 100, 500});
  REQUIRE(remove_later_checkpoints(folder, 20, &removed) == PETSC_SUCCESS);
  CHECK((removed == 2 && checkpoint_steps(folder) == std::vector<long>{8, 500}));
  REQUIRE(remove_later_frames(folder, 7, &removed) == PETSC_SUCCESS);
  CHECK(removed == 3);
  CHECK((fs::exists(folder + "/checkpoint_x.h5") && fs::exists(folder + "/frames/frame_00001.h5")));
  CHECK((fs::exists(folder + "/frames/mine.h5") && !fs::exists(folder + "/frames/frame_00007.h5")));
  CHECK(fs::exists(folder + "/frames/frame_00009.h5"));
}

TEST_CASE("a state that no kernel could take is refused", "[checkpoint]") {
  Config config;
  config.mesh.cells = {20, 10, 1};
  config.bodies.resize(2);
  config.rigids.resize(1);
  SavedState sound;
  sound.rigids.resize(1);
  sound.lost.resize(config.bodies.size() * k_lost);
  sound.unused.resize(config.bodies.size()), sound.variables.resize(config.bodies.size());
  sound.soil.address = {(1 + 5) * 64 + 3};  // the first patch of the mesh: 5 patches a row with the ring
  sound.soil.fields = {{"coordinate", 2, 8, {0.25, 1.2}},
                       {"body", 1, 2, {1}},
                       {"velocity", 2, 8, {3, -4}},
                       {"stress", 4, 8, {-1, -2, -3, 4}},
                       {"volume", 1, 8, {0.1}}};
  REQUIRE(state_fault(sound, config).empty());
  const auto refused = [&](auto&& change) {
    SavedState state = sound;
    change(state);
    return !state_fault(state, config).empty();
  };
  CHECK(refused([](SavedState& s) { s.soil.address[0] = 0; }));
  CHECK(refused([](SavedState& s) { s.soil.address[0] = -64; }));
  CHECK(refused([](SavedState& s) { s.soil.address[0] = 1L << 40; }));
  CHECK(refused([](SavedState& s) { s.soil.fields[0].values[1] = std::nan(""); }));
  CHECK(refused([](SavedState& s) { s.soil.fields[0].values[1] = 3; }));
  CHECK(refused([](SavedState& s) { s.soil.fields[1].values[0] = 2; }));
  CHECK(refused([](SavedState& s) { s.soil.fields[1].values[0] = -1; }));
  CHECK(refused([](SavedState& s) { s.soil.fields[4].values[0] = 0; }));
  for (int n = 0; n < 5; ++n) {
    CHECK(refused([n](SavedState& s) { s.soil.fields.erase(s.soil.fields.begin() + n); }));
    CHECK(refused([n](SavedState& s) { ++s.soil.fields[n].components; }));
  }
  CHECK(refused([](SavedState& s) { s.bound = 0.7; }));
  CHECK(refused([](SavedState& s) { s.unused[1] = -1; }));
  CHECK(refused([](SavedState& s) { s.variables.pop_back(); }));
  CHECK(refused([](SavedState& s) { s.rigids[0][MotionTerms::velocity] = HUGE_VAL; }));
  CHECK(refused([](SavedState& s) { s.rigids.clear(); }));
  CHECK(refused([](SavedState& s) { s.impulse.address = {5}; }));
}

TEST_CASE("a checkpoint of version 0.1 has its unused normal impulses where friction keeps them now",
          "[checkpoint]") {
  Config config;
  config.dim = 2;
  config.mesh.cells = {4, 3, 1};
  SavedState state;
  state.rigids.resize(2);
  state.impulse = {{7}, {50, 51}};
  state.sides.kinds = {0, 0, static_cast<long>(Wall::friction), 0};
  const std::size_t earlier = SideTerms<2>::size + 1 - ImpulseTerms::size, rows = 4 + 3;
  for (std::size_t k = 0; k < rows * earlier; ++k) state.sides.values.push_back(static_cast<double>(k));
  complete_earlier(config, state);
  CHECK(state.impulse.values == std::vector<double>{0, 0, 50, 0, 0, 51});
  REQUIRE(state.sides.values.size() == rows * SideTerms<2>::size);
  const double* const second = &state.sides.values[SideTerms<2>::size];
  CHECK(second[SideTerms<2>::pressed + ImpulseTerms::store] == static_cast<double>(earlier));
  CHECK(second[SideTerms<2>::drift] == static_cast<double>(earlier + 1));
  const SavedState now = state;
  complete_earlier(config, state);
  CHECK(state.impulse.values == now.impulse.values);
  CHECK(state.sides.values == now.sides.values);
}
