#include "step/energy_balance.hpp"

#include "base/copy.hpp"
#include "functions/energy_works.hpp"
#include "transfer/measure.hpp"

namespace mpm {

template <class Space, class T, int Dim>
PetscErrorCode EnergyBalance<Space, T, Dim>::begin() {
  PetscFunctionBeginUser;
  begin_works(run_.state);
  double energies[2] = {};  // J: kinetic, elastic
  for (int b = 0; b < static_cast<int>(run_.config.bodies.size()); ++b) {
    const BodyMeasure m = mpm::measure(run_.state, b);
    energies[0] += m.kinetic_energy, energies[1] += m.stored_energy;
  }
  PetscCall(run_.sum(energies, 2));
  kinetic_at_start_ = energies[0], elastic_at_start_ = energies[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode EnergyBalance<Space, T, Dim>::sum_works(std::vector<double>* works) const {
  PetscFunctionBeginUser;
  const auto own = mirror_of(run_.state.energy.work);
  works->assign(own.data(), own.data() + Work::count);
  PetscCall(run_.sum(works->data(), Work::count));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode EnergyBalance<Space, T, Dim>::measure(HistoryRow* row) const {
  PetscFunctionBeginUser;
  std::vector<double> works;
  PetscCall(sum_works(&works));
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
PetscErrorCode EnergyBalance<Space, T, Dim>::keep(const EnergyRow& before, HistoryRow* now) {
  PetscFunctionBeginUser;
  PetscCall(measure(now));
  elastic_at_start_ += before.dissipated - now->energy.dissipated;
  kinetic_at_start_ += now->energy.update - before.update;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode EnergyBalance<Space, T, Dim>::save(SavedState* saved) const {
  PetscFunctionBeginUser;
  if (!run_.state.energy.on) PetscFunctionReturn(PETSC_SUCCESS);
  static_assert(k_saved_energy == Work::count + 2);
  PetscCall(sum_works(&saved->energy));
  saved->energy.insert(saved->energy.end(), {kinetic_at_start_, elastic_at_start_});
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void EnergyBalance<Space, T, Dim>::restore(const SavedState& saved) {
  if (!run_.state.energy.on || saved.energy.size() < k_saved_energy) return;
  const auto works = Kokkos::create_mirror_view(run_.state.energy.work);
  for (int k = 0; k < Work::count; ++k) works(k) = run_.is_first() ? saved.energy[k] : 0;
  copy(run_.state.energy.work, works);
  kinetic_at_start_ = saved.energy[Work::count], elastic_at_start_ = saved.energy[Work::count + 1];
}

#define MPM_INSTANTIATE(Space, T, Dim) template class EnergyBalance<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
