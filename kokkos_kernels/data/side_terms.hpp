#pragma once
// What nodes on sides of the mesh that act keep, as numbers in a table.

namespace mpm {

/// Numbers that a node of such a side keeps from step to step: the mean normal impulse of a step, which
/// limits friction [N s]; the drift of an absorbing side [m]; its normal and tangential dashpots [kg/s] and
/// springs [N/m], and its static reaction [N], as they were when the side began to absorb; impulse [N s] and
/// work [J] of the side on the soil since the host last took them.
template <int Dim>
struct SideTerms {
  static constexpr int pressing = 0, drift = 1, dashpot = 1 + Dim, spring = 3 + Dim, reaction = 5 + Dim,
                       impulse = 5 + 2 * Dim, work = 5 + 3 * Dim, size = 6 + 3 * Dim;
};

/// Rows of the table of a side normal to direction d: of its nodes, and of those beyond the sides around it.
template <class Cells>
int side_rows(const Cells& cells, int dim, int d) {
  int rows = 1;
  for (int k = 0; k < dim; ++k) rows *= k == d ? 1 : cells[k] + 3;
  return rows;
}

}  // namespace mpm
