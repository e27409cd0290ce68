#pragma once
// Terms of the nodes on sides of the mesh that act, as numbers in a table.

#include "data/impulse_terms.hpp"

namespace mpm {

/// Numbers that a node of such a side keeps from step to step: what friction keeps of normal impulses, as
/// ImpulseTerms; the drift of an absorbing side [m]; its normal and tangential dashpots [kg/s] and springs
/// [N/m], and its static reaction [N], as they were when the side began to absorb; in the place of the
/// reaction, for a side with friction, the part of the normal impulse of the step that the water in the pores
/// carries [N s]; impulse [N s] and work [J] of the side on the soil since the host last took them.
template <int Dim>
struct SideTerms {
  static constexpr int pressed = 0, drift = ImpulseTerms::size, dashpot = drift + Dim, spring = dashpot + 2,
                       reaction = spring + 2, carried = reaction, impulse = reaction + Dim,
                       work = impulse + Dim, size = work + 1;
};

/// Rows of the table of a side normal to direction d: of its nodes, and of those beyond the sides around it.
template <class Cells>
int side_rows(const Cells& cells, int dim, int d) {
  int rows = 1;
  for (int k = 0; k < dim; ++k) rows *= k == d ? 1 : cells[k] + 3;
  return rows;
}

}  // namespace mpm
