#pragma once
// HDF5 identifiers that release themselves.

#include <hdf5.h>

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

}  // namespace mpm
