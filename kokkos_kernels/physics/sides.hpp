#pragma once
// Sides of the mesh with friction, dashpots or a motion of their own, at a node on them (docs/boundaries.md).

#include "physics/contact.hpp"
#include "physics/side_node.hpp"

namespace mpm {

/// The force that a side with dashpots gives a node whatever its velocity [N]: the static reaction, and from
/// a column beside it the stress of the free field.
template <int Dim>
KOKKOS_INLINE_FUNCTION double held_force(const ActingSides<Dim>& acting, int side, const SideNode<Dim>& node,
                                         int k) {
  const double reaction = acting.node(side, node.at)[SideTerms<Dim>::reaction + k];
  if (acting.all[side].kind != Wall::free_field) return reaction;
  return reaction + acting.column(side, node.at)[ColumnTerms<Dim>::traction + k];
}

/// These, to the force on a node [N].
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void add_reactions(const ActingSides<Dim>& acting, const SideNode<Dim>& node,
                                          T* force) {
  for (int side = 0; side < 2 * Dim; ++side) {
    if (!(node.sides >> side & 1u) || !has_dashpots(acting.all[side].kind)) continue;
    for (int k = 0; k < Dim; ++k) force[k] += static_cast<T>(held_force(acting, side, node, k));
  }
}

/// Velocity that dashpots hold on to [m/s]: that of the side, or of the column beside it.
template <int Dim>
KOKKOS_INLINE_FUNCTION const double* far_velocity(const ActingSides<Dim>& acting, int side,
                                                  const SideNode<Dim>& node) {
  if (acting.all[side].kind == Wall::free_field)
    return acting.column(side, node.at) + ColumnTerms<Dim>::after;
  return acting.all[side].velocity.c;
}

/// A dashpot c [kg/s] and a spring s [N/m] on a component of a node's velocity, between the node and what
/// moves with the velocity V, of the implicit step m (v' - v) = -c dt (v' - V) - s dt u' with the drift u' =
/// u
/// + dt (v' - V): v' - v = a (V - v') - pull.
struct Dashpot {
  double a, pull, to;  // -, m/s, V in m/s
  KOKKOS_INLINE_FUNCTION Dashpot(double c, double s, double drift, double dt, double mass, double far)
      : a((c + s * dt) * dt / mass), pull(s * dt / mass * drift), to(far) {}
};
/// That of side n on component k of a node. kept: SideTerms.
template <int Dim>
KOKKOS_INLINE_FUNCTION Dashpot dashpot_of(const ActingSides<Dim>& acting, int n, int k,
                                          const SideNode<Dim>& node, const double* kept) {
  using S = SideTerms<Dim>;
  const int along = k == n / 2 ? 0 : 1;
  return {kept[S::dashpot + along],        kept[S::spring + along], kept[S::drift + k], node.dt, node.mass,
          far_velocity(acting, n, node)[k]};
}

/// Dashpots (Lysmer and Kuhlemeyer 1969) and springs of all sides of a kind at a node, at once, so that
/// their order does not matter. A rehearsal has the springs alone: at rest dashpots have no force, and local
/// damping brakes soil and columns alike.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void absorb(const ActingSides<Dim>& acting, Wall kind, const SideNode<Dim>& node,
                                   const Vector<T, Dim>& v_old, double* v) {
  using S = SideTerms<Dim>;
  const auto each = [&](auto&& f) {
    for (int n = 0; n < 2 * Dim; ++n)
      if (node.on(n) && acting.all[n].kind == kind) f(n, acting.node(n, node.at));
  };
  for (int k = 0; k < Dim; ++k) {
    double sum = v[k], share = 1;
    each([&](int n, const double* kept) {
      const Dashpot by = dashpot_of(acting, n, k, node, kept);
      const double viscous = node.keeps ? by.a : 0;
      sum += viscous * by.to - by.pull, share += viscous;
    });
    v[k] = sum / share;
    each([&](int n, double* kept) {
      const Dashpot by = dashpot_of(acting, n, k, node, kept);
      book(kept, node, v_old, k,
           node.mass * (by.a * (by.to - v[k]) - by.pull) + node.dt * held_force(acting, n, node, k), v[k]);
      if (node.keeps) kept[S::drift + k] += node.dt * (v[k] - by.to);
    });
  }
}

/// Takes the velocity into the side; the side does not pull.
template <int Dim>
KOKKOS_INLINE_FUNCTION void hold_back(const Side<Dim>& side, int d, bool upper, double* v) {
  v[d] = upper ? Kokkos::fmin(v[d], side.velocity[d]) : Kokkos::fmax(v[d], side.velocity[d]);
}

/// Coulomb friction of a side at a node, as contact_correction() has it.
template <int Dim>
struct SideFriction {
  using Terms = SideTerms<Dim>;
  Pressed<double> pressed;  // m/s
  double stops;             // -, share of the slip that friction stops

  /// v: velocity as it comes to the sides; held: that which they leave along their normals [m/s].
  KOKKOS_INLINE_FUNCTION SideFriction(const Side<Dim>& side, int n, const SideNode<Dim>& node,
                                      const double* kept, const double* v, const double* held)
      : pressed{kept_share(ImpulseTerms::sum, node.fresh) * kept[Terms::pressed + ImpulseTerms::sum],
                kept_share(ImpulseTerms::weight, node.fresh) * kept[Terms::pressed + ImpulseTerms::weight],
                kept_share(ImpulseTerms::store, node.fresh) * kept[Terms::pressed + ImpulseTerms::store] /
                    node.mass} {
    const int d = n / 2;
    const double into = n % 2 == 1 ? 1 : -1;
    const double stop = into * (v[d] - side.velocity[d]) - kept[Terms::carried] / node.mass;
    const double normal = node.mass * usable_impulse(pressed, node.fresh, stop);
    double squares = 0;
    for (int k = 0; k < Dim; ++k)
      if (k != d) squares += (held[k] - side.velocity[k]) * (held[k] - side.velocity[k]);
    const double slip = node.mass * Kokkos::sqrt(squares);  // N s
    const double area = side.face * Kokkos::fmin(node.share_of(n), node.mass / side.unit_mass);
    const double most =
        Kokkos::fmin(side.numbers.friction * normal, side.numbers.shear_limit * area * node.dt);
    stops = slip > most ? most / slip : 1;
    if (side.numbers.friction > 0) pressed.store -= stops * slip / (node.mass * side.numbers.friction);
  }
};

