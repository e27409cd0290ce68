// From particles to nodes, functions 2 and 3 of a step and those that some runs have beside them.

#include "step/to_nodes.hpp"

#include "functions/find_strays.hpp"
#include "functions/particle_values.hpp"
#include "functions/step_kernels.hpp"
#include "functions/surface_loads.hpp"
#include "functions/velocity_update.hpp"
#include "loops/interpolation.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void rigids_to_nodes(const State<Space, T, Dim>& s, const Space& stream) {
  if (s.summed.rigids) return;
  for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) {
    const auto& set = s.rigid_points[r];
    if (set.points.surface_normal) continue;
    const NodeField<Space, T, RigidTerms<Dim>::size> out =
        Kokkos::subview(s.nodes.rigid, r, Kokkos::ALL, Kokkos::ALL);
    interpolate<RigidSource<Space, T, Dim>>(s, strategy_of_rigids<Space>(s.p2g.strategy), set.bins,
                                            {set.points, s.rigids, r, s.patches.origin, s.spacing}, out,
                                            stream);
  }
}

namespace {

/// Sets the boundary's sums to zero where function 5 has left those of the soil alone, and nodes of
/// interfaces keep their last ones.
template <class Space, class T, int Dim>
void begin_boundary(const State<Space, T, Dim>& s, const Space& stream) {
  if (s.summed.soil && !s.summed.boundary && s.interfaces.in_use() && !s.plan.writes_sums)
    Kokkos::deep_copy(stream, s.nodes.boundary, T(0));
}

template <class Space, class T, int Dim>
void boundary_of(const State<Space, T, Dim>& s, const Soil<Space, T, Dim>& points, const Bins<Space>& bins,
                 const Space& stream) {
  if (!s.soil_boundary || s.summed.boundary) return;
  with_domain(points, [&](auto domain) {
    interpolate<BoundarySource<Space, T, Dim, domain()>>(
        s, s.p2g.strategy, bins, {points, s.grid.inv_spacing, s.contact.place}, s.nodes.boundary, stream);
  });
}

template <class Space, class T, int Dim>
void mass_and_force_of(const State<Space, T, Dim>& s, const Soil<Space, T, Dim>& points,
                       const Bins<Space>& bins, const Space& space) {
  const P2G how = s.p2g.strategy;
  with_domain(points, [&](auto domain) {
    if (s.soil.points.has_affine)
      interpolate<AffineSource<Space, T, Dim, domain()>>(s, how, bins, {{points, s.grid.inv_spacing}},
                                                         s.nodes.soil, space);
    else if (!s.summed.soil)
      interpolate<SoilSource<Space, T, Dim, domain()>>(s, how, bins, {points, s.grid.inv_spacing},
                                                       s.nodes.soil, space);
  });
}

}  // namespace

template <class Space, class T, int Dim>
void soil_to_nodes(const State<Space, T, Dim>& s, const Space& stream, bool boundary) {
  if (boundary) begin_boundary(s, stream);
  for_all_soil(s, [&](const auto& set) {
    mass_and_force_of(s, set.points, set.bins, stream);
    if (boundary) boundary_of(s, set.points, set.bins, stream);
  });
}
template <class Space, class T, int Dim>
void soil_to_nodes(const State<Space, T, Dim>& s, const Part<Space>& part) {
  const Bins<Space> bins = bins_of(s.soil.bins, part);
  mass_and_force_of(s, s.soil.points, bins, part.space);
  boundary_of(s, s.soil.points, bins, part.space);
}

template <class Space, class T, int Dim>
void buoyancy_to_nodes(State<Space, T, Dim>& s) {
  if (!s.water.is_there()) return;
  if (!s.plan.writes_sums) Kokkos::deep_copy(s.space, s.nodes.displaced, T(0));
  for_all_soil(s, [&](const auto& set) {
    const auto displaced = find_displaced(s, set);
    with_box_or_ring(set.points, [&](auto domain) {
      interpolate<ScalarSource<Space, T, Dim, domain()>>(s, s.p2g.strategy, set.bins, {set.points, displaced},
                                                         s.nodes.displaced);
    });
  });
  add_buoyancy(s);
}

