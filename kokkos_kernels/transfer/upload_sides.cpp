#include "transfer/upload_sides.hpp"

#include <algorithm>
#include <cmath>

#include "base/copy.hpp"
#include "physics/walls.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void upload_sides(State<Space, T, Dim>& s, const GridInput& grid, const std::vector<SideInput>& sides,
                  double density) {
  s.sides = {};
  if (sides.empty()) return;
  int rows = 0, column_rows = 0;
  for (const SideInput& in : sides) {
    const int n = 2 * in.direction + in.side;
    Side<Dim>& side = s.sides.host[n];
    side.kind = grid.walls[in.direction][in.side];
    side.holds_all = in.holds_all;
    for (int d = 0; d < Dim; ++d) side.velocity[d] = in.velocity[d];
    side.numbers = in.numbers;
    side.face = std::pow(grid.spacing, Dim - 1);
    side.unit_mass = density * side.face * grid.spacing / 2;
    side.first = rows;
    for (int d = 0, step = 1; d < Dim; ++d) {
      if (d == in.direction) continue;
      side.step[d] = step;
      step *= grid.cells[d] + 3;
    }
    side.first_column = column_rows;
    rows += side_rows(grid.cells, Dim, in.direction);
    if (side.kind == Wall::free_field) column_rows += side_rows(grid.cells, Dim, in.direction);
    s.sides.mask |= 1u << n;
    if (has_dashpots(side.kind)) s.sides.unknown |= 1u << n;
    s.sides.held[n] = s.sides.mirrored[n] = 1u << in.direction;
  }
  s.sides.all = decltype(s.sides.all)("mpm::sides", 2 * Dim);
  const auto host = Kokkos::create_mirror_view(s.sides.all);
  for (int n = 0; n < 2 * Dim; ++n) host(n) = s.sides.host[n];
  copy(s.sides.all, host);
  s.sides.nodes = decltype(s.sides.nodes)("mpm::side_nodes", rows);
  if (column_rows > 0) s.sides.columns = decltype(s.sides.columns)("mpm::columns", column_rows);
}

template <class Space, class T, int Dim>
SideWork take_side_work(const State<Space, T, Dim>& s) {
  using S = SideTerms<Dim>;
  SideWork done;
  if (!s.sides.in_use()) return done;
  s.space.fence("mpm::take_side_work");
  const auto table = mirror_of(s.sides.nodes);
  for (int n = 0; n < 2 * Dim; ++n) {
    if (!(s.sides.mask >> n & 1u)) continue;
    const int first = s.sides.host[n].first;
    for (int row = first; row < first + side_rows(s.grid.cells, Dim, n / 2); ++row) {
      for (int k = 0; k < Dim; ++k) done.impulse[n / 2][n % 2][k] -= table(row, S::impulse + k);
      done.work += table(row, S::work);
      for (int k = 0; k < Dim; ++k) table(row, S::impulse + k) = 0;
      table(row, S::work) = 0;
    }
  }
  copy(s.sides.nodes, table);
  return done;
}

template <class Space, class T, int Dim>
std::vector<int> own_side_rows(const State<Space, T, Dim>& s) {
  std::vector<int> own(s.sides.nodes.extent(0), s.owned_nodes.extent(0) == 0);
  const auto owned = mirror_of(s.owned_nodes);
  const auto origin = mirror_of(s.patches.origin);
  for (int i = 0; owned.extent(0) > 0 && i < s.patches.node_count(); ++i) {
    if (!(owned(i / Patch<Dim>::cells) >> (i % Patch<Dim>::cells) & 1)) continue;
    Coord<Dim> at = coord_of<Dim>(i);
    bool inside = true;
    for (int d = 0; d < Dim; ++d) {
      at[d] += origin(i / Patch<Dim>::cells)[d];
      inside = inside && at[d] >= -1 && at[d] <= s.grid.cells[d] + 1;
    }
    const unsigned sides = sides_of(s.grid, at) & s.sides.mask;
    for (int n = 0; n < 2 * Dim && inside; ++n) {
      // The node beyond the side has the same row, and may be another rank's.
      const bool on = at[n / 2] == (n % 2 == 0 ? 0 : s.grid.cells[n / 2]);
      if (on && (sides >> n & 1u)) own[s.sides.host[n].row(at)] = 1;
    }
  }
  return own;
}

template <class Space, class T, int Dim>
std::vector<double> side_table(const State<Space, T, Dim>& s) {
  if (!s.sides.in_use()) return {};
  s.space.fence("mpm::side_table");
  const auto table = mirror_of(s.sides.nodes);
  return {table.data(), table.data() + table.size()};
}

template <class Space, class T, int Dim>
std::vector<double> column_table(const State<Space, T, Dim>& s) {
  if (!s.sides.has_columns()) return {};
  s.space.fence("mpm::column_table");
  const auto table = mirror_of(s.sides.columns);
  return {table.data(), table.data() + table.size()};
}

template <class Space, class T, int Dim>
void put_column_table(State<Space, T, Dim>& s, const std::vector<double>& values) {
  if (!s.sides.has_columns()) return;
  const auto table = Kokkos::create_mirror_view(s.sides.columns);
  std::copy(values.begin(), values.end(), table.data());
  copy(s.sides.columns, table);
}

template <class Space, class T, int Dim>
std::vector<double> share_of_side_table(const State<Space, T, Dim>& s, const std::vector<int>& own,
                                        bool first) {
  using S = SideTerms<Dim>;
  std::vector<double> values = side_table(s);
  for (std::size_t row = 0; row < own.size(); ++row) {
    double* const of = &values[row * S::size];
    for (int k = 0; k < S::impulse; ++k) {
      const bool alike = k >= S::dashpot && k < S::reaction;
      if (!(alike ? first : own[row] != 0)) of[k] = 0;
    }
  }
  return values;
}

template <class Space, class T, int Dim>
void put_side_table(State<Space, T, Dim>& s, const std::vector<double>& values, const std::vector<int>& own) {
  using S = SideTerms<Dim>;
  const auto table = Kokkos::create_mirror_view(s.sides.nodes);
  for (std::size_t k = 0; k < values.size(); ++k)
    table.data()[k] = static_cast<int>(k % S::size) >= S::impulse && own[k / S::size] == 0 ? 0 : values[k];
  copy(s.sides.nodes, table);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                   \
  template void upload_sides(State<Space, T, Dim>&, const GridInput&, const std::vector<SideInput>&,     \
                             double);                                                                    \
  template SideWork take_side_work(const State<Space, T, Dim>&);                                         \
  template std::vector<double> side_table(const State<Space, T, Dim>&);                                  \
  template std::vector<int> own_side_rows(const State<Space, T, Dim>&);                                  \
  template std::vector<double> share_of_side_table(const State<Space, T, Dim>&, const std::vector<int>&, \
                                                   bool);                                                \
  template std::vector<double> column_table(const State<Space, T, Dim>&);                                \
  template void put_column_table(State<Space, T, Dim>&, const std::vector<double>&);                     \
  template void put_side_table(State<Space, T, Dim>&, const std::vector<double>&, const std::vector<int>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
