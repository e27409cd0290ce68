#pragma once
// Contact between two rigid bodies: places of surface points, and impulses by Coulomb's and Newton's laws.

#include "data/rigid.hpp"
#include "data/rigid_pairs.hpp"
#include "physics/rigid_motion.hpp"
#include "physics/surface.hpp"

namespace mpm {

/// Pose of a body of a pair; sides of the mesh, which follow the rigids, stay.
template <int Dim>
KOKKOS_INLINE_FUNCTION RigidPose<Dim> pose_of(const Rigid<Dim>* rigids, int count, int n) {
  return n < count ? rigids[n].motion.pose : RigidPose<Dim>{};
}

/// Place where a surface point of one body is nearest to another body.
template <int Dim>
struct Nearness {
  double gap = Kokkos::Experimental::infinity_v<double>;  // m
  Vector<double, Dim> normal = {};                        // of the other body
  Vector<double, Dim> place = {};                         // m, half way between the surfaces
};

/// Nearness of a point of a body to the body `on`. The normal is that at a place a little inside the first,
/// and the gap that to the plane through the nearest place there: a corner of a block that stands on another
/// one of the same width is as near to its side as to its top, and a place above the corner is not.
template <int Dim, class Vertices>
KOKKOS_INLINE_FUNCTION Nearness<Dim> nearness(const RigidPose<Dim>& pose, const SurfacePoint<Dim>& point,
                                              const PairBody<Dim>& on, const RigidPose<Dim>& other,
                                              const Vertices& vertices) {
  constexpr double k_opposite = 0.05;  // of the way inward: less is a face that looks another way
  Nearness<Dim> out;
  Vector<double, Dim> x = pose.to_world(point.x);
  const Vector<double, Dim> inward = pose.turn_to_world(point.inward);
  const Vector<double, Dim> at = other.to_body([&](int d) { return x[d] + inward[d]; });
  const Distance<Dim> found = distance_to(on.surface, vertices, at);
  const Vector<double, Dim> n = other.turn_to_world(found.normal);
  const double along = dot(n, inward), way = Kokkos::sqrt(dot(inward, inward));
  if (!(dot(n, n) > 0.5) || along < k_opposite * way) return out;
  out.gap = found.value - along - point.radius;
  out.normal = n;
  for (int d = 0; d < Dim; ++d) out.place[d] = x[d] - n[d] * (point.radius + out.gap / 2);
  return out;
}

/// Contacts of a pair by number, as PairContact::point: the points of a, and behind them those of b. A ball
/// is nearest to the other body where its centre is. Normals are from b to a.
template <int Dim>
struct PairPlaces {
  PairBody<Dim> a, b;
  RigidPose<Dim> pose_a, pose_b;

