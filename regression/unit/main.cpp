// The tests' session: MPI, Kokkos and PETSc are up while Catch2 runs, and none of them sees its arguments.

#include <mpi.h>
#include <petscsys.h>

#include <Kokkos_Core.hpp>
#include <catch2/catch_session.hpp>

#include "base/subnormals.hpp"

namespace {

int run_tests(int argc, char** argv) {
  mpm::flush_subnormals();
  MPI_Init(nullptr, nullptr);
  Kokkos::initialize();
  int failed = 1;
  if (PetscInitializeNoArguments() == PETSC_SUCCESS) {
    failed = Catch::Session().run(argc, argv);
    if (PetscFinalize() != PETSC_SUCCESS) failed = 1;
  }
  Kokkos::finalize();
  MPI_Finalize();
  return failed;
}

}  // namespace

int main(int argc, char** argv) { return run_tests(argc, argv); }
