#pragma once
// Terms that one particle gives one node. Physics is written here once; the strategies are loop shapes around
// it.

#include <cstddef>
#include <type_traits>

#include "data/contact_slots.hpp"
#include "data/nodes.hpp"
#include "data/particle_values.hpp"
#include "data/particles.hpp"
#include "data/rigid.hpp"
#include "physics/domain.hpp"
#include "physics/ring_domain.hpp"
#include "physics/shape_gimp.hpp"
#include "physics/walls.hpp"

namespace mpm {

// A Point holds what a particle gives, as plain T, so that a strategy may keep it value by value. Each value
// of a node's term goes with the weight, or with components of its gradient, as takes(value, d) says:
//   S factor(q, value)   or   sum over d of dS/dx_d slope(q, value, d)
// Where the particles are rings, d goes up to Dim, and the last one stands for the hoop weight T S.
// component(value) is the direction of a value that is a component of a vector, -1 of a scalar; with `kind`
// it determines the sign of the value's image in a wall.

/// Numbers of a point that lie behind its half lengths, which the weights alone need: how many they are, and
/// the first of them. T: the type of the numbers.
template <class T, class Point>
inline constexpr int k_domain_numbers = sizeof(std::declval<Point&>().half_length) / sizeof(T);
template <class T, class Point>
inline constexpr int k_point_numbers = sizeof(Point) / sizeof(T) - k_domain_numbers<T, Point>;
template <class T, class Point>
KOKKOS_INLINE_FUNCTION auto numbers_of(Point& q) {
  using Plain = std::remove_const_t<Point>;
  static_assert(std::is_trivially_copyable_v<Plain> && sizeof(Plain) % sizeof(T) == 0);
  if constexpr (std::is_standard_layout_v<Plain>) static_assert(offsetof(Plain, half_length) == 0);
  using Number = std::conditional_t<std::is_const_v<Point>, const T, T>;
  return reinterpret_cast<Number*>(&q) + k_domain_numbers<T, Plain>;
}

/// Members that the sources of soil share. A source hides those functions in which it differs: each slot
/// gives, every value is a scalar, and none takes the gradient.
template <class Space_, class T, int Dim, int size_, Kind kind_, ParticleDomain domain_>
struct SourceOfSoil {
  using Space = Space_;
  using real = T;
  static constexpr ParticleDomain domain = domain_;
  static constexpr int dim = Dim, size = size_;
  static constexpr Kind kind = kind_;
  Soil<Space, T, Dim> points;

  KOKKOS_INLINE_FUNCTION static constexpr bool skips(int) { return false; }
  KOKKOS_INLINE_FUNCTION static constexpr int component(int) { return -1; }
  KOKKOS_INLINE_FUNCTION static constexpr bool takes(int, int) { return false; }
  template <class Point>
  KOKKOS_INLINE_FUNCTION static T slope(const Point&, int, int) {
    return 0;
  }
};

/// Soil to nodes, Eqs (1), (2), (4): m_i = sum S m_p, p_i = sum S m_p v_p, f_i = - sum V_p sigma_p grad S.
/// The weight, Eq. (5), is m_i g and is added at the node.
template <class Space_, class T, int Dim, ParticleDomain domain_ = ParticleDomain::fixed>
struct SoilSource : SourceOfSoil<Space_, T, Dim, SoilTerms<Dim>::size, Kind::motion, domain_> {
  static constexpr bool rings = domain_ == ParticleDomain::ring;
  static constexpr int k_stresses = Dim * (Dim + 1) / 2 + rings;
  template <class R>
  struct PointOf {
    DomainOf<R, Dim, domain_> half_length;
    R mass, momentum[Dim];
    R stress_volume[k_stresses];  // - V_p sigma_p / d, components along the axes of the mesh, then the hoop's
  };
  using Point = PointOf<T>;
  /// Place of component (i, j) in stress_volume: that of SymTensor, with zz, the hoop stress, last.
  KOKKOS_INLINE_FUNCTION static constexpr int place(int i, int j) {
    return j == Dim ? 3 : Dim == 2 && i != j ? 2 : sym_index<Dim>(i, j);
  }
  T inv_spacing;

  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    const auto& points = this->points;
    const BodyProperties<T> of = points.properties(p);
    return point(domain_of<domain_>(points, p, of), of.mass, points.velocity(p), points.stress(p),
                 points.volume(p));
  }
  /// R: T, or lanes of it.
  template <class R>
  KOKKOS_INLINE_FUNCTION PointOf<R> point(const DomainOf<R, Dim, domain_>& half_length, R mass,
                                          const Vector<R, Dim>& v_p, const SymTensor<R, Dim>& stress,
                                          R volume) const {
    PointOf<R> q{half_length, mass, {}, {}};
    const R scale = -volume * inv_spacing;
    for (int d = 0; d < Dim; ++d) q.momentum[d] = q.mass * v_p[d];
    for (int k = 0; k < Dim * (Dim + 1) / 2; ++k)
      q.stress_volume[k] = scale * stress[k < Dim ? k : k + 3 - Dim];
    if constexpr (rings) q.stress_volume[3] = scale * stress[2];
    return q;
  }
  KOKKOS_INLINE_FUNCTION static constexpr int component(int value) {
    return value == SoilTerms<Dim>::mass ? -1 : (value - SoilTerms<Dim>::momentum) % Dim;
  }
  KOKKOS_INLINE_FUNCTION static constexpr bool takes(int value, int d) {
    return value >= SoilTerms<Dim>::force && (d < Dim || value == SoilTerms<Dim>::force);
  }
  KOKKOS_INLINE_FUNCTION static T factor(const Point& q, int value) {
    return value == SoilTerms<Dim>::mass ? q.mass : q.momentum[value - SoilTerms<Dim>::momentum];
  }
  KOKKOS_INLINE_FUNCTION static T slope(const Point& q, int value, int d) {
    return q.stress_volume[place(value - SoilTerms<Dim>::force, d)];
  }
};

