#include "input/geometry/cut_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mpm {
namespace {

constexpr double k_round = 1e-9;                       // of a cell: round-off
constexpr double k_tiny = 1.0 / 32, k_nothing = 1e-3;  // of a cell: a small particle; too little for one

}  // namespace

CutCells::CutCells(const Facets& facets, const CellGrid& grid)
    : facets_(facets), grid_(grid), level_(grid.first[2]), below_(grid.columns()), listed_(grid.columns()) {
  const long levels = grid.last[2] - grid.first[2];
  std::vector<long> lowest(facets.size());
  begin_.assign(levels + 2, 0);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const double z = std::floor(in_cells(facets[f]).lowest(2)) - static_cast<double>(grid.first[2]);
    lowest[f] = static_cast<long>(std::clamp(z, 0.0, static_cast<double>(levels)));
    ++begin_[lowest[f] + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  order_.resize(facets.size());
  std::vector<std::size_t> place(begin_.begin(), begin_.end() - 1);
  for (std::size_t f = 0; f < facets.size(); ++f) order_[place[lowest[f]]++] = f;
}

ConvexPiece CutCells::in_cells(const ConvexPiece& piece) const {
  ConvexPiece scaled = piece;
  const int up = grid_.dim - 1;
  for (int v = 0; v < piece.count; ++v) {
    scaled.x[v][0] = (piece.x[v][0] - grid_.origin[0]) / grid_.edge;
    if (grid_.dim == 3) scaled.x[v][1] = (piece.x[v][1] - grid_.origin[1]) / grid_.edge;
    scaled.x[v][2] = (piece.x[v][2] - grid_.origin[up]) / grid_.edge;
  }
  return scaled;
}

/// Takes the facets that begin in this level; their part below the first level counts there.
void CutCells::take_facets() {
  const long at = level_ - grid_.first[2];
  for (std::size_t k = begin_[at]; k < begin_[at + 1]; ++k) {
    active_.push_back(order_[k]);
    if (at > 0) continue;
    ConvexPiece below, above;
    in_cells(facets_[order_[k]]).split(2, static_cast<double>(level_), below, above);
    if (below.count > 0 && below.lowest(2) < static_cast<double>(level_)) add_columns(below, nullptr);
  }
}

/// Ends the columns that no piece below leaves open at the level before.
void CutCells::leave_empty_columns() {
  std::erase_if(columns_, [this](long c) {
    if (std::abs(below_[c].area) > k_round) return false;
    listed_[c] = 0;
    return true;
  });
}

void CutCells::next(LevelParts* parts) {
  if (parts) parts->of.resize(grid_.columns()), parts->clear();
  leave_empty_columns();
  const auto known = static_cast<std::ptrdiff_t>(columns_.size());
  take_facets();
  const auto floor = static_cast<double>(level_), ceiling = floor + 1;
  std::size_t kept = 0;
  for (const std::size_t f : active_) {
    const ConvexPiece facet = in_cells(facets_[f]);
    const double highest = facet.highest(2);
    if (highest >= floor) {
      const ConvexPiece piece = facet.between(2, floor, ceiling);
      if (piece.count > 0) add_columns(piece, parts);
    }
    if (highest > ceiling) active_[kept++] = f;
  }
  active_.resize(kept);
  ++level_;
  std::sort(columns_.begin() + known, columns_.end());
  std::inplace_merge(columns_.begin(), columns_.begin() + known, columns_.end());
  if (!parts) return;
  parts->columns = columns_;
  for (const long c : columns_) {
    CellPart& part = parts->of[c];
    const Area& full = below_[c];
    part.volume -= full.area;
    part.moment[0] -= full.x, part.moment[1] -= full.y, part.moment[2] -= full.area / 2;
  }
}

template <class F>
void CutCells::for_each_slab(const ConvexPiece& piece, int d, const F& f) const {
  const auto first = static_cast<double>(grid_.first[d]), last = static_cast<double>(grid_.last[d]);
  const double low = std::max(piece.lowest(d), first), high = std::min(piece.highest(d), last);
  if (!(low < high)) return;
  ConvexPiece rest = piece, slab, next;
  if (piece.lowest(d) < first) piece.split(d, first, slab, rest);
  for (long n = static_cast<long>(std::floor(low)); rest.count > 0 && static_cast<double>(n) < high; ++n) {
    rest.split(d, static_cast<double>(n + 1), slab, next);
    if (slab.count > 0) f(slab, n);
    rest = next;
  }
}

void CutCells::add_columns(const ConvexPiece& piece, LevelParts* parts) {
  for_each_slab(piece, 0, [&](const ConvexPiece& slab, long i) {
    for_each_slab(slab, 1, [&](const ConvexPiece& cell, long j) { add_cell(cell, i, j, parts); });
  });
}

void CutCells::add_cell(const ConvexPiece& piece, long i, long j, LevelParts* parts) {
  UnderPiece under;
  under.add(piece, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(level_)});
  const long column = (j - grid_.first[1]) * (grid_.last[0] - grid_.first[0]) + i - grid_.first[0];
  if (!listed_[column]) listed_[column] = 1, columns_.push_back(column);
  Area& below = below_[column];
  below.area += under.area, below.x += under.area_x, below.y += under.area_y;
  if (!parts) return;
  CellPart& part = parts->of[column];
  part.volume += under.volume;
  part.moment[0] += under.moment_x, part.moment[1] += under.moment_y, part.moment[2] += under.moment_z;
}