/// Sums the forces of loads at the nodes.
template <class Space, class T, int Dim>
void sum_loads(const State<Space, T, Dim>& s, const NodeField<Space, T, Dim>& out, LoadsOn on) {
  Kokkos::deep_copy(s.space, out, T(0));
  for (int axis = 0; axis < Dim; ++axis) {
    auto it = interpolation_of(s, s.soil.bins, place_faces(s, s.loads, axis, on), out, s.space);
    it.adds = true;  // one axis to the other
    particle_to_node(s.p2g.strategy, it);
  }
}

template <class Space, class T, int Dim>
void loads_to_nodes(State<Space, T, Dim>& s) {
  if (!s.loads.in_use()) return;
  sum_loads(s, s.nodes.load, LoadsOn::soil);
  add_loads(s);
}

template <class Space, class T, int Dim>
PetscErrorCode rayleigh_to_nodes(State<Space, T, Dim>& s, Rayleigh<Space, T, Dim>& by,
                                 Decomposition<Space, T, Dim>* ranks) {
  PetscFunctionBeginUser;
  const int nodes = s.patches.node_count();
  const bool viscous = by.stiffness > 0;
  ensure(by.force, nodes);
  if (viscous) {
    ensure(s.nodes.residual, nodes), ensure(by.sums, nodes), ensure(by.stress, s.soil.points.count);
    find_viscous_stress(s, by);
    Kokkos::deep_copy(s.space, by.sums, T(0));
    const Soil<Space, T, Dim> points = viscous_soil(s, by);
    with_domain(points, [&](auto domain) {
      interpolate<SoilSource<Space, T, Dim, domain()>>(s, s.p2g.strategy, s.soil.bins,
                                                       {points, s.grid.inv_spacing}, by.sums);
    });
    show_viscous_forces(s, by);
    if (ranks) PetscCall(ranks->add_field(s, s.nodes.residual, When::in_step));
  }
  add_rayleigh_forces(s, by, viscous);
  PetscFunctionReturn(PETSC_SUCCESS);
}

