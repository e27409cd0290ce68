#include "functions/position_correction.hpp"

#include "base/ensure.hpp"
#include "loops/particle_to_node.hpp"
#include "physics/surface.hpp"

namespace mpm {
namespace {

constexpr double k_flowed = 0.1;          // -, plastic shear strain from which on soil counts as flowing
constexpr double k_most_diffusion = 0.2;  // -, explicit diffusion of the density stays smooth below
constexpr double k_surface = 0.5;         // -, a node that is filled less may be at a free surface
constexpr double k_outside = 0.15;        // -, more of f - a^2/2 is not that of a node beyond a surface
constexpr double k_most_gap = 0.2;        // -, that counts
constexpr double k_near_rigid = 1.5;      // cells, from its surface: its nodes are not full of soil

/// How full a node is, from what particles give it. Beyond a wall the soil goes on as its mirror image.
template <class Space, class T, int Dim>
struct CompareVolumes {
  using B = BoundaryTerms<Dim>;
  Grid<T, Dim> grid;
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  FillField<Space, T, Dim> fill;
  T per_volume, per_area;  // 1/m3, 1/m2

  KOKKOS_INLINE_FUNCTION void operator()(int i) const {
    const Coord<Dim> node = in_mesh(origin(i / Patch<Dim>::cells), coord_of<Dim>(i));
    T images = 1, square = 0;
    bool at_wall[Dim];
    for (int d = 0; d < Dim; ++d) {
      at_wall[d] = (node[d] == 0 && grid.wall[d][0] != Wall::free) ||
                   (node[d] == grid.cells[d] && grid.wall[d][1] != Wall::free);
      if (at_wall[d]) images *= 2;
    }
    for (int d = 0; d < Dim; ++d) {
      const T a = at_wall[d] ? T(0) : images * per_area * fill(i, B::area + d);
      square += a * a;
    }
    const T f = images * per_volume * fill(i, B::volume), of_surface = square / 2;
    fill(i, FillTerms<Dim>::filled) = f;
    fill(i, FillTerms<Dim>::excess) =
        f - of_surface < T(k_outside) ? T(0) : Kokkos::fmax(T(-k_most_gap), f - 1 + of_surface);
  }
};

/// Sums over the nodes that a particle reaches.
template <class T, int Dim>
struct Surroundings {
  T lowest = 1;               // least share of a node that is filled
  Vector<T, Dim> crowded{};   // sum e_i grad S, 1/cell: to where particles crowd
  Vector<T, Dim> inward{};    // sum f_i grad S: away from a free surface
  Matrix<T, Dim> gradient{};  // of the nodes' velocity, m/s a cell
};

template <class Space, class T, int Dim>
struct FindShift {
  Soil<Space, T, Dim> soil;
  NodePlaces<Space, T, Dim> places;
  FillField<Space, T, Dim> fill;
  NodeField<Space, T, SoilTerms<Dim>::size> sums;
  ParticleValues<Space, T, Dim> shares, shifts;
  decltype(PositionCorrection<Space>::flow_column) flow_column;
  Kokkos::View<Rigid<Dim>*, typename Space::memory_space> rigids;
  SurfaceTables<typename Space::memory_space, Dim> vertices;
  ContactPlaces<Space> contact;
  int rigid_count;
  double rate, elapsed, spacing;

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    shares(p) = shifts(p) = Vector<T, Dim>{};
    if (!flows(p) || is_near_rigid(p)) return;
    const Surroundings<T, Dim> near = look_around(p);
    const T diffusion =
        static_cast<T>(Kokkos::fmin(k_most_diffusion, rate * shear_rate(near.gradient) / spacing * elapsed));
    Vector<T, Dim> shift = near.lowest < T(k_surface) ? along_surface(near) : near.crowded;
    for (int d = 0; d < Dim; ++d) shift[d] *= -diffusion;
    limit(p, shift);
    shifts(p) = shift;
    const T mass = soil.mass_of(p, soil.bodies(soil.body(p)));
    for (int d = 0; d < Dim; ++d)
      for (int e = 0; e < Dim; ++e) shares(p)[d] += mass * near.gradient(d, e) * shift[e];
  }

