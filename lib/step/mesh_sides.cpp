#include "step/mesh_sides.hpp"

#include <algorithm>
#include <limits>

#include "functions/absorbing_sides.hpp"
#include "functions/wall_force.hpp"
#include "rebuild/batches.hpp"
#include "step/body_input.hpp"
#include "transfer/upload_sides.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void MeshSides<Space, T, Dim>::set_up(GridInput* grid) {
  std::vector<SideInput> sides;
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) {
      Wall& kind = grid->walls[d][side];
      const SideConfig& of = run_.config.mesh.sides[d][side];
      SideInput in{.direction = d, .side = side, .holds_all = kind == Wall::fixed, .numbers = of.numbers};
      if (is_mirror(kind) && of.moves) kind = Wall::driven;
      if (!is_acting(kind)) continue;
      if (!of.velocity_table) in.velocity = of.velocity;
      sides.push_back(in);
    }
  double density = std::numeric_limits<double>::max();
  for (const MaterialConfig& material : run_.config.materials) density = std::min(density, material.density);
  upload_sides(run_.state, *grid, sides, density);
}

template <class Space, class T, int Dim>
PetscErrorCode MeshSides<Space, T, Dim>::begin() {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  sum_present_soil(run_.state);
  loads_to_nodes(run_.state);
  if (run_.ranks) PetscCall(run_.ranks->add_present_soil(run_.state));
  PetscErrorCode failed = PETSC_SUCCESS;
  const SideRanks together{
      .sum = [&](long long* values, int count) { failed = run_.sum(values, count); },
      .largest = [&](double* value) { failed = run_.largest(value); },
  };
  PetscCallCXX(begin_absorbing(run_.state, shear_ratios(run_.config), together));
  PetscCall(failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode MeshSides<Space, T, Dim>::measure(double interval, HistoryRow* row) const {
  PetscFunctionBeginUser;
  row->walls = wall_forces(run_.state, run_.state.loads);
  PetscCall(run_.sum(row->walls[0][0].data(), 18));
  if (!run_.state.sides.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  SideWork done = take_side_work(run_.state);
  PetscCall(run_.sum(done.impulse[0][0].data(), 18));
  PetscCall(run_.sum(&done.work));
  row->side_work = done.work;
  for (int n = 0; n < 2 * Dim && interval > 0; ++n)
    for (int k = 0; k < Dim; ++k) row->walls[n / 2][n % 2][k] += done.impulse[n / 2][n % 2][k] / interval;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// On rank 0 these are also the rows that no soil reaches now, so that no rank answers for them.
template <class Space, class T, int Dim>
PetscErrorCode MeshSides<Space, T, Dim>::find_own(std::vector<int>* own) const {
  PetscFunctionBeginUser;
  PetscCallCXX(*own = own_side_rows(run_.state));
  if (!run_.ranks || own->empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<int> owners = *own;
  PetscCall(run_.sum(owners.data(), owners.size()));
  for (std::size_t row = 0; row < owners.size() && run_.is_first(); ++row)
    (*own)[row] = (*own)[row] || owners[row] == 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// All ranks hold the same values of a node that no soil reaches now, since they last met here.
template <class Space, class T, int Dim>
PetscErrorCode MeshSides<Space, T, Dim>::gather(std::vector<double>* table) const {
  PetscFunctionBeginUser;
  *table = side_table(run_.state);
  if (!run_.ranks || table->empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<int> own;
  PetscCall(find_own(&own));
  *table = share_of_side_table(run_.state, own, run_.is_first());
  PetscCall(run_.sum(table->data(), table->size()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The rank that answers for a node goes on with its impulses and works, so that the sums of a run that a
/// checkpoint cuts have the same bits.
template <class Space, class T, int Dim>
PetscErrorCode MeshSides<Space, T, Dim>::put(const std::vector<double>& table) {
  PetscFunctionBeginUser;
  if (table.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<int> own;
  PetscCall(find_own(&own));
  PetscCallCXX(put_side_table(run_.state, table, own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode MeshSides<Space, T, Dim>::save(SavedSides* saved) const {
  PetscFunctionBeginUser;
  for (int n = 0; n < 2 * Dim; ++n)
    saved->kinds.push_back(static_cast<long>(run_.state.grid.wall[n / 2][n % 2]));
  PetscCall(gather(&saved->values));
  PetscCallCXX(saved->columns = column_table(run_.state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode MeshSides<Space, T, Dim>::restore(const SavedSides& saved) {
  PetscFunctionBeginUser;
  if (saved.kinds.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  constexpr unsigned k_all = (1u << Dim) - 1;
  constexpr int size = SideTerms<Dim>::size;
  constexpr int size_of_column = ColumnTerms<Dim>::size, vertical = k_vertical<Dim>;
  const auto& wall = run_.state.grid.wall;
  auto& sides = run_.state.sides;
  std::vector<double> table = side_table(run_.state), columns = column_table(run_.state);
  std::size_t from = 0, from_column = 0;
  bool same_ends = true;
  for (int upper = 0; upper < 2; ++upper)
    same_ends = same_ends && static_cast<Wall>(saved.kinds[2 * vertical + upper]) == wall[vertical][upper];
  for (int n = 0; n < 2 * Dim; ++n) {
    const Wall then = static_cast<Wall>(saved.kinds[n]), now = wall[n / 2][n % 2];
    const std::size_t rows = side_rows(run_.config.mesh.cells, Dim, n / 2), count = size * rows;
    const std::size_t of_columns = then == Wall::free_field ? size_of_column * rows : 0;
    sides.held[n] = then == Wall::free ? 0u : then == Wall::roller ? 1u << (n / 2) : k_all;
    sides.mirrored[n] = is_mirror(then) ? sides.held[n] : 0u;
    if (is_acting(then) && then == now && (of_columns == 0 || same_ends)) {
      std::copy_n(saved.values.begin() + static_cast<long>(from), count,
                  table.begin() + std::size_t(size) * sides.host[n].first);
      std::copy_n(saved.columns.begin() + static_cast<long>(from_column), of_columns,
                  columns.begin() + std::size_t(size_of_column) * sides.host[n].first_column);
      sides.unknown &= ~(1u << n);
    }
    if (is_acting(then)) from += count;
    from_column += of_columns;
  }
  PetscCall(put(table));
  PetscCallCXX(put_column_table(run_.state, columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim) template class MeshSides<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
