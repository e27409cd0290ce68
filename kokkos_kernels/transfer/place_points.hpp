#pragma once
// Cells and coordinates of points from their positions.

#include <cmath>
#include <vector>

#include "data/nodes.hpp"
#include "data/particles.hpp"
#include "transfer/fill_view.hpp"

namespace mpm {

/// Cell and coordinate in it of positions [m from the mesh's lower corner]; those outside the mesh are a
/// fault, but on a periodic side, which is the opposite one. field_of(p): velocity field of point p.
template <class Space, class T, int Dim, class Points_, class Field>
void place_points(const Grid<T, Dim>& grid, double spacing, const std::vector<double>& position,
                  const Field& field_of, ParticleSet<Space, Points_>& set, Fault& fault) {
  const int count = set.points.all = set.points.count;
  std::vector<long> address(count);
  std::vector<Vector<T, Dim>> coordinate(count);
  for (int p = 0; p < count; ++p) {
    Coord<Dim> c{};
    for (int d = 0; d < Dim; ++d) {
      const double x = position[std::size_t(p) * Dim + d] / spacing;
      c[d] = static_cast<int>(std::floor(x));
      coordinate[p][d] = static_cast<T>(x - c[d]);
      if (coordinate[p][d] >= 1) coordinate[p][d] = 0, ++c[d];  // 1 - tiny rounds to 1 in T
      c[d] = grid.in_period(d, c[d]);
    }
    if (!grid.holds(c) && fault.kind == FaultKind::none) {
      fault.kind = FaultKind::outside;
      fault.particle = p;
      for (int d = 0; d < Dim; ++d) fault.position[d] = position[std::size_t(p) * Dim + d];
    }
    address[p] = grid.holds(c) ? grid.address_of(c, field_of(p)) : 0;
  }
  fill_view(set.address, "mpm::address", count, [&](int p) { return address[p]; });
  fill_view(set.points.coordinate, "mpm::coordinate", count, [&](int p) { return coordinate[p]; });
  fill_view(set.points.id, "mpm::id", count, [](int p) { return p; });
  fill_view(set.points.cell, "mpm::cell", count, [](int) { return 0; });
}

}  // namespace mpm
