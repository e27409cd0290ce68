#pragma once
// Loops that end contact at sites: the nodes, what sites keep, and the forces on rigid bodies.

#include "loops/sites.hpp"

namespace mpm {

template <class Space, class T, int Dim>
struct EndSites : Sites<Space, T, Dim> {
  using Base = Sites<Space, T, Dim>;
  using Base::acts, Base::body, Base::kept, Base::place_of_site, Base::node_in_list, Base::node_at;
  using Base::Base;
  using Base::update, Base::sites, Base::list, Base::contact_slots, Base::fresh, Base::cells, Base::corners;
  using typename Base::Place, typename Base::Site, typename Base::Terms;

  /// Ends node number k of the contact slots: sides that act, and its acceleration.
  KOKKOS_INLINE_FUNCTION void end_node(int k) const {
    const auto [node, v_old] = this->node_and_velocity(k);
    if (!(node.inv_m > 0)) return;
    KinematicValues<T, Dim> kinematics;
    Vector<T, Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = update.nodes.kinematics(node.i, NodeKinematics<Dim>::velocity + d);
    if (node.acting != 0) v = by_sides(update.acting_sides, update.side_node(node, true), v_old, v, false);
    apply_walls(update.places.grid, node.sides, v);
    for (int d = 0; d < Dim; ++d) {
      kinematics.c[NodeKinematics<Dim>::velocity + d] = v[d];
      kinematics.c[NodeKinematics<Dim>::acceleration + d] = (v[d] - v_old[d]) * update.inv_dt * update.share;
    }
    update.keep(node.i, kinematics);
  }

  /// Ends the sites of a group, and leaves the force of this rank's soil on its body and the parts of it
  /// there; update_nodes has left none. force: [body, then parts][Wrench::size][cells]
  template <class Team>
  KOKKOS_INLINE_FUNCTION void end_group(const Team& team, int group, double* force) const {
    const int near = group / this->count, n = group % this->count;
    const int r = update.near_bodies.body(contact_slots(n), near);
    const int size = update.wrench(), all = (1 + parts_of(r)) * size;
    const int behind = (update.near_bodies.width + body(r).surface.first - 1) * size;  // place of part 1
    const std::uint64_t marks = list.marks(group);
    for_team(team, cells, [&](int k) {
      if ((marks >> k & 1) == 0) return;
      for (int v = 0; v < all; ++v) force[v * cells + k] = 0;
      end_sites(near, n + 1, k, force + k);
    });
    team.team_barrier();
    for_team(team, all, [&](int v) {
      double sum = 0;
      for (std::uint64_t left = marks; left != 0; left &= left - 1)
        sum += force[v * cells + Kokkos::Experimental::countr_zero_builtin(left)];
      update.forces(n * update.value_count + (v < size ? near * size : behind) + v) = sum;
    });
  }

 private:
  /// Parts of a body whose forces are wanted.
  KOKKOS_INLINE_FUNCTION int parts_of(int r) const {
    return update.parts != nullptr && body(r).surface.kind == SurfaceKind::parts ? body(r).surface.count : 0;
  }
  /// Keeps the impulses of a body's sites of a node for the next step, and adds those on it to force[0],
  /// force[cells] ... [N].
  KOKKOS_INLINE_FUNCTION void end_sites(int near, int place, int k, double* force) const {
    const int first = node_in_list(near, place, k);
    for (int corner = 0; corner < corners; ++corner) {
      const int n = first * corners + corner;
      const bool in_touch = acts(n);
      const Place of = place_of_site(n);
      if (!in_touch && kept(of.near, of.slot * cells + of.k, corner, Terms::weight) == 0)
        continue;  // it keeps nothing already
      keep(of, in_touch ? &sites(n) : nullptr);
      if (in_touch) add_force(of, sites(n), force);
    }
  }
  /// Keeps what a site has for the next step; null: it has no contact.
  KOKKOS_INLINE_FUNCTION void keep(const Place& of, const Site* site) const {
    T values[Terms::size] = {};
    const T friction = static_cast<T>(body(of.rigid).law.friction);
    if (site != nullptr) {
      values[Terms::normal] = site->press * update.inv_dt;
      for (int d = 0; d < Dim; ++d) values[Terms::shear + d] = site->shear[d] * update.inv_dt;
      Pressed<T> pressed{site->sum, site->weight, site->store};
      usable_impulse(pressed, fresh, site->press);
      values[Terms::sum] = pressed.sum, values[Terms::weight] = pressed.weight;
      if (friction > 0)
        values[Terms::store] =
            Kokkos::fmax(T(0), pressed.store - Kokkos::sqrt(dot(site->shear, site->shear)) / friction);
    }
    for (int term = 0; term < Terms::size; ++term)
      kept(of.near, of.slot * cells + of.k, of.corner, term) = values[term];
  }
  KOKKOS_INLINE_FUNCTION void add_force(const Place& of, const Site& site, double* force) const {
    Vector<double, Dim> given;  // N, to the soil
    for (int d = 0; d < Dim; ++d)
      given[d] = (double(site.press) * site.normal[d] + site.shear[d]) * update.inv_dt;
    const Coord<Dim> at = node_at(of);
    const auto in_space = [&](int d) { return (at[d] + double(site.place[d])) * update.spacing; };
    const RigidPose<Dim>& pose = body(of.rigid).motion.pose;
    subtract(pose, in_space, given, force);
    if (parts_of(of.rigid) == 0) return;
    const Surface<Dim>& surface = body(of.rigid).surface;
    const int part =
        nearest_part(surface, update.parts, update.vertices, pose.to_body(in_space)) - surface.first;
    subtract(pose, in_space, given, force + (1 + part) * update.wrench() * cells);
  }
  /// Subtracts a force that acts at a place, and its moment about the centre of a body.
  template <class InSpace>
  KOKKOS_INLINE_FUNCTION void subtract(const RigidPose<Dim>& pose, const InSpace& in_space,
                                       const Vector<double, Dim>& given, double* force) const {
    for (int d = 0; d < Dim; ++d) force[(Wrench<Dim>::force + d) * cells] -= given[d];
    if (!update.turns || !pose.turns) return;
    const AngularVector<Dim> moment = moment_of(pose.arm_to(in_space), given);
    for (int k = 0; k < k_turning_axes<Dim>; ++k) force[(Wrench<Dim>::moment + k) * cells] -= moment[k];
  }
};

}  // namespace mpm
