// An options file of any bytes: read and checked, or refused with lines that say why; never a crash or a
// hang.

#include "input/options/options.hpp"
#include "session.hpp"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  mpm::fuzz::begin();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace mpm;
  const std::string path = fuzz::path_of("options");
  fuzz::write_file(path, data, size);
  std::string words[] = {"mpm", "-options_file", path};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
  char** left = arguments;
  int count = 3;
  InputReport report;
  prepare_arguments(MPI_COMM_SELF, &count, &left, report);
  if (report.file_unread) return 0;
  if (PetscOptionsClear(nullptr) != PETSC_SUCCESS) __builtin_trap();
  if (PetscOptionsInsertArgs(nullptr, count - 1, left + 1) != PETSC_SUCCESS) return 0;
  Config config;
  if (read_options(nullptr, {Backend::serial}, config, report) != PETSC_SUCCESS) __builtin_trap();
  for (const std::string& line : report.errors)
    if (!line.starts_with("mpm: ")) __builtin_trap();
  return 0;
}
