#pragma once
// Rigid bodies at soil with water in its pores.

#include "loops/node_update.hpp"

namespace mpm {

/// Motion of a node as it is at the end of a step without contact [m/s].
template <int Dim>
struct FlowMotion {
  Vector<double, Dim> grains, flux;
};

/// A rigid body that presses a node: the normal from the soil into it, its velocity along the normal [m/s],
/// and whether the water passes it.
template <int Dim>
struct PressingRigid {
  Vector<double, Dim> normal;
  double speed = 0;
  bool permeable = false;
};

/// A run without rigid bodies.
struct NoRigids {
  template <int Dim>
  KOKKOS_INLINE_FUNCTION bool pressing(int, const FlowMotion<Dim>&, double, PressingRigid<Dim>&) const {
    return false;
  }
};

/// Surfaces of rigid bodies as the flux meets them.
template <class Space, class T, int Dim>
struct FlowAtRigids {
  UpdateNodes<Space, T, Dim> update;
  ContactPlaces<Space> contact;

  explicit FlowAtRigids(const State<Space, T, Dim>& s, double dt)
      : update(node_update_of(s, dt)), contact(s.contact.place) {}

  /// The body that presses node i, where one does. share: M_w over the mass of the node, by which the grains
  /// take up the momentum of the flux that the body stops.
  KOKKOS_INLINE_FUNCTION bool pressing(int i, const FlowMotion<Dim>& motion, double share,
                                       PressingRigid<Dim>& by) const {
    const int slot = i / Patch<Dim>::cells;
    if (contact(slot) == 0) return false;
    const Coord<Dim> at = in_mesh(update.places.origin(slot), coord_of<Dim>(i));
    const auto node = update.node_of(update.nodes, i, at, true);
    for (int m = 0; m < node.touching; ++m) {
      const int r = update.near_bodies.body(slot, m);
      if (r < 0) break;
      if (touches(update.rigids(r), node, motion, share, by)) return true;
    }
    return false;
  }

 private:
  using Node = typename UpdateNodes<Space, T, Dim>::Node;
  /// As UpdateNodes::touch finds it, by the velocities at the beginning of the contact.
  KOKKOS_INLINE_FUNCTION bool touches(const Rigid<Dim>& rigid, const Node& node,
                                      const FlowMotion<Dim>& motion, double share,
                                      PressingRigid<Dim>& by) const {
    Vector<T, Dim> boundary, n;
    for (int d = 0; d < Dim; ++d) boundary[d] = node.boundary[BoundaryTerms<Dim>::area + d];
    cancel_at_rollers(update.places.grid, node.sides, boundary);
    double distance = 0;
    Vector<double, Dim> out{};
    if (!update.surface_contact(rigid, node, boundary, distance, out)) return false;
    if (!update.surface_normal(out, node.sides, n)) return false;
    if (distance > update.spacing / 2 + rigid.surface.round_off) return false;
    if (rigid.law.reach > 0) {
      const T area = Kokkos::fmax(T(0), dot(boundary, n)), spacing = update.places.grid.spacing;
      const T depth = surface_depth(node.boundary[BoundaryTerms<Dim>::volume] / spacing, area);
      if (distance + double(depth * spacing) >= rigid.law.reach) return false;
    }
    const Vector<double, Dim> of_body = rigid.motion.velocity_at(update.place_at(node.at));
    by.permeable = rigid.law.permeable;
    const double stopped = by.permeable ? 0.0 : share;
    double arrives = 0;
    by.speed = 0;
    for (int d = 0; d < Dim; ++d) {
      by.normal[d] = n[d];
      arrives += (motion.grains[d] + stopped * motion.flux[d]) * by.normal[d];
      by.speed += of_body[d] * by.normal[d];
    }
    return arrives > by.speed || !rigid.law.separates;
  }
};

}  // namespace mpm
