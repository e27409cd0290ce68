#include "functions/split_patches.hpp"

#include "base/ensure.hpp"
#include "physics/walls.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void split_patches(Core<Space, T, Dim>& s, const Space& stream) {
  const auto& bins = s.soil.bins;
  const int end = bins.last_active;
  const bool has_border = s.plan.form == StepForm::overlapped && bins.border > 0 && bins.border < end;
  ensure(s.split.slots, end);
  s.split.parts.clear();
  const auto split = s.split.slots, active_slots = bins.active_slots;
  const auto origin = s.patches.origin;
  const auto alone = s.strays.alone;
  const WallReach<Dim> reach(s.grid);
  const auto split_part = [&](int first, int last) {
    int common = 0;  // they keep their order; the others are last, in reverse order
    Kokkos::parallel_scan(
        "mpm::split_patches", Kokkos::RangePolicy<Space>(stream, first, last),
        KOKKOS_LAMBDA(int n, int& before, bool writes) {
          const int slot = active_slots(n);
          const bool is_common = !reach(origin(slot)) && alone(slot) == 0;
          if (writes) split(is_common ? first + before : last - 1 - (n - first - before)) = slot;
          before += is_common;
        },
        common);
    s.split.parts.push_back({first, first + common, last});
  };
  if (has_border) split_part(0, bins.border);
  split_part(has_border ? bins.border : 0, end);
}

#define MPM_INSTANTIATE(Space, T, Dim) template void split_patches(Core<Space, T, Dim>&, const Space&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