 private:
  KOKKOS_INLINE_FUNCTION bool flows(int p) const {
    const int column = flow_column(soil.material_of(p));
    return column == Flow::always || (column >= 0 && soil.history.column[column](p) > T(k_flowed));
  }
  KOKKOS_INLINE_FUNCTION Coord<Dim> cell_of_mesh(int p) const {
    return in_mesh(places.origin(soil.cell(p) / Patch<Dim>::cells), coord_of<Dim>(soil.cell(p)));
  }
  KOKKOS_INLINE_FUNCTION bool is_near_rigid(int p) const {
    if (rigid_count == 0 || contact(soil.cell(p) / Patch<Dim>::cells) == 0) return false;
    const Coord<Dim> cell = cell_of_mesh(p);
    for (int r = 0; r < rigid_count; ++r) {
      const Rigid<Dim>& rigid = rigids(r);
      const auto place = rigid.motion.pose.to_body(
          [&](int d) { return (cell[d] + double(soil.coordinate(p)[d])) * spacing; });
      if (distance_to(rigid.surface, vertices, place).value < k_near_rigid * spacing) return true;
    }
    return false;
  }
  KOKKOS_INLINE_FUNCTION Surroundings<T, Dim> look_around(int p) const {
    using S = SoilTerms<Dim>;
    Surroundings<T, Dim> near;
    for_each_node<Kind::motion>(
        soil, any_domain_of(soil, p), places, p, [&](int i, T w, const auto& grad, auto&&, auto&& sign) {
          const T f = fill(i, FillTerms<Dim>::filled), m_i = sums(i, S::mass);
          if (w > T(k_reached)) near.lowest = Kokkos::fmin(near.lowest, f);
          for (int e = 0; e < Dim; ++e) {
            near.crowded[e] += fill(i, FillTerms<Dim>::excess) * grad[e];
            near.inward[e] += f * grad[e];
          }
          if (!(m_i > 0)) return;  // a mass too small for T
          for (int d = 0; d < Dim; ++d)
            for (int e = 0; e < Dim; ++e)
              near.gradient(d, e) += sign(d) * (sums(i, S::momentum + d) / m_i) * grad[e];
        });
    return near;
  }
  /// Engineering shear strain rate [m/s a cell], sqrt(2 e:e) of the deviator e.
  KOKKOS_INLINE_FUNCTION static double shear_rate(const Matrix<T, Dim>& gradient) {
    double trace = 0, square = 0;
    for (int d = 0; d < Dim; ++d) trace += double(gradient(d, d));
    for (int d = 0; d < Dim; ++d)
      for (int e = 0; e < Dim; ++e) {
        const double rate = (double(gradient(d, e)) + double(gradient(e, d))) / 2 - (d == e ? trace / 3 : 0);
        square += rate * rate;
      }
    if (Dim == 2) square += trace * trace / 9;
    return Kokkos::sqrt(2 * square);
  }
  KOKKOS_INLINE_FUNCTION static Vector<T, Dim> along_surface(const Surroundings<T, Dim>& near) {
    Vector<T, Dim> along = near.crowded;
    const T square = dot(near.inward, near.inward);
    if (!(square > 0)) return Vector<T, Dim>{};
    const T share = dot(along, near.inward) / square;
    for (int d = 0; d < Dim; ++d) along[d] -= share * near.inward[d];
    return along;
  }
  /// Keeps a shift [cells] within its bound, and away from sides of the mesh. The soil goes on beyond a
  /// periodic side, which bounds no shift.
  KOKKOS_INLINE_FUNCTION void limit(int p, Vector<T, Dim>& shift) const {
    T largest = 0;
    for (int d = 0; d < Dim; ++d) largest = Kokkos::fmax(largest, Kokkos::fabs(shift[d]));
    const T within = largest > T(k_most_shift) ? T(k_most_shift) / largest : T(1);
    const Coord<Dim> cell = cell_of_mesh(p);
    const auto half = any_domain_of(soil, p);
    for (int d = 0; d < Dim; ++d) {
      const T below = T(cell[d]) + soil.coordinate(p)[d] - half[d].l,
              above = T(places.grid.cells[d] - cell[d]) - soil.coordinate(p)[d] - half[d].l;
      shift[d] *= within;
      if (places.grid.period[d] > 0) continue;
      shift[d] = Kokkos::fmax(shift[d], -Kokkos::fmax(T(0), below));
      shift[d] = Kokkos::fmin(shift[d], Kokkos::fmax(T(0), above));
    }
  }
};

/// Energies that a correction adds [J].
struct Added {
  double kinetic = 0, raised = 0;
  KOKKOS_INLINE_FUNCTION Added& operator+=(const Added& other) {
    kinetic += other.kinetic, raised += other.raised;
    return *this;
  }
};

template <class Space, class T, int Dim>
struct ApplyShift {
  using S = SoilTerms<Dim>;
  Soil<Space, T, Dim> soil;
  NodePlaces<Space, T, Dim> places;
  NodeField<Space, T, Dim> given;
  NodeField<Space, T, SoilTerms<Dim>::size> sums;
  ParticleValues<Space, T, Dim> shares, shifts;
  Vector<double, Dim> gravity;
  double spacing;
  int body;

