#include "functions/launch_update.hpp"
#include "functions/update_about_nodes.hpp"
#include "loops/cpu/host_update.hpp"

namespace mpm {
namespace {

template <class Space>
using Slots = Kokkos::View<int*, typename Space::memory_space>;

template <bool Sums, PatchKind kind, class Space, class T, int Dim>
void launch(ContactCore<Space, T, Dim>& s, double dt, const Slots<Space>& slots, const Part<Space>& part) {
  with_domain(s.soil.points, [&](auto domain) {
    // Rings have one kernel, for all patches and laws.
    constexpr bool may_be_about_nodes = is_device<Space> && Dim == 3 && domain() == ParticleDomain::fixed;
    if constexpr (kind == PatchKind::common && may_be_about_nodes) {
      if (s.p2g.about_nodes && s.plan.sums_ahead) return update_about_nodes(s, dt, slots, part);
    }
    if constexpr (domain() == ParticleDomain::ring) {
      launch_update<Sums, PatchKind::any, Materials, domain()>(s, dt, slots, part);
    } else {
      if (light_kernels_do(s)) return launch_update<Sums, kind, LightMaterials, domain()>(s, dt, slots, part);
      // Domains that stretch have no kernels of one law, which take long to compile.
      if constexpr (kind == PatchKind::common && domain() == ParticleDomain::fixed) {
        if (launch_single_law(s, dt, Sums, slots, part)) return;
      }
      launch_update<Sums, kind, Materials, domain()>(s, dt, slots, part);
    }
  });
}

/// The patches that are not common are few and take longer each, and contact waits for those near it. They
/// are launched first, on a stream of their own, so that common patches fill the device beside them.
template <bool Sums, class Space, class T, int Dim>
void update_on_device(ContactCore<Space, T, Dim>& s, double dt, const Part<Space>& part, const Space& aside) {
  const bool about_nodes = s.p2g.about_nodes && s.plan.sums_ahead;
  if (!s.split.holds(part)) {
    launch<Sums, PatchKind::any>(s, dt, Slots<Space>(s.soil.bins.active_slots), part);
    if (about_nodes) sum_others(s, s.soil.bins.active_slots, part);
    return;
  }
  for (const auto& of : s.split.parts) {
    if (of.first < part.first || of.last > part.last) continue;
    launch<Sums, PatchKind::any>(s, dt, s.split.slots, {aside, of.middle, of.last});
    if (about_nodes) sum_others(s, s.split.slots, {aside, of.middle, of.last});
    launch<Sums, PatchKind::common>(s, dt, s.split.slots, {aside, of.first, of.near});
    launch<Sums, PatchKind::common>(s, dt, s.split.slots, {part.space, of.near, of.middle});
  }
}

}  // namespace

template <class Space, class T, int Dim>
void update_particles(ContactCore<Space, T, Dim>& s, double dt, [[maybe_unused]] const Part<Space>& part,
                      [[maybe_unused]] const Space& aside) {
  const bool sums = s.plan.sums_ahead;
  s.summed = {sums, sums && s.soil_boundary && !s.p2g.about_nodes, false, sums && s.plan.writes_sums};
  if constexpr (is_device<Space>) {
    if constexpr (sums_fit<Space, T, Dim>)
      if (sums) return update_on_device<true>(s, dt, part, aside);
    update_on_device<false>(s, dt, part, aside);
  } else {
    with_domain(s.soil.points, [&](auto domain) { move_on_host<domain()>(s, update_scalars(s, dt), sums); });
  }
}

template <class Space, class T, int Dim>
void update_particles(ContactCore<Space, T, Dim>& s, double dt, const Space& aside) {
  update_particles(s, dt, Part<Space>{s.space, 0, s.soil.bins.last_active}, aside);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                               \
  template void update_particles(ContactCore<Space, T, Dim>&, double, const Space&); \
  template void update_particles(ContactCore<Space, T, Dim>&, double, const Part<Space>&, const Space&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
