#include "common/hdf5_handle.hpp"

namespace mpm {
namespace {

/// Takes the innermost record, which HDF5 gives first.
herr_t take_innermost(unsigned, const H5E_error2_t* record, void* to) {
  Hdf5Fault& fault = *static_cast<Hdf5Fault*>(to);
  fault.cause = record->desc != nullptr ? record->desc : "";
  fault.memory =
      record->maj_num == H5E_RESOURCE || record->min_num == H5E_NOSPACE || record->min_num == H5E_CANTALLOC;
  return 1;
}

}  // namespace

Hdf5Fault hdf5_fault(const std::string& what) {
  Hdf5Fault fault{.what = what, .cause = "HDF5 gives no cause"};
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_innermost, &fault);
  return fault;
}

PetscErrorCode check_hdf5(const Hdf5Fault& fault, const std::string& path) {
  PetscFunctionBeginUser;
  PetscCheck(fault.what.empty(), PETSC_COMM_SELF, fault.memory ? PETSC_ERR_MEM : PETSC_ERR_LIB,
             "HDF5 failed at %s of %s: %s", fault.what.c_str(), path.c_str(), fault.cause.c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode check_hdf5(hid_t result, const std::string& path, const char* what) {
  PetscFunctionBeginUser;
  if (result < 0) PetscCall(check_hdf5(hdf5_fault(what), path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void keep_hdf5_memory() {
  // Free lists of HDF5: bytes of all lists of a kind, and of one list; the last four are its defaults.
  constexpr int k_cache = 640 << 10, k_files = 2, k_kilo = 1024;
  H5set_free_list_limits((k_files + 1) * k_cache, k_files * k_cache, 4096 * k_kilo, 256 * k_kilo,
                         16384 * k_kilo, 1024 * k_kilo);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.id, k_kilo, /*backing_store*/ false);
  const auto create = [&](const char* name) {
    return H5Fcreate(name, H5F_ACC_TRUNC, H5P_DEFAULT, access.id);
  };
  const Handle one(create("mpm one"), H5Fclose), other(create("mpm other"), H5Fclose);
}

}  // namespace mpm
