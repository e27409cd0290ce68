#include "functions/rayleigh.hpp"

#include "functions/side_moduli.hpp"
#include "loops/node_update.hpp"
#include "physics/cell_mean.hpp"

namespace mpm {
namespace {

/// Velocities of the nodes before a step, as sides of the mesh hold them.
template <class Space, class T, int Dim>
struct HeldVelocities {
  using S = SoilTerms<Dim>;
  NodePlaces<Space, T, Dim> places;
  decltype(Nodes<Space, T, Dim>::soil) soil;
  decltype(Nodes<Space, T, Dim>::residual) velocity;
  ActingSides<Dim> acting_sides;
  ControlView<Space> control;
  T at_rest;  // kg, mass below which a node is

  KOKKOS_INLINE_FUNCTION void operator()(int i) const {
    if (control().paused) return;
    const T m_i = soil(i, S::mass);
    double v[Dim] = {};
    if (m_i > at_rest) {
      for (int d = 0; d < Dim; ++d) v[d] = double(soil(i, S::momentum + d)) / double(m_i);
      hold(i, v);
    }
    for (int d = 0; d < Dim; ++d) velocity(i, d) = static_cast<T>(v[d]);
  }

 private:
  KOKKOS_INLINE_FUNCTION void hold(int i, double (&v)[Dim]) const {
    Coord<Dim> at = coord_of<Dim>(i);
    const Coord<Dim> from = places.origin(i / Patch<Dim>::cells);
    for (int d = 0; d < Dim; ++d) at[d] += from[d];
    const unsigned sides = sides_of(places.grid, at);
    for (int n = 0; n < 2 * Dim; ++n)
      if (sides >> n & 1u & acting_sides.mask >> n) prescribe(acting_sides, sides & acting_sides.mask, n, v);
    for (int d = 0; d < Dim; ++d)
      for (int side = 0; side < 2; ++side) {
        if (!(sides >> (2 * d + side) & 1u)) continue;
        const Wall wall = places.grid.wall[d][side];
        for (int k = 0; k < Dim; ++k)
          if (wall == Wall::fixed || (wall == Wall::roller && k == d)) v[k] = 0;
      }
  }
};

/// Viscous stresses of the particles of a cell, whose dilatations F-bar brings together as in advance().
template <class Space, class T, int Dim>
struct ViscousStress {
  Soil<Space, T, Dim> soil;
  NodePlaces<Space, T, Dim> places;
  decltype(Nodes<Space, T, Dim>::residual) velocity;
  decltype(Bins<Space>::begin) begin;
  decltype(Strays<Space>::alone) alone;
  ControlView<Space> control;
  decltype(Rayleigh<Space, T, Dim>::stress) stress;
  decltype(Rayleigh<Space, T, Dim>::shear_ratio) shear_ratio;
  double stiffness;  // s
  T f_bar;
  bool by_material;

  KOKKOS_INLINE_FUNCTION void operator()(int cell) const {
    if (control().paused) return;
    const int first = begin(cell), last = begin(cell + 1);
    CellMean<T> mean;
    for (int p = first; p < last; ++p) {
      stress(p) = rate_of(p);
      mean.add(soil.volume(p), soil.volume(p) * trace(p));
    }
    if (f_bar > 0)
      bring_together(
          soil, first, last, by_material, mean, [&](int p) { return trace(p); },
          [&](int p, T to) { dilate(p, to); });
    for (int p = first; p < last; ++p) resist(p);
  }

