// mpirun -n 4 ./mpm -options_file footing.opts

#include <mpi.h>
#include <petscsys.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <thread>

#include "base/subnormals.hpp"
#include "mpm/about.hpp"
#include "mpm/devices.hpp"
#include "mpm/simulation.hpp"

namespace {

constexpr int k_system_failure = 1;  // exit status of what neither the input nor the computation explains

/// Exit status where the system failed. Memory that runs out before the first step is a matter of the input,
/// later of the computation.
std::atomic_int failure_status{k_system_failure};
std::atomic_bool begun{false};  // the steps

/// Prints the first failure in one line.
void print_failure(bool memory, const char* message) {
  static std::atomic_flag printed;
  if (printed.test_and_set()) return;
  if (!memory) {
    std::fprintf(stderr, "mpm: %s\n", message != nullptr ? message : "the system failed");
    return;
  }
  failure_status = static_cast<int>(begun ? mpm::Outcome::failed : mpm::Outcome::bad_input);
  std::fprintf(stderr, "mpm: memory ran out %s; fewer particles or more memory are needed\n",
               begun ? "during the run" : "before the first step");
}

/// Whether a message is that of an allocation: of the language, its containers or Kokkos.
bool is_of_memory(const char* message) {
  const std::string text = message != nullptr ? message : "";
  return text.find("bad_alloc") != std::string::npos ||
         text.find("failed to allocate") != std::string::npos ||
         text.find("bad_array_new_length") != std::string::npos ||
         text.find("max_size()") != std::string::npos;
}

/// One line instead of PETSc's page, where an error is met first; a full disk is often met by rows and by
/// frames, which are written beside the run.
PetscErrorCode print_in_one_line(MPI_Comm, int, const char*, const char*, PetscErrorCode error,
                                 PetscErrorType type, const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) print_failure(error == PETSC_ERR_MEM || is_of_memory(message), message);
  return error;
}

/// Prints a failure of PETSc's start, where only an option of PETSc can be wrong.
PetscErrorCode print_fault_of_start(MPI_Comm, int, const char*, const char*, PetscErrorCode error,
                                    PetscErrorType type, const char* message, void*) {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (type == PETSC_ERROR_INITIAL && rank == 0)
    std::fprintf(
        stderr,
        "mpm: options of PETSc: given a value that is not one of its words (%s), takes those of its manual\n",
        message != nullptr ? message : "");
  return error;
}

PetscErrorCode run(const mpm::InputReport& arguments, mpm::Outcome* outcome) {
  PetscFunctionBeginUser;
  mpm::Simulation simulation;  // its views die here, before Kokkos does
  simulation.on_first_step([] { begun = true; });
  try {
    PetscCall(simulation.set_from_options(PETSC_COMM_WORLD, nullptr, arguments));
    if (simulation.ready()) PetscCall(simulation.run());
  } catch (const std::exception& error) {
    print_failure(is_of_memory(error.what()), error.what());
    PetscFunctionReturn(PETSC_ERR_MEM);
  }
  *outcome = simulation.outcome();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// An exception that nobody can catch, as in a thread: the same line in lieu of an abort.
void end_of_exception() {
  std::string what = "the program failed";
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
  } catch (const std::exception& error) {
    what = error.what();
  } catch (...) {}
  print_failure(is_of_memory(what.c_str()), what.c_str());
  std::_Exit(failure_status);
}

/// Prints what needs no run; the exit status.
int print(const mpm::AboutAnswer& about) {
  std::FILE* file = about.status == 0 ? stdout : stderr;
  if (std::fputs(about.text.c_str(), file) >= 0 && std::fflush(file) == 0) return about.status;
  std::perror("mpm: Cannot write to the terminal");
  return k_system_failure;
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
  if (!ended) MPI_Abort(MPI_COMM_WORLD, failure_status);
}

}  // namespace

int main(int argc, char** argv) {
  if (const mpm::AboutAnswer about = mpm::answer_without_run(argc, argv); about.asked) return print(about);
  mpm::flush_subnormals();
  std::set_terminate(end_of_exception);
  MPI_Init(&argc, &argv);
  if (!mpm::start_devices(&argc, argv)) {
    MPI_Finalize();
    return static_cast<int>(mpm::Outcome::bad_input);
  }
  const auto arguments = mpm::prepare_arguments(MPI_COMM_WORLD, &argc, &argv);
  // The system's own way with signals: PETSc's is a page of text even where a reader closes a pipe.
  PetscCall(PetscOptionsSetValue(nullptr, "-no_signal_handler", "true"));
  PetscCall(PetscPushErrorHandler(print_fault_of_start, nullptr));  // stays: -malloc_debug could not free it
  if (PetscInitialize(&argc, &argv, nullptr, nullptr) != PETSC_SUCCESS) {
    mpm::end_devices();
    MPI_Finalize();
    return static_cast<int>(mpm::Outcome::bad_input);
  }
  PetscCall(PetscPushErrorHandler(print_in_one_line, nullptr));
  mpm::Outcome outcome{};
  const bool whole = run(*arguments, &outcome) == PETSC_SUCCESS;
  if (!whole) end_others();
  PetscCall(PetscPopErrorHandler());
  PetscCall(PetscFinalize());
  mpm::end_devices();
  MPI_Finalize();
  return whole ? static_cast<int>(outcome) : failure_status.load();
}
