// The order of the points: by slot, by cell in it, by id in the cell. A counting sort, then each cell's few
// points are put in order of id, so that the result does not depend on how threads ran.

#include "base/copy.hpp"
#include "physics/cell_mean.hpp"
#include "physics/materials/any.hpp"
#include "physics/p2g_terms.hpp"
#include "physics/surface.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

/// Bins behind those of the cells, for points of patches without a mark. They are many, so that threads do
/// not wait for one another, and a patch has one, so that its points stay about together.
constexpr int k_rest_bins = 1024;

/// Numbers of points by bin become the first point of each, and of the one behind the last. A thread takes
/// `together` bins at a time, of which there is a multiple.
template <class Space, class Begin>
void begin_of_bins(const Space& space, const Begin& begin, int bins, int together) {
  const int groups = bins / together;
  Kokkos::parallel_scan(
      "mpm::begin_of_bins", Kokkos::RangePolicy<Space>(space, 0, groups),
      KOKKOS_LAMBDA(int group, int& sum, bool last) {
        for (int c = group * together; c < (group + 1) * together; ++c) {
          const int n = begin(c);
          if (last) begin(c) = sum;
          sum += n;
        }
        if (last && group == groups - 1) begin(bins) = sum;
      });
}

/// Cells of the points under the new patch table, counted and summed to ranges. Points of patches without a
/// mark have none: they go behind the others.
template <class Space, class Points_, class Slots>
void count_by_cell(const Space& space, ParticleSet<Space, Points_>& set, const Slots& slot_of,
                   const Slots& marks, int cells, int cells_per_patch) {
  using Range = Kokkos::RangePolicy<Space>;
  const int bins = cells + k_rest_bins;
  ensure(set.bins.begin, bins + 1);
  ensure(set.order, set.points.all);
  const auto begin = set.bins.begin, order = set.order;
  const auto cell = set.points.cell;
  const auto address = set.address;
  Kokkos::parallel_for(
      "mpm::clear_bins", Range(space, 0, bins + 1), KOKKOS_LAMBDA(int c) { begin(c) = 0; });
  Kokkos::parallel_for(
      "mpm::count_by_cell", Range(space, 0, set.points.all), KOKKOS_LAMBDA(int p) {
        const long patch = address(p) / cells_per_patch;
        const bool held = address(p) >= 0 && marks(patch) != 0;
        const int c = held ? slot_of(patch) * cells_per_patch + static_cast<int>(address(p) % cells_per_patch)
                           : cells + static_cast<int>((address(p) < 0 ? p : patch) % k_rest_bins);
        cell(p) = c;
        order(p) = Kokkos::atomic_fetch_add(&begin(c), 1);  // place in the cell, for now
      });
  begin_of_bins(space, begin, bins, cells_per_patch);
}

/// set.order becomes the former place of each point of the new order, and the points' cells are in it.
/// `scratch` is scratch.
template <class Space, class Points_, class ScratchView>
void order_points(const Space& space, ParticleSet<Space, Points_>& set, const ScratchView& scratch,
                  int cells) {
  using Range = Kokkos::RangePolicy<Space>;
  const int count = set.points.all;
  const auto begin = set.bins.begin, order = set.order;
  const auto cell = set.points.cell, id = set.points.id;
  Kokkos::View<int*, typename Space::memory_space, Kokkos::MemoryUnmanaged> former(
      reinterpret_cast<int*>(scratch.data()), count);
  Kokkos::parallel_for(
      "mpm::place_points", Range(space, 0, count),
      KOKKOS_LAMBDA(int p) { former(begin(cell(p)) + order(p)) = p; });
  Kokkos::parallel_for(
      "mpm::order_in_cell", Range(space, 0, cells), KOKKOS_LAMBDA(int c) {
        for (int n = begin(c) + 1; n < begin(c + 1); ++n) {
          const int p = former(n);
          int m = n;
          for (; m > begin(c) && id(former(m - 1)) > id(p); --m) former(m) = former(m - 1);
          former(m) = p;
        }
        for (int n = begin(c); n < begin(c + 1); ++n) cell(n) = c;
      });
  Kokkos::parallel_for(
      "mpm::keep_order", Range(space, 0, count), KOKKOS_LAMBDA(int p) { order(p) = former(p); });
}

