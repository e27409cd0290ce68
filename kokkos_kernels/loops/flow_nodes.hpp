#pragma once
// Water that flows in pores at the nodes of a step (physics/pore_flow.hpp).

#include "loops/flow_at_rigids.hpp"
#include "physics/pore_flow.hpp"

namespace mpm {

/// Numbers of the node solve that the nodes of a step share.
template <class Space, class T, int Dim>
struct FlowStep {
  Nodes<Space, T, Dim> nodes;
  Grid<T, Dim> grid, soil_grid;  // as the flux and as the soil meet its sides
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  Vector<double, Dim> g;           // m/s2
  const Vector<T, Dim>* timed_g;   // of the present step, where gravity follows a table; else null
  double dt, share, mass_cut;      // s, of the change of velocities; over the step's length; kg
  NodeField<Space, T, Dim> loads;  // N, on the water; empty where there are none
  ActingSides<Dim> acting_sides;

  FlowStep(const State<Space, T, Dim>& s, double step)
      : nodes(s.nodes),
        grid(grid_of_flow(s.grid, s.flow)),
        soil_grid(s.grid),
        origin(s.patches.origin),
        g(s.gravity),
        timed_g(s.timed.of_step().gravity),
        dt(s.scheme.kick * step),
        share(s.scheme.kick),
        mass_cut(s.scheme.mass_cut),
        loads(s.loads.pore_load),
        acting_sides(acting(s.sides)) {}

  KOKKOS_INLINE_FUNCTION double gravity(int d) const { return timed_g ? double((*timed_g)[d]) : g[d]; }
  /// Whether node i has water, and forces act there.
  KOKKOS_INLINE_FUNCTION bool is_wet(int i) const {
    return nodes.soil(i, SoilTerms<Dim>::mass) > mass_cut && nodes.flow(i, FlowTerms<Dim>::water) > 0;
  }
  /// Which sides of the mesh node i lies on.
  KOKKOS_INLINE_FUNCTION unsigned sides_at(int i) const {
    return sides_of(grid, in_mesh(origin(i / Patch<Dim>::cells), coord_of<Dim>(i)));
  }
  /// Bit d: no flux along axis d passes a node, which lies on a side that holds the water. sides: sides_at
  /// it.
  KOKKOS_INLINE_FUNCTION unsigned closed_axes(unsigned sides) const {
    unsigned axes = 0;
    for (int d = 0; d < Dim && sides != 0; ++d)
      for (int side = 0; side < 2; ++side)
        if ((sides >> (2 * d + side) & 1u) && holds_flux(grid.wall[d][side])) axes |= 1u << d;
    return axes;
  }
  /// Whether a side of the mesh that the water passes holds a node, which would have the velocity v along
  /// axis d. sides: sides_of the node.
  KOKKOS_INLINE_FUNCTION bool held_by_open_side(unsigned sides, int d, double v) const {
    for (int side = 0; side < 2; ++side) {
      const Wall wall = soil_grid.wall[d][side];
      if ((sides >> (2 * d + side) & 1u) == 0 || is_open(wall)) continue;
      if (wall != Wall::friction || (side == 0 ? v < 0 : v > 0)) return true;
    }
    return false;
  }
  /// Flux of node i at the beginning of the step [m/s].
  KOKKOS_INLINE_FUNCTION double flux(int i, int d) const {
    using F = FlowTerms<Dim>;
    return double(nodes.flow(i, F::momentum + d)) / double(nodes.flow(i, F::water));
  }
  /// Force of loads on the water at node i [N].
  KOKKOS_INLINE_FUNCTION double load(int i, int d) const {
    return loads.extent(0) > 0 ? double(loads(i, d)) : 0.0;
  }
  /// Sums of node i along axis d, with its weight.
  KOKKOS_INLINE_FUNCTION FlowNode sums(int i, int d) const {
    using F = FlowTerms<Dim>;
    const double mass = nodes.soil(i, SoilTerms<Dim>::mass), drag = nodes.flow(i, F::drag);
    return {mass, nodes.flow(i, F::water), double(nodes.flow(i, F::inertia)) + dt * drag,
            double(nodes.soil(i, SoilTerms<Dim>::force + d)) + mass * gravity(d),
            double(nodes.flow(i, F::force + d)) + double(nodes.flow(i, F::weight)) * gravity(d) + load(i, d) -
                drag * flux(i, d)};
  }
};

/// The solve of a node. Leaves in nodes.flux, for contact and for UpdateFlux, the normal of the rigid body
/// that holds the flux at the node, or zero, and the part of the normal impulse on it that the water carries
/// while the grains stay at rest, over the mass [m/s].
template <class Space, class T, int Dim, class Rigids>
struct CoupleFlow {
  FlowStep<Space, T, Dim> of;
  Rigids rigids;
  ControlView<Space> control;

