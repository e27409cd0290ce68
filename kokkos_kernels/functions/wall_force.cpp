#include "functions/wall_force.hpp"

#include "functions/surface_loads.hpp"
#include "loops/particle_to_node.hpp"
#include "physics/displaced_mass.hpp"

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

/// Which particles are near walls, and which wall holds a node.
template <class Space, class T, int Dim>
struct NearWalls {
  NodePlaces<Space, T, Dim> places;

  /// Whether a particle of a cell reaches a node at a wall.
  KOKKOS_INLINE_FUNCTION bool is_near(int cell) const {
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
  /// Adds component k of the forces on a node. For a node beyond a wall, twice the internal force passes that
  /// wall, and the image feels the opposite of the internal force and the weight. Beyond two walls that both
  /// turn the force round nothing passes. The force at a node on walls goes to the wall normal to k, where
  /// that wall holds k, else in equal parts to the walls that do: no part depends on the order of the axes.
  KOKKOS_INLINE_FUNCTION void add(const Coord<Dim>& node, int k, double internal, double weight,
                                  ForceSum<Dim>& sum) const {
    int beyond[Dim], at[Dim], walls_beyond = 0, walls_at = 0;
    for (int d = 0; d < Dim; ++d) {
      const int image = image_along(places.grid, d, node[d]);
      beyond[d] = image != node[d] ? holding_side(d, node[d], k) : -1;
      at[d] = holding_side(d, image, k);
      walls_beyond += beyond[d] >= 0, walls_at += at[d] >= 0;
    }
    const bool turned = walls_beyond % 2 == 1;
    for (int d = 0; d < Dim && turned; ++d)
      if (beyond[d] >= 0) sum.of[d][beyond[d]][k] += 2 * internal / walls_beyond;
    const double held = (turned ? -internal : internal) + weight;
    for (int d = 0; d < Dim; ++d)
      if (at[d] >= 0 && (at[k] < 0 || d == k)) sum.of[d][at[d]][k] += at[k] < 0 ? held / walls_at : held;
  }
  /// The lowest node that a particle of a cell reaches, `first` from the cell.
  template <class Weights>
  KOKKOS_INLINE_FUNCTION Coord<Dim> node(int cell, const Weights& a, const Vector<int, Dim>& step) const {
    Coord<Dim> at = in_mesh(places.origin(cell / Patch<Dim>::cells), coord_of<Dim>(cell));
    for (int d = 0; d < Dim; ++d) at[d] += a[d].first + step[d];
    return at;
  }
};

/// Source of the forces of loads on faces at such nodes, in the same way as the internal forces.
template <class Space, class T, int Dim>
struct PressLoads {
  VectorSource<Space, T, Dim> source;
  NearWalls<Space, T, Dim> walls;

  KOKKOS_INLINE_FUNCTION void operator()(int p, ForceSum<Dim>& sum) const {
    const int cell = source.points.cell(p);
    if (source.skips(cell / Patch<Dim>::cells) || !walls.is_near(cell)) return;
    const auto q = source.load(p);
    with_weights(source.points.coordinate(p), q.half_length, [&](const auto& a) {
      for_each_weight(a, [&](const Vector<int, Dim>& step, T w, const auto&) {
        if (!(w > 0)) return;
        const Coord<Dim> node = walls.node(cell, a, step);
        for (int k = 0; k < Dim; ++k) walls.add(node, k, double(w) * double(q.value[k]), 0, sum);
      });
    });
  }
};

/// Source of the forces at nodes on walls and beyond them. A node at a wall is held against its internal
/// force and weight. For a node beyond, the image's half of the soil takes the internal force, and the image
/// gives as much back (NearWalls::add).
template <class Space, class T, int Dim, ParticleDomain domain>
struct PressOnWalls {
  using Source = SoilSource<Space, T, Dim, domain>;
  Source source;
  NearWalls<Space, T, Dim> walls;
  DisplacedMass<Space, T, Dim> displaced;  // in use where there is water
  Vector<double, Dim> g;

  struct Terms {
    T value[Source::size];
  };

  KOKKOS_INLINE_FUNCTION void operator()(int p, ForceSum<Dim>& sum) const {
    const int cell = source.points.cell(p);
    if (!walls.is_near(cell)) return;
    const typename Source::Point q = source.load(p);
    const T carried = displaced.water.is_there() ? displaced(p) : T(0);
    with_weights(source.points.coordinate(p), q.half_length, [&](const auto& a) {
      for_each_weight(a, [&](const Vector<int, Dim>& step, T w, const auto& grad) {
        if (!(w > 0)) return;
        Terms terms = share_of(q, w, grad);
        terms.value[SoilTerms<Dim>::mass] -= w * carried;
        const Coord<Dim> node = walls.node(cell, a, step);
        for (int k = 0; k < Dim; ++k)
          walls.add(node, k, terms.value[SoilTerms<Dim>::force + k], terms.value[SoilTerms<Dim>::mass] * g[k],
                    sum);
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
};

}  // namespace

template <class Space, class T, int Dim>
WallForces wall_forces(const Core<Space, T, Dim>& s, const SurfaceLoads<Space, T, Dim>& loads) {
  ForceSum<Dim> sum;
  with_domain(s.soil.points, [&](auto domain) {
    PressOnWalls<Space, T, Dim, domain()> press{
        {s.soil.points, s.grid.inv_spacing},
        {{s.grid, s.patches}},
        {s.soil.points, s.water, s.density, s.patches.origin, s.spacing},
        {}};
    for (int d = 0; d < Dim; ++d) press.g[d] = s.gravity[d];
    Kokkos::parallel_reduce("mpm::wall_forces", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                            press, Kokkos::Sum<ForceSum<Dim>>(sum));
  });
  for (int axis = 0; axis < Dim && loads.in_use(); ++axis) {
    ForceSum<Dim> of_loads;
    Kokkos::parallel_reduce("mpm::wall_loads", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                            PressLoads<Space, T, Dim>{place_faces(s, loads, axis), {{s.grid, s.patches}}},
                            Kokkos::Sum<ForceSum<Dim>>(of_loads));
    sum += of_loads;
  }
  WallForces forces{};
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side)
      for (int k = 0; k < Dim; ++k) forces[d][side][k] = sum.of[d][side][k];
  return forces;
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template WallForces wall_forces(const Core<Space, T, Dim>&, const SurfaceLoads<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
