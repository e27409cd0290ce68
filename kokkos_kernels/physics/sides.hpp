#pragma once
// What sides of the mesh with friction, dashpots or a motion of their own do to a node on them
// (docs/boundaries.md).

#include "data/sides.hpp"
#include "physics/contact.hpp"

namespace mpm {

/// A node on such sides in a step.
template <int Dim>
struct SideNode {
  Coord<Dim> at;
  unsigned sides;   // the acting ones that it lies on
  double mass, dt;  // kg, s
  bool counts;      // this rank answers for it
};

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

/// Dashpots [kg/s] and springs [N/m] of a node, normal and tangential, and how far these are stretched [m].
struct Dashpots {
  const double *dashpot, *spring;
  double* drift;
};

/// Implicit dashpots (Lysmer and Kuhlemeyer 1969) between a node of a side normal to d and what moves with
/// the velocity V: m (v' - v) = -c dt (v' - V) - s dt u', where springs s hold the drift u' = u + dt (v' -
/// V).
template <int Dim>
KOKKOS_INLINE_FUNCTION void absorb(const Dashpots& by, int d, const SideNode<Dim>& node, const double* to,
                                   double* v) {
  for (int k = 0; k < Dim; ++k) {
    const int along = k == d ? 0 : 1;
    const double pull = by.spring[along] * node.dt / node.mass,
                 a = by.dashpot[along] * node.dt / node.mass + pull * node.dt;
    v[k] = (v[k] + a * to[k] - pull * by.drift[k]) / (1 + a);
    by.drift[k] += node.dt * (v[k] - to[k]);
  }
}

/// Those of a node on a side. kept: SideTerms.
template <int Dim>
KOKKOS_INLINE_FUNCTION Dashpots dashpots_of(double* kept) {
  using S = SideTerms<Dim>;
  return {kept + S::dashpot, kept + S::spring, kept + S::drift};
}

/// What they hold on to [m/s]: the side, or the column beside it.
template <int Dim>
KOKKOS_INLINE_FUNCTION const double* far_velocity(const ActingSides<Dim>& acting, int side,
                                                  const SideNode<Dim>& node) {
  if (acting.all[side].kind == Wall::free_field)
    return acting.column(side, node.at) + ColumnTerms<Dim>::after;
  return acting.all[side].velocity.c;
}

/// Takes the velocity into the side; the side does not pull.
template <int Dim>
KOKKOS_INLINE_FUNCTION void hold_back(const Side<Dim>& side, int d, bool upper, double* v) {
  v[d] = upper ? Kokkos::fmin(v[d], side.velocity[d]) : Kokkos::fmax(v[d], side.velocity[d]);
}

/// Coulomb friction, as contact_correction() has it: the friction of a step is at most a fraction of the
/// normal impulse of this step and of what earlier ones have left.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void apply_friction(const Side<Dim>& side, int d, bool upper,
                                           const SideNode<Dim>& node, double* kept, double* v) {
  double& stock = kept[SideTerms<Dim>::stock];
  const double approach = (v[d] - side.velocity[d]) * (upper ? 1 : -1);
  stock = double(k_memory<T>) * stock + node.mass * Kokkos::fmax(0.0, approach);
  hold_back(side, d, upper, v);
  double squares = 0;
  for (int k = 0; k < Dim; ++k)
    if (k != d) squares += (v[k] - side.velocity[k]) * (v[k] - side.velocity[k]);
  const double speed = Kokkos::sqrt(squares), stops = node.mass * speed;  // N s
  const double area = side.face * Kokkos::fmin(1.0, node.mass / side.unit_mass);
  const double most = Kokkos::fmin(side.friction * stock, side.shear_limit * area * node.dt);
  const double used = Kokkos::fmin(stops, most), left = stops > 0 ? 1 - used / stops : 1;
  if (side.friction > 0) stock -= used / side.friction;
  for (int k = 0; k < Dim; ++k)
    if (k != d) v[k] = side.velocity[k] + left * (v[k] - side.velocity[k]);
}

/// Components that a side prescribes.
template <int Dim>
KOKKOS_INLINE_FUNCTION void prescribe(const Side<Dim>& side, int d, bool upper, double* v) {
  if (has_dashpots(side.kind)) return;
  if (side.kind == Wall::friction) return hold_back(side, d, upper, v);
  for (int k = 0; k < Dim; ++k)
    if (k == d || side.holds_all) v[k] = side.velocity[k];
}

/// What the acting sides make of the velocity v of a node, which was v_old before the step. meets: dashpots
/// and friction too; else, behind a contact, only what sides prescribe. Where sides meet, those that
/// prescribe more come later; those with columns come behind others with dashpots, which the columns feel
/// too.
template <class T, int Dim>
MPM_CALLED_FUNCTION Vector<T, Dim> by_sides(ActingSides<Dim> acting, SideNode<Dim> node, Vector<T, Dim> v_old,
                                            Vector<T, Dim> v_now, bool meets) {
  using S = SideTerms<Dim>;
  constexpr Wall k_order[] = {Wall::absorbing, Wall::free_field, Wall::friction, Wall::driven};
  double v[Dim], before[Dim];
  for (int k = 0; k < Dim; ++k) v[k] = v_now[k];
  for (const Wall kind : k_order)
    for (int n = 0; n < 2 * Dim; ++n) {
      if (!(node.sides >> n & 1u) || acting.all[n].kind != kind) continue;
      const Side<Dim>& side = acting.all[n];
      double* const kept = acting.node(n, node.at);
      for (int k = 0; k < Dim; ++k) before[k] = v[k];
      if (meets && has_dashpots(kind))
        absorb(dashpots_of<Dim>(kept), n / 2, node, far_velocity(acting, n, node), v);
      if (meets && kind == Wall::friction) apply_friction<T>(side, n / 2, n % 2 == 1, node, kept, v);
      prescribe(side, n / 2, n % 2 == 1, v);
      for (int k = 0; k < Dim && node.counts; ++k) {
        const double carried = meets ? node.dt * held_force(acting, n, node, k) : 0;
        const double impulse = node.mass * (v[k] - before[k]) + carried;
        kept[S::impulse + k] += impulse;
        kept[S::work] += impulse * (double(v_old[k]) + v[k]) / 2;
      }
    }
  for (int k = 0; k < Dim; ++k) v_now[k] = static_cast<T>(v[k]);
  return v_now;
}

}  // namespace mpm