namespace {

/// Levels one above the other, of which the middle one's small parts find their takers.
class Levels {
 public:
  static constexpr long k_reach = 2;  // levels from a small part to its taker
  static constexpr long k_window = 2 * k_reach + 1;

  explicit Levels(const CellGrid& grid)
      : grid_(grid), width_(grid.last[0] - grid.first[0]), rows_(grid.last[1] - grid.first[1]) {
    for (Level& level : levels_)
      level.own.of.resize(grid.columns()), level.taken.resize(grid.columns()),
          level.gone.resize(grid.columns());
  }
  /// The level's parts, of which there are none yet.
  LevelParts& enter(long k) {
    Level& level = at(k);
    for (const long column : level.own.columns) level.taken[column] = {}, level.gone[column] = 0;
    level.own.clear();
    return level.own;
  }
  const std::vector<long>& columns(long k) const { return at(k).own.columns; }
  /// Full cells and empty ones, without round-off.
  void round(long k) {
    for (const long column : columns(k)) {
      CellPart& part = at(k).own.of[column];
      if (std::abs(part.volume - 1) < k_round) part = {1, {0.5, 0.5, 0.5}};
      if (part.volume < k_round) part = {};
    }
  }
  /// Gives the small parts of a level to their takers.
  void join_small(long k);
  /// The part that the particle of a cell stands for.
  CellPart particle(long k, long column) const {
    CellPart part = at(k).taken[column];
    if (!at(k).gone[column]) add(at(k).own.of[column], {}, 1, part);
    return part;
  }

 private:
  struct Level {
    LevelParts own;
    std::vector<CellPart> taken;  // from others, by column
    std::vector<char> gone;       // its own part stands for no particle of its own
  };
  using Cell = std::array<long, 3>;
  Level& at(long k) { return levels_[(k - grid_.first[2] + k_window) % k_window]; }
  const Level& at(long k) const { return levels_[(k - grid_.first[2] + k_window) % k_window]; }
  Cell cell_of(long k, long column) const { return {column % width_, column / width_, k}; }
  const CellPart& own_of(const Cell& cell) const { return at(cell[2]).own.of[cell[1] * width_ + cell[0]]; }
  /// Whether a cell holds as much as `least`, up to round-off: images in a symmetric shape must both hold it.
  bool holds(const Cell& cell, double least) const { return own_of(cell).volume >= least - k_round; }
  std::vector<Cell> largest_neighbours(const Cell& cell) const;
  std::vector<Cell> takers_of(const Cell& cell) const;
  static void add(const CellPart& part, const Cell& offset, double share, CellPart& to) {
    to.volume += share * part.volume;
    for (int d = 0; d < 3; ++d)
      to.moment[d] += share * (part.moment[d] + static_cast<double>(offset[d]) * part.volume);
  }

