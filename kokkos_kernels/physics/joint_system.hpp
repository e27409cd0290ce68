#pragma once
// The linear system of the impulses of joints: J M^-1 J^T, symmetric, one row a condition.

#include "physics/joint_rows.hpp"

namespace mpm {

/// Factors and solves the system of the active rows as L D L^T, by rows from the first column where they
/// hold something: conditions of bodies that no joint connects have nothing in common, so each connected set
/// is a system of its own. A row that follows from the rows before it, as in a closed loop of joints, is left
/// out: its impulse is 0.
template <int Dim>
struct JointSystem {
  const JointRow<Dim>* rows;
  int count;
  double* matrix;  // [count count]: below the diagonal L, on it 1 / D
  int* first;      // [count]

  KOKKOS_INLINE_FUNCTION double& at(int i, int j) const { return matrix[i * count + j]; }

  /// Velocity of the error of row i that an impulse of 1 along row j gives.
  KOKKOS_INLINE_FUNCTION static double answer(const JointRow<Dim>& i, const JointRow<Dim>& j) {
    double sum = 0;
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b) {
        if (i.body[a] != j.body[b] || i.body[a] == Joint<Dim>::k_ground) continue;
        double part = 0;
        for (int d = 0; d < Dim; ++d) part += i.direction[d] * j.velocity[b][d];
        for (int k = 0; k < k_turning_axes<Dim>; ++k) part += i.moment[a][k] * j.spin[b][k];
        sum += a == b ? part : -part;
      }
    return sum;
  }
  KOKKOS_INLINE_FUNCTION static bool connected(const JointRow<Dim>& i, const JointRow<Dim>& j) {
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b)
        if (i.body[a] == j.body[b] && i.body[a] != Joint<Dim>::k_ground) return true;
    return false;
  }

  KOKKOS_INLINE_FUNCTION void factor() const {
    constexpr double k_least = 1e-11;  // pivot over the row's own mobility, below which others imply the row
    for (int i = 0; i < count; ++i) {
      first[i] = 0;
      while (first[i] < i && !connected(rows[i], rows[first[i]])) ++first[i];
      double pivot = answer(rows[i], rows[i]);
      const double least = k_least * pivot;
      for (int j = first[i]; j < i; ++j) {
        double sum = answer(rows[i], rows[j]);
        for (int k = Kokkos::max(first[i], first[j]); k < j; ++k) sum -= at(i, k) * at(j, k);
        at(i, j) = sum;  // L D
      }
      for (int j = first[i]; j < i; ++j) {
        const double own = at(i, j) * at(j, j);
        pivot -= own * at(i, j);
        at(i, j) = own;
      }
      at(i, i) = rows[i].active && pivot > least ? 1 / pivot : 0;
    }
  }

  /// x: the right-hand side, then the solution.
  KOKKOS_INLINE_FUNCTION void solve(double* x) const {
    for (int i = 0; i < count; ++i)
      for (int j = first[i]; j < i; ++j) x[i] -= at(i, j) * x[j];
    for (int i = 0; i < count; ++i) x[i] *= at(i, i);
    for (int i = count - 1; i >= 0; --i)
      for (int j = first[i]; j < i; ++j) x[j] -= at(i, j) * x[i];
  }
};

/// Velocity of the error of a row [m/s, rad/s], less that of the ground's end.
template <int Dim>
KOKKOS_INLINE_FUNCTION double velocity_of(const JointRow<Dim>& row, const Rigid<Dim>* rigids) {
  double sum = 0;
  for (int side = 0; side < 2; ++side) {
    if (row.body[side] == Joint<Dim>::k_ground) continue;
    const RigidMotion<Dim>& motion = rigids[row.body[side]].motion;
    double part = 0;
    for (int d = 0; d < Dim; ++d) part += row.direction[d] * motion.velocity[d];
    for (int k = 0; k < k_turning_axes<Dim>; ++k) part += row.moment[side][k] * motion.spin[k];
    sum += side == 0 ? part : -part;
  }
  return sum;
}

/// Acts on the bodies of a row with an impulse [N s, N m s] along it.
template <int Dim>
KOKKOS_INLINE_FUNCTION void push_along(const JointRow<Dim>& row, double impulse, Rigid<Dim>* rigids) {
  for (int side = 0; side < 2; ++side) {
    if (row.body[side] == Joint<Dim>::k_ground) continue;
    const double own = side == 0 ? impulse : -impulse;
    Vector<double, Dim> force;
    AngularVector<Dim> moment;
    for (int d = 0; d < Dim; ++d) force[d] = own * row.direction[d];
    for (int k = 0; k < k_turning_axes<Dim>; ++k) moment[k] = own * row.moment[side][k];
    push(rigids[row.body[side]], force, moment);
  }
}

}  // namespace mpm
