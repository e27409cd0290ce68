// mpirun ./mpm -options_file footing.opts

#include <Kokkos_Core.hpp>
#include <mpi.h>
#include <petscsys.h>

#include "mpm/simulation.hpp"

namespace {

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
  MPI_Init(&argc, &argv);
  Kokkos::initialize(argc, argv);  // first: takes its --kokkos-* words out of argv
  const auto arguments = mpm::prepare_arguments(MPI_COMM_WORLD, &argc, argv);
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  mpm::Outcome outcome{};
  PetscCall(run(*arguments, &outcome));
  PetscCall(PetscFinalize());
  Kokkos::finalize();
  MPI_Finalize();
  return static_cast<int>(outcome);
}
