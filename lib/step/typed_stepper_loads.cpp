// Loads on surfaces, between configuration, state, history and checkpoints.

#include "base/copy.hpp"
#include "common/collectives.hpp"
#include "functions/surface_loads.hpp"
#include "step/load_input.hpp"
#include "step/typed_stepper.hpp"

namespace mpm {
namespace {

/// The loads at a time of the tables [s].
template <int Dim>
std::vector<SurfaceLoad<Dim>> loads_at(const Config& config, double time) {
  std::vector<SurfaceLoad<Dim>> loads;
  for (const LoadConfig& load : config.loads) {
    SurfaceLoad<Dim> now{pressure_at(load, time), {}};
    for (int d = 0; d < Dim; ++d) now.traction[d] = traction_at(load, d, time);
    loads.push_back(now);
  }
  return loads;
}

}  // namespace

/// Before the particles are put on the device.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::set_up_loads(const Model& model) {
  state_.soil.points.face_count = model.face_count;
  upload_surface_loads(state_, loads_at<Dim>(config_, 0));
}

/// Loads that follow tables at a time [s], for what is measured; the next step sets its own.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::set_loads(double time) {
  for (const LoadConfig& load : config_.loads)
    if (load.pressure_table || load.traction_table)
      return upload_surface_loads(state_, loads_at<Dim>(config_, time - config_.time.start));
}

/// Work of the loads since the start, of all ranks [J].
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::load_work(double* work) const {
  PetscFunctionBeginUser;
  *work = 0;
  if (!state_.loads.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  *work = mirror_of(state_.loads.work)();
  if (ranks_) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, work, 1, MPI_DOUBLE, MPI_SUM, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rank 0 takes the work of all.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::restore_load_work(double work) {
  Kokkos::deep_copy(state_.loads.work, ranks_ && rank_of(comm_) > 0 ? 0 : work);
}

/// Measures the loads for a row of the history.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::measure_loads(HistoryRow* row) const {
  PetscFunctionBeginUser;
  constexpr int k_numbers = 5;
  row->loads.clear();
  if (!state_.loads.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(load_work(&row->load_work));
  const auto now = loads_at<Dim>(config_, row->time - config_.time.start);
  const std::vector<SurfaceSum> sums = sum_surfaces(state_);
  for (std::size_t n = 0; n < sums.size(); ++n) {
    double all[k_numbers] = {sums[n].area, sums[n].start_area};
    for (int d = 0; d < Dim; ++d) all[2 + d] = sums[n].vector[d];
    if (ranks_) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all, k_numbers, MPI_DOUBLE, MPI_SUM, comm_));
    LoadRow load;
    load.area = all[0];
    for (int d = 0; d < Dim; ++d) load.force[d] = now[n].traction[d] * all[1] - now[n].pressure * all[2 + d];
    row->loads.push_back(load);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                           \
  template void TypedStepper<Space, T, Dim>::set_up_loads(const Model&);         \
  template void TypedStepper<Space, T, Dim>::set_loads(double);                  \
  template PetscErrorCode TypedStepper<Space, T, Dim>::load_work(double*) const; \
  template void TypedStepper<Space, T, Dim>::restore_load_work(double);          \
  template PetscErrorCode TypedStepper<Space, T, Dim>::measure_loads(HistoryRow*) const;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
