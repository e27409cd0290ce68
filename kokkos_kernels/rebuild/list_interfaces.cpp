// Places at which several velocity fields are active.

#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

/// The slots of all fields in one patch of the mesh.
template <class Space, class T, int Dim>
struct SlotsOfPatch {
  Grid<T, Dim> grid;
  decltype(Patches<Space, Dim>::slot_of) slot_of;
  decltype(Patches<Space, Dim>::number) number;

  explicit SlotsOfPatch(const ContactCore<Space, T, Dim>& s)
      : grid(s.grid), slot_of(s.patches.slot_of), number(s.patches.number) {}

  /// Slot of a field in the patch of another slot; -1 where it is not active.
  KOKKOS_INLINE_FUNCTION int of(int slot, int field) const {
    return slot_of(field * grid.patches_of_field() + number(slot) % grid.patches_of_field());
  }
  /// Whether a slot stands for its patch: that of its first field, where there are others.
  KOKKOS_INLINE_FUNCTION bool is_first_of_several(int slot) const {
    int active = 0;
    for (int f = 0; f < grid.fields; ++f) {
      const int other = of(slot, f);
      if (other < 0) continue;
      if (active == 0 && other != slot) return false;
      ++active;
    }
    return active > 1;
  }
};

}  // namespace

template <class Space, class T, int Dim>
void list_interfaces(ContactCore<Space, T, Dim>& s) {
  using Range = Kokkos::RangePolicy<Space>;
  Interfaces<Space, Dim>& to = s.interfaces;
  const int slots = s.patches.slots, fields = to.fields;
  const SlotsOfPatch<Space, T, Dim> patch(s);
  ensure(to.entry, slots);
  ensure(to.slots, std::size_t(slots) * fields);
  const auto entry = to.entry, list = to.slots;
  Kokkos::deep_copy(s.space, entry, 0);
  Kokkos::parallel_scan(
      "mpm::list_interfaces", Range(s.space, 0, slots),
      KOKKOS_LAMBDA(int slot, int& n, bool last) {
        if (!patch.is_first_of_several(slot)) return;
        for (int f = 0; last && f < fields; ++f) {
          const int other = patch.of(slot, f);
          list(n * fields + f) = other;
          if (other >= 0) entry(other) = n * fields + f + 1;
        }
        ++n;
      },
      to.count);
  ensure(to.force, std::size_t(to.count) * fields * Dim * Patch<Dim>::cells);
  ensure(to.sums, std::size_t(to.count) * to.rows * InterfaceTerms<Dim>::size);
}

#define MPM_INSTANTIATE(Space, T, Dim) template void list_interfaces(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
