#include "input/cut_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mpm {
namespace {

constexpr double k_round = 1e-9;    // of a cell: round-off
constexpr double k_nothing = 1e-3;  // of a cell: too little for a particle where no neighbour takes it

}  // namespace

CutCells::CutCells(const Facets& facets, const CellGrid& grid)
    : facets_(facets), grid_(grid), level_(grid.first[2]), below_(grid.columns()) {
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

/// Those that begin in this level; what of them is below the first one counts there.
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

void CutCells::next(std::vector<CellPart>* parts) {
  if (parts) parts->assign(grid_.columns(), {});
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
  if (!parts) return;
  for (std::size_t c = 0; c < parts->size(); ++c) {
    CellPart& part = (*parts)[c];
    const Area& full = below_[c];
    part.volume -= full.area;
    part.moment[0] -= full.x, part.moment[1] -= full.y, part.moment[2] -= full.area / 2;
  }
}

void CutCells::add_columns(const ConvexPiece& piece, std::vector<CellPart>* parts) {
  const auto first = static_cast<double>(grid_.first[0]), last = static_cast<double>(grid_.last[0]);
  const double low = std::max(piece.lowest(0), first), high = std::min(piece.highest(0), last);
  if (!(low < high)) return;
  ConvexPiece rest = piece, strip, next;
  if (piece.lowest(0) < first) piece.split(0, first, strip, rest);
  for (long i = static_cast<long>(std::floor(low)); rest.count > 0 && static_cast<double>(i) < high; ++i) {
    rest.split(0, static_cast<double>(i + 1), strip, next);
    if (strip.count > 0) add_row(strip, i, parts);
    rest = next;
  }
}

void CutCells::add_row(const ConvexPiece& strip, long i, std::vector<CellPart>* parts) {
  const auto first = static_cast<double>(grid_.first[1]), last = static_cast<double>(grid_.last[1]);
  const double low = std::max(strip.lowest(1), first), high = std::min(strip.highest(1), last);
  if (!(low < high)) return;
  ConvexPiece rest = strip, cell, next;
  if (strip.lowest(1) < first) strip.split(1, first, cell, rest);
  for (long j = static_cast<long>(std::floor(low)); rest.count > 0 && static_cast<double>(j) < high; ++j) {
    rest.split(1, static_cast<double>(j + 1), cell, next);
    if (cell.count > 0) add_cell(cell, i, j, parts);
    rest = next;
  }
}

void CutCells::add_cell(const ConvexPiece& piece, long i, long j, std::vector<CellPart>* parts) {
  UnderPiece under;
  under.add(piece, {static_cast<double>(i), static_cast<double>(j), static_cast<double>(level_)});
  const long column = (j - grid_.first[1]) * (grid_.last[0] - grid_.first[0]) + i - grid_.first[0];
  Area& below = below_[column];
  below.area += under.area, below.x += under.area_x, below.y += under.area_y;
  if (!parts) return;
  CellPart& part = (*parts)[column];
  part.volume += under.volume;
  part.moment[0] += under.moment_x, part.moment[1] += under.moment_y, part.moment[2] += under.moment_z;
}

namespace {

/// Three levels one above the other, of which the middle one's small parts find their takers.
class Levels {
 public:
  explicit Levels(const CellGrid& grid) : grid_(grid), width_(grid.last[0] - grid.first[0]) {
    for (Level& level : levels_) level.own.resize(grid.columns()), level.taken.resize(grid.columns());
  }
  std::vector<CellPart>& enter(long k) {
    Level& level = at(k);
    std::fill(level.own.begin(), level.own.end(), CellPart{});
    std::fill(level.taken.begin(), level.taken.end(), CellPart{});
    return level.own;
  }
  /// Full cells and empty ones, without round-off.
  void round(long k) {
    for (CellPart& part : at(k).own) {
      if (std::abs(part.volume - 1) < k_round) part = {1, {0.5, 0.5, 0.5}};
      if (part.volume < k_round) part = {};
    }
  }
  void join_small(long k);
  /// The part that the particle of a cell stands for.
  CellPart particle(long k, long column) const {
    const Level& level = levels_[(k - grid_.first[2] + 3) % 3];
    CellPart part = level.own[column];
    add(level.taken[column], {0, 0, 0}, part);
    return part;
  }

 private:
  struct Level {
    std::vector<CellPart> own, taken;  // by column; taken from neighbours
  };
  Level& at(long k) { return levels_[(k - grid_.first[2] + 3) % 3]; }
  static void add(const CellPart& part, const std::array<int, 3>& offset, CellPart& to) {
    to.volume += part.volume;
    for (int d = 0; d < 3; ++d) to.moment[d] += part.moment[d] + offset[d] * part.volume;
  }

  const CellGrid& grid_;
  long width_;
  Level levels_[3];
};

void Levels::join_small(long k) {
  constexpr std::array<int, 3> k_ways[] = {{0, 0, -1}, {0, 0, 1},  {-1, 0, 0},
                                           {1, 0, 0},  {0, -1, 0}, {0, 1, 0}};
  const long rows = grid_.last[1] - grid_.first[1];
  for (long column = 0; column < grid_.columns(); ++column) {
    CellPart& part = at(k).own[column];
    if (part.volume == 0 || part.volume >= k_least_part) continue;
    const long i = column % width_, j = column / width_;
    double most = k_least_part;
    const std::array<int, 3>* taker = nullptr;
    for (const auto& way : k_ways) {
      const long a = i + way[0], b = j + way[1];
      if (a < 0 || a >= width_ || b < 0 || b >= rows) continue;
      const double volume = at(k + way[2]).own[b * width_ + a].volume;
      if (volume >= most && (volume > most || !taker)) most = volume, taker = &way;
    }
    if (taker) {
      const long to = (j + (*taker)[1]) * width_ + i + (*taker)[0];
      add(part, {-(*taker)[0], -(*taker)[1], -(*taker)[2]}, at(k + (*taker)[2]).taken[to]);
    }
    if (taker || part.volume < k_nothing)
      part.volume = -part.volume;  // marked: others still see no taker in it
  }
  for (CellPart& part : at(k).own)
    if (part.volume < 0) part = {};
}

}  // namespace

bool any_cut_particle(const Facets& facets, const CellGrid& grid, long from, long to,
                      const std::function<bool(const Vec3&, double)>& visit) {
  CutCells cells(facets, grid);
  Levels levels(grid);
  const long width = grid.last[0] - grid.first[0];
  std::vector<CellPart> none;
  for (long k = grid.first[2]; k < to + 2; ++k) {
    const bool near = k >= from - 2;
    if (near) levels.enter(k);
    if (k < grid.last[2]) cells.next(near ? &levels.enter(k) : nullptr);
    if (near) levels.round(k);
    if (k - 1 >= grid.first[2] && k - 1 >= from - 1) levels.join_small(k - 1);
    const long done = k - 2;
    if (done < from || done >= to) continue;
    for (long column = 0; column < grid.columns(); ++column) {
      const CellPart part = levels.particle(done, column);
      if (part.volume == 0) continue;
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
  std::vector<CellPart> parts;
  const long width = grid.last[0] - grid.first[0];
  for (long k = grid.first[2]; k < grid.last[2]; ++k) {
    cells.next(&parts);
    for (std::size_t c = 0; c < parts.size(); ++c) {
      if (parts[c].volume > -k_slack && parts[c].volume < 1 + k_slack) continue;
      const long column = static_cast<long>(c);
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
