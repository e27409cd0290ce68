// Files of a run: the history, the frames and their index, the log; and the files that are left when the disk
// is full.

#include <hdf5.h>
#include <petscsys.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/collectives.hpp"
#include "common/energy_meter.hpp"
#include "common/gpu_energy.hpp"
#include "input/deck/run_options.hpp"
#include "output/files.hpp"
#include "output/folder_lock.hpp"
#include "output/frames.hpp"
#include "output/history.hpp"
#include "output/json.hpp"
#include "output/log.hpp"
#include "output/measurement_cache.hpp"
#include "output/own_files.hpp"
#include "output/performance.hpp"
#include "output/performance_json.hpp"

using namespace mpm;
using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

namespace {

/// A folder that goes with its scope.
struct Folder {
  std::string path = (fs::temp_directory_path() / ("mpm_output_" + std::to_string(::getpid()))).string();
  Folder() {
    fs::remove_all(path);
    REQUIRE(prepare_output_folder(path, nullptr) == PETSC_SUCCESS);
  }
  ~Folder() { fs::remove_all(path); }
  std::string operator/(const std::string& name) const { return path + "/" + name; }
};

/// Files may not grow beyond `bytes` while this lives: the nearest thing to a full disk. Errors are not
/// printed.
struct FullDisk {
  rlimit before{};
  explicit FullDisk(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit small{bytes, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
    (void)PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  }
  ~FullDisk() {
    (void)PetscPopErrorHandler();
    setrlimit(RLIMIT_FSIZE, &before);
  }
};

std::string contents(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> split(const std::string& row, char separator) {
  std::vector<std::string> words;
  std::istringstream stream(row);
  for (std::string word; std::getline(stream, word, separator);) words.push_back(word);
  return words;
}

Config footing_like(const std::string& folder, int dim) {
  Config config;
  config.dim = dim;
  config.bodies.resize(1);
  config.bodies[0].name = "soil";
  config.rigids.resize(1);
  config.rigids[0].name = "plate";
  config.materials.push_back({"clay", "von_mises", 500, {}});
  config.output.directory = folder;
  return config;
}

HistoryRow some_row() {
  HistoryRow row{12, 1.0 / 3, 6e-5, 0.1, {BodyRow{}}, {RigidRow{}}};
  row.bodies[0] = {{0, -1e-300, 0}, {3, 4.1, 0}, 2.0 / 7, {1e-17, -0.25, 0}, {2.9, 4, 0}, {1.5, 2.1, 0}, 0.7};
  row.bodies[0].mass = 900.25, row.bodies[0].lost_mass = 3.5, row.bodies[0].lost_energy = 0.125;
  row.bodies[0].lost_momentum = {0.1, -0.2, 0};
  row.bodies[0].strays = 7, row.bodies[0].limited = 1, row.bodies[0].put_back = 2;
  row.walls[0][0] = {-3.25, 0, 0}, row.walls[1][1] = {0, -1e5, 0};
  row.rigids[0] = {{0, -0.02, 0}, {0, -0.1, 0}, {1.5, 8765.4321, 0}};
  row.empty_cells = 6, row.filled_cells = 100;
  row.energy.kinetic = 2.5, row.energy.error = -0.125;
  return row;
}

/// `count` particles, each with other numbers.
ParticleSnapshot some_particles(const std::string& name, int count, bool body) {
  ParticleSnapshot p;
  p.name = name;
  for (int k = 0; k < 3 * count; ++k) p.position.push_back(200 + k / 7.0), p.velocity.push_back(-k / 3.0);
  for (int k = 0; body && k < 3 * count; ++k) p.grid_velocity.push_back(k / 9.0);
  for (int k = 0; body && k < 6 * count; ++k) p.stress.push_back(1000.0 * k);
  if (body) p.state = {{"plastic_strain", {}}};
  for (int k = 0; body && k < count; ++k) {
    p.volume.push_back(0.25), p.state[0].values.push_back(0.1 * k);
    p.mass.push_back(500 + k / 3.0), p.reference_height.push_back(-2 + k / 7.0);
  }
  return p;
}

Snapshot some_snapshot() {
  return {0.5, 42, {some_particles("soil", 5, true)}, {some_particles("plate", 2, false)}};
}

/// Leaves of a body what one of several ranks has.
void take_share(ParticleSnapshot& body, int rank, int ranks) {
  body.total = static_cast<long>(body.volume.size());
  body.first = body.total * rank / ranks;
  const long end = body.total * (rank + 1) / ranks;
  const auto cut = [&](std::vector<double>& values, int width) {
    values = {values.begin() + body.first * width, values.begin() + end * width};
  };
  cut(body.position, 3), cut(body.velocity, 3), cut(body.grid_velocity, 3), cut(body.stress, 6);
  cut(body.volume, 1), cut(body.state[0].values, 1), cut(body.mass, 1), cut(body.reference_height, 1);
}

/// A path that is the same on all ranks.
std::string shared_path(MPI_Comm comm, const std::string& name) {
  std::string path = fs::temp_directory_path() / ("mpm_" + std::to_string(::getpid()) + "_" + name);
  if (rank_of(comm) != 0) path.clear();
  REQUIRE(share_text(comm, &path) == PETSC_SUCCESS);
  return path;
}

/// A dataset as doubles, with its shape and the bytes of a number in the file.
struct Dataset {
  std::vector<double> values;
  std::vector<hsize_t> shape;
  size_t bytes = 0;
};

Dataset read_dataset(const std::string& path, const char* name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  REQUIRE(file >= 0);
  const hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
  REQUIRE(data >= 0);
  const hid_t space = H5Dget_space(data), type = H5Dget_type(data);
  Dataset out;
  out.shape.resize(H5Sget_simple_extent_ndims(space));
  H5Sget_simple_extent_dims(space, out.shape.data(), nullptr);
  out.values.resize(H5Sget_simple_extent_npoints(space));
  out.bytes = H5Tget_size(type);
  CHECK(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.values.data()) >= 0);
  H5Tclose(type), H5Sclose(space), H5Dclose(data), H5Fclose(file);
  return out;
}

double read_attribute(const std::string& path, const char* name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t attribute = H5Aopen(file, name, H5P_DEFAULT);
  double value = NAN;
  CHECK(H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) >= 0);
  H5Aclose(attribute), H5Fclose(file);
  return value;
}

/// Does every tag of the text close in order?
bool is_well_formed(const std::string& xml) {
  std::vector<std::string> open;
  for (size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1), name = tag.substr(0, tag.find(' '));
    if (tag.starts_with("?") || tag.ends_with("/")) continue;
    if (!tag.starts_with("/"))
      open.push_back(name);
    else if (open.empty() || "/" + open.back() != name)
      return false;
    else
      open.pop_back();
  }
  return open.empty();
}

