#pragma once
// One run at a time in an output folder. While it lasts, a run holds a lock of the system on the file
// mpm.lock in the folder, which the system lets go with the process, however that ends; the text in the file
// names the run that holds it. Everything here is called on one rank.

#include <petscsys.h>

#include <string>

namespace mpm {

/// The lock of a folder, given back with its scope.
class FolderLock {
 public:
  FolderLock() = default;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() { release(); }

  /// Takes the lock of a folder that is there; nothing where it is held already. `other`: the run that has
  /// it, in words; empty if it is ours now. A lock that was left by a run that is gone is taken over. Where
  /// the file system has no locks the text decides: its process is looked for if it was of this machine, and
  /// taken to live if it was not. Fails where the file cannot be made.
  PetscErrorCode take(const std::string& folder, std::string* other);
  /// Removes the file and lets the lock go.
  void release();
  bool held() const { return descriptor_ >= 0; }
  /// The run whose lock was taken over, in words; empty if it was given back.
  const std::string& left_by() const { return left_by_; }

 private:
  std::string path_, left_by_;
  int descriptor_ = -1;
};

}  // namespace mpm
