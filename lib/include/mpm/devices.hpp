#pragma once
// Kokkos for a program that runs simulations. It needs no header of Kokkos.

namespace mpm {

/// Starts Kokkos, which takes its --kokkos-... words out of the command line. Call it on every process after
/// MPI_Init and before prepare_arguments. Several processes on one node share its GPUs and its cores, unless
/// the user has chosen. Without a GPU or its driver a program that was built with CUDA starts too, for the
/// processor's back ends. Returns false where Kokkos cannot start as the command line or the environment
/// asks, after printing a line for each mistake; the program then ends with Outcome::bad_input.
bool start_devices(int* argc, char** argv);

/// Ends Kokkos. Call it once every Simulation is gone, before MPI_Finalize.
void end_devices();

}  // namespace mpm
