#include "common/hdf5_handle.hpp"

namespace mpm {

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
