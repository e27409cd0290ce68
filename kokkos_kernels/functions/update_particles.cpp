#include "loops/cpu/host_update.hpp"
#include "loops/gpu/patch_update.hpp"

namespace mpm {
namespace {

template <bool Sums, class Space, class T, int Dim>
void launch_update(State<Space, T, Dim>& s, double dt, const Part<Space>& part) {
  using Update = UpdateParticles<Space, T, Dim, Sums>;
  const int teams = part.last - part.first;
  if (teams == 0) return;
  Kokkos::parallel_for("mpm::update_particles",
                       light(typename Update::Team(part.space, teams, Update::threads)
                                 .set_scratch_size(0, Kokkos::PerTeam(Update::bytes() + k_scratch_slack))),
                       update_of<Update>(s, dt, part.first));
}

}  // namespace

template <class Space, class T, int Dim>
void update_particles(State<Space, T, Dim>& s, double dt, [[maybe_unused]] const Part<Space>& part) {
  const bool sums = s.plan.sums_ahead;
  s.summed = {sums, sums && s.soil_boundary, false, sums && s.plan.writes_sums};
  if constexpr (is_device<Space>) {
    if constexpr (sums_fit<Space, T, Dim>)
      if (sums) return launch_update<true>(s, dt, part);
    launch_update<false>(s, dt, part);
  } else {
    move_on_host(s, update_scalars(s, dt), sums);
  }
}

template <class Space, class T, int Dim>
void update_particles(State<Space, T, Dim>& s, double dt) {
  update_particles(s, dt, Part<Space>{s.space, 0, s.soil.bins.colour_begin[Patch<Dim>::colours]});
}

#define MPM_INSTANTIATE(Space, T, Dim)                           \
  template void update_particles(State<Space, T, Dim>&, double); \
  template void update_particles(State<Space, T, Dim>&, double, const Part<Space>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