/// Puts one field into the new order, piece by piece of its values.
template <class Space, class Field, class Order, class ScratchView>
void permute(const Space& space, const Field& field, const Order& order, int count,
             const ScratchView& scratch) {
  using Range = Kokkos::RangePolicy<Space>;
  using Value = typename Field::value_type;
  using Part = PartOf<Value>;
  constexpr int parts = sizeof(Value) / sizeof(Part);  // NOLINT(bugprone-sizeof-expression): may be 1
  Part* const sorted = reinterpret_cast<Part*>(scratch.data());
  Part* const whole = reinterpret_cast<Part*>(field.data());
  for (int k = 0; k < parts; ++k) {
    Kokkos::parallel_for(
        "mpm::permute", Range(space, 0, count),
        KOKKOS_LAMBDA(int p) { sorted[p] = whole[std::size_t(order(p)) * parts + k]; });
    Kokkos::parallel_for(
        "mpm::permute_back", Range(space, 0, count),
        KOKKOS_LAMBDA(int p) { whole[std::size_t(p) * parts + k] = sorted[p]; });
  }
}

/// Whether a field is the same for all points, so that no order changes it.
template <class Space, class T, int Dim>
bool is_uniform(const Soil<Space, T, Dim>& soil, const void* field) {
  return field == soil.body.data() && soil.bodies.extent(0) == 1;
}
template <class Space, class T, int Dim>
bool is_uniform(const RigidPoints<Space, T, Dim>&, const void*) {
  return false;
}

template <class Space, class Points_, class Order, class ScratchView>
void permute_fields(const Space& space, Points_& points, const Order& order, const ScratchView& scratch) {
  const auto field = [&](const auto& view) { permute(space, view, order, points.all, scratch); };
  field(points.id);
  for_each_field(points, [&](const auto& view) {
    if (!is_uniform(points, view.data())) field(view);
  });
}
/// Points that live in memory of the host are moved there by its own threads: a device would read and write
/// it in pieces.
template <class Space, class Points_, class ScratchView>
void permute_fields(const Space& space, ParticleSet<Space, Points_>& set, const ScratchView& scratch) {
  if constexpr (is_device<Space>) {
    const bool at_host = set.order.use_count() == 0;  // memory of Batches::store
    if (at_host) {
      const Kokkos::DefaultHostExecutionSpace threads;
      const Kokkos::View<int*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> order(set.order.data(),
                                                                                 set.order.extent(0));
      space.fence("mpm::before the host's threads");
      permute_fields(threads, set.points, order, scratch);
      return threads.fence("mpm::permute_fields");
    }
  }
  permute_fields(space, set.points, set.order, scratch);
}

/// Slots that hold points, and the number of points with a slot.
template <class Space, class Points_, int Dim>
void list_held(const Space& space, ParticleSet<Space, Points_>& set, const Patches<Space, Dim>& patches) {
  constexpr int cells = Patch<Dim>::cells;
  const int slots = patches.slots;
  ensure(set.bins.active_slots, slots);
  const auto active_slots = set.bins.active_slots, begin = set.bins.begin;
  // The scan, for whose result the host waits, is behind this copy on the stream.
  copy(space, Kokkos::View<int, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(&set.points.count),
       Kokkos::subview(begin, slots * cells));
  int held = 0;
  Kokkos::parallel_scan(
      "mpm::list_held", Kokkos::RangePolicy<Space>(space, 0, slots),
      KOKKOS_LAMBDA(int slot, int& before, bool last) {
        if (begin(slot * cells) == begin((slot + 1) * cells)) return;
        if (last) active_slots(before) = slot;
        ++before;
      },
      held);
  set.bins.first_slot = 0, set.bins.last_slot = slots;
  set.bins.first_active = 0, set.bins.last_active = held;
}

template <class Space, class Points_, int Dim, class ScratchView>
void sort_set(const Space& space, ParticleSet<Space, Points_>& set, const Patches<Space, Dim>& patches,
              const Kokkos::View<int*, typename Space::memory_space>& marks, ScratchView& scratch) {
  const int cells = patches.node_count();
  ensure(scratch, scratch_of_point(set.points) * set.points.all);
  count_by_cell(space, set, patches.slot_of, marks, cells, Patch<Dim>::cells);
  order_points(space, set, scratch, cells);
  permute_fields(space, set, scratch);
  list_held(space, set, patches);
}

}  // namespace