namespace {

template <class Space, class T, int Dim>
PetscErrorCode strength_to_nodes(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks,
                                 const Space& stream) {
  PetscFunctionBeginUser;
  if (!s.shear_fraction) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s.plan.writes_sums) Kokkos::deep_copy(stream, s.nodes.strength, T(0));
  for_all_soil(s, [&](const auto& set) {
    const auto strengths = find_strengths(s, set, stream);
    with_box_or_ring(set.points, [&](auto domain) {
      interpolate<PairSource<Space, T, Dim, domain()>>(
          s, s.p2g.strategy, set.bins, {set.points, strengths, s.contact.strength}, s.nodes.strength, stream);
    });
  });
  if (ranks) PetscCall(ranks->add_field(s, s.nodes.strength, When::in_step, s.contact.place.data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode cloud_to_nodes(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks,
                              const Space& stream) {
  PetscFunctionBeginUser;
  if (!s.interfaces.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s.plan.writes_sums) Kokkos::deep_copy(stream, s.nodes.cloud, T(0));
  for_all_soil(s, [&](const auto& set) {
    with_box_or_ring(set.points, [&](auto domain) {
      interpolate<CloudSource<Space, T, Dim, domain()>>(
          s, s.p2g.strategy, set.bins, {{set.points}, s.contact.cloud}, s.nodes.cloud, stream);
    });
  });
  if (ranks) PetscCall(ranks->add_field(s, s.nodes.cloud, When::in_step, s.contact.place.data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode contacts_to_nodes(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks,
                                 const Space& stream, bool boundary) {
  PetscFunctionBeginUser;
  if (s.summed.contacts) PetscFunctionReturn(PETSC_SUCCESS);
  if (boundary) {
    begin_boundary(s, stream);
    for_all_soil(s, [&](const auto& set) { boundary_of(s, set.points, set.bins, stream); });
  }
  PetscCall(strength_to_nodes(s, ranks, stream));
  PetscCall(cloud_to_nodes(s, ranks, stream));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode flow_to_nodes(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks) {
  PetscFunctionBeginUser;
  if (!s.flow.in_use()) PetscFunctionReturn(PETSC_SUCCESS);
  if (!s.plan.writes_sums) Kokkos::deep_copy(s.space, s.nodes.flow, T(0));
  for_all_soil(s, [&](const auto& set) {
    with_box_or_ring(set.points, [&](auto domain) {
      const FlowSource<Space, T, Dim, domain()> source{
          {set.points}, s.grid.inv_spacing, s.flow.pores, s.flow.water,
          s.water,      s.patches.origin,   s.spacing,    s.flow.windows};
      auto it = interpolation_of(s, set.bins, source, s.nodes.flow, s.space);
      it.grid = grid_of_flow(s.grid, s.flow);
      particle_to_node(s.p2g.strategy, it);
    });
  });
  if (ranks) PetscCall(ranks->add_field(s, s.nodes.flow, When::in_step));
  if (!s.loads.on_pores) PetscFunctionReturn(PETSC_SUCCESS);
  sum_loads(s, s.loads.pore_load, LoadsOn::pores);
  if (ranks) PetscCall(ranks->add_field(s, s.loads.pore_load, When::in_step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void sum_present_soil(State<Space, T, Dim>& s) {
  finish_sums(s);
  if (!s.summed.soil) reset_nodes(s);
  soil_to_nodes(s, s.space);
  if (s.summed.soil) s.summed.boundary = s.soil_boundary;
}

template <class Space, class T, int Dim>
PetscErrorCode sum_present_forces(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks) {
  PetscFunctionBeginUser;
  sum_present_soil(s);
  buoyancy_to_nodes(s);
  loads_to_nodes(s);
  if (ranks) PetscCall(ranks->add_present_soil(s));
  PetscCall(contacts_to_nodes(s, ranks, s.space));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode update_velocities(State<Space, T, Dim>& s, Decomposition<Space, T, Dim>* ranks) {
  PetscFunctionBeginUser;
  for (int pass = 0; pass < s.scheme.xpic_order; ++pass) {
    if (pass > 0) {
      Kokkos::deep_copy(s.space, s.nodes.residual, T(0));
      with_box_or_ring(s.soil.points, [&](auto domain) {
        interpolate<VectorSource<Space, T, Dim, domain()>>(s, s.p2g.strategy, s.soil.bins,
                                                           {s.soil.points, residual_of(s), {}, Times::mass},
                                                           s.nodes.residual);
      });
      if (ranks) PetscCall(ranks->add_field(s, s.nodes.residual, When::in_step));
    }
    xpic_pass(s, pass);
  }
  if (s.soil.points.has_affine) take_affine(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                              \
  template void rigids_to_nodes(const State<Space, T, Dim>&, const Space&);                         \
  template void soil_to_nodes(const State<Space, T, Dim>&, const Space&, bool);                     \
  template void soil_to_nodes(const State<Space, T, Dim>&, const Part<Space>&);                     \
  template void buoyancy_to_nodes(State<Space, T, Dim>&);                                           \
  template void loads_to_nodes(State<Space, T, Dim>&);                                              \
  template PetscErrorCode rayleigh_to_nodes(State<Space, T, Dim>&, Rayleigh<Space, T, Dim>&,        \
                                            Decomposition<Space, T, Dim>*);                         \
  template PetscErrorCode contacts_to_nodes(State<Space, T, Dim>&, Decomposition<Space, T, Dim>*,   \
                                            const Space&, bool);                                    \
  template PetscErrorCode flow_to_nodes(State<Space, T, Dim>&, Decomposition<Space, T, Dim>*);      \
  template PetscErrorCode sum_present_forces(State<Space, T, Dim>&, Decomposition<Space, T, Dim>*); \
  template void sum_present_soil(State<Space, T, Dim>&);                                            \
  template PetscErrorCode update_velocities(State<Space, T, Dim>&, Decomposition<Space, T, Dim>*);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
