#pragma once
// Terms of the columns beside a side of the mesh (Wall::free_field), as numbers in a table: a row for each
// node of the side. Nodes of the side that lie over one another form a column.

namespace mpm {

/// The vertical axis, along which columns stand.
template <int Dim>
inline constexpr int k_vertical = Dim - 1;

/// A column is elastic ground that varies with the height alone, computed as the soil of the run is: by its
/// particles as they were when the side began, with their weights then. Their terms are summed to matrices
/// between the rows: the element (i, j) is number j - i + `reach` of its band in row i. Each matrix exists
/// twice: number 0 for movement along the vertical, number 1 for movement along the level.
template <int Dim>
struct ColumnTerms {
  static constexpr int reach = 3, band = 2 * reach + 1, matrix = 2 * band;
  /// Terms that change in a step: velocity before the step and displacement [m/s, m]; velocity after it and
  /// acceleration [m/s, m/s2], walls at its ends included; the force of its stress on the side [N]; how far a
  /// base with springs has drifted [m]; what XPIC has left of the velocity [m/s].
  static constexpr int velocity = 0, displacement = Dim, after = 2 * Dim, acceleration = 3 * Dim,
                       traction = 4 * Dim, drift = 5 * Dim, residual = 6 * Dim, changing = 8 * Dim;
  /// Terms that the column takes from the soil when the side begins: mass [kg], which is 0 where the row has
  /// no soil or moves as the row below; the gravity then [m/s2]; dashpot [kg/s] and spring [N/m] of an
  /// absorbing end, normal and tangential. Matrices: force on the rows by their displacement [N/m]; mass
  /// times what the particles carry from the nodes to the nodes [kg]; force on the side by the displacement
  /// [N/m].
  static constexpr int mass = changing, gravity = mass + 1, dashpot = gravity + Dim, spring = dashpot + 2,
                       stiffness = spring + 2, inertia = stiffness + matrix, pull = inertia + matrix,
                       size = pull + matrix;
};

}  // namespace mpm
