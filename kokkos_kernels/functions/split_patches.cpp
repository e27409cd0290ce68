#include "functions/split_patches.hpp"

#include "base/ensure.hpp"
#include "data/node_bins.hpp"
#include "physics/walls.hpp"

namespace mpm {
namespace {

/// Whether the kernel for bins about nodes takes a slot: at the upper sides of the mesh particles are in bins
/// of cells, and its stage must hold each bin.
template <class Space, int Dim>
struct FitsNodeBins {
  static constexpr int k_most_in_bin = 256;
  Kokkos::View<int*, typename Space::memory_space> begin;
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  Coord<Dim> cells, at_walls;  // at_walls: the nodes at the upper side have bins

  template <class T>
  explicit FitsNodeBins(const ContactCore<Space, T, Dim>& s)
      : begin(s.soil.bins.begin), origin(s.patches.origin), cells(s.grid.cells) {
    const Coord<Dim> last = last_bins(s.grid);
    for (int d = 0; d < Dim; ++d) at_walls[d] = last[d] == cells[d];
  }
  KOKKOS_INLINE_FUNCTION bool operator()(int slot) const {
    bool fits = true;
    for (int d = 0; d < Dim; ++d)
      fits = fits && (at_walls[d] || origin(slot)[d] + Patch<Dim>::edge < cells[d]);
    for (int b = slot * Patch<Dim>::cells; fits && b < (slot + 1) * Patch<Dim>::cells; ++b)
      fits = begin(b + 1) - begin(b) <= k_most_in_bin;
    return fits;
  }
};

/// Kinds of slots, by the kernel of function 5 that may take their soil.
template <class Space, class T, int Dim>
struct PatchKinds {
  enum Kind { near, common, other };  // near: common, and it gives to contact sums that are wanted early
  ContactPlaces<Space> contact;
  decltype(Strays<Space>::alone) alone;
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  WallReach<Dim> reach;
  FitsNodeBins<Space, Dim> fits;
  bool about_nodes, has_near;  // about_nodes: else kernels for bins of cells do it

  explicit PatchKinds(const ContactCore<Space, T, Dim>& s)
      : contact(s.contact.place),
        alone(s.strays.alone),
        origin(s.patches.origin),
        reach(s.grid),
        fits(s),
        about_nodes(s.p2g.about_nodes && s.plan.sums_ahead),
        has_near(about_nodes && s.interfaces.in_use()) {}
  KOKKOS_INLINE_FUNCTION Kind operator()(int slot) const {
    const bool is_common = alone(slot) == 0 && (about_nodes ? fits(slot) : !reach(origin(slot)));
    return !is_common ? other : has_near && contact(slot) != 0 ? near : common;
  }
};

}  // namespace

template <class Space, class T, int Dim>
void split_patches(ContactCore<Space, T, Dim>& s, const Space& stream) {
  using Kinds = PatchKinds<Space, T, Dim>;
  const auto& bins = s.soil.bins;
  const int end = bins.last_active;
  const bool has_border = s.plan.form == StepForm::overlapped && bins.border > 0 && bins.border < end;
  ensure(s.split.slots, end);
  s.split.parts.clear();
  const auto split = s.split.slots, active_slots = bins.active_slots;
  const Kinds kinds(s);
  // Lists the slots of a kind from `at` on, upwards or downwards. Returns how many they are.
  const auto list = [&](typename Kinds::Kind kind, int first, int last, int at, int way) {
    int count = 0;
    Kokkos::parallel_scan(
        "mpm::split_patches", Kokkos::RangePolicy<Space>(stream, first, last),
        KOKKOS_LAMBDA(int n, int& before, bool writes) {
          const int slot = active_slots(n);
          if (kinds(slot) != kind) return;
          if (writes) split(at + way * before) = slot;
          ++before;
        },
        count);
    return count;
  };
  const auto split_part = [&](int first, int last) {
    const int near = first + (kinds.has_near ? list(Kinds::near, first, last, first, 1) : 0),
              middle = near + list(Kinds::common, first, last, near, 1);
    if (middle < last) list(Kinds::other, first, last, last - 1, -1);
    s.split.parts.push_back({first, near, middle, last});
  };
  if (has_border) split_part(0, bins.border);
  split_part(has_border ? bins.border : 0, end);
}

#define MPM_INSTANTIATE(Space, T, Dim) template void split_patches(ContactCore<Space, T, Dim>&, const Space&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