 private:
  KOKKOS_INLINE_FUNCTION T trace(int p) const { return stress(p)[0] + stress(p)[1] + stress(p)[2]; }
  KOKKOS_INLINE_FUNCTION void dilate(int p, T to) const {
    const T correction = f_bar * (to - trace(p)) / 3;
    for (int d = 0; d < 3; ++d) stress(p)[d] += correction;
  }
  /// Rate of strain [1/s].
  KOKKOS_INLINE_FUNCTION SymTensor<T, Dim> rate_of(int p) const {
    SymTensor<T, Dim> rate{};
    const T half = places.grid.inv_spacing / 2;
    with_any_domain(soil, p, [&](const auto& domain) {
      constexpr bool ring = std::is_same_v<std::decay_t<decltype(domain)>, RingDomain<T>>;
      for_each_node<Kind::motion>(soil, domain, places, p,
                                  [&](int i, T, const auto& grad, auto&&, auto&& sign) {
                                    for (int d = 0; d < Dim; ++d) {
                                      const T v = sign(d) * velocity(i, d);
                                      for (int e = 0; e < Dim; ++e)
                                        rate[sym_index<Dim>(d, e)] += (d == e ? 2 : 1) * half * v * grad[e];
                                      if constexpr (ring)
                                        if (d == 0) rate[2] += 2 * half * v * grad[Dim];  // of the hoop
                                    }
                                  });
    });
    return rate;
  }
  /// The stress of a rate of strain. Particles that are alone have none.
  KOKKOS_INLINE_FUNCTION void resist(int p) const {
    if (is_alone(alone, soil.cell(p))) {
      stress(p) = SymTensor<T, Dim>{};
      return;
    }
    const SideModuli of = side_moduli(soil, shear_ratio(soil.material_of(p)), p);
    const T shear = static_cast<T>(2 * stiffness * of.shear),
            volumetric = static_cast<T>(stiffness * (of.wave - 2 * of.shear)) * trace(p);
    for (int k = 0; k < sym_size<Dim>; ++k) stress(p)[k] = shear * stress(p)[k] + (k < 3 ? volumetric : T(0));
  }
};

}  // namespace

template <class Space, class T, int Dim>
void begin_rayleigh(Rayleigh<Space, T, Dim>& by, double mass, double stiffness,
                    const std::vector<double>& shear_ratio) {
  by.mass = mass, by.stiffness = stiffness;
  by.shear_ratio = shear_ratios<Space>(shear_ratio);
  by.work = decltype(by.work)("mpm::rayleigh.work");
}

template <class Space, class T, int Dim>
void find_viscous_stress(State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by) {
  const int nodes = s.patches.node_count();
  Kokkos::parallel_for("mpm::held_velocities", Kokkos::RangePolicy<Space>(s.space, 0, nodes),
                       HeldVelocities<Space, T, Dim>{{s.grid, s.patches},
                                                     s.nodes.soil,
                                                     s.nodes.residual,
                                                     acting(s.sides),
                                                     s.control,
                                                     T(1e-12) * T(s.scheme.mass_cut)});
  Kokkos::parallel_for("mpm::viscous_stress", Kokkos::RangePolicy<Space>(s.space, 0, nodes),
                       ViscousStress<Space, T, Dim>{s.soil.points,
                                                    {s.grid, s.patches},
                                                    s.nodes.residual,
                                                    s.soil.bins.begin,
                                                    s.strays.alone,
                                                    s.control,
                                                    by.stress,
                                                    by.shear_ratio,
                                                    by.stiffness,
                                                    T(s.f_bar.fraction),
                                                    s.f_bar.by_material});
}

template <class Space, class T, int Dim>
void show_viscous_forces(State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by) {
  const auto sums = by.sums;
  const auto residual = s.nodes.residual;
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::show_viscous_forces", light(Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count())),
      KOKKOS_LAMBDA(int i) {
        if (control().paused) return;
        for (int d = 0; d < Dim; ++d) residual(i, d) = sums(i, SoilTerms<Dim>::force + d);
      });
}

template <class Space, class T, int Dim>
void add_rayleigh_forces(State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by, bool viscous) {
  using S = SoilTerms<Dim>;
  const auto soil = s.nodes.soil;
  const auto residual = s.nodes.residual;
  const auto force = by.force;
  const auto control = s.control;
  const T mass = static_cast<T>(by.mass);
  Kokkos::parallel_for(
      "mpm::add_rayleigh_forces", light(Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count())),
      KOKKOS_LAMBDA(int i) {
        if (control().paused) return;
        for (int d = 0; d < Dim; ++d) {
          force(i, d) = (viscous ? residual(i, d) : T(0)) - mass * soil(i, S::momentum + d);
          soil(i, S::force + d) += force(i, d);
        }
      });
}

template <class Space, class T, int Dim>
void add_rayleigh_work(State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by, double dt) {
  using S = SoilTerms<Dim>;
  constexpr int cells = Patch<Dim>::cells;
  const auto soil = s.nodes.soil;
  const auto kinematics = s.nodes.kinematics;
  const auto owned = s.owned_nodes;
  const auto force = by.force;
  const auto control = s.control;
  const double mass_cut = s.scheme.mass_cut, half_step = s.scheme.kick * dt / 2;
  const auto of_step = by.work;
  Kokkos::parallel_reduce(
      "mpm::rayleigh_work", Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()),
      KOKKOS_LAMBDA(int i, double& sum) {
        const double m_i = soil(i, S::mass);
        if (control().paused || !(m_i > mass_cut)) return;  // no force acts on a node of less mass
        if (owned.extent(0) > 0 && (owned(i / cells) >> (i % cells) & 1) == 0) return;
        for (int d = 0; d < Dim; ++d) {
          const double v = soil(i, S::momentum + d) / m_i + kinematics(i, NodeKinematics<Dim>::velocity + d);
          sum += double(force(i, d)) * v * half_step;
        }
      },
      Kokkos::Sum<double, typename Space::memory_space>(of_step));
  const auto works = s.energy.work;
  Kokkos::parallel_for(
      "mpm::add_rayleigh_work", Kokkos::RangePolicy<Space>(s.space, 0, 1), KOKKOS_LAMBDA(int) {
        works(Work::damping) += of_step();
        works(Work::internal) -= of_step();  // which counts all forces at the nodes
      });
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                \
  template void begin_rayleigh(Rayleigh<Space, T, Dim>&, double, double, const std::vector<double>&); \
  template void find_viscous_stress(State<Space, T, Dim>&, const Rayleigh<Space, T, Dim>&);           \
  template void show_viscous_forces(State<Space, T, Dim>&, const Rayleigh<Space, T, Dim>&);           \
  template void add_rayleigh_forces(State<Space, T, Dim>&, const Rayleigh<Space, T, Dim>&, bool);     \
  template void add_rayleigh_work(State<Space, T, Dim>&, const Rayleigh<Space, T, Dim>&, double);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