int temporary_files(const std::string& folder) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    count += entry.path().extension() == ".tmp";
  return count;
}

}  // namespace

TEST_CASE("the history's columns are those of the manual", "[output]") {
  CHECK(history_header(footing_like("", 2)) ==
        "step,time,dt,wall_time,soil_xmin,soil_xmax,soil_ymin,soil_ymax,soil_kinetic_energy,soil_momentum_x,"
        "soil_momentum_y,soil_xq999,soil_yq999,soil_centre_x,soil_centre_y,soil_grid_velocity,soil_"
        "mass,soil_lost_mass,soil_lost_energy,soil_lost_momentum_x,soil_lost_momentum_y,soil_strays,soil_"
        "limited,soil_put_back,plate_x,plate_y,plate_velocity_x,plate_velocity_y,plate_force_x,plate_force_y,"
        "wall_xmin_force_x,wall_xmin_force_y,wall_xmax_force_x,wall_xmax_force_y,wall_ymin_force_x,wall_ymin_"
        "force_y,wall_ymax_force_x,wall_ymax_force_y,empty_cells");
  Config balanced = footing_like("", 2);
  balanced.output.energy = true;
  CHECK_THAT(history_header(balanced),
             ContainsSubstring(",empty_cells,energy_kinetic,energy_internal,energy_elastic,energy_dissipated,"
                               "energy_lost,work_gravity,work_rigids,work_contact,work_damping,work_update,"
                               "energy_error"));
  CHECK_THAT(history_header(footing_like("", 3)),
             ContainsSubstring("soil_ymax,soil_zmin,soil_zmax,soil_kinetic_energy"));
  CHECK_THAT(history_header(footing_like("", 3)),
             ContainsSubstring("soil_xq999,soil_yq999,soil_zq999,soil_centre_x,soil_centre_y,soil_centre_z,"
                               "soil_grid_velocity,"));
  CHECK_THAT(history_header(footing_like("", 3)),
             ContainsSubstring("plate_x,plate_y,plate_z,plate_velocity_x"));
}

