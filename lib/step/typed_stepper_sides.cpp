// Sides of the mesh that act on the soil, between configuration, state and checkpoints.

#include <algorithm>

#include "common/collectives.hpp"
#include "functions/absorbing_sides.hpp"
#include "step/body_input.hpp"
#include "step/typed_stepper.hpp"

namespace mpm {

/// Puts the sides that act on the device. A roller or fixed side that moves becomes a driven one in `grid`.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::set_up_sides(GridInput* grid) {
  std::vector<SideInput> sides;
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) {
      Wall& kind = grid->walls[d][side];
      const SideConfig& of = config_.mesh.sides[d][side];
      SideInput in{.direction = d, .side = side, .holds_all = kind == Wall::fixed};
      if (is_mirror(kind) && of.moves) kind = Wall::driven;
      if (!is_acting(kind)) continue;
      if (!of.velocity_table) in.velocity = of.velocity;
      in.friction = of.friction;
      in.shear_limit = of.shear_limit.value_or(std::numeric_limits<double>::infinity());
      in.dashpot_factor = of.dashpot_factor, in.spring_length = of.spring_length.value_or(0);
      sides.push_back(in);
    }
  double density = std::numeric_limits<double>::max();
  for (const MaterialConfig& material : config_.materials) density = std::min(density, material.density);
  upload_sides(state_, *grid, sides, density);
}

/// Sides with dashpots take these, their reactions and their columns from the soil as it is before the first
/// step.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::begin_sides() {
  PetscFunctionBeginUser;
  if (state_.sides.unknown == 0) PetscFunctionReturn(PETSC_SUCCESS);
  set_gravity(state_.time);
  set_loads(state_.time);
  collect_soil(state_);
  sum_present_soil(state_);
  loads_to_nodes(state_);
  if (ranks_) PetscCall(ranks_->add_present_soil(state_));
  SideRanks together;
  PetscErrorCode failed = PETSC_SUCCESS;
  if (ranks_) {
    together.sum = [&](long long* values, int count) {
      failed = MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_LONG_LONG, MPI_SUM, comm_);
    };
    together.largest = [&](double* value) {
      failed = MPI_Allreduce(MPI_IN_PLACE, value, 1, MPI_DOUBLE, MPI_MAX, comm_);
    };
  }
  PetscCallCXX(begin_absorbing(state_, shear_ratios(config_), together));
  PetscCallMPI(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Mean forces on the sides that act, and their work, since the last row.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::measure_sides(double interval, HistoryRow* row) {
  PetscFunctionBeginUser;
  if (!state_.sides.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  SideWork done = take_side_work(state_);
  if (ranks_) {
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, done.impulse[0][0].data(), 18, MPI_DOUBLE, MPI_SUM, comm_));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &done.work, 1, MPI_DOUBLE, MPI_SUM, comm_));
  }
  row->side_work = done.work;
  for (int n = 0; n < 2 * Dim && interval > 0; ++n)
    for (int k = 0; k < Dim; ++k) row->walls[n / 2][n % 2][k] += done.impulse[n / 2][n % 2][k] / interval;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Rows of the sides' nodes that this rank answers for, and on rank 0 those that no soil reaches now, so that
/// no rank answers for them.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::find_own_sides(std::vector<int>* own) const {
  PetscFunctionBeginUser;
  PetscCallCXX(*own = own_side_rows(state_));
  if (!ranks_ || own->empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<int> owners = *own;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, owners.data(), static_cast<int>(owners.size()), MPI_INT, MPI_SUM, comm_));
  for (std::size_t row = 0; row < owners.size() && rank_of(comm_) == 0; ++row)
    (*own)[row] = (*own)[row] || owners[row] == 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The table of the sides' nodes, of all ranks. What a node keeps that no soil reaches now, all have known
