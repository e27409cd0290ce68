#include "functions/energy_works.hpp"

#include "loops/node_update.hpp"
#include "physics/cell_mean.hpp"

namespace mpm {
namespace {

/// The works at node i. The forces are those of UpdateNodes::accelerate; walls and contact give the rest of
/// the node's acceleration. The rank that is responsible for a node counts its works, but each rank counts
/// that of the water which its own soil displaces there: nodes.displaced is not summed over ranks.
template <class Space, class T, int Dim>
struct WorkAtNodes {
  using S = SoilTerms<Dim>;
  static constexpr int cells = Patch<Dim>::cells;
  UpdateNodes<Space, T, Dim> update;
  ControlView<Space> control;
  ContactPlaces<Space> contact;
  Interfaces<Space, Dim> interfaces;
  bool in_water;

  KOKKOS_INLINE_FUNCTION void operator()(int i, NodeWorks& sum) const {
    if (control().paused) return;
    const auto& owned_nodes = update.owned_nodes;
    const bool owned = owned_nodes.extent(0) == 0 || (owned_nodes(i / cells) >> (i % cells) & 1) != 0;
    if (!owned && !in_water) return;
    const double m_i = update.nodes.soil(i, S::mass);
    if (!(m_i > update.at_rest())) return;
    const bool heavy = m_i > update.mass_cut;
    const Vector<T, Dim> g = update.gravity(), braking = owned ? braking_of(i) : filled<T, Dim>(0);
    for (int d = 0; d < Dim; ++d) {
      const double v_old = update.nodes.soil(i, S::momentum + d) / m_i,
                   v = update.nodes.kinematics(i, NodeKinematics<Dim>::velocity + d);
      const double carried =
          in_water && heavy ? -double(update.nodes.displaced(i, DisplacedTerms::mass)) * update.g[d] : 0;
      const double way = update.dt * (v_old + v) / 2;
      sum.internal -= carried * way;
      sum.gravity += carried * way;
      if (!owned) continue;
      const double force = heavy ? double(update.nodes.soil(i, S::force + d)) : 0, weight = m_i * g[d];
      const double damped = -m_i * double(braking[d]);
      const double pressed = of_other_fields(i, d);
      sum.internal += (force - pressed) * way;
      sum.gravity += weight * way;
      sum.damping += damped * way;
      sum.boundary += (m_i * (v - v_old) / update.dt - force - weight - damped + pressed) * way;
    }
  }

  /// Force of other velocity fields on node i [N], which is in the sums.
  KOKKOS_INLINE_FUNCTION double of_other_fields(int i, int d) const {
    if (interfaces.fields < 2 || interfaces.laws.extent(0) == 0) return 0;
    const int entry = interfaces.entry(i / cells);
    return entry == 0 ? 0 : interfaces.force((std::size_t(entry - 1) * Dim + d) * cells + i % cells);
  }
  /// Deceleration of node i by local damping in the step [m/s2].
  KOKKOS_INLINE_FUNCTION Vector<T, Dim> braking_of(int i) const {
    const bool touches = update.rigids.extent(0) > 0 && contact(i / cells) > 0;
    Coord<Dim> at = coord_of<Dim>(i);
    for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(i / cells)[d];
    const auto node = update.node_of(update.nodes, i, at, touches);
    Vector<T, Dim> v_old, a, brake;
    update.accelerate(node.soil, node.inv_m, v_old, a);
    if (update.at_sites && touches) return braking_behind_sites(i, v_old);
    update.advanced(update.nodes, update.rigids.data(), node, v_old, a, false, nullptr, brake);
    return brake;
  }
  /// Deceleration [m/s2] where damping follows contact at sites, from the acceleration that damping left.
  KOKKOS_INLINE_FUNCTION Vector<T, Dim> braking_behind_sites(int i, const Vector<T, Dim>& v_old) const {
    Vector<T, Dim> brake;
    for (int d = 0; d < Dim; ++d) {
      const T left =
          (update.nodes.kinematics(i, NodeKinematics<Dim>::velocity + d) - v_old[d]) * update.inv_dt;
      const bool along = left * v_old[d] > 0;  // damping has reduced it, else increased it
      const T size = Kokkos::fabs(left) * update.damping / (along ? 1 - update.damping : 1 + update.damping);
      brake[d] = v_old[d] == 0 ? T(0) : Kokkos::copysign(size, v_old[d]);
    }
    return brake;
  }
};

/// Strain of the particles of a cell in the step, as advance() makes it of the nodes' velocities.
template <class Space, class T, int Dim>
struct StrainOfCells {
  Soil<Space, T, Dim> soil;
  NodePlaces<Space, T, Dim> places;
  decltype(Nodes<Space, T, Dim>::kinematics) kinematics;
  decltype(Bins<Space>::begin) begin;
  EnergyWorks<Space, T, Dim> works;
  ControlView<Space> control;
  T dt, f_bar;
  bool by_material;

