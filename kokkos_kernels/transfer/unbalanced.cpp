#include "transfer/unbalanced.hpp"

#include "physics/surface.hpp"
#include "physics/walls.hpp"

namespace mpm {
namespace {

template <class Space, class T, int Dim>
struct NodeForces {
  using Memory = typename Space::memory_space;
  using S = SoilTerms<Dim>;
  static constexpr int cells = Patch<Dim>::cells;

  Grid<T, Dim> grid;
  Kokkos::View<Coord<Dim>*, Memory> origin;
  NodeField<Space, T, S::size> soil;
  Kokkos::View<Rigid<Dim>*, Memory> rigids;
  Kokkos::View<Vertex*, Memory> vertices;
  Kokkos::View<int*, Memory> near_rigid;
  Kokkos::View<std::uint64_t*, Memory> owned_nodes;
  Vector<double, Dim> gravity;
  double spacing, mass_cut;

  /// Whether contact may act at a node of a slot: within a cell's diagonal of a surface.
  KOKKOS_INLINE_FUNCTION bool may_be_touched(int slot, const Coord<Dim>& at) const {
    if (rigids.extent(0) == 0 || near_rigid(slot) == 0) return false;
    const double reach = (1 + Kokkos::sqrt(double(Dim))) * spacing;
    for (int r = 0; r < static_cast<int>(rigids.extent(0)); ++r) {
      const Rigid<Dim>& rigid = rigids(r);
      if (!rigid.surface_normal) return true;  // its points tell where it is, not a distance
      const auto x = rigid.pose.to_body([&](int d) { return grid.coordinate_within(d, at[d], spacing); });
      if (distance_to(rigid.surface, vertices, x).value <= reach) return true;
    }
    return false;
  }

  KOKKOS_INLINE_FUNCTION void operator()(int i, double& unbalanced, double& weight) const {
    const int slot = i / cells;
    if (owned_nodes.extent(0) > 0 && (owned_nodes(slot) >> (i % cells) & 1) == 0) return;
    const double m_i = soil(i, S::mass);
    if (!(m_i > mass_cut)) return;
    Coord<Dim> at = coord_of<Dim>(i);
    for (int d = 0; d < Dim; ++d) at[d] += origin(slot)[d];
    if (may_be_touched(slot, at)) return;
    Vector<T, Dim> free;  // 0 where a wall holds a component
    for (int d = 0; d < Dim; ++d) free[d] = 1;
    apply_walls(grid, sides_of(grid, at), free);
    for (int d = 0; d < Dim; ++d)
      for (int side = 0; side < 2; ++side)  // what such a side holds is not known before its step
        if ((sides_of(grid, at) >> (2 * d + side) & 1u) && is_acting(grid.wall[d][side])) return;
    double force = 0, heavy = 0;
    for (int d = 0; d < Dim; ++d) {
      const double w = free[d] * m_i * gravity[d], f = free[d] * double(soil(i, S::force + d)) + w;
      force += f * f, heavy += w * w;
    }
    unbalanced += Kokkos::sqrt(force), weight += Kokkos::sqrt(heavy);
  }
};

}  // namespace

template <class Space, class T, int Dim>
UnbalancedForces unbalanced_forces(const State<Space, T, Dim>& s) {
  const NodeForces<Space, T, Dim> forces{s.grid,       s.patches.origin, s.nodes.soil, s.rigids,  s.vertices,
                                         s.near_rigid, s.owned_nodes,    s.gravity,    s.spacing, s.mass_cut};
  UnbalancedForces sum;
  Kokkos::parallel_reduce("mpm::unbalanced_forces",
                          Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()), forces, sum.force,
                          sum.weight);
  s.space.fence("mpm::unbalanced_forces");
  return sum;
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template UnbalancedForces unbalanced_forces(const State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
