#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <list>

#include "checkpoint/archive.hpp"
#include "checkpoint/id_blocks.hpp"
#include "checkpoint/sealed_file.hpp"
#include "common/collectives.hpp"
#include "common/hdf5_handle.hpp"
#include "output/files.hpp"
#include "output/shared_file.hpp"

namespace mpm {
namespace {

/// The rows of this rank that are not in its layout of the file, and what had to be changed for them.
struct SharedRows {
  std::vector<Stretch> stretches;
  std::list<std::vector<char>> changed;
};

/// Writes items into an open file. The first item that fails is kept.
class Writer {
 public:
  /// `shared`: of several ranks, which all make the same layout; null where all rows are here.
  explicit Writer(hid_t file, SharedRows* shared = nullptr) : file_(file), shared_(shared) {}

  void value(const char* name, int x) { attribute(name, H5T_STD_I32LE, H5T_NATIVE_INT, &x); }
  void value(const char* name, long x) { attribute(name, H5T_STD_I64LE, H5T_NATIVE_LONG, &x); }
  void value(const char* name, std::uint32_t x) { attribute(name, H5T_STD_U32LE, H5T_NATIVE_UINT32, &x); }
  void value(const char* name, double x) { attribute(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &x); }
  void value(const char* name, const std::string& x) {
    Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    check(H5Tset_size(type.id, std::max<size_t>(x.size(), 1)), name);
    attribute(name, type.id, type.id, x.empty() ? "" : x.data());
  }
  void list(const char* path, const std::vector<double>& x) {
    whole(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, x.size(), x.data());
  }
  void list(const char* path, const std::vector<long>& x) {
    whole(path, H5T_STD_I64LE, H5T_NATIVE_LONG, x.size(), x.data());
  }
  void list_of_some(const char* path, const std::vector<double>& x) {
    if (!x.empty()) list(path, x);
  }
  void text(const char* path, const std::string& x) {
    whole(path, H5T_STD_U8LE, H5T_NATIVE_UCHAR, x.size(), x.data());
  }
  void points(const std::string& path, const SavedPoints& points, const IdBlock& block) {
    Handle group(H5Gcreate2(file_, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    check(group.id, path);
    rows(path + "/address", H5T_STD_I64LE, H5T_NATIVE_LONG, 1, block, points.address.data());
    for (const SavedField& field : points.fields) {
      const hid_t type = field.bytes == 8   ? H5T_IEEE_F64LE
                         : field.bytes == 4 ? H5T_IEEE_F32LE
                                            : H5T_STD_U16LE;
      rows(path + "/" + field.name, type, H5T_NATIVE_DOUBLE, field.components, block, field.values.data());
    }
  }
  const Hdf5Fault& fault() const { return fault_; }

 private:
  void check(hid_t result, const std::string& what) {
    if (result < 0 && fault_.what.empty()) fault_ = hdf5_fault(what);
  }
  void attribute(const char* name, hid_t type, hid_t memory, const void* x) {
    Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    Handle item(H5Acreate2(file_, name, type, space.id, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    check(item.id, name);
    if (item.id >= 0) check(H5Awrite(item.id, memory, x), name);
  }
  void whole(const char* path, hid_t type, hid_t memory, hsize_t count, const void* x) {
    Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
    Handle data(H5Dcreate2(file_, path, type, space.id, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    check(data.id, path);
    if (data.id >= 0 && count > 0) check(H5Dwrite(data.id, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, x), path);
  }
  void rows(const std::string& path, hid_t type, hid_t memory, int width, const IdBlock& block,
            const void* x) {
    const hsize_t sizes[2] = {static_cast<hsize_t>(block.total), static_cast<hsize_t>(width)};
    Handle space(H5Screate_simple(2, sizes, nullptr), H5Sclose);
    Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    if (shared_ != nullptr)  // its place in the file is fixed now
      check(std::min(H5Pset_alloc_time(layout.id, H5D_ALLOC_TIME_EARLY),
                     H5Pset_fill_time(layout.id, H5D_FILL_TIME_NEVER)),
            path);
    Handle data(H5Dcreate2(file_, path.c_str(), type, space.id, H5P_DEFAULT, layout.id, H5P_DEFAULT),
                H5Dclose);
    check(data.id, path);
    if (data.id < 0 || block.total == 0) return;
    if (shared_ == nullptr)
      check(H5Dwrite(data.id, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, x), path);
    else
      keep_rows(H5Dget_offset(data.id), path, type, memory, width, block, x);
  }
  /// The rows of this rank as they will be in the file.
  void keep_rows(haddr_t offset, const std::string& path, hid_t type, hid_t memory, int width,
                 const IdBlock& block, const void* x) {
    Stretch stretch{.offset = static_cast<long long>(offset), .rows = block.count, .data = x};
    stretch.width = static_cast<int>(H5Tget_size(type)) * width;
    stretch.size = stretch.width * static_cast<long long>(block.total);
    stretch.place = stretch.offset + stretch.width * static_cast<long long>(block.first);
    if (H5Tequal(memory, type) <= 0 && block.count > 0) {
      const size_t count = static_cast<size_t>(block.count) * width;
      const char* const first = static_cast<const char*>(x);
      auto& changed = shared_->changed.emplace_back(first, first + count * H5Tget_size(memory));
      check(H5Tconvert(memory, type, count, changed.data(), nullptr, H5P_DEFAULT), path);
      stretch.data = changed.data();
    }
    shared_->stretches.push_back(stretch);
  }

  hid_t file_;
  SharedRows* shared_;
  Hdf5Fault fault_;
};

/// All items, to a file that is open.
Hdf5Fault write_items(hid_t file, Checkpoint& checkpoint, IdBlock& soil, SharedRows* shared = nullptr) {
  Writer writer(file, shared);
  std::string options = text_of_options(checkpoint.options);
  go_through(writer, checkpoint, options, soil);
  return writer.fault();
}

/// On one rank HDF5 makes the file in memory, for it does not survive a disk that fills while it writes: its
/// close fails, and its clean-up at the end of the program then crashes.
PetscErrorCode write_alone(const std::string& path, Checkpoint& checkpoint, IdBlock& soil) {
  constexpr size_t k_growth = 16 << 20;  // bytes
  PetscFunctionBeginUser;
  std::string image;
  {
    Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_core(access.id, k_growth, /*backing_store*/ false);
    Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id), H5Fclose);
    if (file.id < 0) PetscCall(check_hdf5(hdf5_fault("creation"), path));
    PetscCall(check_hdf5(write_items(file.id, checkpoint, soil), path));
    checkpoint.state = {};
    const ssize_t size =
        H5Fflush(file.id, H5F_SCOPE_GLOBAL) >= 0 ? H5Fget_file_image(file.id, nullptr, 0) : -1;
    if (size > 0) image.resize(static_cast<size_t>(size));
    if (size <= 0 || H5Fget_file_image(file.id, image.data(), image.size()) != size)
      PetscCall(check_hdf5(hdf5_fault("the image"), path));
  }
  PetscCall(replace_sealed(path, image));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Every rank makes the same layout, which gives the place of its rows; the layout of rank 0 becomes the
/// file.
PetscErrorCode lay_out(const std::string& path, Checkpoint& checkpoint, IdBlock& soil, int* layout,
                       SharedRows* shared) {
  PetscFunctionBeginUser;
  std::string name;
  PetscCall(open_layout(&name, layout));
  Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  ::unlink(name.c_str());
  if (file.id < 0) PetscCall(check_hdf5(hdf5_fault("creation"), path));
  PetscCall(check_hdf5(write_items(file.id, checkpoint, soil, shared), path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The file under its temporary name becomes the checkpoint, once it reads as it was written.
PetscErrorCode finish_file(MPI_Comm comm, const std::string& temporary, const std::string& path) {
  PetscFunctionBeginUser;
  std::string fault;
  PetscCall(seal_file(comm, temporary));
  PetscCall(check_seal(comm, temporary, &fault));
  PetscCall(share_text(comm, &fault));
  PetscCheck(fault.empty(), comm, PETSC_ERR_FILE_READ, "%s does not read as it was written: %s", path.c_str(),
             fault.c_str());
  PetscCall(agree(comm, rank_of(comm) == 0 ? rename_file(temporary, path) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode write_together(MPI_Comm comm, const std::string& path, Checkpoint& checkpoint, IdBlock& soil) {
  PetscFunctionBeginUser;
  const std::string temporary = path + ".tmp";
  SharedRows shared;
  int layout = -1;
  PetscErrorCode failed = agree(comm, lay_out(path, checkpoint, soil, &layout, &shared));
  if (!failed) failed = write_shared_file(comm, temporary, layout, shared.stretches);
  if (layout >= 0) ::close(layout);
  if (!failed) failed = finish_file(comm, temporary, path);
  if (failed && rank_of(comm) == 0) ::unlink(temporary.c_str());
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode write_checkpoint(MPI_Comm comm, const std::string& path, Checkpoint&& checkpoint) {
  PetscFunctionBeginUser;
  SavedState& state = checkpoint.state;
  IdBlock soil;
  PetscCall(bring_to_blocks(comm, state.particles, ids_without_particle(state), state.soil, &soil));
  PetscCall(gather_impulse(comm, state.impulse));
  if (size_of(comm) == 1)
    PetscCall(write_alone(path, checkpoint, soil));
  else
    PetscCall(write_together(comm, path, checkpoint, soil));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
