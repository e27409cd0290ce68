#include "halo.hpp"
#include "warp.hpp"
#include "window.hpp"

namespace mpm {

constexpr int k_patch_nodes = Patch<2>::cells;
static_assert(k_patch_nodes == Patch<3>::cells);

template <class Space, class T>
void pack_nodes(const Space& space, const HaloLists<Space>& lists, const HaloField<T>& field, int width,
                T* out) {
  const auto node = lists.node;
  Kokkos::parallel_for(
      "mpm::pack_nodes", light(Kokkos::RangePolicy<Space>(space, 0, lists.sent * field.size)),
      KOKKOS_LAMBDA(int m) {
        const int n = m / field.size, k = m % field.size;
        out[std::size_t(n) * width + field.offset + k] = field.values[std::size_t(node(n)) * field.size + k];
      });
}

template <class Space, class T>
void sum_shares(const Space& space, const HaloLists<Space>& lists, const HaloField<T>& field, int width,
                const T* in) {
  const auto node = lists.shared_node, begin = lists.begin, source = lists.source;
  Kokkos::parallel_for(
      "mpm::sum_shares", light(Kokkos::RangePolicy<Space>(space, 0, lists.shared * field.size)),
      KOKKOS_LAMBDA(int m) {
        const int n = m / field.size, k = m % field.size;
        T& value = field.values[std::size_t(node(n)) * field.size + k];
        const bool read = field.read == nullptr || field.read[node(n) / k_patch_nodes] != 0;
        const T own = value;
        T sum = 0;
        for (int e = begin(n); e < begin(n + 1) && read; ++e)
          sum += source(e) < 0 ? own : in[std::size_t(source(e)) * width + field.offset + k];
        value = sum;
      });
}

template <class Space, class T, int Dim>
void sum_rigid_forces(const State<Space, T, Dim>& s, const Space& space) {
  const auto forces = s.slot_forces, sums = s.sums;
  const int values = Dim * static_cast<int>(s.rigid_points.size()), slots = s.near_count;
  if (values == 0) return;
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int threads = is_device<Space> ? 256 : 1, warps = (threads + k_warp - 1) / k_warp;
  Kokkos::parallel_for(
      "mpm::sum_rigid_forces",
      light(Team(space, values, threads)
                .set_scratch_size(0, Kokkos::PerTeam(scratch_bytes<double>(warps) + k_scratch_slack))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        const int v = team.league_rank(), thread = team.team_rank();
        double* const part = scratch<double>(team, warps);
        double sum = 0;
        for (int n = thread; n < slots; n += threads) sum += forces(n * values + v);
        sum = sum_of_warp(sum);
        if (thread % k_warp == 0) part[thread / k_warp] = sum;
        team.team_barrier();
        Kokkos::single(Kokkos::PerTeam(team), [&] {
          sums(v) = part[0];
          for (int w = 1; w < warps; ++w) sums(v) += part[w];
        });
      });
}

template <class Space, class T, int Dim>
void put_rigid_forces(State<Space, T, Dim>& s) {
  const auto forces = s.slot_forces, sums = s.sums;
  Kokkos::parallel_for(
      "mpm::put_rigid_forces", light(Kokkos::RangePolicy<Space>(s.space, 0, sums.extent(0))),
      KOKKOS_LAMBDA(int v) { forces(v) = sums(v); });
  s.near_count = 1;
}

// Once for both dimensions.
#define MPM_HALO_2(Space, T)                                                                     \
  template void pack_nodes(const Space&, const HaloLists<Space>&, const HaloField<T>&, int, T*); \
  template void sum_shares(const Space&, const HaloLists<Space>&, const HaloField<T>&, int, const T*);
#define MPM_HALO_3(Space, T)
#define MPM_INSTANTIATE(Space, T, Dim)                                                                \
  MPM_HALO_##Dim(Space, T) template void sum_rigid_forces(const State<Space, T, Dim>&, const Space&); \
  template void put_rigid_forces(State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
