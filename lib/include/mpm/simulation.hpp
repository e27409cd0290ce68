#pragma once
// One simulation, from its options to its results.

#include <petscsys.h>

#include <functional>
#include <memory>

namespace mpm {

/// How a simulation ended, as the exit status of the program.
enum class Outcome : int { finished = 0, bad_input = 2, failed = 3, stopped = 75 };

inline constexpr const char* k_version = "0.2.0";

struct InputReport;

/// A run of the material point method. A non-zero PetscErrorCode means that the system failed (a full disk,
/// lost MPI); every fault that a user can mend is reported in one line and kept in outcome(). MPI, Kokkos and
/// PETSc are up before, and stay up until it is gone.
class Simulation {
 public:
  Simulation();
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Reads and checks every option with this prefix (null for none). `arguments` is what prepare_arguments
  /// found. Writes nothing. Sets outcome() to bad_input, after printing a line for each mistake, or to
  /// finished where only help was asked for.
  PetscErrorCode set_from_options(MPI_Comm comm, const char* prefix, const InputReport& arguments);
  /// Whether there is something to run.
  bool ready() const;
  /// To be called once when all is set up and the steps begin.
  void on_first_step(std::function<void()> call);
  /// Runs to the end and writes all results.
  PetscErrorCode run();
  Outcome outcome() const;

 private:
  struct Body;
  std::unique_ptr<Body> body_;
};

/// Takes what PETSc must not see out of the command line; see input/options.hpp.
std::unique_ptr<InputReport, void (*)(InputReport*)> prepare_arguments(MPI_Comm comm, int* argc,
                                                                       char*** argv);

}  // namespace mpm
