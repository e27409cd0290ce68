#include "input/deck/report.hpp"

#include <cstdio>

#include "common/collectives.hpp"
#include "common/text.hpp"

namespace mpm {
namespace {

PetscErrorCode print_lines(MPI_Comm comm, FILE* file, const std::string& text) {
  PetscFunctionBeginUser;
  PetscMPIInt rank = 0;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    PetscCheck(std::fputs(text.c_str(), file) >= 0 && std::fflush(file) == 0, PETSC_COMM_SELF,
               PETSC_ERR_FILE_WRITE, "Cannot write to the terminal");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode print_help(MPI_Comm comm, const InputReport& report) {
  return print_lines(comm, stdout, report.help_text);
}

PetscErrorCode print_errors(MPI_Comm comm, const InputReport& report) {
  return print_lines(comm, stderr, report.errors.empty() ? "" : join(report.errors, "\n") + "\n");
}

}  // namespace mpm