/// Friction of all sides that have it at a node, at once. Where sides share a component, they stop at most
/// all of its slip.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void rub(const ActingSides<Dim>& acting, const SideNode<Dim>& node,
                                const Vector<T, Dim>& v_old, double* v) {
  using S = SideTerms<Dim>;
  double held[Dim], stops[Dim], slows[Dim], came[Dim];
  const auto each = [&](auto&& f) {
    for (int n = 0; n < 2 * Dim; ++n)
      if (node.on(n) && acting.all[n].kind == Wall::friction) f(n, acting.all[n], acting.node(n, node.at));
  };
  for (int k = 0; k < Dim; ++k) held[k] = came[k] = v[k], stops[k] = slows[k] = 0;
  each([&](int n, const Side<Dim>& side, const double*) { hold_back(side, n / 2, n % 2 == 1, held); });
  each([&](int n, const Side<Dim>& side, const double* kept) {
    const SideFriction<Dim> by(side, n, node, kept, came, held);
    for (int k = 0; k < Dim; ++k)
      if (k != n / 2) stops[k] += by.stops, slows[k] += by.stops * (held[k] - side.velocity[k]);
  });
  for (int k = 0; k < Dim; ++k) v[k] = held[k] - slows[k] / Kokkos::fmax(1.0, stops[k]);
  each([&](int n, const Side<Dim>& side, double* kept) {
    const SideFriction<Dim> by(side, n, node, kept, came, held);
    for (int k = 0; k < Dim; ++k) {
      const double change = k == n / 2
                                ? held[k] - came[k]
                                : -by.stops * (held[k] - side.velocity[k]) / Kokkos::fmax(1.0, stops[k]);
      book(kept, node, v_old, k, node.mass * change, v[k]);
    }
    if (!node.keeps) return;
    kept[S::pressed + ImpulseTerms::sum] = by.pressed.sum;
    kept[S::pressed + ImpulseTerms::weight] = by.pressed.weight;
    kept[S::pressed + ImpulseTerms::store] = by.pressed.store * node.mass;
  });
}

/// Whether a side that comes later prescribes component k of what side n has at a node on `sides`. Then n
/// leaves it alone: it would take away what the other has given, and behind a contact both would count that
/// again.
template <int Dim>
KOKKOS_INLINE_FUNCTION bool is_overruled(const ActingSides<Dim>& acting, unsigned sides, int n, int k) {
  bool overruled = false;
  for (int m = 0; m < 2 * Dim; ++m) {
    const Side<Dim>& other = acting.all[m];
    const bool later = m != n && (m > n || acting.all[n].kind != Wall::driven);
    const bool holds = other.kind == Wall::driven && (k == m / 2 || other.holds_all);
    overruled |= (sides >> m & 1u) && later && holds;
  }
  return overruled;
}

/// Components that side n of the `sides` that a node lies on prescribes.
template <int Dim>
KOKKOS_INLINE_FUNCTION void prescribe(const ActingSides<Dim>& acting, unsigned sides, int n, double* v) {
  const Side<Dim>& side = acting.all[n];
  const int d = n / 2;
  if (side.kind != Wall::driven && side.kind != Wall::friction) return;
  for (int k = 0; k < Dim; ++k) {
    if ((k != d && !side.holds_all) || is_overruled(acting, sides, n, k)) continue;
    if (side.kind != Wall::friction)
      v[k] = side.velocity[k];
    else if (k == d)
      hold_back(side, d, n % 2 == 1, v);
  }
}

/// Velocity that the acting sides make of v_now at a node, which had v_old before the step. meets: dashpots
/// and friction too; else, behind a contact, only components that sides prescribe. Where sides meet, those
/// that prescribe more come later; those with columns come behind others with dashpots, which the columns
/// feel too.
template <class T, int Dim>
MPM_CALLED_FUNCTION Vector<T, Dim> by_sides(ActingSides<Dim> acting, SideNode<Dim> node, Vector<T, Dim> v_old,
                                            Vector<T, Dim> v_now, bool meets) {
  constexpr Wall k_order[] = {Wall::absorbing, Wall::free_field, Wall::friction, Wall::driven};
  double v[Dim];
  for (int k = 0; k < Dim; ++k) v[k] = v_now[k];
  for (const Wall kind : k_order) {
    if (meets && has_dashpots(kind)) absorb(acting, kind, node, v_old, v);
    if (meets && kind == Wall::friction) rub(acting, node, v_old, v);
    for (int n = 0; n < 2 * Dim; ++n) {
      if (!node.on(n) || acting.all[n].kind != kind) continue;
      double before[Dim];
      for (int k = 0; k < Dim; ++k) before[k] = v[k];
      prescribe(acting, node.sides, n, v);
      for (int k = 0; k < Dim; ++k)
        book(acting.node(n, node.at), node, v_old, k, node.mass * (v[k] - before[k]), v[k]);
    }
  }
  for (int k = 0; k < Dim; ++k) v_now[k] = static_cast<T>(v[k]);
  return v_now;
}

}  // namespace mpm