  const CellGrid& grid_;
  long width_, rows_;
  Level levels_[k_window];
};

/// The cells that hold most among those that touch a cell, if that is more than it holds; else the cell.
/// Several are equal up to round-off where the shape is symmetric.
std::vector<Levels::Cell> Levels::largest_neighbours(const Cell& cell) const {
  double most = 0;
  const auto for_each_neighbour = [&](auto&& f) {
    for (long k = cell[2] - 1; k <= cell[2] + 1; ++k)
      for (long j = std::max(cell[1] - 1, 0L); j <= std::min(cell[1] + 1, rows_ - 1); ++j)
        for (long i = std::max(cell[0] - 1, 0L); i <= std::min(cell[0] + 1, width_ - 1); ++i)
          f(Cell{i, j, k});
  };
  for_each_neighbour([&](const Cell& near) { most = std::max(most, own_of(near).volume); });
  if (holds(cell, most)) return {cell};
  std::vector<Cell> largest;
  for_each_neighbour([&](const Cell& near) {
    if (holds(near, most)) largest.push_back(near);
  });
  return largest;
}

/// The cells that share a small part equally, so that a symmetric shape has symmetric particles: cells of
/// k_least_part or more that are neighbours, or neighbours of the largest neighbours; a cell counts as often
/// as it is found. If there is none, a tiny part goes where there is more, and others stay.
std::vector<Levels::Cell> Levels::takers_of(const Cell& cell) const {
  const std::vector<Cell> next = largest_neighbours(cell);
  if (holds(next.front(), k_least_part) || next.front() == cell) return next;
  std::vector<Cell> last, large;
  for (const Cell& neighbour : next) {
    const std::vector<Cell> found = largest_neighbours(neighbour);
    last.insert(last.end(), found.begin(), found.end());
    if (holds(found.front(), k_least_part)) large.insert(large.end(), found.begin(), found.end());
  }
  if (!large.empty()) return large;
  if (holds(cell, k_tiny)) return {cell};
  return holds(next.front(), k_tiny) ? next : last;
}

void Levels::join_small(long k) {
  for (const long column : columns(k)) {
    const CellPart& part = at(k).own.of[column];
    const Cell here = cell_of(k, column);
    if (part.volume == 0 || holds(here, k_least_part)) continue;
    const std::vector<Cell> takers = takers_of(here);
    at(k).gone[column] = takers.front() != here;
    if (takers.front() == here) continue;
    for (const Cell& to : takers)
      add(part, {here[0] - to[0], here[1] - to[1], here[2] - to[2]}, 1.0 / static_cast<double>(takers.size()),
          at(to[2]).taken[to[1] * width_ + to[0]]);
  }
}

}  // namespace

bool any_cut_particle(const Facets& facets, const CellGrid& grid, long from, long to,
                      const std::function<bool(const Vec3&, double)>& visit) {
  constexpr long k_reach = Levels::k_reach;
  CutCells cells(facets, grid);
  Levels levels(grid);
  const long width = grid.last[0] - grid.first[0];
  // A level takes parts of two levels above and below it, whose takers depend on two more.
  for (long k = grid.first[2]; k < to + 2 * k_reach; ++k) {
    const bool near = k >= from - 2 * k_reach;
    LevelParts* const own = near ? &levels.enter(k) : nullptr;
    if (k < grid.last[2]) cells.next(own);
    if (near) levels.round(k);
    if (const long middle = k - k_reach; middle >= grid.first[2] && middle >= from - k_reach)
      levels.join_small(middle);
    const long done = k - 2 * k_reach;
    if (done < from || done >= to) continue;
    for (const long column : levels.columns(done)) {
      const CellPart part = levels.particle(done, column);
      if (part.volume < k_nothing) continue;
      Vec3 x{};
      const std::array<long, 3> cell{column % width + grid.first[0], column / width + grid.first[1], done};
      for (int d = 0; d < 3; ++d)
        x[d] = grid.origin[d] + (static_cast<double>(cell[d]) + part.moment[d] / part.volume) * grid.edge;
      if (grid.dim == 2)
        x[1] = grid.origin[1] + (static_cast<double>(done) + part.moment[2] / part.volume) * grid.edge,
        x[2] = 0;
      if (visit(x, part.volume)) return true;
    }
  }
  return false;
}

std::optional<Vec3> overfull_cell(const Facets& facets, const CellGrid& grid) {
  constexpr double k_slack = 1e-6;
  CutCells cells(facets, grid);
  LevelParts parts;
  const long width = grid.last[0] - grid.first[0];
  for (long k = grid.first[2]; k < grid.last[2]; ++k) {
    cells.next(&parts);
    for (const long column : parts.columns) {
      const double volume = parts.of[column].volume;
      if (volume > -k_slack && volume < 1 + k_slack) continue;
      Vec3 x;
      const std::array<long, 3> cell{column % width + grid.first[0], column / width + grid.first[1], k};
      for (int d = 0; d < 3; ++d) x[d] = grid.origin[d] + (static_cast<double>(cell[d]) + 0.5) * grid.edge;
      if (grid.dim == 2) x[1] = grid.origin[1] + (static_cast<double>(k) + 0.5) * grid.edge, x[2] = 0;
      return x;
    }
  }
  return std::nullopt;
}

}  // namespace mpm