  KOKKOS_INLINE_FUNCTION void operator()(int i) const {
    if (control().paused) return;
    using F = FluxTerms<Dim>;
    const bool wet = of.is_wet(i);
    Vector<double, Dim> normal{};
    double carried = 0;  // m/s
    if (wet) couple(i, normal, carried);
    for (int d = 0; d < Dim; ++d) of.nodes.flux(i, F::flux + d) = static_cast<T>(normal[d]);
    of.nodes.flux(i, F::rate) = static_cast<T>(carried);
    if (of.acting_sides.mask != 0) press_sides(i, wet);
  }

 private:
  KOKKOS_INLINE_FUNCTION void couple(int i, Vector<double, Dim>& normal, double& carried) const {
    using S = SoilTerms<Dim>;
    const unsigned sides = of.sides_at(i), closed = of.closed_axes(sides);
    const double mass = of.nodes.soil(i, S::mass), share = of.nodes.flow(i, FlowTerms<Dim>::water) / mass;
    FlowMotion<Dim> motion;
    Vector<double, Dim> a;
    for (int d = 0; d < Dim; ++d) {
      const FlowNode sums = of.sums(i, d);
      const double before = of.flux(i, d);
      const FlowRates rates = closed >> d & 1u ? hold_flux(sums, -before / of.dt) : solve_flow(sums);
      const double grains = double(of.nodes.soil(i, S::momentum + d)) / mass;
      a[d] = rates.grains;
      // The side takes the force of the mixture less the inertia of the flux that it lets pass.
      if ((closed >> d & 1u) == 0 && of.held_by_open_side(sides, d, grains + a[d] * of.dt))
        a[d] = (sums.force - sums.water * sums.water_force / sums.inertia) / mass;
      motion.grains[d] = grains + a[d] * of.dt;
      motion.flux[d] = before + rates.flux * of.dt;
    }
    PressingRigid<Dim> by;
    if (rigids.pressing(i, motion, share, by)) {
      if (by.permeable)
        let_pass(i, by, a);
      else
        stop(i, by, share * dot(motion.flux, by.normal) / of.dt, a, normal, carried);
    }
    for (int d = 0; d < Dim; ++d)
      of.nodes.soil(i, S::force + d) = static_cast<T>(mass * (a[d] - of.gravity(d)));
  }

  /// Stops the flux into a body, whose momentum the grains take up with the acceleration `taken` [m/s2].
  KOKKOS_INLINE_FUNCTION void stop(int i, const PressingRigid<Dim>& by, double taken, Vector<double, Dim>& a,
                                   Vector<double, Dim>& normal, double& carried) const {
    normal = by.normal;
    for (int d = 0; d < Dim; ++d) {
      a[d] += taken * normal[d];
      carried += impulse_of_water(i, d) * normal[d];
    }
    carried /= double(of.nodes.soil(i, SoilTerms<Dim>::mass));
  }
  /// Leaves the force of the mixture less the inertia of the flux that passes the body while it holds the
  /// grains, as at a side that is open.
  KOKKOS_INLINE_FUNCTION void let_pass(int i, const PressingRigid<Dim>& by, Vector<double, Dim>& a) const {
    FlowNode sums{};
    double force = 0, water_force = 0, grains = 0;
    for (int d = 0; d < Dim; ++d) {
      sums = of.sums(i, d);
      force += sums.force * by.normal[d], water_force += sums.water_force * by.normal[d];
      grains += double(of.nodes.soil(i, SoilTerms<Dim>::momentum + d)) / sums.mass * by.normal[d];
    }
    const double held = (by.speed - grains) / of.dt;  // m/s2
    const double flux = (water_force - sums.water * held) / sums.inertia;
    const double change = (force - sums.water * flux) / sums.mass - dot(a, by.normal);
    for (int d = 0; d < Dim; ++d) a[d] += change * by.normal[d];
  }

