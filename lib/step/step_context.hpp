#pragma once
// Data that all parts of the stepper share: this rank's part of the run, and reductions over all ranks.

#include <memory>

#include "common/collectives.hpp"
#include "parallel/decomposition.hpp"
#include "step/present_rigids.hpp"
#include "step/stepper.hpp"
#include "step/to_nodes.hpp"

namespace mpm {

inline MPI_Datatype mpi_type(const double*) { return MPI_DOUBLE; }
inline MPI_Datatype mpi_type(const int*) { return MPI_INT; }
inline MPI_Datatype mpi_type(const long*) { return MPI_LONG; }
inline MPI_Datatype mpi_type(const long long*) { return MPI_LONG_LONG; }

template <class Space, class T, int Dim>
struct StepContext {
  StepContext(const Config& all, MPI_Comm comm) : rigids(all), config(rigids.narrowed(all)), comm(comm) {
    state.space = space_of<Space>(all.backend);
  }

  PresentRigids rigids;
  Config config;  // with the rigid bodies that are in the run
  MPI_Comm comm;
  State<Space, T, Dim> state;
  std::unique_ptr<Decomposition<Space, T, Dim>> ranks;  // null on one rank

  /// Reductions of numbers over all ranks, in place; on one rank they stay as they are. Collective.
  PetscErrorCode sum(auto* values, std::size_t count = 1) const { return reduce(MPI_SUM, values, count); }
  PetscErrorCode least(auto* values, std::size_t count = 1) const { return reduce(MPI_MIN, values, count); }
  PetscErrorCode largest(auto* values, std::size_t count = 1) const { return reduce(MPI_MAX, values, count); }
  double sum_of(double own) const { return static_cast<void>(sum(&own)), own; }
  /// The failure of the lowest rank that has one, on every rank. Collective.
  PetscErrorCode share(Failure* failure) const { return share_text(comm, &failure->what); }
  /// Whether this rank takes the sums of all ranks from a checkpoint.
  bool is_first() const { return !ranks || rank_of(comm) == 0; }
  /// Sums the soil as it is to the nodes, over all ranks. Collective.
  PetscErrorCode sum_soil() {
    PetscFunctionBeginUser;
    sum_present_soil(state);
    if (ranks) PetscCall(ranks->add_present_soil(state));
    PetscFunctionReturn(PETSC_SUCCESS);
  }

 private:
  PetscErrorCode reduce(MPI_Op op, auto* values, std::size_t count) const {
    PetscFunctionBeginUser;
    const int size = static_cast<int>(count);
    if (ranks) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, values, size, mpi_type(values), op, comm));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
};

}  // namespace mpm
