#pragma once
// Particles that are rings: 2D runs of bodies of revolution (-geometry axisymmetric), x the radius r and y
// the axis. The weights are means over the particle with the measure r dr dz (Nairn & Guilkey 2015). A
// particle whose domain would cross the axis is cut there. Volumes and masses are those of the whole ring.

#include "physics/domain.hpp"
#include "physics/shape_gimp.hpp"

namespace mpm {

/// Domain of a particle that is no ring, of which a step needs nothing.
struct PlaneDomain {};

/// The part of a ring that is on the outer side of the axis: its centre and half length [cells].
template <class T>
struct RadialPart {
  T centre;  // in the frame of the particle's cell
  HalfLength<T> half;
};
template <class T>
KOKKOS_INLINE_FUNCTION RadialPart<T> radial_part(T x, const RingDomain<T>& ring) {
  const T low = Kokkos::fmax(x - ring.half.l, ring.axis_x);
  const T half = (x + ring.half.l - low) / 2;
  return {low + half, HalfLength<T>(half)};
}

/// Centre of the mass of a part, along the radius [cells].
template <class T>
KOKKOS_INLINE_FUNCTION T radial_centroid(const RadialPart<T>& part, const RingDomain<T>& ring) {
  return part.centre + part.half.l * part.half.l / (3 * (part.centre - ring.axis_x));
}

/// Weights along the radius: w and g of AxisWeights are means of N and dN/dr with the measure r dr, and
///   t[k] [1/cell] mean of N / r, which gives the hoop strain; their sum is 1 / (radius of the part's centre)
///   centroid [cells] sum of w[k] times the node's coordinate: the centre of the part's mass
template <class T>
struct RadialWeights : AxisWeights<T> {
  T t[3], centroid;
};

/// `first` is known here, as in weights_from;  r [cells] from that node to the centre of the part,  radius
/// [cells] of the centre.
template <class T>
KOKKOS_INLINE_FUNCTION RadialWeights<T> radial_weights_from(FirstNode<T> first, T r, HalfLengthOf<T> half,
                                                            T radius) {
  RadialWeights<T> a;
  static_cast<AxisWeights<T>&>(a) = weights_from<T>(first, r, half);
  const T l = half.l, inverse = 1 / radius;
  const T over = 2 * l * a.g[2];  // how far the particle reaches beyond the second node
  const T under = 2 * l - over;   // and how much of it is on this side of it
  for (int k = 0; k < 3; ++k) a.t[k] = a.w[k] * inverse;
  a.w[0] = a.w[0] * (1 - over * inverse / 2) - under * under * under * half.inverse * inverse / 12;
  a.w[2] = a.t[2] * (radius - r + 1 + 2 * over / 3);
  a.w[1] = 1 - a.w[0] - a.w[2];
  a.g[0] *= 1 - over * inverse / 2;
  a.g[2] *= 1 + (l - over / 2) * inverse;
  a.g[1] = -(a.g[0] + a.g[2]);
  return a;
}

/// The weights along the radius of a particle at any x.
template <class T>
KOKKOS_INLINE_FUNCTION RadialWeights<T> radial_weights(T x, const RingDomain<T>& ring) {
  const RadialPart<T> part = radial_part(x, ring);
  const T low = Kokkos::floor(part.centre - part.half.l);
  RadialWeights<T> a =
      radial_weights_from<T>(static_cast<int>(low), part.centre - low, part.half, part.centre - ring.axis_x);
  a.centroid = radial_centroid(part, ring);
  return a;
}

/// Radial weights of a particle that has drifted from its cell by half a cell at most, as axis_weights_near.
template <class T>
KOKKOS_INLINE_FUNCTION RadialWeights<T> radial_weights_near(T x, const RingDomain<T>& ring) {
  const RadialPart<T> part = radial_part(x, ring);
  const T low = part.centre - part.half.l;
  const auto beyond = low >= 1;
  const auto first = select(low < 0, FirstNode<T>(-1), FirstNode<T>(0));
  RadialWeights<T> a = radial_weights_from<T>(first, part.centre - first - select(beyond, T(1), T(0)),
                                              part.half, part.centre - ring.axis_x);
  for (int k = 2; k >= 0; --k) {
    a.w[k] = select(beyond, k > 0 ? a.w[k - 1] : T(0), a.w[k]);
    a.g[k] = select(beyond, k > 0 ? a.g[k - 1] : T(0), a.g[k]);
    a.t[k] = select(beyond, k > 0 ? a.t[k - 1] : T(0), a.t[k]);
  }
  a.centroid = radial_centroid(part, ring);
  return a;
}

/// The weights of a ring: along the radius, and along the axis of revolution.
template <class T>
struct RingWeights {
  RadialWeights<T> r;
  AxisWeights<T> z;
  KOKKOS_INLINE_FUNCTION const AxisWeights<T>& operator[](int d) const {
    return d == 0 ? static_cast<const AxisWeights<T>&>(r) : z;
  }
};

/// As for_each_weight of a plane; the last component of the gradient is the weight of the hoop strain, T S.
template <class T, class F>
KOKKOS_INLINE_FUNCTION void for_each_weight(const RingWeights<T>& a, F&& f) {
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      f(Vector<int, 2>{i, j}, a.r.w[i] * a.z.w[j],
        Vector<T, 3>{a.r.g[i] * a.z.w[j], a.r.w[i] * a.z.g[j], a.r.t[i] * a.z.w[j]});
}
template <int N, int M, class T, class At, class V>
KOKKOS_INLINE_FUNCTION void interpolate_by_lines(const RingWeights<T>& a, At&& at, V (&value)[N],
                                                 V (&gradient)[M][3]) {
  for (int j = 0; j < 3; ++j) {
    V along[N] = {}, slope[M] = {}, hoop[M] = {};
    for (int i = 0; i < 3; ++i) {
      const auto& node = at(Vector<int, 2>{i, j});
      for (int n = 0; n < N; ++n) along[n] += a.r.w[i] * node[n];
      for (int n = 0; n < M; ++n) slope[n] += a.r.g[i] * node[n], hoop[n] += a.r.t[i] * node[n];
    }
    for (int n = 0; n < N; ++n) value[n] += a.z.w[j] * along[n];
    for (int n = 0; n < M; ++n) {
      gradient[n][0] += a.z.w[j] * slope[n];
      gradient[n][1] += a.z.g[j] * along[n];
      gradient[n][2] += a.z.w[j] * hoop[n];
    }
  }
}
/// From the centre of the particle's mass, so that the weighted sum of all offsets is zero.
template <class T>
KOKKOS_INLINE_FUNCTION Vector<T, 2> offset_to(const Vector<T, 2>& x, const RingWeights<T>& a,
                                              const Vector<int, 2>& k) {
  return {a.r.first + k[0] - a.r.centroid, a.z.first + k[1] - x[1]};
}
template <class T, class F>
KOKKOS_INLINE_FUNCTION void with_weights(const Vector<T, 2>& x, const RingDomain<T>& ring, F&& f) {
  f(RingWeights<T>{radial_weights(x[0], ring), axis_weights(x[1], ring.half)});
}
template <class T, class F>
KOKKOS_INLINE_FUNCTION void with_weights_near(const Vector<T, 2>& x, const RingDomain<T>& ring, F&& f) {
  f(RingWeights<T>{radial_weights_near(x[0], ring), axis_weights_near(x[1], ring.half)});
}

/// Weight, gradient and hoop weight, as for_each_weight has them, of a single node.
///   x [cells] particle minus node;  ring: in the frame of the node
template <class T>
KOKKOS_INLINE_FUNCTION T single_node_weight(const Vector<T, 2>& x, const RingDomain<T>& ring,
                                            Vector<T, 3>& grad) {
  const RadialWeights<T> a = radial_weights(x[0], ring);
  T w = 0, g = 0, t = 0, s, ds;
  for (int k = 0; k < 3; ++k)
    if (a.first + k == 0) w = a.w[k], g = a.g[k], t = a.t[k];
  node_weight(x[1], ring.half, s, ds);
  grad = {g * s, w * ds, t * s};
  return w * s;
}
template <class T>
KOKKOS_INLINE_FUNCTION Vector<T, 2> offset_from(const Vector<T, 2>& x, const RingDomain<T>& ring) {
  return {-radial_centroid(radial_part(x[0], ring), ring), -x[1]};
}

/// How a particle moves in a step along axis d [cells/s], from `hoop`, the weighted sums of the nodes'
/// velocities with T [1/s]: the radius times the rate of the hoop strain, so that no particle passes the
/// axis, and along the axis of revolution the mean over the plane section.
template <class T>
KOKKOS_INLINE_FUNCTION T ring_velocity(T x, const RingDomain<T>& ring, int d, T hoop) {
  return hoop * ((d == 0 ? x : radial_part(x, ring).centre) - ring.axis_x);
}

/// Length of the circle that a particle is revolved along [m]; 1 m where the run is plane. x [cells]
template <class T, class Domain>
KOKKOS_INLINE_FUNCTION T revolved_length([[maybe_unused]] T x, const Domain& domain,
                                         [[maybe_unused]] T spacing) {
  if constexpr (requires { domain.axis_x; })
    return T(2 * Kokkos::numbers::pi) * (x - domain.axis_x) * spacing;
  else
    return T(1);
}
/// Volume of particle p that the bounds of volumes limit [m3]: for a ring, its section times 1 m.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION T bounded_volume(const Soil<Space, T, Dim>& soil, int p, [[maybe_unused]] T spacing) {
  if constexpr (Dim == 2)
    if (soil.rings) {
      const RingDomain<T> ring{{}, axis_of<T>(soil, soil.cell(p))};
      return soil.volume(p) / revolved_length(soil.coordinate(p)[0], ring, spacing);
    }
  return soil.volume(p);
}

}  // namespace mpm