  KOKKOS_INLINE_FUNCTION int begin() const { return b.ball && !a.ball ? a.count : 0; }
  KOKKOS_INLINE_FUNCTION int end() const { return a.ball ? a.count : a.count + b.count; }
  template <class Points, class Vertices>
  KOKKOS_INLINE_FUNCTION Nearness<Dim> operator()(int n, const Points& points,
                                                  const Vertices& vertices) const {
    if (n < a.count) return nearness(pose_a, points(a.first + n), b, pose_b, vertices);
    Nearness<Dim> out = nearness(pose_b, points(b.first + n - a.count), a, pose_a, vertices);
    for (int d = 0; d < Dim; ++d) out.normal[d] = -out.normal[d];
    return out;
  }
  /// Sets the place, normal and gap of a contact.
  KOKKOS_INLINE_FUNCTION void set(PairContact<Dim>& at, const Nearness<Dim>& found) const {
    at.normal = found.normal, at.gap = found.gap;
    at.arms[0] = pose_a.arm_to([&](int d) { return found.place[d]; });
    at.arms[1] = pose_b.arm_to([&](int d) { return found.place[d]; });
  }
};

/// Component d of way k along which the farthest contact of a pair is kept: the axes, and the diagonals.
template <int Dim>
KOKKOS_INLINE_FUNCTION int pair_way(int k, int d) {
  if (k < 2 * Dim) return k / 2 != d ? 0 : (k % 2 == 0 ? 1 : -1);
  return ((k - 2 * Dim) >> d & 1) == 0 ? 1 : -1;
}

/// The product of a body's inverse inertia with a moment.
KOKKOS_INLINE_FUNCTION AngularVector<2> turned_by(const PairMotion<2>& body, const AngularVector<2>& m) {
  return {body.ease[0] * m[0]};
}
KOKKOS_INLINE_FUNCTION AngularVector<3> turned_by(const PairMotion<3>& body, const AngularVector<3>& m) {
  const double* const e = body.ease;
  return {e[0] * m[0] + e[3] * m[1] + e[5] * m[2], e[3] * m[0] + e[1] * m[1] + e[4] * m[2],
          e[5] * m[0] + e[4] * m[1] + e[2] * m[2]};
}

/// Inverse inertia in space.
KOKKOS_INLINE_FUNCTION void set_ease(const Turning<2>& body, const Rotation<2>&, PairMotion<2>& to) {
  to.ease[0] = body.axis == Turning<2>::k_held ? 0 : 1 / body.principal[0];
}
KOKKOS_INLINE_FUNCTION void set_ease(const Turning<3>& body, const Rotation<3>& rotation, PairMotion<3>& to) {
  for (double& e : to.ease) e = 0;
  if (body.axis == Turning<3>::k_held) return;
  if (body.axis != Turning<3>::k_free) {
    to.ease[body.axis] = 1 / inertia_about(body, rotation, body.axis);
    return;
  }
  for (int d = 0; d < 3; ++d) {
    AngularVector<3> unit{};
    unit[d] = 1;
    const AngularVector<3> column = spin_of(body, rotation, unit);
    const int next = (d + 1) % 3;
    to.ease[d] = column[d];
    to.ease[3 + d] = column[next];
  }
}

/// Motion of a rigid body at the end of a step of dt [s] without contact between rigid bodies; soil: the
/// wrench of the soil on it.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION PairMotion<Dim> free_motion(const MovingRigid<Dim>& rigid, const Wrench<Dim>& soil,
                                                   double damping, double dt) {
  PairMotion<Dim> out{};
  const Turning<Dim>& turning = rigid.inertia.turning;
  const Vector<double, Dim> a = acceleration_of<T>(rigid, soil, damping, dt);
  for (int d = 0; d < Dim; ++d) {
    out.before[d] = rigid.motion.velocity[d];
    out.velocity[d] = out.before[d] + dt * a[d];
    out.lightness[d] = rigid.inertia.dynamic && !rigid.inertia.held[d] ? 1 / rigid.inertia.mass : 0;
  }
  out.spin = out.spin_before = rigid.motion.spin;
  if (!rigid.motion.pose.turns || !rigid.inertia.dynamic || turning.axis == Turning<Dim>::k_held) return out;
  const Rotation<Dim>& rotation = rigid.motion.pose.rotation;
  set_ease(turning, rotation, out);
  const AngularVector<Dim> kick = kick_of<T>(rigid, soil, damping, dt);
  const AngularVector<Dim> more = turned_by(out, kick);
  for (int k = 0; k < k_turning_axes<Dim>; ++k) out.spin[k] += 2 * more[k];
  return out;
}

/// Velocity of a point at the end of an arm.
template <int Dim>
KOKKOS_INLINE_FUNCTION Vector<double, Dim> velocity_at(const Vector<double, Dim>& velocity,
                                                       const AngularVector<Dim>& spin,
                                                       const Vector<double, Dim>& arm) {
  Vector<double, Dim> v = cross(spin, arm);
  for (int d = 0; d < Dim; ++d) v[d] += velocity[d];
  return v;
}

/// Velocity of body a against body b at a contact.
template <int Dim>
KOKKOS_INLINE_FUNCTION Vector<double, Dim> parting(const PairContact<Dim>& at, const PairMotion<Dim>& a,
                                                   const PairMotion<Dim>& b) {
  Vector<double, Dim> v = velocity_at<Dim>(a.velocity, a.spin, at.arms[0]);
  const Vector<double, Dim> other = velocity_at<Dim>(b.velocity, b.spin, at.arms[1]);
  for (int d = 0; d < Dim; ++d) v[d] -= other[d];
  return v;
}

/// The same at the beginning of the step.
template <int Dim>
KOKKOS_INLINE_FUNCTION Vector<double, Dim> parting_before(const PairContact<Dim>& at,
                                                          const PairMotion<Dim>& a,
                                                          const PairMotion<Dim>& b) {
  Vector<double, Dim> v = velocity_at<Dim>(a.before, a.spin_before, at.arms[0]);
  const Vector<double, Dim> other = velocity_at<Dim>(b.before, b.spin_before, at.arms[1]);
  for (int d = 0; d < Dim; ++d) v[d] -= other[d];
  return v;
}

/// Whether impulses move a body. Several threads may push one that they do not move, as pairs of one colour
/// share such bodies: it stays as it is.
template <int Dim>
KOKKOS_INLINE_FUNCTION bool moves(const PairMotion<Dim>& body) {
  bool any = false;
  for (int d = 0; d < Dim; ++d) any = any || body.lightness[d] != 0;
  for (double each : body.ease) any = any || each != 0;
  return any;
}

