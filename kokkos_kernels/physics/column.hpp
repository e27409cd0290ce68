#pragma once
// A column of the free field beside a side of the mesh: elastic ground that varies with the height alone. Its
// rows move as nodes of the run do, by the same formulas (docs/boundaries.md).

#include "physics/sides.hpp"

namespace mpm {

/// The rows of a column over one another, number r of the node r - 1 along the vertical.
template <int Dim>
struct Column {
  double* first;
  long stride;  // numbers from row to row
  int rows;

  KOKKOS_INLINE_FUNCTION double* row(int r) const { return first + r * stride; }
  /// Row r of a matrix times what all rows have of a value.
  KOKKOS_INLINE_FUNCTION double product(int r, int matrix, int value) const {
    constexpr int reach = ColumnTerms<Dim>::reach;
    const double* const of = row(r) + matrix + reach;
    double sum = 0;
    for (int k = -reach; k <= reach; ++k)
      if (r + k >= 0 && r + k < rows) sum += of[k] * row(r + k)[value];
    return sum;
  }
  KOKKOS_INLINE_FUNCTION bool has_soil(int r) const { return row(r)[ColumnTerms<Dim>::mass] > 0; }
};

/// Number of a matrix for movement along k.
template <int Dim>
KOKKOS_INLINE_FUNCTION int matrix_along(int first, int k) {
  return first + (k == k_vertical<Dim> ? 0 : ColumnTerms<Dim>::band);
}

/// A step of the columns of a side normal to direction d.
template <class T, int Dim>
struct ColumnStep {
  using C = ColumnTerms<Dim>;
  static constexpr int vertical = k_vertical<Dim>;
  Wall ends[2];                   // of the mesh, along the vertical
  const Side<Dim>* sides;         // of the mesh, those that act
  Vector<double, Dim> g;          // m/s2
  const Vector<T, Dim>* timed_g;  // of the present step, where gravity follows a table; else null
  double dt, change;              // s, length of the step; time over which it changes velocities
  double flip, damping, still;    // -, -, -: k_still
  double mass_cut;                // kg, as of nodes
  int xpic;                       // m of XPIC(m), 0 without it
  bool affine;                    // APIC
  int d;

  /// Velocity of a row after the step, and the force of the column on the side.
  KOKKOS_INLINE_FUNCTION void accelerate(const Column<Dim>& column, int r) const {
    double* const row = column.row(r);
    double v[Dim], v_old[Dim], a[Dim], brake[Dim];
    const double inv_m = row[C::mass] > mass_cut ? 1 / row[C::mass] : 0;
    for (int k = 0; k < Dim; ++k) {
      v_old[k] = row[C::velocity + k], brake[k] = 0;
      const double force = -column.product(r, matrix_along<Dim>(C::stiffness, k), C::displacement + k),
                   weight = (timed_g == nullptr ? g[k] : double((*timed_g)[k])) - row[C::gravity + k];
      a[k] = force * inv_m + weight;
    }
    for (int pass = damping > 0 ? 0 : 1; pass < 2; ++pass) {  // as at the nodes beside it, a rehearsal first
      for (int k = 0; k < Dim; ++k) v[k] = v_old[k] + (a[k] - brake[k]) * change;
      if (r == 1) hold_end(0, row, v, pass == 1);
      if (r == column.rows - 2) hold_end(1, row, v, pass == 1);
      for (int k = 0; k < Dim && pass == 0; ++k) {
        const double size = Kokkos::fabs(v[k] - v_old[k]);
        if (Kokkos::fabs(v_old[k]) > still * size)
          brake[k] = damping * size / change * (v_old[k] > 0 ? 1 : -1);
      }
    }
    for (int k = 0; k < Dim; ++k) {
      row[C::after + k] = v[k];
      row[C::acceleration + k] = (v[k] - v_old[k]) / dt;
      row[C::traction + k] = 0;
    }
    row[C::traction + d] = column.product(r, C::pull, C::displacement + vertical);
    row[C::traction + vertical] = column.product(r, C::pull + C::band, C::displacement + d);
  }

  /// A row without soil moves as the row below.
  KOKKOS_INLINE_FUNCTION void follow(const Column<Dim>& column, int r) const {
    const bool any = r > 0 && column.has_soil(r - 1);
    for (int k = 0; k < Dim; ++k) column.row(r)[C::after + k] = any ? column.row(r - 1)[C::after + k] : 0;
  }

  /// Residual of the velocities after pass `pass` of XPIC; the first pass takes them all.
  KOKKOS_INLINE_FUNCTION void filter(const Column<Dim>& column, int r, int pass) const {
    const int from = pass == 0 ? C::velocity : left_behind(pass - 1), to = left_behind(pass);
    for (int k = 0; k < Dim; ++k)
      column.row(r)[to + k] = column.row(r)[from + k] - to_particles_and_back(column, r, from, k);
  }
  /// Where that lies.
  KOKKOS_INLINE_FUNCTION static int left_behind(int pass) { return C::residual + pass % 2 * Dim; }

  /// Velocity before the next step, as -velocity_update has it, and displacement.
  KOKKOS_INLINE_FUNCTION void move(const Column<Dim>& column, int r) const {
    double* const row = column.row(r);
    for (int k = 0; k < Dim; ++k) {
      double& v = row[C::velocity + k];
      const double kept = affine || xpic > 0 ? 1 : flip;
      const double after = kept < 1 || affine ? to_particles_and_back(column, r, C::after, k) : 0;
      if (affine) {
        v = after;
      } else {
        if (xpic > 0) v -= (1 - flip) * row[left_behind(xpic - 1) + k];
        v = kept * (v + dt * to_particles_and_back(column, r, C::acceleration, k)) + (1 - kept) * after;
      }
      row[C::displacement + k] += dt * row[C::after + k];
    }
  }

 private:
  /// Applies the constraints of a side at an end of the column to the velocity of its last row. keeps: the
  /// step itself, else the trial pass for damping.
  KOKKOS_INLINE_FUNCTION void hold_end(int upper, double* row, double* v, bool keeps) const {
    const Wall kind = ends[upper];
    const Side<Dim>& side = sides[2 * vertical + upper];
    for (int k = 0; k < Dim && kind == Wall::absorbing; ++k) {
      const int along = k == vertical ? 0 : 1;
      const Dashpot by(row[C::dashpot + along], row[C::spring + along], row[C::drift + k], change,
                       row[C::mass], side.velocity[k]);
      const double viscous = keeps ? by.a : 0;
      v[k] = (v[k] + viscous * by.to - by.pull) / (1 + viscous);
      if (keeps) row[C::drift + k] += change * (v[k] - by.to);
    }
    for (int k = 0; k < Dim; ++k) {
      const bool all = kind == Wall::fixed || (kind == Wall::driven && side.holds_all);
      if (all || ((kind == Wall::roller || kind == Wall::driven) && k == vertical))
        v[k] = kind == Wall::driven ? side.velocity[k] : 0;
    }
  }
  KOKKOS_INLINE_FUNCTION double to_particles_and_back(const Column<Dim>& column, int r, int value,
                                                      int k) const {
    return column.product(r, matrix_along<Dim>(C::inertia, k), value + k) / column.row(r)[C::mass];
  }
};

}  // namespace mpm
