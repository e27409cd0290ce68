// Reports on the soil as a whole: its energy balance, and cells without soil inside it.

#include <algorithm>

#include "base/copy.hpp"
#include "common/collectives.hpp"
#include "step/gaps.hpp"
#include "step/typed_stepper.hpp"
#include "transfer/filled_cells.hpp"

namespace mpm {

/// The works begin at zero, and the energies that they start from are those of the soil as it is.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::begin_energy() {
  PetscFunctionBeginUser;
  begin_works(state_);
  double energies[2] = {};  // J: kinetic, elastic
  for (int b = 0; b < static_cast<int>(config_.bodies.size()); ++b) {
    const BodyMeasure m = mpm::measure(state_, b);
    energies[0] += m.kinetic_energy, energies[1] += m.stored_energy;
  }
  if (ranks_) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, energies, 2, MPI_DOUBLE, MPI_SUM, comm_));
  kinetic_at_start_ = energies[0], elastic_at_start_ = energies[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Under the rows of the bodies.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::measure_energy(HistoryRow* row) {
  PetscFunctionBeginUser;
  SavedState now;
  PetscCall(save_energy(&now));
  const std::vector<double>& works = now.energy;
  EnergyRow& e = row->energy = {};
  for (const BodyRow& body : row->bodies) {
    e.kinetic += body.kinetic_energy, e.elastic += body.stored_energy;
    e.lost += body.lost_energy + body.merged_energy;
  }
  e.internal = works[Work::stress];
  e.dissipated = e.internal - (e.elastic - elastic_at_start_);
  e.gravity = works[Work::gravity], e.damping = works[Work::damping];
  e.rigids = works[Work::rigids], e.contact = works[Work::boundary] - e.rigids;
  e.loads = row->load_work;
  const double of_nodes = works[Work::internal] + e.gravity + e.loads + e.damping + works[Work::boundary];
  e.update = e.kinetic + e.lost - kinetic_at_start_ - of_nodes;
  e.error = e.internal + works[Work::internal];
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::keep_balance(const EnergyRow& before) {
  PetscFunctionBeginUser;
  HistoryRow row;
  collect_soil(state_);
  PetscCall(sum_soil());
  for (int b = 0; b < static_cast<int>(config_.bodies.size()); ++b) {
    BodyRow body;
    PetscCall(measure_body(b, &body));
    row.bodies.push_back(body);
  }
  PetscCall(measure_energy(&row));
  elastic_at_start_ += before.dissipated - row.energy.dissipated;
  kinetic_at_start_ += row.energy.update - before.update;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The works of all ranks, and the energies at the start.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::save_energy(SavedState* saved) const {
  PetscFunctionBeginUser;
  saved->energy.clear();
  if (state_.energy.on) {
    static_assert(k_saved_energy == Work::count + 2);
    const auto works = mirror_of(state_.energy.work);
    saved->energy.assign(works.data(), works.data() + Work::count);
    if (ranks_)
      PetscCallMPI(
          MPI_Allreduce(MPI_IN_PLACE, saved->energy.data(), Work::count, MPI_DOUBLE, MPI_SUM, comm_));
    saved->energy.insert(saved->energy.end(), {kinetic_at_start_, elastic_at_start_});
  }
  if (!state_.loads.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  double work = 0;
  PetscCall(load_work(&work));
  PetscCallCXX(saved->energy.push_back(work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rank 0 takes the works of all.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::restore_energy(const SavedState& saved) {
  if (state_.loads.in_use() && !saved.energy.empty()) restore_load_work(saved.energy.back());
  if (!state_.energy.on || saved.energy.size() < k_saved_energy) return;
  const auto works = Kokkos::create_mirror_view(state_.energy.work);
  for (int k = 0; k < Work::count; ++k) works(k) = ranks_ && rank_of(comm_) > 0 ? 0 : saved.energy[k];
  copy(state_.energy.work, works);
  kinetic_at_start_ = saved.energy[Work::count], elastic_at_start_ = saved.energy[Work::count + 1];
}

/// Cells that hold soil, and gaps between them.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::count_cells(HistoryRow* row) const {
  PetscFunctionBeginUser;
  std::vector<FilledPatch> patches = filled_cells(state_);
  if (ranks_) PetscCall(gather_patches(comm_, &patches));
  std::array<int, 3> cells{1, 1, 1};
  std::array<bool, 3> periodic{};
  for (int d = 0; d < Dim; ++d) cells[d] = config_.mesh.cells[d], periodic[d] = is_periodic(config_.mesh, d);
  const Gaps gaps = count_gaps<Dim>(patches, cells, periodic);
  row->filled_cells = gaps.filled, row->empty_cells = gaps.empty;
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                 \
  template PetscErrorCode TypedStepper<Space, T, Dim>::begin_energy();                 \
  template PetscErrorCode TypedStepper<Space, T, Dim>::measure_energy(HistoryRow*);    \
  template PetscErrorCode TypedStepper<Space, T, Dim>::save_energy(SavedState*) const; \
  template void TypedStepper<Space, T, Dim>::restore_energy(const SavedState&);        \
  template PetscErrorCode TypedStepper<Space, T, Dim>::keep_balance(const EnergyRow&); \
  template PetscErrorCode TypedStepper<Space, T, Dim>::count_cells(HistoryRow*) const;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
