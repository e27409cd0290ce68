#pragma once
// The parts of the cells of a grid that are in a shape, and the particles that stand for them.

#include <functional>
#include <vector>

#include "input/geometry/facets.hpp"

namespace mpm {

/// Cells first <= k < last along x, y and up; in 2D there is one cell in y, from 0 to 1.
struct CellGrid {
  Vec3 origin{};    // m, lower corner of cell 0, 0, 0
  double edge = 0;  // m
  int dim = 3;
  std::array<long, 3> first{}, last{};

  long columns() const { return (last[0] - first[0]) * (last[1] - first[1]); }
};

/// The part of a cell that is in a shape.
struct CellPart {
  double volume = 0;  // of the cell's
  Vec3 moment{};      // volume times the centre, in edges from the cell's lower corner
};

/// The parts of a level's cells, by column, x fastest, and the columns, in ascending order, of which they may
/// not be empty.
struct LevelParts {
  std::vector<CellPart> of;
  std::vector<long> columns;

  void clear() {
    for (const long c : columns) of[c] = {};
    columns.clear();
  }
};

/// The cells of a grid level by level, from the lowest one up. What a cell holds is what lies between its
/// floor and the pieces of the surface in it, and is full up to its ceiling under the pieces above: a sum
/// over pieces with the sign of their area. The pieces below a level have, in each column, the opposite area
/// of those above. Work: the number of pairs of a facet and a cell that it cuts, and of cells that hold soil.
class CutCells {
 public:
  /// Both must outlive it.
  CutCells(const Facets& facets, const CellGrid& grid);
  /// The parts of the next level in the place of others; a null pointer passes it over.
  void next(LevelParts* parts);
  long level() const { return level_; }

 private:
  ConvexPiece in_cells(const ConvexPiece& piece) const;
  void take_facets();
  void leave_empty_columns();
  void add_columns(const ConvexPiece& piece, LevelParts* parts);
  /// Calls f(slab, n) for the part of a piece in each slab n of cells along axis d, within the grid.
  template <class F>
  void for_each_slab(const ConvexPiece& piece, int d, const F& f) const;
  void add_cell(const ConvexPiece& piece, long i, long j, LevelParts* parts);

  struct Area {
    double area = 0, x = 0, y = 0;  // and its moments about the column's corner
  };
  const Facets& facets_;
  const CellGrid& grid_;
  long level_;
  std::vector<std::size_t> order_,
      begin_;  // facets by the level of their lowest point, and where each begins
  std::vector<std::size_t> active_;
  std::vector<Area> below_;    // of the pieces below the level's ceiling, by column
  std::vector<long> columns_;  // that hold soil in this level or are cut in it, in ascending order
  std::vector<char> listed_;   // by column: it is in columns_
};

/// A cell whose part is smaller than this gives it to neighbours that hold as much, or to their neighbours: a
/// particle so much lighter than those around it would be thrown about by them.
inline constexpr double k_least_part = 0.125;

/// Bytes that any_cut_particle() needs for a column of the grid: ten levels of parts, and what is below.
inline constexpr double k_column_bytes = 10 * sizeof(CellPart) + 6 + 3 * sizeof(double) + 6 * sizeof(long);

/// Calls visit(x, volume) for the particles of cells of the levels from <= k < to, at the centre [m] of the
/// part that they stand for, volume over a cell's; x fastest, then y. Until visit returns true; returns
/// whether it did. Whatever from and to are, the particles of a level are the same to the bit.
bool any_cut_particle(const Facets& facets, const CellGrid& grid, long from, long to,
                      const std::function<bool(const Vec3&, double)>& visit);

/// A cell that holds less than nothing or more than all of itself, as where a surface overlaps itself [m].
std::optional<Vec3> overfull_cell(const Facets& facets, const CellGrid& grid);

}  // namespace mpm
