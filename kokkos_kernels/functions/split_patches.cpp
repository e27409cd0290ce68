#include "functions/split_patches.hpp"

#include "base/ensure.hpp"
#include "data/node_bins.hpp"
#include "physics/walls.hpp"

namespace mpm {
namespace {

/// Whether the kernel for bins about nodes takes a slot: it sums no boundary, at the upper sides of the mesh
/// particles are in bins of cells, and its stage must hold each bin.
template <class Space, int Dim>
struct FitsNodeBins {
  static constexpr int k_most_in_bin = 256;
  ContactPlaces<Space> contact;
  Kokkos::View<int*, typename Space::memory_space> begin;
  Kokkos::View<Coord<Dim>*, typename Space::memory_space> origin;
  Coord<Dim> cells, at_walls;  // at_walls: the nodes at the upper side have bins
  bool has_boundary;

  template <class T>
  explicit FitsNodeBins(const ContactCore<Space, T, Dim>& s)
      : contact(s.contact.place),
        begin(s.soil.bins.begin),
        origin(s.patches.origin),
        cells(s.grid.cells),
        has_boundary(s.soil_boundary) {
    const Coord<Dim> last = last_bins(s.grid);
    for (int d = 0; d < Dim; ++d) at_walls[d] = last[d] == cells[d];
  }
  KOKKOS_INLINE_FUNCTION bool operator()(int slot) const {
    bool fits = !(has_boundary && contact(slot) != 0);
    for (int d = 0; d < Dim; ++d)
      fits = fits && (at_walls[d] || origin(slot)[d] + Patch<Dim>::edge < cells[d]);
    for (int b = slot * Patch<Dim>::cells; fits && b < (slot + 1) * Patch<Dim>::cells; ++b)
      fits = begin(b + 1) - begin(b) <= k_most_in_bin;
    return fits;
  }
};

}  // namespace

template <class Space, class T, int Dim>
void split_patches(ContactCore<Space, T, Dim>& s, const Space& stream) {
  const auto& bins = s.soil.bins;
  const int end = bins.last_active;
  const bool has_border = s.plan.form == StepForm::overlapped && bins.border > 0 && bins.border < end;
  ensure(s.split.slots, end);
  s.split.parts.clear();
  const auto split = s.split.slots, active_slots = bins.active_slots;
  const auto origin = s.patches.origin;
  const auto alone = s.strays.alone;
  const WallReach<Dim> reach(s.grid);
  const FitsNodeBins<Space, Dim> fits(s);
  const bool about_nodes = s.p2g.about_nodes && s.plan.sums_ahead;  // else kernels for bins of cells do it
  const auto split_part = [&](int first, int last) {
    int common = 0;  // they keep their order; the others are last, in reverse order
    Kokkos::parallel_scan(
        "mpm::split_patches", Kokkos::RangePolicy<Space>(stream, first, last),
        KOKKOS_LAMBDA(int n, int& before, bool writes) {
          const int slot = active_slots(n);
          const bool is_common = alone(slot) == 0 && (about_nodes ? fits(slot) : !reach(origin(slot)));
          if (writes) split(is_common ? first + before : last - 1 - (n - first - before)) = slot;
          before += is_common;
        },
        common);
    s.split.parts.push_back({first, first + common, last});
  };
  if (has_border) split_part(0, bins.border);
  split_part(has_border ? bins.border : 0, end);
}

#define MPM_INSTANTIATE(Space, T, Dim) template void split_patches(ContactCore<Space, T, Dim>&, const Space&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
