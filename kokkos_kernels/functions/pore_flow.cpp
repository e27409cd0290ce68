#include "functions/pore_flow.hpp"

#include "functions/step_kernels.hpp"
#include "loops/cpu/host_pores.hpp"
#include "loops/flow_nodes.hpp"
#include "physics/pore_water.hpp"

namespace mpm {
namespace {

/// Pore pressure and flux of the particles of a cell.
template <class Space, class T, int Dim, ParticleDomain domain>
struct UpdatePores {
  PoreUpdate<Space, T, Dim> pores;
  NodePlaces<Space, T, Dim> places, flow_places;  // the latter as the flux meets the sides of the mesh
  decltype(Bins<Space>::begin) begin;
  decltype(Nodes<Space, T, Dim>::kinematics) kinematics;
  decltype(Nodes<Space, T, Dim>::flux) flux;
  ControlView<Space> control;

  KOKKOS_INLINE_FUNCTION void operator()(int cell) const {
    if (control().paused) return;
    PoreSums sums;
    for (int p = begin(cell); p < begin(cell + 1); ++p)
      if (pores.is_wet(p)) pores.add(p, sample(p), sums);
    if (sums.volume > 0) pores.press_cell(begin(cell), begin(cell + 1), sums);
  }

 private:
  /// Whether a particle of a cell reaches nodes at sides of the mesh.
  KOKKOS_INLINE_FUNCTION bool is_near_sides(int cell) const {
    const Coord<Dim> at = in_mesh(places.origin(cell / Patch<Dim>::cells), coord_of<Dim>(cell));
    bool near = false;
    for (int d = 0; d < Dim; ++d) near |= at[d] < 2 || at[d] >= places.grid.cells[d] - 2;
    return near;
  }
  /// Calls f(node, weight, gradient [1/cell], sign) for the nodes of particle p.
  template <class F>
  KOKKOS_INLINE_FUNCTION void nodes_of(const NodePlaces<Space, T, Dim>& at, int p, F&& f) const {
    const auto& soil = pores.soil;
    for_each_node<Kind::motion>(
        soil, domain_of<domain>(soil, p, soil.bodies(soil.body(p))), at, p,
        [&](int i, T w, const auto& grad, auto&&, auto&& sign) { f(i, w, grad, sign); });
  }
  /// Divergence of particle p's share of a vector c at a node.
  template <class Gradient>
  KOKKOS_INLINE_FUNCTION static double divergence(const Vector<double, Dim>& c, const Gradient& grad) {
    double sum = 0;
    for (int d = 0; d < Dim; ++d) sum += c[d] * double(grad[d]);
    if constexpr (domain == ParticleDomain::ring) sum += c[0] * double(grad[Dim]);
    return sum;
  }
  KOKKOS_INLINE_FUNCTION PoreSample<Dim> sample(int p) const {
    PoreSample<Dim> at;
    Vector<double, Dim> c;
    const auto add_grains = [&](int i, const auto& grad, const auto& sign) {
      for (int d = 0; d < Dim; ++d) c[d] = double(sign(d) * kinematics(i, NodeKinematics<Dim>::velocity + d));
      at.of_grains += divergence(c, grad);
    };
    const auto add_water = [&](int i, T w, const auto& grad, const auto& sign) {
      for (int d = 0; d < Dim; ++d) {
        c[d] = double(sign(d) * flux(i, FluxTerms<Dim>::flux + d));
        at.flux[d] += double(w) * c[d];
        at.rate[d] += double(w * sign(d) * flux(i, FluxTerms<Dim>::rate + d));
      }
      at.of_flux += divergence(c, grad);
    };
    if (is_near_sides(pores.soil.cell(p))) {  // where the images of nodes may differ
      nodes_of(places, p, [&](int i, T, const auto& grad, const auto& sign) { add_grains(i, grad, sign); });
      nodes_of(flow_places, p, add_water);
    } else {
      nodes_of(places, p, [&](int i, T w, const auto& grad, const auto& sign) {
        add_grains(i, grad, sign), add_water(i, w, grad, sign);
      });
    }
    at.of_grains *= double(places.grid.inv_spacing), at.of_flux *= double(places.grid.inv_spacing);
    return at;
  }
};

template <ParticleDomain domain, class Space, class T, int Dim>
void update_pores_for(State<Space, T, Dim>& s, double dt) {
  const PoreUpdate<Space, T, Dim> pores{s.soil.points, s.flow.pores, s.strays.alone, s.flow.water, dt};
  if constexpr (is_device<Space>) {
    Kokkos::parallel_for("mpm::update_pores",
                         light(Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count())),
                         UpdatePores<Space, T, Dim, domain>{pores,
                                                            {s.grid, s.patches},
                                                            {grid_of_flow(s.grid, s.flow), s.patches},
                                                            s.soil.bins.begin,
                                                            s.nodes.kinematics,
                                                            s.nodes.flux,
                                                            s.control});
  } else {
    const HostPores<Space, T, Dim, domain> host{pores,
                                                s.grid,
                                                grid_of_flow(s.grid, s.flow),
                                                s.soil.bins.begin,
                                                s.patches.neighbours,
                                                s.patches.origin,
                                                s.nodes.kinematics,
                                                s.nodes.flux};
    const Shared slots[] = {slots_held<Dim>(s.soil.bins)};
    for_each_shared("mpm::update_pores", s.space, slots, [&](int, int n) {
      if (!s.control().paused) host(s.soil.bins.active_slots(n));
    });
  }
}

template <class Space, class T, int Dim>
auto all_nodes(const Core<Space, T, Dim>& s) {
  return light(Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()));
}

}  // namespace