/// alike since they last met here.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::gather_sides(std::vector<double>* table) const {
  PetscFunctionBeginUser;
  *table = side_table(state_);
  if (!ranks_ || table->empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<int> own;
  PetscCall(find_own_sides(&own));
  *table = share_of_side_table(state_, own, rank_of(comm_) == 0);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, table->data(), static_cast<int>(table->size()), MPI_DOUBLE,
                             MPI_SUM, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::save_sides(SavedSides* saved) const {
  PetscFunctionBeginUser;
  for (int n = 0; n < 2 * Dim; ++n) saved->kinds.push_back(static_cast<long>(state_.grid.wall[n / 2][n % 2]));
  PetscCall(gather_sides(&saved->values));
  PetscCallCXX(saved->columns = column_table(state_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The table of all ranks, after lists were made. The rank that answers for a node goes on with its impulses
/// and works, so that the sums of a run that a checkpoint cuts have the same bits.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::put_sides(const std::vector<double>& table) {
  PetscFunctionBeginUser;
  if (table.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<int> own;
  PetscCall(find_own_sides(&own));
  PetscCallCXX(put_side_table(state_, table, own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Sides of the same kind go on with what they have kept. One that begins to absorb goes on to carry what it
/// has held till now. So does one with columns where what holds these has become another: they begin anew.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::restore_sides(const SavedSides& saved) {
  PetscFunctionBeginUser;
  if (saved.kinds.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  constexpr unsigned k_all = (1u << Dim) - 1;
  constexpr int size = SideTerms<Dim>::size;
  constexpr int size_of_column = ColumnTerms<Dim>::size, vertical = k_vertical<Dim>;
  std::vector<double> table = side_table(state_), columns = column_table(state_);
  std::size_t from = 0, from_column = 0;
  bool same_ends = true;
  for (int upper = 0; upper < 2; ++upper)
    same_ends = same_ends &&
                static_cast<Wall>(saved.kinds[2 * vertical + upper]) == state_.grid.wall[vertical][upper];
  for (int n = 0; n < 2 * Dim; ++n) {
    const Wall then = static_cast<Wall>(saved.kinds[n]), now = state_.grid.wall[n / 2][n % 2];
    const std::size_t rows = side_rows(config_.mesh.cells, Dim, n / 2), count = size * rows;
    const std::size_t of_columns = then == Wall::free_field ? size_of_column * rows : 0;
    state_.sides.held[n] = then == Wall::free ? 0u : then == Wall::roller ? 1u << (n / 2) : k_all;
    state_.sides.mirrored[n] = is_mirror(then) ? state_.sides.held[n] : 0u;
    if (is_acting(then) && then == now && (of_columns == 0 || same_ends)) {
      std::copy_n(saved.values.begin() + static_cast<long>(from), count,
                  table.begin() + std::size_t(size) * state_.sides.host[n].first);
      std::copy_n(saved.columns.begin() + static_cast<long>(from_column), of_columns,
                  columns.begin() + std::size_t(size_of_column) * state_.sides.host[n].first_column);
      state_.sides.unknown &= ~(1u << n);
    }
    if (is_acting(then)) from += count;
    from_column += of_columns;
  }
  PetscCall(put_sides(table));
  PetscCallCXX(put_column_table(state_, columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                           \
  template void TypedStepper<Space, T, Dim>::set_up_sides(GridInput*);                           \
  template PetscErrorCode TypedStepper<Space, T, Dim>::begin_sides();                            \
  template PetscErrorCode TypedStepper<Space, T, Dim>::measure_sides(double, HistoryRow*);       \
  template PetscErrorCode TypedStepper<Space, T, Dim>::gather_sides(std::vector<double>*) const; \
  template PetscErrorCode TypedStepper<Space, T, Dim>::save_sides(SavedSides*) const;            \
  template PetscErrorCode TypedStepper<Space, T, Dim>::find_own_sides(std::vector<int>*) const;  \
  template PetscErrorCode TypedStepper<Space, T, Dim>::put_sides(const std::vector<double>&);    \
  template PetscErrorCode TypedStepper<Space, T, Dim>::restore_sides(const SavedSides&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
