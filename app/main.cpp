// mpirun -n 1 ./mpm -options_file footing.opts

#include <mpi.h>
#include <petscsys.h>
#include <Kokkos_Core.hpp>

#include <atomic>
#include <cstdio>
#include <cstdlib>

#include "mpm/simulation.hpp"
#include "signals.hpp"

namespace {

constexpr int k_system_failure = 1;  // exit status of what neither the input nor the computation explains

/// One line instead of PETSc's page, where an error is met first; a full disk is often met by rows and by frames,
/// which are written beside the run.
PetscErrorCode tell_in_one_line(MPI_Comm, int, const char*, const char*, PetscErrorCode error,
                                PetscErrorType type, const char* message, void*) {
  static std::atomic_flag told;
  if (type == PETSC_ERROR_INITIAL && !told.test_and_set())
    std::fprintf(stderr, "mpm: %s\n", message != nullptr ? message : "the system failed");
  return error;
}

PetscErrorCode run(const mpm::InputReport& arguments, mpm::Outcome* outcome) {
  PetscFunctionBeginUser;
  mpm::Simulation simulation;  // its views die here, before Kokkos does
  PetscCall(simulation.set_from_options(PETSC_COMM_WORLD, nullptr, arguments));
  if (simulation.ready()) PetscCall(simulation.run());
  *outcome = simulation.outcome();
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

int main(int argc, char** argv) {
  setenv("OMP_PROC_BIND", "false", 0);  // what an unset variable means; Kokkos would warn of it
  MPI_Init(&argc, &argv);
  Kokkos::initialize(argc, argv);  // first: takes its --kokkos-* words out of argv
  const auto arguments = mpm::prepare_arguments(MPI_COMM_WORLD, &argc, argv);
  // The system's own way with signals: PETSc's is a page of text even where a reader closes a pipe.
  PetscCall(PetscOptionsSetValue(nullptr, "-no_signal_handler", "true"));
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  PetscCall(PetscPushErrorHandler(tell_in_one_line, nullptr));
  mpm::catch_signals();
  mpm::Outcome outcome{};
  const bool whole = run(*arguments, &outcome) == PETSC_SUCCESS;
  PetscCall(PetscPopErrorHandler());
  PetscCall(PetscFinalize());
  Kokkos::finalize();
  MPI_Finalize();
  return whole ? static_cast<int>(outcome) : k_system_failure;
}
