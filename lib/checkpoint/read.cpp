#include <algorithm>
#include <numeric>

#include "checkpoint/archive.hpp"
#include "checkpoint/id_blocks.hpp"
#include "checkpoint/sealed_file.hpp"
#include "common/hdf5_handle.hpp"
#include "common/text.hpp"
#include "input/deck/renamed.hpp"

namespace mpm {
namespace {

/// Reads items from an open file. The first item that is missing or not as it should be is kept.
class Reader {
 public:
  Reader(hid_t file, int rank, int ranks) : file_(file), rank_(rank), ranks_(ranks) {
    H5Fget_filesize(file, &bytes_);
  }

  void value(const char* name, int& x) { attribute(name, H5T_INTEGER, H5T_NATIVE_INT, &x); }
  void value(const char* name, long& x) { attribute(name, H5T_INTEGER, H5T_NATIVE_LONG, &x); }
  void value(const char* name, std::uint32_t& x) { attribute(name, H5T_INTEGER, H5T_NATIVE_UINT32, &x); }
  void value(const char* name, double& x) { attribute(name, H5T_FLOAT, H5T_NATIVE_DOUBLE, &x); }
  void value(const char* name, std::string& x) {
    Handle item(H5Aopen(file_, name, H5P_DEFAULT), H5Aclose);
    if (!check(item.id, name)) return;
    Handle type(H5Aget_type(item.id), H5Tclose);
    constexpr size_t k_longest = 1000;
    const size_t length = H5Tget_size(type.id);
    const bool sound = H5Tget_class(type.id) == H5T_STRING && H5Tis_variable_str(type.id) == 0 &&
                       length <= k_longest && points_of(H5Aget_space(item.id)) == 1;
    if (!check(sound ? 0 : -1, name)) return;
    x.assign(length, '\0');
    check(H5Aread(item.id, type.id, x.data()), name);
    x.resize(std::min(x.find('\0'), x.size()));
  }
  void list(const char* path, std::vector<double>& x) { whole(path, H5T_FLOAT, H5T_NATIVE_DOUBLE, x); }
  void list(const char* path, std::vector<long>& x) { whole(path, H5T_INTEGER, H5T_NATIVE_LONG, x); }
  void list_of_some(const char* path, std::vector<double>& x) {
    x.clear();
    if (H5Lexists(file_, path, H5P_DEFAULT) > 0) list(path, x);
  }
  void text(const char* path, std::string& x) { whole(path, H5T_INTEGER, H5T_NATIVE_UCHAR, x); }

  /// The block of this rank; all datasets of the group have one row a point.
  void points(const std::string& path, SavedPoints& points, IdBlock& block) {
    Handle group(H5Gopen2(file_, path.c_str(), H5P_DEFAULT), H5Gclose);
    if (!check(group.id, path)) return;
    std::vector<double> unused;
    int width = 0, bytes = 0;
    block.total = -1;
    rows(path + "/address", H5T_INTEGER, H5T_NATIVE_LONG, block, points.address, width, bytes);
    check(width == 1 ? 0 : -1, path + "/address");
    for (const std::string& name : names_in(group.id)) {
      SavedField field{name, 0, 0, {}};
      if (name == "address") continue;
      rows(path + "/" + name, H5T_NO_CLASS, H5T_NATIVE_DOUBLE, block, field.values, field.components,
           field.bytes);
      points.fields.push_back(std::move(field));
    }
    points.id.resize(points.address.size());
    std::iota(points.id.begin(), points.id.end(), block.first);
    leave_out_lost(points);
  }
  const std::string& fault() const { return fault_; }