TEST_CASE("a row of the history reads back to the same numbers", "[output]") {
  const HistoryRow row = some_row();
  const auto words = split(format_history_row(row, footing_like("", 2)), ',');
  const double expected[] = {
      12,  row.time, row.dt, row.wall_time, 0,     3,     -1e-300, 4.1,  2.0 / 7, 1e-17, -0.25, 2.9,  4,
      1.5, 2.1,      0.7,    900.25,        3.5,   0.125, 0.1,     -0.2, 7,       1,     2,     0,    -0.02,
      0,   -0.1,     1.5,    8765.4321,     -3.25, 0,     0,       0,    0,       0,     0,     -1e5, 6};
  REQUIRE(words.size() == std::size(expected));
  for (size_t k = 0; k < words.size(); ++k) CHECK(std::strtod(words[k].c_str(), nullptr) == expected[k]);
  CHECK(split(format_history_row(row, footing_like("", 3)), ',').size() ==
        split(history_header(footing_like("", 3)), ',').size());
  Config balanced = footing_like("", 2);
  balanced.output.energy = true;
  const auto with_energy = split(format_history_row(row, balanced), ',');
  REQUIRE(with_energy.size() == words.size() + 11);
  CHECK(with_energy.size() == split(history_header(balanced), ',').size());
  CHECK(with_energy[words.size()] == "2.5");
  CHECK(with_energy.back() == "-0.125");
}

TEST_CASE("history.csv holds its header and whole rows, whatever the disk does", "[output]") {
  const Folder folder;
  History history;
  REQUIRE(history.open(footing_like(folder.path, 2)) == PETSC_SUCCESS);
  REQUIRE(history.write(some_row()) == PETSC_SUCCESS);
  const std::string whole = contents(folder / "history.csv");
  CHECK(split(whole, '\n').size() == 2);
  CHECK(whole.ends_with('\n'));
  {
    const FullDisk full(whole.size() + 20);
    CHECK(history.write(some_row()) == PETSC_ERR_FILE_WRITE);
  }
  CHECK(contents(folder / "history.csv") == whole);
  CHECK(history.close() == PETSC_SUCCESS);
}

TEST_CASE("a frame reads back", "[output]") {
  const Folder folder;
  const Snapshot snapshot = some_snapshot();
  const bool single = GENERATE(false, true);
  const std::string path = folder / "frames/frame_00000.h5";
  REQUIRE(write_frame(path, snapshot, single ? Precision::single : Precision::double_) == PETSC_SUCCESS);

  CHECK(read_attribute(path, "time") == 0.5);
  CHECK(read_attribute(path, "step") == 42);
  const Dataset position = read_dataset(path, "soil/position");
  CHECK(position.bytes == 8);
  CHECK(position.shape == std::vector<hsize_t>{5, 3});
  CHECK(position.values == snapshot.bodies[0].position);
  const Dataset stress = read_dataset(path, "soil/stress");
  CHECK(stress.bytes == (single ? 4 : 8));
  CHECK(stress.shape == std::vector<hsize_t>{5, 6});
  CHECK(stress.values == snapshot.bodies[0].stress);
  const Dataset grid_velocity = read_dataset(path, "soil/grid_velocity");
  CHECK(grid_velocity.shape == std::vector<hsize_t>{5, 3});
  if (!single) CHECK(grid_velocity.values == snapshot.bodies[0].grid_velocity);
  CHECK(read_dataset(path, "soil/volume").shape == std::vector<hsize_t>{5});
  CHECK(read_dataset(path, "soil/plastic_strain").values.size() == 5);
  CHECK(read_dataset(path, "soil/mass").bytes == (single ? 4 : 8));
  const Dataset height = read_dataset(path, "soil/reference_height");  // exact: strengths follow it
  CHECK((height.bytes == 8 && height.values == snapshot.bodies[0].reference_height));
  CHECK(read_dataset(path, "plate/velocity").shape == std::vector<hsize_t>{2, 3});
  CHECK(temporary_files(folder.path) == 0);
}

TEST_CASE("the index names every frame and every field", "[output]") {
  const Folder folder;
  Frames frames;
  frames.open(folder.path, Precision::single);
  for (int k = 0; k < 3; ++k) REQUIRE(frames.write(some_snapshot()) == PETSC_SUCCESS);

  const std::string index = contents(folder / "particles.xdmf");
  CHECK(frames.count() == 3);
  CHECK(is_well_formed(index));
  for (const char* item :
       {"frames/frame_00002.h5:/soil/stress", "frames/frame_00000.h5:/plate/velocity", "Name=\"stress_zx\"",
        "0 5 1 1 5 1", "Dimensions=\"5 6\"", "Time Value=\"0.5\"", "Precision=\"4\"", "Precision=\"8\""})
    CHECK_THAT(index, ContainsSubstring(item));
  CHECK_THAT(index, !ContainsSubstring("plate/stress"));
  CHECK_THAT(index, ContainsSubstring(
                        "Precision=\"8\" Dimensions=\"5\">frames/frame_00000.h5:/soil/reference_height"));
  CHECK_THAT(index, ContainsSubstring("Precision=\"4\" Dimensions=\"5\">frames/frame_00000.h5:/soil/mass"));
  CHECK_THAT(index, !ContainsSubstring("plate/mass"));
  CHECK(temporary_files(folder.path) == 0);
}

