// A file that is given to -restart. The first byte of the input says which: the bytes behind it are the file
// itself; or bytes of a sound checkpoint, its seal too, are changed where they say, which must be found out;
// or its items are changed as they say (they go, or get another type, size or value) and the seal is left
// out. Reading must refuse it or give a state that passes every check; never crash.

#include <hdf5.h>

#include "checkpoint/checkpoint.hpp"
#include "checkpoint/sealed_file.hpp"
#include "common/checksum.hpp"
#include "session.hpp"

namespace {

using namespace mpm;

constexpr const char* k_attributes[] = {
    "version",  "dim",      "ranks",    "backend",       "precision",     "strategy",    "step",
    "time",     "wall",     "dt",       "frames",        "bound",         "increment",   "longest",
    "shortest", "rebuilds", "stepping", "since_rebuild", "history_bytes", "history_crc", "last_row_time"};
constexpr const char* k_datasets[] = {
    "options", "soil/address", "soil/coordinate", "soil/body",       "soil/stress", "rigids",
    "bounds",  "owners",       "impulse",         "impulse_address", "soil",        "soil/new"};

Config some_config() {
  Config config;
  config.mesh.cells = {20, 10, 1};
  config.bodies.resize(2);
  config.rigids.resize(1);
  return config;
}

Checkpoint some_checkpoint() {
  Checkpoint c;
  c.version = "0", c.backend = "serial", c.precision = "double", c.strategy = "gather";
  c.options = {{"-gravity", "0,-10", "m/s2", false}};
  c.run.step = 3;
  c.state.soil = {{0, 1, 2},
                  {387, 388, 389},
                  {{"coordinate", 2, 8, {0, 0, .5, .5, 1, 1}},
                   {"body", 1, 2, {0, 1, 0}},
                   {"stress", 4, 8, std::vector<double>(12, 1)}}};
  c.state.particles = 3, c.state.lost.assign(2 * k_lost, 0), c.state.alone = {387};
  c.state.rigids.resize(1);
  c.state.bounds = {1, 2, 3}, c.state.owners = {0, 1, 0};
  c.state.impulse = {{387}, {1}};
  return c;
}

/// Bytes to choose by; zeros when they are used up.
struct Bytes {
  const uint8_t* data;
  size_t size;
  uint8_t next() { return size == 0 ? 0 : (--size, *data++); }
  template <class T>
  T value() {
    T x{};
    for (size_t k = 0; k < sizeof x; ++k) reinterpret_cast<uint8_t*>(&x)[k] = next();
    return x;
  }
};

hid_t type_of(uint8_t which) {
  const hid_t types[] = {H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT, H5T_NATIVE_LONG, H5T_NATIVE_USHORT,
                         H5T_NATIVE_UCHAR,  H5T_C_S1,         H5T_NATIVE_INT};
  return types[which % 7];
}

/// One change of an open file.
void change(hid_t file, Bytes& bytes) {
  const uint8_t what = bytes.next();
  const hsize_t sizes[3] = {bytes.next() % 5u, bytes.next() % 12u, 2};
  const hid_t space = H5Screate_simple(what % 4, sizes, nullptr), type = type_of(bytes.next());
  double values[128];
  for (double& x : values) x = bytes.size > 0 ? bytes.value<double>() : 1;
  if (what & 0x40) {
    const char* name = k_attributes[bytes.next() % std::size(k_attributes)];
    H5Adelete(file, name);
    const hid_t item = what & 0x20 ? -1 : H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (item >= 0) H5Awrite(item, type, values), H5Aclose(item);
  } else if (what & 0x80) {
    const hid_t data = H5Dopen2(file, k_datasets[bytes.next() % (std::size(k_datasets) - 2)], H5P_DEFAULT);
    if (data >= 0) H5Dwrite(data, H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), H5Dclose(data);
  } else {
    const char* name = k_datasets[bytes.next() % std::size(k_datasets)];
    H5Ldelete(file, name, H5P_DEFAULT);
    const hid_t data =
        what & 0x20 ? -1 : H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (data >= 0) H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), H5Dclose(data);
  }
  H5Sclose(space);
}

std::string read_file(const std::string& path) {
  std::string text(1 << 20, '\0');
  std::FILE* file = std::fopen(path.c_str(), "rb");
  text.resize(std::fread(text.data(), 1, text.size(), file));
  std::fclose(file);
  return text;
}

void look_at(Checkpoint& c) {
  const Config config = some_config();
  (void)state_fault(c.state, config);
  (void)compare_options(c, some_checkpoint().options, {}, "FILE");
}

/// Reads the file as -restart does; what is wrong with it.
std::string read_whole(const std::string& path) {
  Checkpoint c;
  std::string fault;
  if (read_checkpoint(PETSC_COMM_SELF, path, c, &fault) != PETSC_SUCCESS) __builtin_trap();
  if (fault.empty()) look_at(c);
  return fault;
}

void change_items(const std::string& path, Bytes bytes) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (int n = 0; n < 8 && bytes.size > 0; ++n) change(file, bytes);
  H5Fclose(file);
  Checkpoint c;
  if (read_items(path, bytes.next() % 3, 3, c).empty()) look_at(c);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  fuzz::begin();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  if (write_checkpoint(PETSC_COMM_SELF, fuzz::path_of("sound.h5"), some_checkpoint()) != PETSC_SUCCESS)
    _exit(1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::string sound = read_file(fuzz::path_of("sound.h5"));
  const std::string path = fuzz::path_of("file.h5");
  Bytes bytes{data, size};
  const int how = bytes.next() % 3;
  if (how == 0) {
    fuzz::write_file(path, bytes.data, bytes.size);
    (void)read_whole(path);
    return 0;
  }
  std::string text = sound;
  if (how == 1)
    while (bytes.size > 0) text[bytes.value<uint32_t>() % text.size()] = static_cast<char>(bytes.next());
  fuzz::write_file(path, reinterpret_cast<const uint8_t*>(text.data()), text.size());
  if (how == 2)
    change_items(path, bytes);
  else if (read_whole(path).empty() != (text == sound))
    __builtin_trap();
  return 0;
}
