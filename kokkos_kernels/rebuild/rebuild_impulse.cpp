#include "base/copy.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {

template <class Space, class T, int Dim>
KeptImpulse<Space, T, Dim> keep_impulse(const ContactCore<Space, T, Dim>& s) {
  KeptImpulse<Space, T, Dim> kept;
  if (impulse_rows(s) == 0 || s.nodes.impulse.extent(1) == 0) return kept;
  kept.slots = s.patches.slots;
  kept.impulse = s.nodes.impulse;  // restore_impulse makes a new one
  kept.number =
      decltype(kept.number)(Kokkos::view_alloc("mpm::kept_number", Kokkos::WithoutInitializing), kept.slots);
  copy(s.space, kept.number, Kokkos::subview(s.patches.number, Kokkos::make_pair(0, kept.slots)));
  kept.near = s.contact.near;
  if (kept.near.listed) {  // the next lists take its place
    const auto part = Kokkos::make_pair(0, kept.slots * kept.near.width);
    kept.near.of = decltype(kept.near.of)(Kokkos::view_alloc("mpm::kept_bodies", Kokkos::WithoutInitializing),
                                          part.second);
    copy(s.space, kept.near.of, Kokkos::subview(s.contact.near.of, part));
  }
  return kept;
}

template <class Space, class T, int Dim>
void restore_impulse(ContactCore<Space, T, Dim>& s, const KeptImpulse<Space, T, Dim>& kept) {
  const int stride = impulse_stride(s);
  s.nodes.impulse = decltype(s.nodes.impulse)("mpm::nodes.impulse", impulse_rows(s), s.patches.node_count());
  const NearBodies<Space> before = kept.near, near = s.contact.near;
  const auto old = kept.impulse;
  const auto number = kept.number;
  const auto impulse = s.nodes.impulse;
  const auto slot_of = s.patches.slot_of;
  Kokkos::parallel_for(
      "mpm::restore_impulse", Kokkos::RangePolicy<Space>(s.space, 0, kept.slots * Patch<Dim>::cells),
      KOKKOS_LAMBDA(int i) {
        constexpr int cells = Patch<Dim>::cells;
        const int slot = slot_of(number(i / cells));
        if (slot < 0) return;
        for (int n = 0; n < before.width; ++n) {
          const int body = before.body(i / cells, n), to = body < 0 ? -1 : near.number(slot, body);
          if (to < 0) continue;
          for (int k = 0; k < stride; ++k)
            impulse(to * stride + k, slot * cells + i % cells) = old(n * stride + k, i);
        }
      });
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                 \
  template KeptImpulse<Space, T, Dim> keep_impulse(const ContactCore<Space, T, Dim>&); \
  template void restore_impulse(ContactCore<Space, T, Dim>&, const KeptImpulse<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