  /// Impulse of the water in the pores on a surface that holds the flux along axis d and leaves the grains at
  /// rest [N s]; grains of the velocity v behind the step take M_w v off it.
  KOKKOS_INLINE_FUNCTION double impulse_of_water(int i, int d) const {
    using S = SoilTerms<Dim>;
    const FlowNode sums = of.sums(i, d);
    const double drag = of.nodes.flow(i, FlowTerms<Dim>::drag), flux = of.flux(i, d);
    const double grains = double(of.nodes.soil(i, S::momentum + d)) / sums.mass;
    return (sums.water_force + drag * flux) * of.dt + (sums.inertia - of.dt * drag) * flux +
           sums.water * grains;
  }
  /// Whether the tables of sides have rows for a node.
  KOKKOS_INLINE_FUNCTION bool is_in_table(const Coord<Dim>& at) const {
    bool inside = true;
    for (int d = 0; d < Dim; ++d) inside &= at[d] >= -1 && at[d] <= of.grid.cells[d] + 1;
    return inside;
  }
  /// Leaves for friction of the sides of the mesh the part of the normal impulse that the water carries.
  KOKKOS_INLINE_FUNCTION void press_sides(int i, bool wet) const {
    const Coord<Dim> at = in_mesh(of.origin(i / Patch<Dim>::cells), coord_of<Dim>(i));
    const unsigned closed = of.closed_axes(of.sides_at(i));
    for (int n = 0; n < 2 * Dim; ++n) {
      const Side<Dim>* const side = of.acting_sides.all + n;
      const int d = n / 2;
      const bool on = at[d] == (n % 2 == 0 ? 0 : of.grid.cells[d]);  // the nodes beyond have the same row
      if (!on || !is_in_table(at) || side->kind != Wall::friction) continue;
      double carried = 0;
      if (wet && (closed >> d & 1u) != 0)
        carried =
            impulse_of_water(i, d) - double(of.nodes.flow(i, FlowTerms<Dim>::water)) * side->velocity[d];
      of.acting_sides.node(n, at)[SideTerms<Dim>::carried] = n % 2 == 1 ? carried : -carried;
    }
  }
};

template <class Space, class T, int Dim>
struct UpdateFlux {
  FlowStep<Space, T, Dim> of;
  ControlView<Space> control;

  KOKKOS_INLINE_FUNCTION void operator()(int i) const {
    if (control().paused) return;
    Vector<double, Dim> before{}, after{}, normal;
    for (int d = 0; d < Dim; ++d) normal[d] = of.nodes.flux(i, FluxTerms<Dim>::flux + d);
    if (of.is_wet(i)) {
      const unsigned closed = of.closed_axes(of.sides_at(i));
      for (int d = 0; d < Dim; ++d) {
        const FlowNode sums = of.sums(i, d);
        const double grains =
            double(of.nodes.kinematics(i, NodeKinematics<Dim>::acceleration + d)) / of.share;
        before[d] = of.flux(i, d);
        if ((closed >> d & 1u) == 0)
          after[d] = before[d] + (sums.water_force - sums.water * grains) / sums.inertia * of.dt;
      }
    }
    const double through = dot(after, normal);
    for (int d = 0; d < Dim; ++d) {
      const double flux = after[d] - through * normal[d];
      of.nodes.flux(i, FluxTerms<Dim>::flux + d) = static_cast<T>(flux);
      of.nodes.flux(i, FluxTerms<Dim>::rate + d) = static_cast<T>((flux - before[d]) / of.dt * of.share);
    }
  }
};

}  // namespace mpm
