// The correction of positions at a rebuild.

#include <algorithm>

#include "base/copy.hpp"
#include "physics/materials/any.hpp"
#include "step/correct_positions.hpp"
#include "step/typed_stepper.hpp"

namespace mpm {
namespace {

/// Column of History that shows whether soil of this material flows (PositionCorrection::flow_column).
int flow_column(const MaterialConfig& material) {
  const auto variables = state_variables(material);
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (std::string(variables[k].name) == "plastic_strain") return static_cast<int>(k);
  return material.model == "newtonian" ? Flow::always : Flow::never;
}

}  // namespace

/// Lists have room for the margin and a correction together, half a cell at most.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::set_up_correction() {
  if (!config_.position_correction) return;
  config_.p2g.margin = std::min(config_.p2g.margin, 0.5 - k_most_shift);
  state_.p2g.reserve = k_most_shift;
  state_.correction.on = true;
  state_.correction.rate = config_.position_correction_rate;
  const int count = static_cast<int>(config_.materials.size());
  state_.correction.flow_column = decltype(state_.correction.flow_column)("mpm::flow_column", count);
  const auto host = Kokkos::create_mirror_view(state_.correction.flow_column);
  for (int m = 0; m < count; ++m) host(m) = flow_column(config_.materials[m]);
  copy(state_.correction.flow_column, host);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::correct_positions(double elapsed) {
  PetscFunctionBeginUser;
  PetscCallCXX(PetscCall(mpm::correct_positions(state_, elapsed, ranks_.get())));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                            \
  template void TypedStepper<Space, T, Dim>::set_up_correction(); \
  template PetscErrorCode TypedStepper<Space, T, Dim>::correct_positions(double);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
