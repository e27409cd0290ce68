#pragma once
// Rotations of rigid bodies: about the normal of the plane in 2D, about any axis in 3D.

#include "base/types.hpp"

namespace mpm {

/// Axes about which a body can turn: one in 2D.
template <int Dim>
inline constexpr int k_turning_axes = Dim == 2 ? 1 : 3;

/// Angular velocity [rad/s], angular momentum [kg m2/s] or moment [N m]; in 2D about the axis normal to the
/// plane, counter-clockwise.
template <int Dim>
using AngularVector = Vector<double, k_turning_axes<Dim>>;

/// The velocity w x r of the end of an arm r.
KOKKOS_INLINE_FUNCTION Vector<double, 2> cross(const AngularVector<2>& w, const Vector<double, 2>& r) {
  return {-w[0] * r[1], w[0] * r[0]};
}
KOKKOS_INLINE_FUNCTION Vector<double, 3> cross(const Vector<double, 3>& w, const Vector<double, 3>& r) {
  return {w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]};
}
/// The moment r x f of a force at the end of an arm r.
KOKKOS_INLINE_FUNCTION AngularVector<2> moment_of(const Vector<double, 2>& r, const Vector<double, 2>& f) {
  return {r[0] * f[1] - r[1] * f[0]};
}
KOKKOS_INLINE_FUNCTION AngularVector<3> moment_of(const Vector<double, 3>& r, const Vector<double, 3>& f) {
  return cross(r, f);
}

template <int Dim>
struct Rotation;

/// A rotation in the plane by an angle [rad], which counts whole turns.
template <>
struct Rotation<2> {
  static constexpr int size = 1;  // numbers that keep it
  double angle = 0, cosine = 1, sine = 0;

  KOKKOS_INLINE_FUNCTION static Rotation by(const AngularVector<2>& angle) {
    return {angle[0], Kokkos::cos(angle[0]), Kokkos::sin(angle[0])};
  }
  KOKKOS_INLINE_FUNCTION Vector<double, 2> turn(const Vector<double, 2>& v) const {
    return {cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]};
  }
  KOKKOS_INLINE_FUNCTION Vector<double, 2> turn_back(const Vector<double, 2>& v) const {
    return {cosine * v[0] + sine * v[1], cosine * v[1] - sine * v[0]};
  }
  /// Rotation by this one and then by another one.
  KOKKOS_INLINE_FUNCTION Rotation then(const Rotation& next) const { return by({angle + next.angle}); }
  /// Angle [rad] from another rotation to this one, along which moments do work.
  KOKKOS_INLINE_FUNCTION AngularVector<2> way_from(const Rotation& other) const {
    return {angle - other.angle};
  }

  KOKKOS_INLINE_FUNCTION void store(double* to) const { to[0] = angle; }
  KOKKOS_INLINE_FUNCTION static Rotation load(const double* from) { return by({from[0]}); }
};

/// A rotation in space, by a unit quaternion: its real part and its vector.
template <>
struct Rotation<3> {
  static constexpr int size = 4;
  double real = 1;
  Vector<double, 3> vector = {0, 0, 0};

  /// By the length of a vector [rad] about it.
  KOKKOS_INLINE_FUNCTION static Rotation by(const AngularVector<3>& angle) {
    const double half = Kokkos::sqrt(angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2]) / 2;
    const double share = half > 1e-8 ? Kokkos::sin(half) / (2 * half) : 0.5;  // to round-off
    return {Kokkos::cos(half), {share * angle[0], share * angle[1], share * angle[2]}};
  }
  KOKKOS_INLINE_FUNCTION Rotation inverse() const { return {real, {-vector[0], -vector[1], -vector[2]}}; }
  KOKKOS_INLINE_FUNCTION Vector<double, 3> turn(const Vector<double, 3>& v) const {
    const Vector<double, 3> twice = cross(vector, v), more = cross(vector, twice);
    Vector<double, 3> out;
    for (int d = 0; d < 3; ++d) out[d] = v[d] + 2 * (real * twice[d] + more[d]);
    return out;
  }
  KOKKOS_INLINE_FUNCTION Vector<double, 3> turn_back(const Vector<double, 3>& v) const {
    return inverse().turn(v);
  }
  /// Rotation by this one and then by another one. Its length is set to 1, so that no round-off gathers.
  KOKKOS_INLINE_FUNCTION Rotation then(const Rotation& next) const {
    const Vector<double, 3> both = cross(next.vector, vector);
    Rotation out{next.real * real};
    for (int d = 0; d < 3; ++d) {
      out.real -= next.vector[d] * vector[d];
      out.vector[d] = next.real * vector[d] + real * next.vector[d] + both[d];
    }
    double square = out.real * out.real;
    for (int d = 0; d < 3; ++d) square += out.vector[d] * out.vector[d];
    const double scale = 1 / Kokkos::sqrt(square);
    out.real *= scale;
    for (int d = 0; d < 3; ++d) out.vector[d] *= scale;
    return out;
  }
  /// The rotation vector [rad], no longer than half a turn.
  KOKKOS_INLINE_FUNCTION AngularVector<3> angle() const {
    const double sign = real < 0 ? -1 : 1;
    const double length = Kokkos::sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    const double scale = length > 1e-12 ? 2 * sign * Kokkos::atan2(length, sign * real) / length : 2 * sign;
    return {scale * vector[0], scale * vector[1], scale * vector[2]};
  }
  KOKKOS_INLINE_FUNCTION AngularVector<3> way_from(const Rotation& other) const {
    return other.inverse().then(*this).angle();
  }

  KOKKOS_INLINE_FUNCTION void store(double* to) const {
    to[0] = real;
    for (int d = 0; d < 3; ++d) to[1 + d] = vector[d];
  }
  KOKKOS_INLINE_FUNCTION static Rotation load(const double* from) {
    return {from[0], {from[1], from[2], from[3]}};
  }
};

}  // namespace mpm