  KOKKOS_INLINE_FUNCTION void operator()(int cell) const {
    if (control().paused) return;
    const int first = begin(cell), last = begin(cell + 1);
    CellMean<T> mean;
    for (int p = first; p < last; ++p) {
      works.stress(p) = soil.stress(p), works.volume(p) = soil.volume(p);
      works.strain(p) = strain_of(p);
      mean.add(soil.volume(p), soil.volume(p) * trace(p));
    }
    if (f_bar > 0)
      bring_together(
          soil, first, last, by_material, mean, [&](int p) { return trace(p); },
          [&](int p, T to) { dilate(p, to); });
  }

 private:
  KOKKOS_INLINE_FUNCTION T trace(int p) const {
    T sum = 0;
    for (int d = 0; d < 3; ++d) sum += works.strain(p)[d];
    return sum;
  }
  KOKKOS_INLINE_FUNCTION void dilate(int p, T to) const {
    const T correction = f_bar * (to - trace(p)) / 3;
    for (int d = 0; d < 3; ++d) works.strain(p)[d] += correction;
  }
  KOKKOS_INLINE_FUNCTION SymTensor<T, Dim> strain_of(int p) const {
    SymTensor<T, Dim> strain{};
    const T half = dt * places.grid.inv_spacing / 2;
    with_any_domain(soil, p, [&](const auto& domain) {
      constexpr bool ring = std::is_same_v<std::decay_t<decltype(domain)>, RingDomain<T>>;
      for_each_node<Kind::motion>(soil, domain, places, p,
                                  [&](int i, T, const auto& grad, auto&&, auto&& sign) {
                                    for (int d = 0; d < Dim; ++d) {
                                      const T v = sign(d) * kinematics(i, NodeKinematics<Dim>::velocity + d);
                                      for (int e = 0; e < Dim; ++e)
                                        strain[sym_index<Dim>(d, e)] += (d == e ? 2 : 1) * half * v * grad[e];
                                      if constexpr (ring)
                                        if (d == 0) strain[2] += 2 * half * v * grad[Dim];  // of the hoop
                                    }
                                  });
    });
    return strain;
  }
};

}  // namespace
}  // namespace mpm

namespace Kokkos {
template <>
struct reduction_identity<mpm::NodeWorks> {
  KOKKOS_FORCEINLINE_FUNCTION static mpm::NodeWorks sum() { return {}; }
};
}  // namespace Kokkos

