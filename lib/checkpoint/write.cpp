#include <algorithm>

#include "checkpoint/archive.hpp"
#include "checkpoint/id_blocks.hpp"
#include "checkpoint/sealed_file.hpp"
#include "output/files.hpp"
#include "output/hdf5_handle.hpp"

namespace mpm {
namespace {

/// Writes items into an open file; every rank calls all. The first item that fails is kept.
class Writer {
 public:
  /// `transfer`: how rows of a block are written; of lists only `speaks` writes.
  Writer(hid_t file, hid_t transfer, bool speaks) : file_(file), transfer_(transfer), speaks_(speaks) {}

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
  const std::string& fault() const { return fault_; }

 private:
  void check(hid_t result, const std::string& what) {
    if (result < 0 && fault_.empty()) fault_ = what;
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
    if (data.id >= 0 && count > 0 && speaks_)
      check(H5Dwrite(data.id, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, x), path);
  }
  /// A dataset of all rows, of which this rank writes its block.
  void rows(const std::string& path, hid_t type, hid_t memory, int width, const IdBlock& block,
            const void* x) {
    const hsize_t components = static_cast<hsize_t>(width);
    const hsize_t all[2] = {static_cast<hsize_t>(block.total), components};
    const hsize_t own[2] = {static_cast<hsize_t>(block.count), components};
    const hsize_t first[2] = {static_cast<hsize_t>(block.first), 0};
    Handle there(H5Screate_simple(2, all, nullptr), H5Sclose),
        here(H5Screate_simple(2, own, nullptr), H5Sclose);
    Handle data(H5Dcreate2(file_, path.c_str(), type, there.id, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                H5Dclose);
    check(data.id, path);
    if (data.id < 0 || block.total == 0) return;
    check(block.count > 0 ? H5Sselect_hyperslab(there.id, H5S_SELECT_SET, first, nullptr, own, nullptr)
                          : H5Sselect_none(there.id),
          path);
    if (block.count == 0) check(H5Sselect_none(here.id), path);
    check(H5Dwrite(data.id, memory, here.id, there.id, transfer_, x), path);
  }

  hid_t file_, transfer_;
  bool speaks_;
  std::string fault_;
};

/// All items, to a file that is open.
std::string write_items(hid_t file, hid_t transfer, bool speaks, Checkpoint& checkpoint, IdBlock& soil) {
  Writer writer(file, transfer, speaks);
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
    PetscCheck(file.id >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "HDF5 failed at creation of %s", path.c_str());
    const std::string fault = write_items(file.id, H5P_DEFAULT, true, checkpoint, soil);
    PetscCheck(fault.empty(), PETSC_COMM_SELF, PETSC_ERR_LIB, "HDF5 failed at %s of %s", fault.c_str(),
               path.c_str());
    checkpoint.state = {};
    const bool flushed = H5Fflush(file.id, H5F_SCOPE_GLOBAL) >= 0;
    const ssize_t size = flushed ? H5Fget_file_image(file.id, nullptr, 0) : -1;
    if (size > 0) image.resize(static_cast<size_t>(size));
    PetscCheck(size > 0 && H5Fget_file_image(file.id, image.data(), image.size()) == size, PETSC_COMM_SELF,
               PETSC_ERR_LIB, "HDF5 failed at the image of %s", path.c_str());
  }
  PetscCall(replace_sealed(path, image));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Whether all ranks have no fault; the fault of this rank is kept.
PetscErrorCode all_well(MPI_Comm comm, const std::string& fault, bool* well) {
  PetscFunctionBeginUser;
  int good = fault.empty() ? 1 : 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &good, 1, MPI_INT, MPI_MIN, comm));
  *well = good != 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Several ranks write one file through MPI-IO, each its rows of every set.
std::string write_rows(MPI_Comm comm, int rank, const std::string& path, Checkpoint& checkpoint,
                       IdBlock& soil) {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose), transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
  if (H5Pset_fapl_mpio(access.id, comm, MPI_INFO_NULL) < 0 ||
      H5Pset_dxpl_mpio(transfer.id, H5FD_MPIO_COLLECTIVE) < 0)
    return "MPI-IO";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id);
  if (file < 0) return "creation";
  std::string fault = write_items(file, transfer.id, rank == 0, checkpoint, soil);
  if (H5Fclose(file) < 0 && fault.empty()) fault = "closing";
  return fault;
}

PetscErrorCode write_together(MPI_Comm comm, int rank, const std::string& path, Checkpoint& checkpoint,
                              IdBlock& soil) {
  PetscFunctionBeginUser;
  const std::string temporary = path + ".tmp";
  std::string fault = write_rows(comm, rank, temporary, checkpoint, soil);
  bool well = true;
  PetscCall(all_well(comm, fault, &well));
  PetscCheck(well, comm, PETSC_ERR_LIB, "HDF5 failed at %s of %s", fault.c_str(), path.c_str());
  PetscCall(seal_file(comm, temporary));
  PetscCallMPI(MPI_Barrier(comm));
  PetscCall(check_seal(comm, temporary, &fault));
  PetscCheck(fault.empty(), comm, PETSC_ERR_FILE_READ, "%s does not read as it was written", path.c_str());
  if (rank == 0) PetscCall(rename_file(temporary, path));
  PetscCallMPI(MPI_Barrier(comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode write_checkpoint(MPI_Comm comm, const std::string& path, Checkpoint&& checkpoint) {
  PetscFunctionBeginUser;
  PetscMPIInt rank = 0, ranks = 1;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  SavedState& state = checkpoint.state;
  IdBlock soil;
  PetscCall(bring_to_blocks(comm, state.soil, &soil));
  PetscCall(gather_impulse(comm, static_cast<int>(state.rigids.size()), state.impulse));
  if (ranks == 1)
    PetscCall(write_alone(path, checkpoint, soil));
  else
    PetscCall(write_together(comm, rank, path, checkpoint, soil));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