TEST_CASE("a frame that does not fit leaves nothing, and the frames before it stay", "[output]") {
  const Folder folder;
  Frames frames;
  frames.open(folder.path, Precision::double_);
  REQUIRE(frames.write(some_snapshot()) == PETSC_SUCCESS);
  const std::string index = contents(folder / "particles.xdmf");
  {
    const FullDisk full(4000);
    Snapshot large = some_snapshot();
    large.bodies[0] = some_particles("soil", 1000, true);
    CHECK(frames.write(large) == PETSC_ERR_FILE_WRITE);
  }
  CHECK(frames.count() == 1);
  CHECK(temporary_files(folder.path) == 0);
  CHECK(!fs::exists(folder / "frames/frame_00001.h5"));
  CHECK(contents(folder / "particles.xdmf") == index);
  REQUIRE(frames.write(some_snapshot()) == PETSC_SUCCESS);
}

TEST_CASE("a frame of several ranks holds what one of a single rank holds", "[frames_together]") {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const int rank = rank_of(comm), ranks = size_of(comm);
  const std::string one = shared_path(comm, "one.h5"), together = shared_path(comm, "together.h5");
  // None, fewer than ranks, some, and more than a piece.
  const int count = GENERATE(0, 1, 5, 1000, 200001);
  const int compression = GENERATE(0, 1, 9);
  const Precision precision = GENERATE(Precision::double_, Precision::single);
  const FrameStyle style{GENERATE(0, 1) ? std::vector<std::string>{"stress"} : std::vector<std::string>{},
                         compression};
  Snapshot whole = some_snapshot();
  whole.bodies = {some_particles("soil", count, true), some_particles("rock", 7, true)};
  for (int k = 0; k < count; ++k) whole.bodies[0].stress[k] = std::sin(1e5 * k);  // not to be compressed
  Snapshot part = whole;
  for (ParticleSnapshot& body : part.bodies) take_share(body, rank, ranks);
  REQUIRE(write_frame_together(comm, together, part, precision, style) == PETSC_SUCCESS);
  if (rank == 0) {
    REQUIRE(write_frame(one, whole, precision, style) == PETSC_SUCCESS);
    for (const char* name : {"soil/position", "soil/stress", "rock/stress", "plate/position"}) {
      const Dataset a = read_dataset(one, name), b = read_dataset(together, name);
      CHECK(a.values == b.values);
      CHECK(a.shape == b.shape);
      CHECK(a.bytes == b.bytes);
    }
    if (count == 200001 && compression > 0)
      CHECK(fs::file_size(together) < 1.1 * static_cast<double>(fs::file_size(one)));
    CHECK(!fs::exists(together + ".tmp"));
    fs::remove(one), fs::remove(together);
  }
  MPI_Barrier(comm);
}

TEST_CASE("a frame that several ranks cannot write fails on all of them and leaves nothing",
          "[frames_together]") {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const std::string folder = shared_path(comm, "none");
  Snapshot part = some_snapshot();
  take_share(part.bodies[0], rank_of(comm), size_of(comm));
  REQUIRE(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr) == PETSC_SUCCESS);
  for (const int compression : {0, 1})
    CHECK(write_frame_together(comm, folder + "/frame.h5", part, Precision::double_, {{}, compression}) ==
          PETSC_ERR_FILE_WRITE);
  REQUIRE(PetscPopErrorHandler() == PETSC_SUCCESS);
  CHECK(!fs::exists(folder));
}

TEST_CASE("an earlier run's files go, others stay", "[output]") {
  const Folder folder;
  const auto make = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
  };
  const std::string picture = "\x89PNG\r\n....IHDR....tEXtSoftware Matplotlib version 3";
  make("history.csv", "step,time,dt,wall_time,soil_xmin\n0,0,1,0,0\n"), make("mpm.log", "mpm 0.1.0  today\n");
  make("performance.json", performance_json({}));
  make("runout.png", picture), make("frames/frame_00008.h5.tmp", "half of it"), make("checkpoint_200.h5", "");
  make("checkpoint_300.h5", "\x89HDF\r\n\x1a\n and then rubbish");
  REQUIRE(write_frame(folder / "frames/frame_00007.h5", some_snapshot(), Precision::double_) ==
          PETSC_SUCCESS);
  const std::vector<std::string> others = {
      "notes.txt",           "my_checkpoint_100.h5", "checkpoint_notes.h5",        "checkpoint_01.h5",
      "checkpoint_100.h5",   "velocity.png",         "frames/frame_mine.h5",       "frames/frame_7.h5",
      "frames/frame_012.h5", "options.json",         "frames/frame_000001.h5.tmp", "frames/history.csv"};
  for (const std::string& name : others) make(name, "of a user");
  CHECK(foreign_file(folder.path) == folder / "checkpoint_100.h5");
  int removed = 0;
  REQUIRE(prepare_output_folder(folder.path, &removed) == PETSC_SUCCESS);
  CHECK(removed == 8);
  for (const std::string& name : others) CHECK(contents(folder / name) == "of a user");
}