  KOKKOS_INLINE_FUNCTION void operator()(int p, Added& added) const {
    if (soil.body(p) != body) return;
    const T mass = soil.mass_of(p, soil.bodies(body));
    Vector<T, Dim> change;
    for (int d = 0; d < Dim; ++d) change[d] = shares(p)[d] / mass;
    for_each_node<Kind::geometry>(soil, any_domain_of(soil, p), places, p,
                                  [&](int i, T w, const auto&, auto&&, auto&&) {
                                    const T m_i = sums(i, S::mass);
                                    if (!(m_i > 0)) return;  // a mass too small for T
                                    for (int d = 0; d < Dim; ++d) change[d] -= w * (given(i, d) / m_i);
                                  });
    Vector<T, Dim> v = soil.velocity(p), x = soil.coordinate(p);
    double square = 0, work = 0;
    for (int d = 0; d < Dim; ++d) {
      square -= double(v[d]) * v[d];
      v[d] += change[d], x[d] += shifts(p)[d];
      square += double(v[d]) * v[d];
      work += gravity[d] * double(shifts(p)[d]) * spacing;
    }
    soil.velocity(p) = v, soil.coordinate(p) = x;
    added.kinetic += double(mass) * square / 2, added.raised -= double(mass) * work;
  }
};

}  // namespace
}  // namespace mpm

namespace Kokkos {
template <>
struct reduction_identity<mpm::Added> {
  KOKKOS_FORCEINLINE_FUNCTION static mpm::Added sum() { return {}; }
};
}  // namespace Kokkos

namespace mpm {

template <class Space, class T, int Dim>
void compare_volumes(ContactCore<Space, T, Dim>& s, const FillField<Space, T, Dim>& fill) {
  const double area = power(s.spacing, Dim - 1);
  Kokkos::parallel_for(
      "mpm::compare_volumes", Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()),
      CompareVolumes<Space, T, Dim>{s.grid, s.patches.origin, fill, static_cast<T>(1 / (area * s.spacing)),
                                    static_cast<T>(1 / area)});
}

template <class Space, class T, int Dim>
void find_shifts(ContactCore<Space, T, Dim>& s, const FillField<Space, T, Dim>& fill, double elapsed) {
  ensure(s.scratch, 2 * sizeof(Vector<T, Dim>) * s.soil.points.count);
  Kokkos::parallel_for("mpm::find_shifts", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                       FindShift<Space, T, Dim>{s.soil.points,
                                                {s.grid, s.patches},
                                                fill,
                                                s.nodes.soil,
                                                shares_of(s),
                                                shifts_of(s),
                                                s.correction.flow_column,
                                                s.rigids,
                                                s.vertices,
                                                s.contact.place,
                                                static_cast<int>(s.rigid_points.size()),
                                                s.correction.rate,
                                                elapsed,
                                                s.spacing});
}

template <class Space, class T, int Dim>
void apply_shifts(ContactCore<Space, T, Dim>& s) {
  for (int b = 0; b < static_cast<int>(s.strays.lost.size()); ++b) {
    Added added;
    Kokkos::parallel_reduce("mpm::apply_shifts", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                            ApplyShift<Space, T, Dim>{s.soil.points,
                                                      {s.grid, s.patches},
                                                      s.nodes.shares,
                                                      s.nodes.soil,
                                                      shares_of(s),
                                                      shifts_of(s),
                                                      s.gravity,
                                                      s.spacing,
                                                      b},
                            Kokkos::Sum<Added>(added));
    s.strays.lost[b].corrected += added.kinetic, s.strays.lost[b].raised += added.raised;
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                             \
  template void compare_volumes(ContactCore<Space, T, Dim>&, const FillField<Space, T, Dim>&);     \
  template void find_shifts(ContactCore<Space, T, Dim>&, const FillField<Space, T, Dim>&, double); \
  template void apply_shifts(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