/// Adds an impulse [N s] at the end of an arm to a body that moves.
template <int Dim>
KOKKOS_INLINE_FUNCTION void push_body(PairMotion<Dim>& body, const Vector<double, Dim>& arm,
                                      const Vector<double, Dim>& impulse, double sign) {
  if (!moves(body)) return;
  const AngularVector<Dim> moment = moment_of(arm, impulse), more = turned_by(body, moment);
  for (int d = 0; d < Dim; ++d) {
    body.velocity[d] += sign * body.lightness[d] * impulse[d];
    body.impulse[Wrench<Dim>::force + d] += sign * impulse[d];
  }
  for (int k = 0; k < k_turning_axes<Dim>; ++k) {
    body.spin[k] += sign * more[k];
    body.impulse[Wrench<Dim>::moment + k] += sign * moment[k];
  }
}

/// Velocity [1/kg] along `to` of a body by an impulse of 1 along `by`, both at the end of an arm.
template <int Dim>
KOKKOS_INLINE_FUNCTION double yield_of(const PairMotion<Dim>& body, const Vector<double, Dim>& arm,
                                       const Vector<double, Dim>& by, const Vector<double, Dim>& to) {
  double sum = 0;
  const AngularVector<Dim> m = moment_of(arm, by), n = moment_of(arm, to), turned = turned_by(body, m);
  for (int d = 0; d < Dim; ++d) sum += body.lightness[d] * by[d] * to[d];
  for (int k = 0; k < k_turning_axes<Dim>; ++k) sum += turned[k] * n[k];
  return sum;
}

/// The largest yield along the face of a contact.
KOKKOS_INLINE_FUNCTION double slide_of(const PairContact<2>& at, const PairMotion<2>& a,
                                       const PairMotion<2>& b) {
  const Vector<double, 2> t{-at.normal[1], at.normal[0]};
  return yield_of(a, at.arms[0], t, t) + yield_of(b, at.arms[1], t, t);
}
KOKKOS_INLINE_FUNCTION double slide_of(const PairContact<3>& at, const PairMotion<3>& a,
                                       const PairMotion<3>& b) {
  const Vector<double, 3>& n = at.normal;
  int least = 0;
  for (int d = 1; d < 3; ++d)
    if (Kokkos::fabs(n[d]) < Kokkos::fabs(n[least])) least = d;
  Vector<double, 3> t{};
  t[least] = 1;
  t = cross(n, t);
  const double length = Kokkos::sqrt(dot(t, t));
  for (int d = 0; d < 3; ++d) t[d] /= length;
  const Vector<double, 3> u = cross(n, t);
  const auto both = [&](const Vector<double, 3>& by, const Vector<double, 3>& to) {
    return yield_of(a, at.arms[0], by, to) + yield_of(b, at.arms[1], by, to);
  };
  const double tt = both(t, t), uu = both(u, u), tu = both(t, u), half = (tt - uu) / 2;
  return (tt + uu) / 2 + Kokkos::sqrt(half * half + tu * tu);
}

/// Sets what a contact of a step of dt [s] asks for: bodies do not come into each other, and after an impact
/// they part with a share of the velocity of approach (Newton). A velocity that gravity and other forces make
/// in two steps is no impact. `at` has its place, normal and gap.
template <int Dim>
KOKKOS_INLINE_FUNCTION void set_bounds(PairContact<Dim>& at, const PairMotion<Dim>& a,
                                       const PairMotion<Dim>& b, double restitution, double dt) {
  const auto& n = at.normal;
  const double v_free = dot(parting(at, a, b), n);
  at.before = dot(parting_before(at, a, b), n);
  const bool meet = at.gap + dt / 2 * (at.before + v_free) < 0;
  at.least = Kokkos::fmin(0.0, -2 * Kokkos::fmax(0.0, at.gap) / dt - at.before);
  if (meet && -at.before > 2 * Kokkos::fabs(v_free - at.before))
    at.least = Kokkos::fmax(at.least, -restitution * at.before);
  at.yield = yield_of(a, at.arms[0], n, n) + yield_of(b, at.arms[1], n, n);
  at.slide = slide_of(at, a, b);
  at.lift = 0;
}

