#pragma once
// Loops that bring the impulses at sites to where soil and rigid bodies do not interpenetrate.

#include "loops/sites.hpp"

namespace mpm {

template <class Space, class T, int Dim>
struct SolveSites : Sites<Space, T, Dim> {
  using Base = Sites<Space, T, Dim>;
  using Base::acts, Base::touches, Base::body, Base::kept, Base::place_of_site, Base::node_in_list,
      Base::node_number, Base::sums_of;
  using Base::Base;
  using Base::cells, Base::corners, Base::momentum, Base::given, Base::k_whole;
  using Base::update, Base::sites, Base::sums, Base::contact_place, Base::contact_slots, Base::fresh,
      Base::unit;
  using typename Base::Place, typename Base::Site, typename Base::Terms;

  /// Begins the impulse of a site with that of the step before, and gives it to the nodes.
  KOKKOS_INLINE_FUNCTION void begin_impulse(int n) const {
    if (!acts(n)) return;
    const Place of = place_of_site(n);
    Site& site = sites(n);
    T inverse_mass = 0;
    this->for_each_hat(of, site, [&](int m, int i, T) {
      if (site.share[m] > 0)
        inverse_mass += site.share[m] * static_cast<T>(sums(sums_of(i), SiteSums<Dim>::sites) / k_whole) /
                        update.nodes.soil(i, SoilTerms<Dim>::mass);
    });
    site.inverse_mass = inverse_mass / site.part;
    load(of, site);
    Impulse<T, Dim> whole;
    for (int d = 0; d < Dim; ++d) whole[d] = site.press * site.normal[d] + site.shear[d];
    give(of, site, whole);
  }

  /// Brings an impulse of a site towards contact without interpenetration, from the velocities of its nodes.
  KOKKOS_INLINE_FUNCTION void sweep(int n) const {
    if (!acts(n)) return;
    const Place of = place_of_site(n);
    Site& site = sites(n);
    Vector<T, Dim> v = filled<T, Dim>(0);
    T pressed = 0;
    this->for_each_hat(of, site, [&](int m, int i, T) {
      if (!(site.share[m] > 0)) return;
      for (int d = 0; d < Dim; ++d) {
        v[d] += site.share[m] * update.nodes.kinematics(i, NodeKinematics<Dim>::velocity + d);
        pressed += site.share[m] * static_cast<T>(sums(sums_of(i), given + d) * unit) * site.normal[d];
      }
    });
    for (int d = 0; d < Dim; ++d) v[d] -= site.velocity[d];
    const ContactLaw& law = body(of.rigid).law;
    const SiteInterface<T> interface {
      shear_limit(of, site, law), fresh, update.inv_dt* update.share, pressed
    };
    give(of, site, resolve(site, law, v, interface));
  }

  /// Gives node number k of the contact slots what the sites have for it. Walls hold what they held.
  KOKKOS_INLINE_FUNCTION void take(int k) const {
    const int i = contact_slots(k / cells) * cells + k % cells;
    bool moves = false;
    for (int d = 0; d < Dim; ++d) moves = moves || sums(k, momentum + d) != 0;
    if (!moves) return;
    const T m_i = update.nodes.soil(i, SoilTerms<Dim>::mass);
    Vector<T, Dim> v;
    for (int d = 0; d < Dim; ++d) {
      v[d] = update.nodes.kinematics(i, NodeKinematics<Dim>::velocity + d) +
             static_cast<T>(sums(k, momentum + d) * unit / m_i);
      sums(k, given + d) += sums(k, momentum + d);
      sums(k, momentum + d) = 0;
    }
    Coord<Dim> at = coord_of<Dim>(i);
    for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(i / cells)[d];
    apply_walls(update.places.grid, sides_of(update.places.grid, at), v);
    for (int d = 0; d < Dim; ++d) update.nodes.kinematics(i, NodeKinematics<Dim>::velocity + d) = v[d];
  }

  /// Brakes node number k of the contact slots by local damping of the acceleration that contact leaves.
  KOKKOS_INLINE_FUNCTION void brake(int k) const {
    const auto [node, v_old] = this->node_and_velocity(k);
    if (!(node.inv_m > 0)) return;
    Vector<T, Dim> a;
    for (int d = 0; d < Dim; ++d)
      a[d] = (update.nodes.kinematics(node.i, NodeKinematics<Dim>::velocity + d) - v_old[d]) * update.inv_dt;
    const Vector<T, Dim> brake = update.braking(a, v_old);
    for (int d = 0; d < Dim; ++d)
      update.nodes.kinematics(node.i, NodeKinematics<Dim>::velocity + d) -= brake[d] * update.dt;
  }

