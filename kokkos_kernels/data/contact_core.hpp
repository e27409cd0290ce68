#pragma once
// Middle floor of the data of a time step (data/floors.hpp): rigid bodies, their contact with soil and with
// each other, and what joins them.

#include <vector>

#include "data/contact_sites.hpp"
#include "data/contact_slots.hpp"
#include "data/core.hpp"
#include "data/interfaces.hpp"
#include "data/light_rigids.hpp"
#include "data/part_forces.hpp"
#include "data/rigid.hpp"
#include "data/rigid_links.hpp"
#include "data/rigid_pairs.hpp"
#include "data/surface_samples.hpp"

namespace mpm {

template <class Space, class T, int Dim>
struct ContactCore : Core<Space, T, Dim> {
  using Memory = typename Space::memory_space;
  std::vector<ParticleSet<Space, RigidPoints<Space, T, Dim>>> rigid_points;
  Kokkos::View<Rigid<Dim>*, Memory> rigids;
  SurfaceTables<Memory, Dim> vertices;  // and samples, of the rigids' surfaces
  ContactSlots<Space> contact;
  ContactSites<Space, T, Dim> at_sites;
  RigidPairs<Space, Dim> pairs;          // rigid bodies that may touch each other
  RigidLinks<Space, Dim> links;          // joints, springs and dashpots of rigid bodies
  LightRigids<Space, Dim> light_rigids;  // and how contact takes them
  PartForces<Space, Dim> part_forces;
  Interfaces<Space, Dim> interfaces;          // of deformable bodies
  Kokkos::View<double*, Memory> rigid_force;  // N, of the soil on each rigid in this step, and on each part
  Kokkos::View<double*, Memory> rigid_moved;  // cells, of each rigid in this step, where a kernel before
                                              // move_rigids moves it: some are linked, or there are many
  bool forces_summed =
      false;  // `rigid_force` holds the forces of this step, of all ranks if a rigid moves by them
  bool rigids_ahead = false;    // the rigids have moved in this step already, while particles were computed
  bool rigid_moves = false;     // some rigid is not fixed
  bool rigid_turns = false;     // some rigid may turn
  bool rigid_dynamic = false;   // some rigid moves by the forces on it
  bool mass_normals = false;    // some rigid's normals are those of its mass gradient
  bool soil_boundary = false;   // some contact needs the soil's boundary at the nodes
  bool shear_fraction = false;  // some contact needs the soil's strength at the nodes
  bool has_friction = false;    // some contact at nodes has Coulomb friction
  double friction_time = 1;     // s, over which friction takes the mean normal impulse
};

/// Wrenches that contact leaves at a slot: on the bodies near it, and on parts of bodies.
template <class Space, class T, int Dim>
int wrenches_of_slot(const ContactCore<Space, T, Dim>& s) {
  return s.contact.near.width + s.part_forces.count;
}

/// Numbers of one rigid body at a node in Nodes::impulse; 0: no contact keeps any.
template <class Space, class T, int Dim>
int impulse_stride(const ContactCore<Space, T, Dim>& s) {
  if (s.at_sites.in_use) return k_sites<Dim> * SiteTerms<Dim>::size;
  return s.has_friction ? ImpulseTerms::size : 0;
}
/// Numbers of all rigid bodies at a node, where they leave a run or a rank.
template <class Space, class T, int Dim>
int impulse_numbers(const ContactCore<Space, T, Dim>& s) {
  return impulse_stride(s) * static_cast<int>(s.rigid_points.size());
}
/// Rows of Nodes::impulse: of the bodies near a slot.
template <class Space, class T, int Dim>
int impulse_rows(const ContactCore<Space, T, Dim>& s) {
  return impulse_stride(s) * s.contact.near.width;
}

}  // namespace mpm