TEST_CASE("a file under our name is ours by what is in it, and never a pipe, a link or a folder",
          "[output]") {
  const Folder folder;
  CHECK(foreign_file(folder.path).empty());
  const auto alone = [&](const std::string& name, auto&& make) {
    make(folder / name);
    const std::string foreign = foreign_file(folder.path);
    fs::remove_all(folder / name);
    return foreign;
  };
  const auto text = [](const std::string& words) {
    return [words](const std::string& path) { std::ofstream(path, std::ios::binary) << words; };
  };
  CHECK(alone("history.csv", text("step,time,dt,wall_time\n")).empty());
  CHECK(alone("history.csv", text(std::string(4096, '\0'))).empty());  // what a crash leaves
  CHECK(!alone("history.csv", text("year,rain\n")).empty());
  CHECK(!alone("history.csv", [](const std::string& path) {
           REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
         }).empty());
  CHECK(!alone("mpm.log", [](const std::string& path) { fs::create_symlink("/dev/null", path); }).empty());
  CHECK(!alone("options.json", [](const std::string& path) { fs::create_directory(path); }).empty());
  CHECK(alone("checkpoint_7.h5", text("bits\nmpm checkpoint, 4 bytes before this line")).empty());
  CHECK(!alone("checkpoint_7.h5", text("weights of a network")).empty());
  const auto hdf5 = [](const char* attribute) {
    return [attribute](const std::string& path) {
      const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
      for (const char* name : {"time", attribute}) {
        const hid_t space = H5Screate(H5S_SCALAR);
        H5Aclose(H5Acreate2(file, name, H5T_NATIVE_INT, space, H5P_DEFAULT, H5P_DEFAULT));
        H5Sclose(space);
      }
      H5Fclose(file);
    };
  };
  CHECK(alone("frames/frame_00000.h5", hdf5("step")).empty());
  CHECK(!alone("frames/frame_00000.h5", hdf5("epoch")).empty());
  CHECK(alone("frames/frame_mine.h5", hdf5("epoch")).empty());  // no name of ours
}

TEST_CASE("a folder is locked until its run is gone", "[output]") {
  const Folder folder;
  std::string other;
  FolderLock first, second;
  REQUIRE(first.take(folder.path, &other) == PETSC_SUCCESS);
  CHECK((other.empty() && first.left_by().empty() && fs::exists(folder / "mpm.lock")));
  REQUIRE(second.take(folder.path, &other) == PETSC_SUCCESS);
  CHECK_THAT(other, ContainsSubstring("process " + std::to_string(::getpid()) + " on "));
  CHECK_THAT(other, ContainsSubstring(", since 20"));
  CHECK(!second.held());
  REQUIRE(first.take(folder.path, &other) == PETSC_SUCCESS);  // it has it
  CHECK(other.empty());
  first.release();
  CHECK(!fs::exists(folder / "mpm.lock"));
  REQUIRE(second.take(folder.path, &other) == PETSC_SUCCESS);
  CHECK((other.empty() && second.held()));
}

TEST_CASE("a lock whose run was killed is taken over, and a file of others of its name is not", "[output]") {
  const Folder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    FolderLock lock;
    std::string other;
    const bool taken = lock.take(folder.path, &other) == PETSC_SUCCESS && lock.held();
    ::_exit(taken ? 0 : 1);  // as if killed: the lock is not given back
  }
  int status = 1;
  REQUIRE((::waitpid(child, &status, 0) == child && status == 0));
  REQUIRE(fs::exists(folder / "mpm.lock"));
  std::string other;
  {
    FolderLock lock;
    REQUIRE(lock.take(folder.path, &other) == PETSC_SUCCESS);
    CHECK((other.empty() && lock.held()));
    CHECK_THAT(lock.left_by(), ContainsSubstring("process " + std::to_string(child) + " on "));
  }
  CHECK(!fs::exists(folder / "mpm.lock"));
  std::ofstream(folder / "mpm.lock") << "my notes";
  FolderLock lock;
  REQUIRE(lock.take(folder.path, &other) == PETSC_SUCCESS);
  CHECK((!lock.held() && other.find("no lock of this program") != std::string::npos));
  CHECK(contents(folder / "mpm.lock") == "my notes");
}

