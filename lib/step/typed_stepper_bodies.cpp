// Bodies that are not all in the run: ids without a particle, and the columns of their laws.

#include <algorithm>
#include <numeric>

#include "common/collectives.hpp"
#include "common/text.hpp"
#include "step/typed_stepper.hpp"

namespace mpm {

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::leave_out(Model* model) {
  PetscFunctionBeginUser;
  unused_.assign(model->bodies.size(), 0);
  const bool leaves = std::any_of(model->bodies.begin(), model->bodies.end(),
                                  [](const BodyParticles& body) { return !body.left_out.empty(); });
  for (std::size_t b = 0; b < model->bodies.size() && leaves; ++b) {
    BodyParticles& body = model->bodies[b];
    const std::vector<char> out = std::move(body.left_out);
    if (body.id.empty()) {
      body.id.resize(body.position.size() / Dim);
      std::iota(body.id.begin(), body.id.end(), static_cast<int>(first_[b]));
    }
    unused_[b] = std::count(out.begin(), out.end(), 1);
    if (unused_[b] == 0) continue;
    remove_rows(out, body);
    remove_rows(out, body.id);
  }
  if (size_of(comm_) > 1)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, unused_.data(), static_cast<int>(unused_.size()), MPI_LONG,
                               MPI_SUM, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
long TypedStepper<Space, T, Dim>::particles() const {
  return ids() - std::accumulate(unused_.begin(), unused_.end(), 0L);
}

template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::name_columns(SavedState* saved) const {
  const auto& history = state_.soil.points.history;
  saved->columns.assign(history.name.data(), history.name.data() + history.columns);
  saved->variables.clear();
  for (const BodyConfig& body : config_.bodies) {
    std::vector<std::string> names;
    for (const StateVariable& variable : state_variables(config_.materials[body.material]))
      names.emplace_back(variable.name);
    saved->variables.push_back(join(names));
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                                    \
  template PetscErrorCode TypedStepper<Space, T, Dim>::leave_out(Model*); \
  template long TypedStepper<Space, T, Dim>::particles() const;           \
  template void TypedStepper<Space, T, Dim>::name_columns(SavedState*) const;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
