#include "step/applied_loads.hpp"

#include "base/copy.hpp"
#include "functions/surface_loads.hpp"
#include "step/load_input.hpp"

namespace mpm {
namespace {

/// Loads at a time of the tables [s].
template <int Dim>
std::vector<SurfaceLoad<Dim>> loads_at(const Config& config, double time) {
  std::vector<SurfaceLoad<Dim>> loads;
  for (const LoadConfig& load : config.loads) {
    SurfaceLoad<Dim> now{pressure_at(load, time), {}, load.on_pores ? 1 : 0};
    for (int d = 0; d < Dim; ++d) now.traction[d] = traction_at(load, d, time);
    loads.push_back(now);
  }
  return loads;
}

}  // namespace

template <class Space, class T, int Dim>
void AppliedLoads<Space, T, Dim>::set_up(int face_count, const std::vector<double>& carried) {
  run_.state.soil.points.face_count = face_count;
  upload_surface_loads(run_.state, loads_at<Dim>(run_.config, 0));
  upload_loads(run_.state, load_input(run_.config, carried));
}

template <class Space, class T, int Dim>
void AppliedLoads<Space, T, Dim>::set_time(double time) {
  const Config& config = run_.config;
  for (int d = 0; d < Dim && config.gravity_table; ++d)
    run_.state.gravity[d] = gravity_at(config, d, time - config.time.start);
  for (const LoadConfig& load : config.loads)
    if (load.pressure_table || load.traction_table)
      return upload_surface_loads(run_.state, loads_at<Dim>(config, time - config.time.start));
}

template <class Space, class T, int Dim>
PetscErrorCode AppliedLoads<Space, T, Dim>::work(double* work) const {
  PetscFunctionBeginUser;
  *work = mirror_of(run_.state.loads.work)();
  PetscCall(run_.sum(work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode AppliedLoads<Space, T, Dim>::measure(HistoryRow* row) const {
  PetscFunctionBeginUser;
  constexpr int k_numbers = 5;
  row->loads.clear();
  if (!run_.state.loads.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(work(&row->load_work));
  const auto now = loads_at<Dim>(run_.config, row->time - run_.config.time.start);
  const std::vector<SurfaceSum> sums = sum_surfaces(run_.state, run_.state.loads);
  for (std::size_t n = 0; n < sums.size(); ++n) {
    double all[k_numbers] = {sums[n].area, sums[n].start_area};
    for (int d = 0; d < Dim; ++d) all[2 + d] = sums[n].vector[d];
    PetscCall(run_.sum(all, k_numbers));
    LoadRow load;
    load.area = all[0];
    for (int d = 0; d < Dim; ++d) load.force[d] = now[n].traction[d] * all[1] - now[n].pressure * all[2 + d];
    row->loads.push_back(load);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode AppliedLoads<Space, T, Dim>::save(SavedState* saved) const {
  PetscFunctionBeginUser;
  if (!run_.state.loads.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  double sum = 0;
  PetscCall(work(&sum));
  PetscCallCXX(saved->energy.push_back(sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void AppliedLoads<Space, T, Dim>::restore(const SavedState& saved) {
  if (!run_.state.loads.in_use() || saved.energy.empty()) return;
  Kokkos::deep_copy(run_.state.loads.work, run_.is_first() ? saved.energy.back() : 0);
}

#define MPM_INSTANTIATE(Space, T, Dim) template class AppliedLoads<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
