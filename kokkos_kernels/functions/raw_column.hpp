#pragma once
// A column of the free field while it is made from the sums of particles, on the host.

#include <algorithm>
#include <vector>

#include "data/column_terms.hpp"

namespace mpm {

inline constexpr int k_rows_reached = 4;  // rows that the particles of a cell reach, from the one below it on

/// Sums of the rows of columns, with gradients per cell: mass, and the matrices of ColumnTerms. The stiffness
/// by the mean dilatation of a cell (F-bar) is a product of two sums over the cell's particles. The row of
/// the cell's lower node keeps them: the volume; the volume times the gradient of each row; and, with the
/// part of the bulk modulus that acts on the mean, the force of each row and the force on the side.
template <int Dim>
struct ColumnSum {
  using C = ColumnTerms<Dim>;
  static constexpr int mass = 0, stiffness = 1, inertia = stiffness + C::matrix, pull = inertia + C::matrix,
                       volume = pull + C::matrix, dilatation = volume + 1,
                       pressed = dilatation + k_rows_reached, pressing = pressed + k_rows_reached,
                       size = pressing + k_rows_reached;
};

/// The rows of a column while it is made from sums.
template <int Dim>
struct RawColumn {
  using C = ColumnTerms<Dim>;
  using S = ColumnSum<Dim>;
  std::vector<std::vector<double>> sums;  // [row][ColumnSum], in kg, m3, N/m; gradients by cells

  double* element(int i, int j, int matrix) {
    const int place = j - i + C::reach, rows = static_cast<int>(sums.size());
    return i < 0 || i >= rows || j < 0 || j >= rows || place < 0 || place >= C::band
               ? nullptr
               : &sums[i][matrix + place];
  }
  void add(int i, int j, int matrix, double value) {
    if (double* const to = element(i, j, matrix)) *to += value;
  }
  /// Adds the part of the mean dilatations of cells to the stiffness and to the force on the side.
  void add_means() {
    for (int c = 0; c < static_cast<int>(sums.size()); ++c) {
      const std::vector<double> of = sums[c];
      for (int i = 0; i < k_rows_reached && of[S::volume] > 0; ++i)
        for (int j = 0; j < k_rows_reached; ++j) {
          const double mean = of[S::dilatation + j] / of[S::volume];
          add(c - 1 + i, c - 1 + j, S::stiffness, of[S::pressed + i] * mean);
          add(c - 1 + i, c - 1 + j, S::pull, of[S::pressing + i] * mean);
        }
    }
  }
  /// A row with so little soil that round-off would decide how stiff it is moves as the row below, and gives
  /// it all that it has.
  void tie_light_rows() {
    constexpr double k_light = 1e-6;  // of the heaviest row
    double heaviest = 0;
    for (const auto& row : sums) heaviest = std::max(heaviest, row[S::mass]);
    const int rows = static_cast<int>(sums.size());
    for (int r = 1; r < rows; ++r) {
      if (sums[r][S::mass] > k_light * heaviest || !(sums[r - 1][S::mass] > k_light * heaviest)) continue;
      sums[r - 1][S::mass] += sums[r][S::mass];
      for (int matrix = S::stiffness; matrix < S::volume; matrix += C::band) {
        for (int j = 0; j < rows; ++j) move(r, j, r - 1, j, matrix);
        for (int i = 0; i < rows; ++i) move(i, r, i, r - 1, matrix);
      }
    }
    for (auto& row : sums)
      if (!(row[S::mass] > k_light * heaviest)) row[S::mass] = 0;
  }

 private:
  void move(int i, int j, int to_i, int to_j, int matrix) {
    double* const from = element(i, j, matrix);
    if (from == nullptr) return;
    add(to_i, to_j, matrix, *from);
    *from = 0;
  }
};

}  // namespace mpm