template <class Space, class T, int Dim>
void weigh_saturated(const Core<Space, T, Dim>& s, const ControlView<Space>& control) {
  const auto soil = s.soil.points;
  const auto pores = s.flow.pores;
  const auto origin = s.patches.origin;
  const double density = s.flow.water.density, spacing = s.spacing;
  Kokkos::parallel_for(
      "mpm::weigh_saturated", light(Kokkos::RangePolicy<Space>(s.space, 0, soil.count)),
      KOKKOS_LAMBDA(int p) {
        const Pores& of = pores(soil.material_of(p));
        if (control().paused || !of.saturated) return;
        const double solid = soil.solid_volume(p), volume = soil.volume(p), n = 1 - solid / volume;
        soil.mass(p) = static_cast<T>(density * volume + (of.solid_density - density) * solid);
        if (n > k_least_porosity && n < k_most_porosity) return;
        double position[3] = {};
        const Coord<Dim> cell =
            in_mesh(origin(soil.cell(p) / Patch<Dim>::cells), coord_of<Dim>(soil.cell(p)));
        for (int d = 0; d < Dim; ++d) position[d] = (cell[d] + double(soil.coordinate(p)[d])) * spacing;
        report(control, FaultKind::porosity, soil.id(p), position, Dim);
      });
}

template <class Space, class T, int Dim>
void couple_flow(State<Space, T, Dim>& s, double dt) {
  finish_sums(s);
  const FlowStep<Space, T, Dim> of(s, dt);
  if (s.rigid_points.empty()) {
    Kokkos::parallel_for("mpm::couple_flow", all_nodes(s),
                         CoupleFlow<Space, T, Dim, NoRigids>{of, {}, s.control});
  } else {
    using Rigids = FlowAtRigids<Space, T, Dim>;
    Kokkos::parallel_for("mpm::couple_flow_at_rigids", all_nodes(s),
                         CoupleFlow<Space, T, Dim, Rigids>{of, Rigids(s, dt), s.control});
  }
}

template <class Space, class T, int Dim>
void update_flux(State<Space, T, Dim>& s, double dt) {
  Kokkos::parallel_for("mpm::update_flux", all_nodes(s),
                       UpdateFlux<Space, T, Dim>{FlowStep<Space, T, Dim>(s, dt), s.control});
}

template <class Space, class T, int Dim>
void update_pores(State<Space, T, Dim>& s, double dt) {
  with_domain(s.soil.points, [&](auto domain) { update_pores_for<domain()>(s, dt); });
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                  \
  template void weigh_saturated(const Core<Space, T, Dim>&, const ControlView<Space>&); \
  template void couple_flow(State<Space, T, Dim>&, double);                             \
  template void update_flux(State<Space, T, Dim>&, double);                             \
  template void update_pores(State<Space, T, Dim>&, double);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