/// Soil to nodes by APIC (Jiang et al. 2015): as SoilSource, but p_i = sum S m_p (v_p + C_p (x_i - x_p)).
template <class Space_, class T, int Dim, ParticleDomain domain_ = ParticleDomain::fixed>
struct AffineSource : SoilSource<Space_, T, Dim, domain_> {
  using Base = SoilSource<Space_, T, Dim, domain_>;
  static constexpr bool takes_offset = true;
  struct Point : Base::Point {
    T affine[Dim * Dim];  // m_p C_p by rows, kg m/s a cell
  };

  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    Point q{Base::load(p), {}};
    for (int k = 0; k < Dim * Dim; ++k) q.affine[k] = q.mass * this->points.affine(p)[k];
    return q;
  }
  /// Additions to the term of a node with weight w, `offset` [cells] from the particle.
  template <class W, class Add>
  KOKKOS_INLINE_FUNCTION static void give_more(const Point& q, W w, const Vector<W, Dim>& offset, Add&& add) {
    for (int d = 0; d < Dim; ++d) {
      W more = q.affine[d * Dim] * offset[0];
      for (int e = 1; e < Dim; ++e) more += q.affine[d * Dim + e] * offset[e];
      add(SoilTerms<Dim>::momentum + d, w * more);
    }
  }
};

/// Factor of a particle's numbers: 1, or its mass [kg].
enum class Times { one, mass };

/// N numbers of each particle to nodes, sum S q_p, which some kernel has put in memory: of Kind::motion the
/// components of a vector, of Kind::geometry scalars, which no wall turns, so that their sum over the nodes
/// is that over the particles. The kernels are the same for domains that are fixed and that stretch.
template <class Space_, class T, int Dim, int N, Kind kind_, ParticleDomain domain_ = ParticleDomain::stretch>
struct ValueSource : SourceOfSoil<Space_, T, Dim, N, kind_, domain_> {
  static_assert(kind_ == Kind::geometry || N == Dim);
  struct Point {
    DomainOf<T, Dim, domain_> half_length;
    T value[N];
  };
  ParticleValues<Space_, T, N> values;
  Windows<Space_> windows = {};  // of the slots that give; without places all do, and have those of the bins
  Times times = Times::one;

  KOKKOS_INLINE_FUNCTION bool skips(int slot) const {
    return windows.place.extent(0) > 0 && windows.place(slot) == 0;
  }
  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    const BodyProperties<T>& body = this->points.bodies(this->points.body(p));
    const T scale = times == Times::mass ? this->points.mass_of(p, body) : T(1);
    Point q{box_or_ring_of<domain_>(this->points, p, body), {}};
    for (int n = 0; n < N; ++n) q.value[n] = scale * values(p)[n];
    return q;
  }
  KOKKOS_INLINE_FUNCTION static constexpr int component(int value) {
    return kind_ == Kind::motion ? value : -1;
  }
  KOKKOS_INLINE_FUNCTION static T factor(const Point& q, int value) { return q.value[value]; }
};

