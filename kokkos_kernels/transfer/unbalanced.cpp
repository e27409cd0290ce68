#include "transfer/unbalanced.hpp"

#include "functions/step_kernels.hpp"
#include "loops/solve_sites.hpp"

namespace mpm {
namespace {

template <class Space, class T, int Dim>
struct NodeForces {
  using S = SoilTerms<Dim>;
  static constexpr int cells = Patch<Dim>::cells;

  UpdateNodes<Space, T, Dim> update;
  ContactPlaces<Space> contact;
  Vector<double, Dim> gravity;
  SolveSites<Space, T, Dim> sites;

  KOKKOS_INLINE_FUNCTION void operator()(int i, double& unbalanced, double& weight) const {
    const int slot = i / cells;
    const auto& owned = update.owned_nodes;
    if (owned.extent(0) > 0 && (owned(slot) >> (i % cells) & 1) == 0) return;
    const double m_i = update.nodes.soil(i, S::mass);
    if (!(m_i > update.mass_cut)) return;
    Coord<Dim> at = coord_of<Dim>(i);
    for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(slot)[d];
    const auto node = update.node_of(update.nodes, i, at, update.rigids.extent(0) > 0 && contact(slot) > 0);
    Vector<T, Dim> v_old, a, free = filled<T, Dim>(1);
    update.accelerate(node.soil, node.inv_m, v_old, a);
    for (int d = 0; d < Dim && update.at_sites && contact(slot) > 0; ++d)
      a[d] += sites.reaction(i, node.inv_m, d);
    if (node.is_held()) a = update.held_acceleration(update.nodes, update.rigids.data(), node, v_old, a);
    apply_walls(update.places.grid, node.sides, free);  // 0 where a wall holds a component
    double force = 0, heavy = 0;
    for (int d = 0; d < Dim; ++d) {
      const double w = free[d] * m_i * gravity[d], f = free[d] * m_i * double(a[d]);
      force += f * f, heavy += w * w;
    }
    unbalanced += Kokkos::sqrt(force), weight += Kokkos::sqrt(heavy);
  }
};

}  // namespace

template <class Space, class T, int Dim>
UnbalancedForces unbalanced_forces(const State<Space, T, Dim>& s, double dt) {
  const NodeForces<Space, T, Dim> forces{node_update_of(s, dt), s.contact.place, s.gravity, {s, dt}};
  UnbalancedForces sum;
  Kokkos::parallel_reduce("mpm::unbalanced_forces",
                          Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()), forces, sum.force,
                          sum.weight);
  s.space.fence("mpm::unbalanced_forces");
  return sum;
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template UnbalancedForces unbalanced_forces(const State<Space, T, Dim>&, double);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
