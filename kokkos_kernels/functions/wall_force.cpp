#include "functions/wall_force.hpp"

#include "loops/particle_to_node.hpp"

namespace mpm {
namespace {

/// Forces on all sides, as a sum for parallel_reduce.
template <int Dim>
struct ForceSum {
  double of[Dim][2][Dim];
  KOKKOS_INLINE_FUNCTION ForceSum() : of{} {}
  KOKKOS_INLINE_FUNCTION ForceSum& operator+=(const ForceSum& other) {
    for (int d = 0; d < Dim; ++d)
      for (int side = 0; side < 2; ++side)
        for (int k = 0; k < Dim; ++k) of[d][side][k] += other.of[d][side][k];
    return *this;
  }
};

}  // namespace
}  // namespace mpm

namespace Kokkos {
template <int Dim>
struct reduction_identity<mpm::ForceSum<Dim>> {
  KOKKOS_FORCEINLINE_FUNCTION static mpm::ForceSum<Dim> sum() { return {}; }
};
}  // namespace Kokkos

namespace mpm {
namespace {

/// What particles give the nodes at walls and beyond. A node at a wall is held against its internal force and
/// weight. Of one beyond, the image's half of the soil takes the internal force, and the image gives as much
/// back: twice that force passes the wall.
template <class Space, class T, int Dim, ParticleDomain domain>
struct PressOnWalls {
  using Source = SoilSource<Space, T, Dim, domain>;
  Source source;
  NodePlaces<Space, T, Dim> places;
  DisplacedSource<Space, T, Dim, domain> displaced;  // in use where there is water
  Vector<double, Dim> g;

  struct Terms {
    T value[Source::size];
  };

  /// Whether a particle reaches a node at a wall.
  KOKKOS_INLINE_FUNCTION bool is_near(int p) const {
    const int cell = source.points.cell(p);
    const Coord<Dim> from = places.origin(cell / Patch<Dim>::cells), in = coord_of<Dim>(cell);
    bool near = false;
    for (int d = 0; d < Dim; ++d) near |= from[d] + in[d] < 2 || from[d] + in[d] >= places.grid.cells[d] - 2;
    return near;
  }
  /// The side of direction d that holds component k at a node, or lies between it and its image; -1: none.
  KOKKOS_INLINE_FUNCTION int holding_side(int d, int at, int k) const {
    if (at > 0 && at < places.grid.cells[d]) return -1;
    const int side = at > 0;
    const Wall wall = places.grid.wall[d][side];
    return wall == Wall::fixed || (wall == Wall::roller && k == d) ? side : -1;  // others: side_forces
  }
  KOKKOS_INLINE_FUNCTION void operator()(int p, ForceSum<Dim>& sum) const {
    if (!is_near(p)) return;
    const typename Source::Point q = source.load(p);
    const T carried = displaced.water.is_there() ? displaced.load(p).mass : T(0);
    with_weights(source.points.coordinate(p), q.half_length, [&](const auto& a) {
      const int cell = source.points.cell(p);
      const Coord<Dim> first = in_mesh(places.origin(cell / Patch<Dim>::cells), coord_of<Dim>(cell));
      for_each_weight(a, [&](const Vector<int, Dim>& step, T w, const auto& grad) {
        Coord<Dim> node;
        for (int d = 0; d < Dim; ++d) node[d] = first[d] + a[d].first + step[d];
        if (!(w > 0)) return;
        Terms terms = share_of(q, w, grad);
        terms.value[SoilTerms<Dim>::mass] -= w * carried;
        add_node(node, terms, sum);
      });
    });
  }

 private:
  template <class Gradient>
  KOKKOS_INLINE_FUNCTION static Terms share_of(const typename Source::Point& q, T w, const Gradient& grad) {
    Terms terms{};
    give<Source>(
        q, w, grad, [] { return 0; }, [&](int value, T v) { terms.value[value] += v; });
    return terms;
  }
  KOKKOS_INLINE_FUNCTION void add_node(const Coord<Dim>& node, const Terms& terms, ForceSum<Dim>& sum) const {
    for (int k = 0; k < Dim; ++k)
      for (int d = 0; d < Dim; ++d) {
        const int at = node[d], side = holding_side(d, at, k);
        if (side < 0) continue;
        const bool beyond = image_along(places.grid, d, at) != at;
        const double f = terms.value[SoilTerms<Dim>::force + k];
        sum.of[d][side][k] += beyond ? 2 * f : f + terms.value[SoilTerms<Dim>::mass] * g[k];
        break;  // where two sides hold it, the first one
      }
  }
};

}  // namespace

template <class Space, class T, int Dim>
WallForces wall_forces(const State<Space, T, Dim>& s) {
  ForceSum<Dim> sum;
  with_domain(s.soil.points, [&](auto domain) {
    PressOnWalls<Space, T, Dim, domain()> press{
        {s.soil.points, s.grid.inv_spacing},
        {s.grid, s.patches},
        {s.soil.points, s.water, s.density, s.patches.origin, s.spacing},
        {}};
    for (int d = 0; d < Dim; ++d) press.g[d] = s.gravity[d];
    Kokkos::parallel_reduce("mpm::wall_forces", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                            press, Kokkos::Sum<ForceSum<Dim>>(sum));
  });
  WallForces forces{};
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side)
      for (int k = 0; k < Dim; ++k) forces[d][side][k] = sum.of[d][side][k];
  return forces;
}

#define MPM_INSTANTIATE(Space, T, Dim) template WallForces wall_forces(const State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