namespace mpm {

template <class Space, class T, int Dim>
void begin_works(State<Space, T, Dim>& s) {
  s.energy.on = true;
  s.energy.work = decltype(s.energy.work)("mpm::energy.work", Work::count);
  s.energy.of_nodes = decltype(s.energy.of_nodes)("mpm::energy.of_nodes");
  s.energy.of_stress = decltype(s.energy.of_stress)("mpm::energy.of_stress");
  s.energy.rigid_at = decltype(s.energy.rigid_at)("mpm::energy.rigid_at", s.rigid_points.size());
}

template <class Space, class T, int Dim>
void add_node_works(State<Space, T, Dim>& s, double dt) {
  const auto& works = s.energy;
  const Kokkos::RangePolicy<Space> nodes(s.space, 0, s.patches.node_count());
  const auto sum = works.of_nodes;
  Kokkos::parallel_reduce("mpm::node_works", nodes,
                          WorkAtNodes<Space, T, Dim>{node_update_of(s, dt), s.control, s.contact.place,
                                                     s.interfaces, s.water.is_there()},
                          Kokkos::Sum<NodeWorks, typename Space::memory_space>(sum));
  const auto work = works.work;
  const auto rigid_at = works.rigid_at;
  const auto rigids = s.rigids;
  const int rigid_count = static_cast<int>(s.rigid_points.size());
  Kokkos::parallel_for(
      "mpm::add_node_works", Kokkos::RangePolicy<Space>(s.space, 0, 1), KOKKOS_LAMBDA(int) {
        work(Work::internal) += sum().internal, work(Work::gravity) += sum().gravity;
        work(Work::damping) += sum().damping, work(Work::boundary) += sum().boundary;
        for (int r = 0; r < rigid_count; ++r) rigid_at(r) = rigids(r).motion.pose;
      });
  Kokkos::parallel_for("mpm::strain_of_cells", nodes,
                       StrainOfCells<Space, T, Dim>{s.soil.points,
                                                    {s.grid, s.patches},
                                                    s.nodes.kinematics,
                                                    s.soil.bins.begin,
                                                    works,
                                                    s.control,
                                                    T(dt),
                                                    T(s.f_bar.fraction),
                                                    s.f_bar.by_material});
}

template <class Space, class T, int Dim>
void add_stress_work(State<Space, T, Dim>& s) {
  const auto works = s.energy;
  const auto soil = s.soil.points;
  const auto control = s.control;
  const auto alone = s.strays.alone;
  const auto sum = works.of_stress;
  Kokkos::parallel_reduce(
      "mpm::stress_work", Kokkos::RangePolicy<Space>(s.space, 0, soil.count),
      KOKKOS_LAMBDA(int p, double& work) {
        if (control().paused || is_alone(alone, soil.cell(p))) return;
        double density = 0;  // J/m3
        for (int k = 0; k < sym_size<Dim>; ++k)
          density += (k < 3 ? 0.5 : 1.0) * (double(works.stress(p)[k]) + double(soil.stress(p)[k])) *
                     double(works.strain(p)[k]);
        work += density * (double(works.volume(p)) + double(soil.volume(p))) / 2;
      },
      Kokkos::Sum<double, typename Space::memory_space>(sum));
  const auto work = s.energy.work;
  Kokkos::parallel_for(
      "mpm::add_stress_work", Kokkos::RangePolicy<Space>(s.space, 0, 1),
      KOKKOS_LAMBDA(int) { work(Work::stress) += sum(); });
}

template <class Space, class T, int Dim>
void add_rigid_work(State<Space, T, Dim>& s, bool counts) {
  const int count = static_cast<int>(s.rigid_points.size());
  if (count == 0 || !counts) return;
  const auto work = s.energy.work;
  const auto before = s.energy.rigid_at;
  const auto rigids = s.rigids;
  const auto force = s.rigid_force;
  const int size = wrench_size<Dim>(s.rigid_turns);
  Kokkos::parallel_for(
      "mpm::add_rigid_work", Kokkos::RangePolicy<Space>(s.space, 0, 1), KOKKOS_LAMBDA(int) {
        for (int r = 0; r < count; ++r) {
          const auto way = way_between(before(r), rigids(r).motion.pose);
          for (int k = 0; k < size; ++k) work(Work::rigids) -= force(r * size + k) * way[k];
        }
      });
}

#define MPM_INSTANTIATE(Space, T, Dim)                         \
  template void begin_works(State<Space, T, Dim>&);            \
  template void add_node_works(State<Space, T, Dim>&, double); \
  template void add_stress_work(State<Space, T, Dim>&);        \
  template void add_rigid_work(State<Space, T, Dim>&, bool);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