TEST_CASE("options.json is JSON whatever bytes a path has", "[output]") {
  const Folder folder;
  const auto written = [&](const std::string& value) {
    REQUIRE(write_options_json(folder.path, "1", {{"-soil_file", value, "", false}}) == PETSC_SUCCESS);
    const std::string text = contents(folder / "options.json");
    const auto from = text.find("\"soil_file\": ") + 13;
    return text.substr(from, text.find('\n', from) - from);
  };
  CHECK(written("a\"b\\c") == R"("a\"b\\c")");
  CHECK(written("sch\xc3\xb6n \xe2\x82\xac \xf0\x9f\x98\x80") ==
        "\"sch\xc3\xb6n \xe2\x82\xac \xf0\x9f\x98\x80\"");
  CHECK(written("sch\xf6n") == R"("sch\ufffdn")");              // Latin-1
  CHECK(written("\xc3") == R"("\ufffd")");                      // cut
  CHECK(written("\xc0\xaf") == R"("\ufffd\ufffd")");            // overlong
  CHECK(written("\xed\xa0\x80") == R"("\ufffd\ufffd\ufffd")");  // half of a pair
}

TEST_CASE("a folder that cannot be made is an error", "[output]") {
  const Folder folder;
  std::ofstream(folder / "file") << "in the way";
  REQUIRE(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr) == PETSC_SUCCESS);
  CHECK(prepare_output_folder(folder / "file/out", nullptr) == PETSC_ERR_FILE_OPEN);
  REQUIRE(PetscPopErrorHandler() == PETSC_SUCCESS);
}

TEST_CASE("progress says how far and how long", "[output]") {
  CHECK(format_progress({500, 0.5, 0, 2, 10, 5e7}) ==
        "step 500  t = 0.5 s  25.0 %  5.0 M/s particle updates  30 s left");
  CHECK(format_progress({500, 1.5, 1, 2, 10, 5e4}) ==
        "step 500  t = 1.5 s  50.0 %  5.0 k/s particle updates  10 s left");
  CHECK(format_progress({900, 2, 0, 2, 125, 2.5e11}) ==
        "step 900  t = 2 s  100.0 %  2.00 G/s particle updates  in 2 min 05 s");
  CHECK(format_progress({0, 0, 0, 2, 0, 0}) == "step 0  t = 0 s  0.0 %");
  CHECK(format_duration(2 * 3600 + 7 * 60) == "2 h 07 min");
}

TEST_CASE("the closing table adds up", "[output]") {
  Performance p;
  p.functions = {{"interpolate", 100, 6.0, 3e11}, {"move", 100, 3.0, 0}};
  p.wall = 10, p.stepping = 9.5, p.steps = 100, p.particles = 190000;
  p.rebuilds = 3, p.shortest = 20, p.longest = 40, p.interval = 30;
  p.strategy = "tile", p.memory = 19e6, p.bandwidth = 1e11;
  const std::string report = format_performance(p);
  for (const char* part :
       {"60.0 %", "30.0 %", "everything else", "10.0 %", "300.00      50.0   50.0 %",
        "rebuilt 3 times, after 20 to 40", "30.0 on average", "strategy tile", "100.0 bytes a particle",
        "31.6 GB/s, 31.6 % of it", "2.0 M/s", "9.5e+04 us a step"})
    CHECK_THAT(report, ContainsSubstring(part));
}

TEST_CASE("the report ends with the motion in a second and the energy", "[output]") {
  Performance p;
  p.wall = 10, p.stepping = 9.5, p.steps = 100, p.particles = 190000;
  CHECK(format_performance(p).ends_with("particle updates"));
  p.simulated = 0.5, p.energy = 7.2e6;
  CHECK(
      format_performance(p).ends_with("\n0.05 s of motion in a second of wall time\n2 kWh taken by the "
                                      "processors, with all that ran on them"));
  CHECK_THAT(performance_json(p), ContainsSubstring("\"real_time_factor\": 0.05"));
  CHECK_THAT(performance_json(p), ContainsSubstring("\"energy_joules\": 7200000"));
  p.gpu_energy = 3.6e5;
  CHECK(format_performance(p).ends_with("\n0.1 kWh taken by the GPUs, with all that ran on them"));
  CHECK_THAT(performance_json(p), ContainsSubstring("\"gpu_energy_joules\": 360000"));
}

TEST_CASE("energy is counted over the counters' beginning anew", "[output]") {
  const Folder folder;
  const auto zone = [&](const std::string& name, const char* what, double energy) {
    const fs::path place = fs::path(folder.path) / name;
    fs::create_directories(place);
    std::ofstream(place / "name") << what << "\n";
    std::ofstream(place / "energy_uj") << std::fixed << energy << "\n";
    std::ofstream(place / "max_energy_range_uj") << "262143328850\n";
  };
  zone("intel-rapl:0", "package-0", 262143000000), zone("intel-rapl:0:0", "core", 5),
      zone("intel-rapl:0:1", "dram", 1e6);
  EnergyMeter meter(folder.path);
  CHECK(meter.found());
  zone("intel-rapl:0", "package-0", 1000000), zone("intel-rapl:0:0", "core", 9e9),
      zone("intel-rapl:0:1", "dram", 3e6);
  meter.read();
  CHECK(meter.joules() == Catch::Approx(0.32885 + 1 + 2));
  CHECK_FALSE(EnergyMeter(folder.path + "/none").found());
}

