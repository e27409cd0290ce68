#pragma once
// What one particle gives one node. Physics is written here once; the strategies are loop shapes around it.

#include "nodes.hpp"
#include "particles.hpp"
#include "shape_gimp.hpp"

namespace mpm {

/// Soil to nodes, Eqs (1), (2), (4): m_i = sum S m_p, p_i = sum S m_p v_p, f_i = - sum V_p sigma_p grad S.
/// The weight, Eq. (5), is m_i g and is added at the node.
template <class Space_, class T, int Dim>
struct SoilSource {
  using Space = Space_;
  using real = T;
  static constexpr int dim = Dim, size = SoilShare<Dim>::size;
  struct Point {
    T half_length, mass;
    Vector<T, Dim> momentum;
    SymTensor<T, Dim> stress_volume;  // - V_p sigma_p / d
  };
  Soil<Space, T, Dim> points;
  T inv_spacing;

  KOKKOS_INLINE_FUNCTION static constexpr bool skips(int) { return false; }
  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    const BodyProperties<T> body = points.bodies(points.body(p));
    Point q{body.half_length, body.mass, points.velocity(p), points.stress(p)};
    const T scale = -points.volume(p) * inv_spacing;
    for (int d = 0; d < Dim; ++d) q.momentum[d] *= q.mass;
    for (int k = 0; k < sym_size<Dim>; ++k) q.stress_volume[k] *= scale;
    return q;
  }
  template <class Add>
  KOKKOS_INLINE_FUNCTION static void give(const Point& q, T w, const Vector<T, Dim>& grad, Add&& add) {
    add(SoilShare<Dim>::mass, w * q.mass);
    for (int d = 0; d < Dim; ++d) add(SoilShare<Dim>::momentum + d, w * q.momentum[d]);
    for (int d = 0; d < Dim; ++d) {
      T f = q.stress_volume[sym_index<Dim>(d, 0)] * grad[0];
      for (int e = 1; e < Dim; ++e) f += q.stress_volume[sym_index<Dim>(d, e)] * grad[e];
      add(SoilShare<Dim>::force + d, f);
    }
  }
};

/// Soil to nodes by APIC (Jiang et al. 2015): as SoilSource, but p_i = sum S m_p (v_p + C_p (x_i - x_p)).
template <class Space_, class T, int Dim>
struct AffineSource : SoilSource<Space_, T, Dim> {
  using Base = SoilSource<Space_, T, Dim>;
  static constexpr bool takes_offset = true;
  struct Point : Base::Point {
    Matrix<T, Dim> affine;  // m_p C_p, kg m/s a cell
  };

  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    Point q{Base::load(p), this->points.affine(p)};
    for (int k = 0; k < Dim * Dim; ++k) q.affine[k] *= q.mass;
    return q;
  }
  /// offset [cells] from the particle to the node.
  template <class Add>
  KOKKOS_INLINE_FUNCTION static void give(const Point& q, T w, const Vector<T, Dim>& grad,
                                          const Vector<T, Dim>& offset, Add&& add) {
    typename Base::Point here = q;
    for (int d = 0; d < Dim; ++d)
      for (int e = 0; e < Dim; ++e) here.momentum[d] += q.affine(d, e) * offset[e];
    Base::give(here, w, grad, add);
  }
};

/// Any velocity of the particles to nodes, as momentum: sum S m_p r_p. XPIC sends what is left of theirs.
template <class Space_, class T, int Dim>
struct RestSource {
  using Space = Space_;
  using real = T;
  static constexpr int dim = Dim, size = Dim;
  struct Point {
    T half_length;
    Vector<T, Dim> momentum;
  };
  Soil<Space, T, Dim> points;
  Kokkos::View<Vector<T, Dim>*, typename Space::memory_space, Kokkos::MemoryUnmanaged> rest;  // m/s

  KOKKOS_INLINE_FUNCTION static constexpr bool skips(int) { return false; }
  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    const BodyProperties<T> body = points.bodies(points.body(p));
    Point q{body.half_length, rest(p)};
    for (int d = 0; d < Dim; ++d) q.momentum[d] *= body.mass;
    return q;
  }
  template <class Add>
  KOKKOS_INLINE_FUNCTION static void give(const Point& q, T w, const Vector<T, Dim>&, Add&& add) {
    for (int d = 0; d < Dim; ++d) add(d, w * q.momentum[d]);
  }
};

/// The soil's boundary at a node, sum grad S V_p: by Gauss' theorem the integral of S_i n over it, n out of
/// the soil. Summed over the nodes along a face it is the face's area, however the face cuts the cells. And
/// its volume there, sum S V_p.
template <class Space_, class T, int Dim>
struct BoundarySource {
  using Space = Space_;
  using real = T;
  static constexpr int dim = Dim, size = BoundaryShare<Dim>::size;
  struct Point {
    T half_length, area, volume;  // V_p / d, V_p
  };
  Soil<Space, T, Dim> points;
  T inv_spacing;
  Kokkos::View<int*, typename Space::memory_space> near_rigid;  // by slot

  /// Far from every rigid the boundary matters to nobody.
  KOKKOS_INLINE_FUNCTION bool skips(int slot) const { return near_rigid(slot) == 0; }
  KOKKOS_INLINE_FUNCTION Point load(int p) const {
    const T volume = points.volume(p);
    return {points.bodies(points.body(p)).half_length, volume * inv_spacing, volume};
  }
  template <class Add>
  KOKKOS_INLINE_FUNCTION static void give(const Point& q, T w, const Vector<T, Dim>& grad, Add&& add) {
    for (int d = 0; d < Dim; ++d) add(BoundaryShare<Dim>::area + d, grad[d] * q.area);
    add(BoundaryShare<Dim>::volume, w * q.volume);
  }
};

/// Rigid body to nodes: m_i^R = sum S m_p and the mass gradient n_i^R = sum grad S m_p (Eq. 3; it points out
/// of the body).
template <class Space_, class T, int Dim>
struct RigidSource {
  using Space = Space_;
  using real = T;
  static constexpr int dim = Dim, size = RigidShare<Dim>::size;
  struct Point {
    T half_length, mass;
  };
  RigidPoints<Space, T, Dim> points;

  KOKKOS_INLINE_FUNCTION static constexpr bool skips(int) { return false; }
  KOKKOS_INLINE_FUNCTION Point load(int) const { return {points.half_length, points.mass}; }
  template <class Add>
  KOKKOS_INLINE_FUNCTION static void give(const Point& q, T w, const Vector<T, Dim>& grad, Add&& add) {
    add(RigidShare<Dim>::mass, w * q.mass);
    for (int d = 0; d < Dim; ++d) add(RigidShare<Dim>::normal + d, grad[d] * q.mass);
  }
};

/// Source::give, with the offset() from the particle to the node [cells] where the source takes one.
template <class Source, class T, int Dim, class Offset, class Add>
KOKKOS_INLINE_FUNCTION void give(const typename Source::Point& q, T w, const Vector<T, Dim>& grad,
                                 Offset&& offset, Add&& add) {
  if constexpr (requires { Source::takes_offset; })
    Source::give(q, w, grad, offset(), add);
  else
    Source::give(q, w, grad, add);
}

/// Applies X(Source) to every source of a space, real type and dimension.
#define MPM_FOR_EACH_SOURCE(X, Space, T, Dim) \
  X(SoilSource, Space, T, Dim)                \
  X(AffineSource, Space, T, Dim)              \
  X(RestSource, Space, T, Dim)                \
  X(BoundarySource, Space, T, Dim)            \
  X(RigidSource, Space, T, Dim)

}  // namespace mpm