/// The soil's boundary at a node, sum grad S V_p, of rings with T S V_p in the radial component: by Gauss'
/// theorem the integral of S_i n over it, n out of the soil. Summed over the nodes along a face it is the
/// face's area, however the face cuts the cells. The source also sums the soil's volume there, sum S V_p.
template <class Space_, class T, int Dim, ParticleDomain domain_ = ParticleDomain::fixed>
struct BoundarySource : SourceOfSoil<Space_, T, Dim, BoundaryTerms<Dim>::size, Kind::geometry, domain_> {
  struct Point {
    DomainOf<T, Dim, domain_> half_length;
    T area, volume;  // V_p / d, V_p
  };
  T inv_spacing;
  ContactPlaces<Space_> contact;

  /// No contact needs the boundary elsewhere.
  KOKKOS_INLINE_FUNCTION bool skips(int slot) const { return contact(slot) == 0; }
  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    const auto& points = this->points;
    const T volume = points.volume(p);
    return {domain_of<domain_>(points, p, points.bodies(points.body(p))), volume * inv_spacing, volume};
  }
  KOKKOS_INLINE_FUNCTION static constexpr int component(int value) {
    return value < BoundaryTerms<Dim>::volume ? value : -1;
  }
  KOKKOS_INLINE_FUNCTION static constexpr bool takes(int value, int d) {
    return value == BoundaryTerms<Dim>::area + (d == Dim ? 0 : d);
  }
  KOKKOS_INLINE_FUNCTION static T factor(const Point& q, int) { return q.volume; }
  KOKKOS_INLINE_FUNCTION static T slope(const Point& q, int, int) { return q.area; }
};

/// Where the soil of a node is: its mass m_i, and m_i times the way from the node to its centre of mass.
template <class Space_, class T, int Dim>
struct CentreSource
    : SourceOfSoil<Space_, T, Dim, CentreTerms<Dim>::size, Kind::geometry, ParticleDomain::stretch> {
  using Terms = CentreTerms<Dim>;
  static constexpr bool takes_offset = true;
  struct Point {
    HalfLengths<T, Dim> half_length;
    T mass;
  };

  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    return {with_inverses<T>(this->points.half_length(p)), this->points.properties(p).mass};
  }
  KOKKOS_INLINE_FUNCTION static constexpr int component(int value) { return value - Terms::way; }
  KOKKOS_INLINE_FUNCTION static T factor(const Point& q, int value) {
    return value == Terms::mass ? q.mass : T(0);
  }
  /// As AffineSource::give_more.
  template <class W, class Add>
  KOKKOS_INLINE_FUNCTION static void give_more(const Point& q, W w, const Vector<W, Dim>& offset, Add&& add) {
    for (int d = 0; d < Dim; ++d) add(Terms::way + d, -w * (q.mass * offset[d]));
  }
};

/// How the soil of a node lies round it, in the slots of contact: CloudTerms, with a particle's domain as a
/// box.
template <class Space_, class T, int Dim, ParticleDomain domain_ = ParticleDomain::stretch>
struct CloudSource : SourceOfSoil<Space_, T, Dim, CloudTerms<Dim>::size, Kind::geometry, domain_> {
  using Terms = CloudTerms<Dim>;
  static constexpr bool takes_offset = true;
  struct Point {
    DomainOf<T, Dim, domain_> half_length;
    T volume, spread[Dim];  // of the domain itself
  };
  Windows<Space_> windows;

  KOKKOS_INLINE_FUNCTION bool skips(int slot) const { return windows.place(slot) == 0; }
  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    const auto& points = this->points;
    const BodyProperties<T>& body = points.bodies(points.body(p));
    Point q{box_or_ring_of<domain_>(points, p, body), points.volume(p), {}};
    for (int d = 0; d < Dim; ++d) {
      const T half = points.has_domain ? T(points.half_length(p)[d]) : T(body.half_length);
      q.spread[d] = q.volume * half * half / 3;
    }
    return q;
  }
  KOKKOS_INLINE_FUNCTION static constexpr int component(int value) {
    return value < Terms::spread ? value - Terms::way : -1;
  }
  KOKKOS_INLINE_FUNCTION static T factor(const Point& q, int value) {
    const int d = value - Terms::spread;
    return d >= 0 && d < Dim ? q.spread[d] : T(0);
  }
  /// As AffineSource::give_more.
  template <class W, class Add>
  KOKKOS_INLINE_FUNCTION static void give_more(const Point& q, W w, const Vector<W, Dim>& offset, Add&& add) {
    for (int i = 0; i < Dim; ++i) {
      add(Terms::way + i, -w * (q.volume * offset[i]));
      for (int j = i; j < Dim; ++j)
        add(Terms::spread + Terms::place(i, j), w * (q.volume * offset[i] * offset[j]));
    }
  }
};

