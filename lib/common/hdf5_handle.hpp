#pragma once
// HDF5 identifiers that release themselves, its faults, and silence.

#include <hdf5.h>
#include <petscsys.h>

#include <string>

namespace mpm {

/// An HDF5 identifier that is released with its scope.
struct Handle {
  hid_t id;
  herr_t (*release)(hid_t);
  Handle(hid_t id_, herr_t (*release_)(hid_t)) : id(id_), release(release_) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id >= 0) release(id);
  }
};

/// HDF5 prints nothing from now on, in this thread where it is built for several.
inline void silence_hdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// Has HDF5 hold from now on what its cache of metadata takes for two files (0.5 MB each), as many as are
/// open at once: HDF5 (1.10) crashes where it cannot have that memory for a new file.
void keep_hdf5_memory();

/// Cause of the failure of HDF5's last call.
struct Hdf5Fault {
  std::string what;     // empty: nothing failed
  std::string cause;    // in HDF5's words
  bool memory = false;  // it asked for memory that it did not get
};

/// The fault of the call that failed just now in this thread, before any other call of HDF5; `what` names the
/// part of the file.
Hdf5Fault hdf5_fault(const std::string& what);

/// A fault is an error that names the file; one of memory is PETSC_ERR_MEM.
PetscErrorCode check_hdf5(const Hdf5Fault& fault, const std::string& path);
/// Checks the result of a call of HDF5: a negative one is an error that names the file and its part.
PetscErrorCode check_hdf5(hid_t result, const std::string& path, const char* what);

/// HDF5 prints nothing in this scope; the caller reports failures from the results.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

}  // namespace mpm