TEST_CASE("energy of a GPU is that of its driver's counter", "[output]") {
  const char* elsewhere = std::getenv("MPM_UMATS");  // where the libraries of the unit tests lie
  const std::string library =
      std::string(elsewhere != nullptr ? elsewhere : MPM_UMATS) + "/libmpm_umat_nvml.so";
  GpuEnergyMeter meter("00000000:1b:00.0", library.c_str());
  REQUIRE(meter.found());
  CHECK(meter.joules() == Catch::Approx(2.5));
  CHECK(meter.joules() == Catch::Approx(2.5));  // the counter fails
  CHECK(meter.joules() == Catch::Approx(7.5));
  CHECK_FALSE(GpuEnergyMeter("00000000:2b:00.0", library.c_str()).found());  // no such GPU
  CHECK_FALSE(GpuEnergyMeter("00000000:1b:00.0", "libno_such.so").found());
  CHECK_FALSE(GpuEnergyMeter("").found());
  CHECK(GpuEnergyMeter().joules() == 0);
}

TEST_CASE("times that the waiting has made longer than the steps are scaled", "[output]") {
  Performance p;
  p.functions = {{"interpolate", 100, 6.0, 3e9}, {"move", 100, 3.0, 0}};
  p.wall = 4, p.stepping = 3, p.steps = 100, p.particles = 1000;
  const std::string report = format_performance(p);
  for (const char* part :
       {"2.000   50.0 %        3.00       1.5", "1.000   25.0 %", "1.000   25.0 %\n  wall time"})
    CHECK_THAT(report, ContainsSubstring(part));
}

TEST_CASE("performance.json has the figures of the report, with units in the names", "[output]") {
  const Folder folder;
  Performance p;
  p.functions = {{"interpolate", 100, 6.0, 3e9}, {"move \"it\"", 50, 2.0, 0}};
  p.wall = 4.5, p.stepping = 4, p.steps = 100, p.particles = 1000, p.looks = 7;
  p.rebuilds = 3, p.shortest = 20, p.longest = 40, p.interval = 30.5;
  p.version = "1.0", p.outcome = "stopped", p.strategy = "tile", p.device = "2 threads", p.memory = 19e6;
  p.backend = "openmp", p.precision = "single", p.processor = "some \\ processor", p.dim = 2, p.ranks = 4;
  p.threads = 2, p.cores = 8, p.first_step = 200, p.time = 0.1;
  RankFigures ranks;
  ranks.ranks = 4, ranks.particles = {200, 300, 250}, ranks.wait = {0.25, 0.5, 0.375};
  ranks.halo_path = "through host memory";
  p.between_ranks = ranks;
  REQUIRE(write_performance_json(folder.path, p) == PETSC_SUCCESS);
  CHECK(contents(folder / "performance.json") == R"({
  "program": "mpm",
  "version": "1.0",
  "outcome": "stopped",
  "dim": 2,
  "precision": "single",
  "backend": "openmp",
  "strategy": "tile",
  "device": "2 threads",
  "processor": "some \\ processor",
  "cores": 8,
  "threads_per_rank": 2,
  "ranks": 4,
  "particles": 1000,
  "first_step": 200,
  "steps": 100,
  "end_time_seconds": 0.1,
  "wall_seconds": 4.5,
  "stepping_seconds": 4,
  "particle_updates_per_second": 25000,
  "real_time_factor": null,
  "energy_joules": null,
  "gpu_energy_joules": null,
  "memory_bytes": 1.9e+07,
  "copy_bandwidth_bytes_per_second": null,
  "moved_bytes_per_second": 7.5e+08,
  "looks_of_host": 7,
  "rebuilds": {
    "count": 3,
    "shortest_interval_steps": 20,
    "longest_interval_steps": 40,
    "mean_interval_steps": 30.5
  },
  "functions": [
    {"name": "interpolate", "calls": 100, "seconds": 3, "bytes": 3e+09},
    {"name": "move \"it\"", "calls": 50, "seconds": 1, "bytes": null}
  ],
  "between_ranks": {
    "particles": {"least": 200, "most": 300, "mean": 250},
    "neighbours": {"least": 0, "most": 0, "mean": 0},
    "halo_nodes": {"least": 0, "most": 0, "mean": 0},
    "sent_bytes_per_step": {"least": 0, "most": 0, "mean": 0},
    "compute_seconds": {"least": 0, "most": 0, "mean": 0},
    "halo_seconds": {"least": 0, "most": 0, "mean": 0},
    "wait_seconds": {"least": 0.25, "most": 0.5, "mean": 0.375},
    "held_seconds": null,
    "halo_path": "through host memory"
  }
}
)");
  CHECK_THAT(format_ranks(ranks), ContainsSubstring("200 to 300 particles a rank, largest over mean 1.200"));
}

