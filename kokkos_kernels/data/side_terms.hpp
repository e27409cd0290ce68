#pragma once
// What nodes on sides of the mesh that act keep, as numbers in a table.

namespace mpm {

/// What a node of such a side keeps from step to step. Till `dashpot`: the mean normal impulse of a step, which
/// limits friction [N s], and how far an absorbing side has drifted [m]. What an absorbing side takes from the soil
/// when it begins: normal and tangential dashpot [kg/s] and spring [N/m], and the static reaction [N]. Since
/// the host last took them: impulse [N s] and work [J] of the side on the soil.
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
