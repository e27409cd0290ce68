#include "step/resampling.hpp"

#include <algorithm>
#include <limits>

#include "base/copy.hpp"
#include "common/material_table.hpp"
#include "rebuild/merge_particles.hpp"
#include "rebuild/split_particles.hpp"
#include "step/correct_positions.hpp"

namespace mpm {
namespace {

/// Column of LawHistory that shows whether soil of this material flows (PositionCorrection::flow_column).
int flow_column(const MaterialConfig& material) {
  const auto variables = state_variables(material);
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (std::string(variables[k].name) == "plastic_strain") return static_cast<int>(k);
  return material.model == "newtonian" ? Flow::always : Flow::never;
}

}  // namespace

/// Lists have room for the margin and a correction together, half a cell at most.
template <class Space, class T, int Dim>
void Resampling<Space, T, Dim>::set_up() {
  Config& config = run_.config;
  auto& correction = run_.state.correction;
  if (!config.position_correction) return;
  config.p2g.margin = std::min(config.p2g.margin, 0.5 - k_most_shift);
  run_.state.p2g.reserve = k_most_shift;
  correction.on = true;
  correction.rate = config.position_correction_rate;
  const int count = static_cast<int>(config.materials.size());
  correction.flow_column = decltype(correction.flow_column)("mpm::flow_column", count);
  const auto host = Kokkos::create_mirror_view(correction.flow_column);
  for (int m = 0; m < count; ++m) host(m) = flow_column(config.materials[m]);
  copy(correction.flow_column, host);
}

template <class Space, class T, int Dim>
PetscErrorCode Resampling<Space, T, Dim>::split_and_merge() {
  PetscFunctionBeginUser;
  if (!run_.state.soil.points.splits) PetscFunctionReturn(PETSC_SUCCESS);
  merge_particles(run_.state);
  const std::vector<Splitting> own = find_splittings(run_.state);
  std::vector<int> all;  // ids of the particles of all ranks that are split
  for (const Splitting& splitting : own) all.push_back(splitting.id);
  if (run_.ranks) {
    PetscCall(share_records(run_.comm, &all));
    std::sort(all.begin(), all.end());
  }
  PetscCheck(ids_.given() + static_cast<long>(all.size()) <= std::numeric_limits<int>::max(), run_.comm,
             PETSC_ERR_ARG_OUTOFRANGE,
             "-particle_domain split: there are no numbers left for more particles");
  std::vector<int> children;  // the same ids whatever the ranks are
  for (const Splitting& splitting : own)
    children.push_back(static_cast<int>(
        ids_.given() + (std::lower_bound(all.begin(), all.end(), splitting.id) - all.begin())));
  PetscCallCXX(split_particles(run_.state, own, children));
  ids_.add_children(static_cast<long>(all.size()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Resampling<Space, T, Dim>::correct_positions(double elapsed) {
  PetscFunctionBeginUser;
  PetscCallCXX(PetscCall(mpm::correct_positions(run_.state, elapsed, run_.ranks.get())));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim) template class Resampling<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