/// Improves the impulse of a contact. Returns the change of velocity by it [m/s].
template <int Dim>
KOKKOS_INLINE_FUNCTION double relax_contact(PairContact<Dim>& at, PairMotion<Dim>& a, PairMotion<Dim>& b,
                                            double friction) {
  if (!(at.yield > 0)) return 0;
  const Vector<double, Dim>& n = at.normal;
  const Vector<double, Dim> v = parting(at, a, b);
  const double v_n = dot(v, n), was = dot(at.impulse, n);
  const double normal = Kokkos::fmax(0.0, was + (at.least - v_n) / at.yield);
  if (normal == 0 && was == 0) return 0;
  Vector<double, Dim> along;
  double square = 0;
  for (int d = 0; d < Dim; ++d) {
    along[d] = at.impulse[d] - was * n[d];
    if (at.slide > 0) along[d] -= (v[d] - v_n * n[d]) / at.slide;
    square += along[d] * along[d];
  }
  const double most = friction * normal, size = Kokkos::sqrt(square), share = size > most ? most / size : 1;
  Vector<double, Dim> more;
  for (int d = 0; d < Dim; ++d) {
    const double now = normal * n[d] + share * along[d];
    more[d] = now - at.impulse[d];
    at.impulse[d] = now;
  }
  push_body(a, at.arms[0], more, 1);
  push_body(b, at.arms[1], more, -1);
  return Kokkos::sqrt(dot(more, more)) * Kokkos::fmax(at.yield, at.slide);
}

/// Halves the velocity with which bodies part after an impact, or leaves nothing of it (`ends`), where the
/// impact with friction would raise their energy, as Newton's law of restitution may (Kane & Levinson 1985).
/// Returns 1 where it does so, else 0.
template <int Dim>
KOKKOS_INLINE_FUNCTION double soften_impact(PairContact<Dim>& at, const PairMotion<Dim>& a,
                                            const PairMotion<Dim>& b, double friction, bool ends) {
  constexpr double k_round_off = 1e-9;
  if (!(at.least > 0 && friction > 0)) return 0;
  const Vector<double, Dim> v = parting(at, a, b), before = parting_before(at, a, b);
  const double gain = dot(at.impulse, v) + dot(at.impulse, before);  // twice the work of the contact [J]
  const double size = Kokkos::sqrt(dot(at.impulse, at.impulse) * (dot(v, v) + dot(before, before)));
  if (!(gain > k_round_off * size)) return 0;
  at.least = ends ? 0 : at.least / 2;
  return 1;
}

/// Adds a shift of a body's place by an impulse, as its velocity would change [m].
template <int Dim>
KOKKOS_INLINE_FUNCTION void shift_body(PairMotion<Dim>& body, const Vector<double, Dim>& arm,
                                       const Vector<double, Dim>& by, double sign) {
  if (!moves(body)) return;
  const AngularVector<Dim> more = turned_by(body, moment_of(arm, by));
  for (int d = 0; d < Dim; ++d) body.shift[Wrench<Dim>::force + d] += sign * body.lightness[d] * by[d];
  for (int k = 0; k < k_turning_axes<Dim>; ++k) body.shift[Wrench<Dim>::moment + k] += sign * more[k];
}

/// Gap of a contact at the end of a step of dt [s] by the velocities, without shifts [m].
template <int Dim>
KOKKOS_INLINE_FUNCTION double gap_after(const PairContact<Dim>& at, const PairMotion<Dim>& a,
                                        const PairMotion<Dim>& b, double dt) {
  return at.gap + dt / 2 * (at.before + dot(parting(at, a, b), at.normal));
}

/// Improves the shifts by which the bodies of a contact part that would come into each other, by `most` at
/// most [m]. They have no velocity, so that no energy comes of them. Returns the change [m].
template <int Dim>
KOKKOS_INLINE_FUNCTION double part_bodies(PairContact<Dim>& at, PairMotion<Dim>& a, PairMotion<Dim>& b,
                                          double most, double dt) {
  if (!(at.yield > 0)) return 0;
  constexpr double k_share = 0.5;  // of what overlaps, in a step
  const Vector<double, Dim>& n = at.normal;
  const auto shifted = [&](const PairMotion<Dim>& body, const Vector<double, Dim>& arm) {
    Vector<double, Dim> way;
    AngularVector<Dim> angle;
    for (int d = 0; d < Dim; ++d) way[d] = body.shift[Wrench<Dim>::force + d];
    for (int k = 0; k < k_turning_axes<Dim>; ++k) angle[k] = body.shift[Wrench<Dim>::moment + k];
    return dot(velocity_at<Dim>(way, angle, arm), n);
  };
  const double gap = gap_after(at, a, b, dt), least = gap < 0 ? Kokkos::fmin(-k_share * gap, most) : -gap;
  const double now = shifted(a, at.arms[0]) - shifted(b, at.arms[1]);
  const double lift = Kokkos::fmax(0.0, at.lift + (least - now) / at.yield), more = lift - at.lift;
  if (more == 0) return 0;
  at.lift = lift;
  Vector<double, Dim> by;
  for (int d = 0; d < Dim; ++d) by[d] = more * n[d];
  shift_body(a, at.arms[0], by, 1);
  shift_body(b, at.arms[1], by, -1);
  return Kokkos::fabs(more) * at.yield;
}

}  // namespace mpm