/// Rigid body to nodes: m_i^R = sum S m_p and the mass gradient n_i^R = sum grad S m_p (Eq. 3; it points out
/// of the body). A strategy may move() a point before it gives.
template <class Space_, class T, int Dim>
struct RigidSource {
  using Space = Space_;
  using real = T;
  static constexpr int dim = Dim, size = RigidTerms<Dim>::size;
  static constexpr Kind kind = Kind::geometry;
  struct Point {
    HalfLength<T> half_length;
    T mass;
  };
  RigidPoints<Space, T, Dim> points;
  Kokkos::View<Rigid<Dim>*, typename Space::memory_space> rigids;
  int rigid;  // whose points they are
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  double spacing;

  KOKKOS_INLINE_FUNCTION static constexpr bool skips(int) { return false; }
  KOKKOS_INLINE_FUNCTION Point load(int) const { return {points.half_length, points.mass}; }
  /// Brings point p to where its body is now, or to where the body is in another pose.
  KOKKOS_INLINE_FUNCTION void move(int p) const { move(p, rigids(rigid).motion.pose); }
  KOKKOS_INLINE_FUNCTION void move(int p, const RigidPose<Dim>& pose) const {
    const Coord<Dim> from = origin(points.cell(p) / Patch<Dim>::cells), cell = coord_of<Dim>(points.cell(p));
    const Vector<double, Dim> x =
        pose.in_cells(spacing).template to_world<false>(points.reference_position(p));
    for (int d = 0; d < Dim; ++d) points.coordinate(p)[d] = static_cast<T>(x[d] - from[d] - cell[d]);
  }
  KOKKOS_INLINE_FUNCTION static constexpr int component(int value) {
    return value - RigidTerms<Dim>::normal;  // -1 of the mass
  }
  KOKKOS_INLINE_FUNCTION static constexpr bool takes(int value, int d) {
    return value == RigidTerms<Dim>::normal + d;
  }
  KOKKOS_INLINE_FUNCTION static T factor(const Point& q, int) { return q.mass; }
  KOKKOS_INLINE_FUNCTION static T slope(const Point& q, int, int) { return q.mass; }
};

/// Components of the gradient that a source's particles have.
template <class Source>
inline constexpr int k_slopes_of = [] {
  if constexpr (requires { Source::domain; }) return k_slopes<Source::dim, Source::domain>;
  return Source::dim;
}();

/// Whether each value is a sum of one kind, so that its unit does not depend on the mesh: the hoop weight T S
/// of rings goes only where the gradient along the radius goes, and a scalar takes no gradient.
template <class Source>
constexpr bool sums_of_one_kind() {
  for (int value = 0; value < Source::size; ++value)
    for (int d = 0; d < k_slopes_of<Source>; ++d)
      if (Source::takes(value, d) &&
          (Source::component(value) < 0 || !Source::takes(value, d == Source::dim ? 0 : d)))
        return false;
  return true;
}

/// The first component of the gradient, from d on, that goes into a value of the term; k_slopes_of if none.
template <class Source>
KOKKOS_INLINE_FUNCTION constexpr int first_taken(int value, int d = 0) {
  while (d < k_slopes_of<Source> && !Source::takes(value, d)) ++d;
  return d;
}

/// The term of a node with weight w and its gradient `grad` [1/cell], by add(value, term). offset() [cells]
/// from the particle to the node is asked for where the source takes one.
template <class Source, class W, int Slopes, class Offset, class Add>
KOKKOS_INLINE_FUNCTION void give(const typename Source::Point& q, W w, const Vector<W, Slopes>& grad,
                                 [[maybe_unused]] Offset&& offset, Add&& add) {
  static_assert(Slopes == k_slopes_of<Source> && sums_of_one_kind<Source>());
  unrolled<Source::size>([&](auto value) {
    constexpr int first = first_taken<Source>(value);
    if constexpr (first == Slopes) {
      add(value, w * Source::factor(q, value));
    } else {
      W term = grad[first] * Source::slope(q, value, first);
      unrolled<Slopes>([&](auto d) {
        if constexpr (d > first && Source::takes(value, d)) term += grad[d] * Source::slope(q, value, d);
      });
      add(value, term);
    }
  });
  if constexpr (requires { Source::takes_offset; }) Source::give_more(q, w, offset(), add);
}