  /// Force of the sites on a node over its mass [m/s2], after begin_impulse alone.
  KOKKOS_INLINE_FUNCTION T reaction(int i, T inv_m, int d) const {
    return sums_of(i) < 0 ? T(0)
                          : static_cast<T>(sums(sums_of(i), momentum + d) * unit) * inv_m * update.inv_dt;
  }

 private:
  KOKKOS_INLINE_FUNCTION void give(const Place& of, const Site& site, const Impulse<T, Dim>& impulse) const {
    this->for_each_hat(of, site, [&](int m, int i, T) {
      if (!(site.share[m] > 0)) return;
      for (int d = 0; d < Dim; ++d)
        if (impulse[d] != 0) this->add(i, momentum + d, double(site.share[m]) * impulse[d] / unit);
    });
  }

  /// Largest shear impulse [N s] of the interface at a site by its shear limit, infinite without one.
  KOKKOS_INLINE_FUNCTION T shear_limit(const Place& of, const Site& site, const ContactLaw& law) const {
    T limit = static_cast<T>(law.shear_limit);
    if (law.shear_fraction >= 0) {
      T strength = 0, volume = 0;
      this->for_each_hat(of, site, [&](int m, int i, T) {
        if (!(site.share[m] > 0)) return;
        strength += site.share[m] * update.nodes.strength(i, StrengthTerms::strength);
        volume += site.share[m] * update.nodes.strength(i, StrengthTerms::volume);
      });
      limit = volume > 0 ? static_cast<T>(law.shear_fraction) * (strength / volume) : T(0);
    }
    if (!(limit < Kokkos::Experimental::infinity<T>::value) || limit == 0) return limit;
    return limit * area(of, site) * update.dt;
  }
  /// Area of the soil's boundary at a site, towards the body [m2; m in 2D]: the sites of a node share its
  /// area, as they share its mass.
  KOKKOS_INLINE_FUNCTION T area(const Place& of, const Site& site) const {
    T area = 0;
    this->for_each_hat(of, site, [&](int m, int i, T) {
      if (!(site.share[m] > 0)) return;
      Coord<Dim> at = coord_of<Dim>(i);
      Vector<T, Dim> boundary;
      for (int d = 0; d < Dim; ++d) {
        at[d] += update.places.origin(i / cells)[d];
        boundary[d] = update.nodes.boundary(i, BoundaryTerms<Dim>::area + d);
      }
      cancel_at_rollers(update.places.grid, sides_of(update.places.grid, at), boundary);
      const T sharing = static_cast<T>(sums(sums_of(i), SiteSums<Dim>::sites) / k_whole);
      area += site.share[m] * Kokkos::fmax(T(0), -dot(boundary, site.normal)) / sharing;
    });
    return site.part * area;
  }

  KOKKOS_INLINE_FUNCTION bool is_in_touch(int rigid, int near, int node, int corner) const {
    const int place = contact_place(node / cells);
    const int n = place > 0 ? node_in_list(near, place, node % cells) : -1;
    return n >= 0 && touches(rigid, n * corners + corner);
  }
  /// Loads what a site kept. One that had no contact takes what the next one along the normal had, where that
  /// has none now: the face has moved on.
  KOKKOS_INLINE_FUNCTION void load(const Place& of, Site& site) const {
    int near = of.near, node = of.slot * cells + of.k, corner = of.corner;
    if (kept(near, node, corner, Terms::weight) == 0) {
      T most = 0;
      for (int sign = -1; sign <= 1; sign += 2) {
        Coord<Dim> c = coord_of<Dim>(of.k);
        int there = 0;
        for (int d = 0; d < Dim; ++d) {
          const int step = site.normal[d] > T(0.5) ? 1 : site.normal[d] < T(-0.5) ? -1 : 0;
          const int half = 2 * c[d] + (of.corner >> d & 1) + sign * step;
          c[d] = half >> 1, there |= (half & 1) << d;
        }
        const int i = node_number(of.slot, c);
        const int body = i < 0 ? -1 : update.near_bodies.number(i / cells, of.rigid);
        if (body < 0 || !(kept(body, i, there, Terms::normal) > most)) continue;
        if (is_in_touch(of.rigid, body, i, there)) continue;
        most = kept(body, i, there, Terms::normal);
        near = body, node = i, corner = there;
      }
    }
    site.press = kept(near, node, corner, Terms::normal) * update.dt;
    for (int d = 0; d < Dim; ++d) site.shear[d] = kept(near, node, corner, Terms::shear + d) * update.dt;
    const T across = dot(site.shear, site.normal);
    for (int d = 0; d < Dim; ++d) site.shear[d] -= across * site.normal[d];
    site.sum = kept(near, node, corner, Terms::sum) * (1 - fresh);
    site.weight = kept(near, node, corner, Terms::weight) * (1 - fresh);
    site.store = kept(near, node, corner, Terms::store) * kept_share(ImpulseTerms::store, update.fresh);
  }
};

}  // namespace mpm