template <class Space, class T, int Dim>
void sort_points(ContactCore<Space, T, Dim>& s) {
  sort_set(s.space, s.soil, s.patches, s.marks, s.scratch);
  s.soil.points.all = s.soil.points.count;  // what is left belongs to other ranks now
  if (s.contact.near.listed) return;        // what is near them is found by their surfaces
  for (auto& set : s.rigid_points) sort_set(s.space, set, s.patches, s.marks, s.scratch);
}

/// Takes from the pressure of each of the particles [first, last) of a cell this fraction of what it differs
/// from their mean.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION void average_pressure_of(const Soil<Space, T, Dim>& soil, int first, int last,
                                                T fraction) {
  CellMean<T> mean;
  for (int p = first; p < last; ++p) mean.add(soil.volume(p), soil.volume(p) * mean_of(soil.stress(p)));
  for (int p = first; p < last; ++p) {
    const T change = fraction * (mean.value() - mean_of(soil.stress(p)));
    for (int d = 0; d < 3; ++d) soil.stress(p)[d] += change;
  }
}
/// Averages the excess pore pressure of the particles that have one. With it and the stress, the effective
/// stress is averaged too.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION void average_pore_pressure_of(const Soil<Space, T, Dim>& soil, int first, int last,
                                                     T fraction) {
  const auto& excess = soil.history.column[soil.history.pore];
  const auto has = [&](int p) {
    return material_in(soil.materials(soil.material_of(p))).has_pore_pressure();
  };
  T volume = 0, sum = 0;
  for (int p = first; p < last; ++p)
    if (has(p)) volume += soil.volume(p), sum += soil.volume(p) * excess(p);
  for (int p = first; p < last; ++p)
    if (has(p)) excess(p) += fraction * (sum / volume - excess(p));
}

/// Both, of a cell whose particles differ in material: each material has means and a share of F-bar of its
/// own. most: the run's fraction of F-bar.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION void average_mixed_cell(const Soil<Space, T, Dim>& soil, int first, int last, T most) {
  const auto fraction_of = [&](int p) { return most * soil.materials(soil.material_of(p)).f_bar_share; };
  average_by_material(
      soil, first, last, [&](int p) { return soil.volume(p) * mean_of(soil.stress(p)); },
      [&](int p, T mean) {
        const T change = fraction_of(p) * (mean - mean_of(soil.stress(p)));
        for (int d = 0; d < 3; ++d) soil.stress(p)[d] += change;
      });
  if (soil.history.pore < 0) return;
  const auto& excess = soil.history.column[soil.history.pore];  // 0 where a material drains
  average_by_material(
      soil, first, last, [&](int p) { return soil.volume(p) * excess(p); },
      [&](int p, T mean) { excess(p) += fraction_of(p) * (mean - excess(p)); });
}

template <class Space, class T, int Dim>
void average_pressure(ContactCore<Space, T, Dim>& s) {
  const auto soil = s.soil.points;
  const auto begin = s.soil.bins.begin;
  const T fraction = static_cast<T>(s.f_bar.fraction);
  const bool by_material = s.f_bar.by_material;
  Kokkos::parallel_for(
      "mpm::average_pressure", Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()),
      KOKKOS_LAMBDA(int cell) {
        const int first = begin(cell), last = begin(cell + 1);
        T of_cell = fraction;
        for (int p = first; by_material && p < last; ++p) {
          if (soil.material_of(p) != soil.material_of(first))
            return average_mixed_cell(soil, first, last, fraction);
          of_cell = fraction * soil.materials(soil.material_of(p)).f_bar_share;
        }
        average_pressure_of(soil, first, last, of_cell);
        if (soil.history.pore >= 0) average_pore_pressure_of(soil, first, last, of_cell);
      });
}

#define MPM_INSTANTIATE(Space, T, Dim)                    \
  template void sort_points(ContactCore<Space, T, Dim>&); \
  template void average_pressure(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