/// Gives what the nodes beyond walls have in a window's sums to their images; at a wall, what soil and image
/// have together stays. sum(n, value): that of node n.
template <class Source, class T, int Dim, class Sum>
KOKKOS_INLINE_FUNCTION void fold_images(const Grid<T, Dim>& grid, const Coord<Dim>& origin, const Sum& sum) {
  for (int d = 0; d < Dim; ++d)
    for_each_image(grid, origin, d, [&](int place, int image, int at) {
      for (int v = 0; v < Source::size; ++v) {
        const T given = image_sign<Source::kind, T>(grid, d, at, Source::component(v)) * sum(place, v);
        sum(place, v) = 0;
        sum(image, v) += given;
      }
    });
}

/// Bytes of the sums of one window.
template <class Source>
inline constexpr std::size_t window_bytes =
    sizeof(typename Source::real) * Source::size* Patch<Source::dim>::window;

/// Sources of one, two or three scalars, and of a vector. In 2D two scalars are also one for each direction.
template <class Space, class T, int Dim, ParticleDomain domain = ParticleDomain::stretch>
using ScalarSource = ValueSource<Space, T, Dim, 1, Kind::geometry, domain>;
template <class Space, class T, int Dim, ParticleDomain domain = ParticleDomain::stretch>
using PairSource = ValueSource<Space, T, Dim, 2, Kind::geometry, domain>;
template <class Space, class T, int Dim>
using TripleSource = ValueSource<Space, T, Dim, 3, Kind::geometry>;
template <class Space, class T, int Dim, ParticleDomain domain = ParticleDomain::stretch>
using VectorSource = ValueSource<Space, T, Dim, Dim, Kind::motion, domain>;

/// Applies X(Source) to the sources of soil, or of values, whose particles have a domain.
#define MPM_SOIL_SOURCES(X, Space, T, Dim, domain)       \
  X(SoilSource<Space, T, Dim, ParticleDomain::domain>)   \
  X(AffineSource<Space, T, Dim, ParticleDomain::domain>) \
  X(BoundarySource<Space, T, Dim, ParticleDomain::domain>)
#define MPM_VALUE_SOURCES(X, Space, T, Dim, domain)      \
  X(ScalarSource<Space, T, Dim, ParticleDomain::domain>) \
  X(PairSource<Space, T, Dim, ParticleDomain::domain>) X(VectorSource<Space, T, Dim, ParticleDomain::domain>)
/// Bodies of revolution are in 2D alone; three scalars are summed in 3D alone.
#define MPM_IN_2D_2(...) __VA_ARGS__
#define MPM_IN_2D_3(...)
#define MPM_IN_3D_2(...)
#define MPM_IN_3D_3(...) __VA_ARGS__

/// Applies X(Source) to the sources that most runs take in every step, of a space, real type and dimension.
#define MPM_FOR_EACH_STEP_SOURCE(X, Space, T, Dim) \
  MPM_SOIL_SOURCES(X, Space, T, Dim, fixed)        \
  X(RigidSource<Space, T, Dim>)                    \
  MPM_SOIL_SOURCES(X, Space, T, Dim, stretch)      \
  MPM_IN_2D_##Dim(MPM_SOIL_SOURCES(X, Space, T, 2, ring))
/// The others.
#define MPM_FOR_EACH_OTHER_SOURCE(X, Space, T, Dim)                      \
  MPM_VALUE_SOURCES(X, Space, T, Dim, stretch)                           \
  X(CentreSource<Space, T, Dim>)                                         \
  X(CloudSource<Space, T, Dim>)                                          \
  X(FlowSource<Space, T, Dim>)                                           \
  MPM_IN_2D_##Dim(X(FlowSource<Space, T, 2, ParticleDomain::ring>))      \
      MPM_IN_2D_##Dim(X(CloudSource<Space, T, 2, ParticleDomain::ring>)) \
          MPM_IN_2D_##Dim(MPM_VALUE_SOURCES(X, Space, T, 2, ring))       \
              MPM_IN_3D_##Dim(X(TripleSource<Space, T, 3>))
#define MPM_FOR_EACH_SOURCE(X, Space, T, Dim) \
  MPM_FOR_EACH_STEP_SOURCE(X, Space, T, Dim)  \
  MPM_FOR_EACH_OTHER_SOURCE(X, Space, T, Dim)

}  // namespace mpm
