#pragma once
// Surroundings of a fuzzed function: MPI and PETSc are up, and nothing is printed.

#include <mpi.h>
#include <petscsys.h>
#include <sanitizer/lsan_interface.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <string>

namespace mpm::fuzz {

inline void begin() {
  const __lsan::ScopedDisabler of_libraries;  // what they keep until the end is no leak of an input
  MPI_Init(nullptr, nullptr);
  if (PetscInitializeNoArguments() != PETSC_SUCCESS) _exit(1);
  (void)PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
}

/// A file in memory, of this process.
inline std::string path_of(const char* name) {
  return "/dev/shm/mpm_fuzz_" + std::to_string(::getpid()) + "_" + name;
}

inline void write_file(const std::string& path, const uint8_t* data, size_t size) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr || std::fwrite(data, 1, size, file) != size) _exit(1);
  std::fclose(file);
}

}  // namespace mpm::fuzz
