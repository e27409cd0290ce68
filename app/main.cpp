// mpirun -n 4 ./mpm -options_file footing.opts

#include <mpi.h>
#include <petscsys.h>
#include <Kokkos_Core.hpp>

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "mpm/simulation.hpp"
#include "signals.hpp"
#include "subnormals.hpp"

namespace {

constexpr int k_system_failure = 1;  // exit status of what neither the input nor the computation explains

/// One line instead of PETSc's page, where an error is met first; a full disk is often met by rows and by
/// frames, which are written beside the run.
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

/// What several ranks on a node must not each take whole, where the user has not chosen: a device each, in
/// turn
/// (--kokkos-device-id, KOKKOS_DEVICE_ID), and a part of the cores (OMP_NUM_THREADS, KOKKOS_NUM_THREADS). One
/// of them speaks for all of what Kokkos warns of.
void share_node() {
  MPI_Comm node = MPI_COMM_NULL;
  int world = 0, rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &world);
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  MPI_Comm_rank(node, &rank);
  MPI_Comm_size(node, &size);
  MPI_Comm_free(&node);
  const int devices = Kokkos::num_devices();
  if (devices > 0) setenv("KOKKOS_DEVICE_ID", std::to_string(rank % devices).c_str(), 0);
  cpu_set_t mine;
  const int usable = sched_getaffinity(0, sizeof mine, &mine) == 0 ? CPU_COUNT(&mine) : 1;
  const int part = std::max(1, static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)) / size);
  if (size > 1 && std::getenv("OMP_NUM_THREADS") == nullptr)
    setenv("KOKKOS_NUM_THREADS", std::to_string(std::min(usable, part)).c_str(), 0);
  if (world > 0) setenv("KOKKOS_DISABLE_WARNINGS", "1", 0);
}

/// A rank that failed alone, as for want of memory, must not leave the others waiting for it for ever.
void end_others() {
  constexpr int k_patience = 5000;  // ms
  MPI_Request all = MPI_REQUEST_NULL;
  int ended = 0;
  MPI_Ibarrier(MPI_COMM_WORLD, &all);
  for (int n = 0; n < k_patience && !ended; ++n) {
    MPI_Test(&all, &ended, MPI_STATUS_IGNORE);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (!ended) MPI_Abort(MPI_COMM_WORLD, k_system_failure);
}

}  // namespace

int main(int argc, char** argv) {
  setenv("OMP_PROC_BIND", "false", 0);  // what an unset variable means; Kokkos would warn of it
  mpm::flush_subnormals();
  MPI_Init(&argc, &argv);
  share_node();
  Kokkos::initialize(argc, argv);  // first: takes its --kokkos-* words out of argv
  const auto arguments = mpm::prepare_arguments(MPI_COMM_WORLD, &argc, argv);
  // The system's own way with signals: PETSc's is a page of text even where a reader closes a pipe.
  PetscCall(PetscOptionsSetValue(nullptr, "-no_signal_handler", "true"));
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  PetscCall(PetscPushErrorHandler(tell_in_one_line, nullptr));
  mpm::catch_signals();
  mpm::Outcome outcome{};
  const bool whole = run(*arguments, &outcome) == PETSC_SUCCESS;
  if (!whole) end_others();
  PetscCall(PetscPopErrorHandler());
  PetscCall(PetscFinalize());
  Kokkos::finalize();
  MPI_Finalize();
  return whole ? static_cast<int>(outcome) : k_system_failure;
}
