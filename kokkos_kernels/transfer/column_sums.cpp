#include "transfer/column_sums.hpp"

#include "base/copy.hpp"
#include "physics/gap_room.hpp"
#include "transfer/body_mask.hpp"
#include "transfer/particle_box.hpp"

namespace mpm {
namespace {

/// Adds particles to columns.
template <class Space, class T, int Dim>
struct AddColumns {
  static constexpr int axes = Dim - 1;  // of the ground
  Positions<Space, T, Dim> position;
  BodyMask<Space> counts;
  Kokkos::View<long*, typename Space::memory_space> sums;
  double lower[2], cell;
  int cells[2];

  /// Columns along an axis that an interval of the ground reaches: [first, last], none where last < first.
  KOKKOS_INLINE_FUNCTION void range(int d, double low, double high, int& first, int& last) const {
    const double most = cells[d] - 1.0;
    const double from = Kokkos::floor((low - lower[d]) / cell), to = Kokkos::floor((high - lower[d]) / cell);
    first = last = 0;
    if (d >= axes) return;
    last = -1;
    if (!(from <= most && to >= 0)) return;  // not a number either
    first = static_cast<int>(Kokkos::fmax(0.0, from)), last = static_cast<int>(Kokkos::fmin(most, to));
  }

  /// Part of a box that is over the grid: a particle at a side of the mesh has all of its volume there.
  KOKKOS_INLINE_FUNCTION ParticleBox<Dim> within(ParticleBox<Dim> box) const {
    for (int d = 0; d < axes; ++d) {
      const double low = Kokkos::fmax(box.centre[d] - box.half[d], lower[d]);
      const double high = Kokkos::fmin(box.centre[d] + box.half[d], lower[d] + cells[d] * cell);
      if (!(high > low)) continue;  // it is beyond
      box.centre[d] = (low + high) / 2, box.half[d] = (high - low) / 2;
    }
    return box;
  }

  KOKKOS_INLINE_FUNCTION double share(const ParticleBox<Dim>& box, int d, int column) const {
    if (d >= axes) return 1;
    const double from = lower[d] + column * cell;
    return share_between(box.centre[d] - box.half[d], box.centre[d] + box.half[d], from, from + cell,
                         position.soil.rings);
  }

  /// Quanta of depth that 1 m3 is in a column.
  KOKKOS_INLINE_FUNCTION double quanta(int column) const {
    const double from = lower[0] + column * cell;
    const double area = axes == 2             ? cell * cell
                        : position.soil.rings ? Kokkos::numbers::pi * cell * (2 * from + cell)
                                              : cell;
    return 1 / (k_depth_quantum * position.spacing * area);
  }

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    const auto& soil = position.soil;
    if (!counts(0, soil.body(p))) return;
    const ParticleBox<Dim> box = within(box_of(position, p));
    const double volume = double(soil.volume(p)) / double(gap_room(soil, p));  // of the soil between its gaps
    int first[2], last[2];
    for (int d = 0; d < 2; ++d) {
      const int k = d < axes ? d : 0;
      range(d, box.centre[k] - box.half[k], box.centre[k] + box.half[k], first[d], last[d]);
    }
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) {
        const double part = volume * share(box, 0, i) * share(box, 1, j) * quanta(i);
        const long column = (long(j) * cells[0] + i) * (1 + Dim);
        if (!(part > 0)) continue;
        Kokkos::atomic_add(&sums(column), static_cast<long>(part + 0.5));
        for (int d = 0; d < Dim; ++d) {
          const double flow = part * double(soil.velocity(p)[d]);
          Kokkos::atomic_add(&sums(column + 1 + d), static_cast<long>(Kokkos::floor(flow + 0.5)));
        }
      }
  }
};

}  // namespace

template <class Space, class T, int Dim>
std::vector<long> column_sums(const Core<Space, T, Dim>& s, const ColumnGrid& grid) {
  const std::vector<ColumnGrid> lists{grid};
  const Kokkos::View<long*, typename Space::memory_space> sums("mpm::column_sums", grid.count() * (1 + Dim));
  AddColumns<Space, T, Dim> add{positions_of(s), mask_of(s, lists), sums, {}, grid.cell, {}};
  for (int d = 0; d < 2; ++d) add.lower[d] = grid.lower[d], add.cells[d] = grid.cells[d];
  Kokkos::parallel_for("mpm::column_sums", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count), add);
  s.space.fence("mpm::column_sums");
  const auto host = mirror_of(sums);
  return {host.data(), host.data() + host.extent(0)};
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template std::vector<long> column_sums(const Core<Space, T, Dim>&, const ColumnGrid&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
