// The least that a program needs to run a simulation of its own.

#include <cstdio>

#include "mpm/devices.hpp"
#include "mpm/simulation.hpp"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  if (!mpm::start_devices(&argc, argv)) {
    MPI_Finalize();
    return static_cast<int>(mpm::Outcome::bad_input);
  }
  const auto arguments = mpm::prepare_arguments(MPI_COMM_WORLD, &argc, &argv);
  PetscCall(PetscInitialize(&argc, &argv, nullptr, nullptr));
  mpm::Outcome outcome{};
  {
    mpm::Simulation simulation;
    simulation.on_first_step([] { std::printf("example: the steps begin\n"); });
    PetscCall(simulation.set_from_options(PETSC_COMM_WORLD, nullptr, *arguments));
    if (simulation.ready()) PetscCall(simulation.run());
    outcome = simulation.outcome();
  }
  PetscCall(PetscFinalize());
  mpm::end_devices();
  MPI_Finalize();
  std::printf("example: mpm %s ended with %d\n", mpm::k_version, static_cast<int>(outcome));
  return static_cast<int>(outcome);
}