 private:
  bool check(hid_t result, const std::string& what) {
    if (result < 0 && fault_.empty()) fault_ = what;
    return fault_.empty();
  }
  /// Takes a dataspace; the number of its points.
  static hssize_t points_of(hid_t space) {
    const Handle handle(space, H5Sclose);
    return H5Sget_simple_extent_npoints(space);
  }
  void attribute(const char* name, H5T_class_t kind, hid_t memory, void* x) {
    Handle item(H5Aopen(file_, name, H5P_DEFAULT), H5Aclose);
    if (!check(item.id, name)) return;
    Handle type(H5Aget_type(item.id), H5Tclose);
    const bool sound = H5Tget_class(type.id) == kind && points_of(H5Aget_space(item.id)) == 1;
    if (check(sound ? 0 : -1, name)) check(H5Aread(item.id, memory, x), name);
  }
  /// The rank of the dataset and its sizes; false where they cannot be those of data in this file.
  bool sizes_of(hid_t data, H5T_class_t kind, int ranks, hsize_t* sizes, size_t* bytes) const {
    Handle space(H5Dget_space(data), H5Sclose);
    Handle type(H5Dget_type(data), H5Tclose);
    const H5T_class_t found = H5Tget_class(type.id);
    *bytes = std::max<size_t>(H5Tget_size(type.id), 1);
    if (kind == H5T_NO_CLASS ? found != H5T_FLOAT && found != H5T_INTEGER : found != kind) return false;
    if (H5Sget_simple_extent_ndims(space.id) != ranks ||
        H5Sget_simple_extent_dims(space.id, sizes, nullptr) < 0)
      return false;
    hsize_t all = 1;
    for (int k = 0; k < ranks; ++k) {
      if (sizes[k] > bytes_ / *bytes / std::max<hsize_t>(all, 1)) return false;
      all *= sizes[k];
    }
    return true;
  }
  template <class Container>
  void whole(const char* path, H5T_class_t kind, hid_t memory, Container& x) {
    Handle data(H5Dopen2(file_, path, H5P_DEFAULT), H5Dclose);
    hsize_t size = 0;
    size_t bytes = 0;
    if (!check(data.id, path) || !check(sizes_of(data.id, kind, 1, &size, &bytes) ? 0 : -1, path)) return;
    x.resize(size);
    if (size > 0) check(H5Dread(data.id, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, x.data()), path);
  }
  template <class Number>
  void rows(const std::string& path, H5T_class_t kind, hid_t memory, IdBlock& block, std::vector<Number>& x,
            int& width, int& width_in_bytes) {
    constexpr hsize_t k_most_components = 9;
    Handle data(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    hsize_t all[2] = {0, 0};
    size_t bytes = 0;
    if (!check(data.id, path) || !check(sizes_of(data.id, kind, 2, all, &bytes) ? 0 : -1, path)) return;
    if (block.total < 0) block = block_of(static_cast<long>(all[0]), rank_, ranks_);
    const bool sound =
        all[0] == static_cast<hsize_t>(block.total) && all[1] >= 1 && all[1] <= k_most_components;
    if (!check(sound ? 0 : -1, path)) return;
    width = static_cast<int>(all[1]), width_in_bytes = static_cast<int>(bytes);
    x.resize(static_cast<size_t>(block.count) * width);
    if (block.count == 0) return;
    const hsize_t own[2] = {static_cast<hsize_t>(block.count), all[1]};
    const hsize_t first[2] = {static_cast<hsize_t>(block.first), 0};
    Handle there(H5Dget_space(data.id), H5Sclose), here(H5Screate_simple(2, own, nullptr), H5Sclose);
    check(H5Sselect_hyperslab(there.id, H5S_SELECT_SET, first, nullptr, own, nullptr), path);
    check(H5Dread(data.id, memory, here.id, there.id, H5P_DEFAULT, x.data()), path);
  }
  static std::vector<std::string> names_in(hid_t group) {
    std::vector<std::string> names;
    H5G_info_t info{};
    constexpr hsize_t k_most = 100;
    if (H5Gget_info(group, &info) < 0) return names;
    for (hsize_t n = 0; n < std::min(info.nlinks, k_most); ++n) {
      char name[200] = "";
      if (H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, n, name, sizeof name, H5P_DEFAULT) > 0)
        names.emplace_back(name);
    }
    return names;
  }

  hid_t file_;
  int rank_, ranks_;
  hsize_t bytes_ = 0;
  std::string fault_;
};

}  // namespace

std::string text_of_options(const std::vector<EffectiveOption>& options) {
  std::string text;
  for (const EffectiveOption& option : options)
    text += option.name + "\t" + option.value + "\t" + option.unit + "\t" +
            (option.standard ? "default" : "given") + "\n";
  return text;
}

bool options_of_text(const std::string& text, std::vector<EffectiveOption>& options) {
  for (const std::string& line : split(text, '\n')) {
    if (line.empty()) continue;
    const auto words = split(line, '\t');
    if (words.size() != 4) return false;
    options.push_back({present_name(words[0]), words[1], words[2], words[3] == "default"});
  }
  return true;
}

std::string read_items(const std::string& path, int rank, int ranks, Checkpoint& checkpoint) {
  const Quiet quiet;
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file.id < 0) return "a checkpoint; this is no HDF5 file";
  Reader reader(file.id, rank, ranks);
  std::string options;
  IdBlock soil;
  go_through(reader, checkpoint, options, soil);
  if (!reader.fault().empty()) return "a checkpoint with a sound " + reader.fault();
  const bool sound = options_of_text(options, checkpoint.options) && !checkpoint.options.empty();
  return sound ? "" : "a checkpoint with sound options";
}

PetscErrorCode read_checkpoint(MPI_Comm comm, const std::string& path, Checkpoint& checkpoint,
                               std::string* fault) {
  PetscFunctionBeginUser;
  PetscMPIInt rank = 0, ranks = 1;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  checkpoint = {};
  PetscCall(check_seal(comm, path, fault));
  if (fault->empty()) PetscCallCXX(*fault = read_items(path, rank, ranks, checkpoint));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