TEST_CASE("performance.json has no figures that are not finite, and goes before a run goes on", "[output]") {
  const Folder folder;
  const std::string text = performance_json({});
  for (const char* part : {"\"steps\": 0,", "\"particle_updates_per_second\": null,", "\"functions\": [],",
                           "\"mean_interval_steps\": null\n", "\"between_ranks\": null\n"})
    CHECK_THAT(text, ContainsSubstring(part));
  CHECK(json_number(std::nan("")) == "null");
  CHECK(std::stod(json_number(1.0 / 3)) == 1.0 / 3);
  REQUIRE(write_performance_json(folder.path, {}) == PETSC_SUCCESS);
  CHECK(foreign_file(folder.path).empty());
  REQUIRE(forget_performance_json(folder.path) == PETSC_SUCCESS);
  CHECK(!fs::exists(folder / "performance.json"));
  REQUIRE(forget_performance_json(folder.path) == PETSC_SUCCESS);
  std::ofstream(folder / "performance.json") << "{\n  \"program\": \"another\"\n}\n";
  CHECK(foreign_file(folder.path) == folder / "performance.json");
  REQUIRE(forget_performance_json(folder.path) == PETSC_SUCCESS);
  CHECK(fs::exists(folder / "performance.json"));
}

TEST_CASE("a figure is measured once a key, and every time where it cannot be kept", "[output]") {
  const Folder folder;
  const char* const before = std::getenv("XDG_CACHE_HOME");
  const std::string kept = before != nullptr ? before : "";
  int measured = 0;
  const auto figure = [&](const std::string& key, double value) {
    return cached_measurement("figures", key, [&] { return ++measured, value; });
  };
  setenv("XDG_CACHE_HOME", folder.path.c_str(), 1);
  CHECK(figure("serial, some processor", 1.0 / 3) == 1.0 / 3);
  CHECK(figure("cuda, some GPU", 4e12) == 4e12);
  CHECK(figure("serial, some processor", 5) == 1.0 / 3);
  CHECK(figure("cuda, some GPU", 5) == 4e12);
  CHECK(measured == 2);
  CHECK(figure("no memory", 0) == 0);
  CHECK(figure("no memory", 0) == 0);
  CHECK(measured == 4);
  std::ofstream(folder / "a file");
  setenv("XDG_CACHE_HOME", (folder / "a file").c_str(), 1);
  CHECK(figure("serial, some processor", 7) == 7);
  CHECK(figure("serial, some processor", 8) == 8);
  before != nullptr ? setenv("XDG_CACHE_HOME", kept.c_str(), 1) : unsetenv("XDG_CACHE_HOME");
}

TEST_CASE("the log's file holds what was said before it was opened and each tenth of the run", "[output]") {
  const Folder folder;
  Log log;
  REQUIRE(log.start(PETSC_COMM_SELF, Progress::automatic) == PETSC_SUCCESS);
  REQUIRE(log.line("before") == PETSC_SUCCESS);
  REQUIRE(log.open(folder.path) == PETSC_SUCCESS);
  REQUIRE(log.print("%s %d", "after", 1) == PETSC_SUCCESS);
  for (int k = 0; k <= 100; ++k)
    REQUIRE(log.progress({k, 0.02 * k, 0, 2, 0.01 * k, 1e4 * k}) == PETSC_SUCCESS);
  REQUIRE(log.close() == PETSC_SUCCESS);
  const auto lines = split(contents(folder / "mpm.log"), '\n');
  REQUIRE(lines.size() == 12);
  CHECK(lines[0] == "before");
  CHECK(lines[1] == "after 1");
  CHECK_THAT(lines[2], ContainsSubstring("10.0 %"));
}

TEST_CASE("the options in force show which were given and which are defaults", "[output]") {
  const Folder folder;
  const std::vector<EffectiveOption> options = {{"-mesh_spacing", "0.05", "m", false},
                                                {"-p2g", "auto", "", true}};
  CHECK(format_options(options) ==
        "  -mesh_spacing  0.05 m      given\n"
        "  -p2g           auto        default\n");
  REQUIRE(write_options_json(folder.path, "1.0 \"x\"", options) == PETSC_SUCCESS);
  CHECK(contents(folder / "options.json") ==
        "{\n  \"version\": \"1.0 \\\"x\\\"\",\n  \"options\": {\n"
        "    \"mesh_spacing\": \"0.05\",\n    \"p2g\": \"auto\"\n  }\n}\n");
}
