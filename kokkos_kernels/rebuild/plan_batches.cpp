// Where the soil lives, and how it is cut into batches.

#include <algorithm>
#include <array>

#include "base/copy.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

constexpr int k_most_places = 64;
/// Particles of a batch below which starting kernels and copies takes longer than they do.
template <class Space>
constexpr int k_worth = is_device<Space> ? 1 << 18 : 1 << 10;

/// Cuts memory into arrays; without memory it only counts.
struct Cutter {
  char* from = nullptr;
  std::size_t end = 0;  // bytes

  /// An array of the entries [first, last), numbered so.
  template <class View>
  void cut(View& view, std::size_t first, std::size_t last) {
    using Value = typename View::value_type;
    constexpr std::size_t k_line = 256;
    if (from) view = View(reinterpret_cast<Value*>(from + end) - first, last);
    end += ((last - first) * sizeof(Value) + k_line - 1) / k_line * k_line;
  }
};

/// Lays a batch's place out; returns its bytes.
template <class Space, class T, int Dim>
std::size_t lay_out(const Core<Space, T, Dim>& s, char* from, SoilBatch<Space, T, Dim>& batch) {
  Cutter cutter{from};
  for_each_of_step(s.soil.points, batch.set.points,
                   [&](const auto&, auto& there, Use) { cutter.cut(there, batch.first, batch.last); });
  Kokkos::View<T*, typename Space::memory_space> dilatation;
  if (s.f_bar.fraction > 0) cutter.cut(dilatation, batch.first, batch.last);
  batch.scratch =
      decltype(batch.scratch)(reinterpret_cast<char*>(dilatation.data()), dilatation.extent(0) * sizeof(T));
  return cutter.end;
}
template <class Space, class T, int Dim>
std::size_t bytes_of(const Core<Space, T, Dim>& s, int particles) {
  SoilBatch<Space, T, Dim> batch;
  batch.last = particles;
  return lay_out(s, nullptr, batch);
}

/// First particle of each slot, and behind the last.
template <class Space, class T, int Dim>
Kokkos::View<int*, Kokkos::HostSpace> first_of_slots(const Core<Space, T, Dim>& s) {
  const int slots = s.patches.slots;
  const Kokkos::View<int*, typename Space::memory_space> first("mpm::first_of_slots", slots + 1);
  const auto begin = s.soil.bins.begin;
  Kokkos::parallel_for(
      "mpm::first_of_slots", Kokkos::RangePolicy<Space>(s.space, 0, slots + 1),
      KOKKOS_LAMBDA(int slot) { first(slot) = begin(slot * Patch<Dim>::cells); });
  s.space.fence("mpm::first_of_slots");
  return mirror_of(first, slots + 1);
}

/// Puts whole patches together as long as they have at most `most` particles.
template <class Space, class T, int Dim, class First>
void cut_into_batches(Core<Space, T, Dim>& s, const First& first, int most) {
  auto& all = s.batches.all;
  const int slots = s.patches.slots;
  all.clear();
  for (int slot = 0; slot < slots; ++slot) {
    if (first(slot) == first(slot + 1)) continue;
    if (all.empty() || first(slot + 1) - all.back().first > most) {
      SoilBatch<Space, T, Dim>& batch = all.emplace_back();
      batch.first = first(slot);
      batch.set.bins.first_slot = slot;
    }
    all.back().last = first(slot + 1);
    all.back().set.bins.last_slot = slot + 1;
  }
}

/// Bins::active_slots of every batch.
template <class Space, class T, int Dim>
void list_slots(Core<Space, T, Dim>& s) {
  const auto& whole = s.soil.bins;
  auto& b = s.batches;
  ensure(b.slots, whole.last_active);
  const auto slots = mirror_of(whole.active_slots, whole.last_active);
  int end = 0;
  for (SoilBatch<Space, T, Dim>& batch : b.all) {
    Bins<Space>& bins = batch.set.bins;
    const int begin = end;
    while (end < whole.last_active && slots(end) < bins.last_slot) ++end;
    bins.begin = whole.begin, bins.windows = whole.windows;
    bins.first_active = 0, bins.last_active = end - begin;
    bins.active_slots = Kokkos::subview(b.slots, Kokkos::make_pair(begin, end));
  }
  const auto all = Kokkos::make_pair(0, end);
  copy(Kokkos::subview(b.slots, all), Kokkos::subview(whole.active_slots, all));
}

/// Gives each batch its place. As many as can stay on the device.
template <class Space, class T, int Dim>
void give_places(Core<Space, T, Dim>& s, std::size_t bytes_of_place) {
  auto& b = s.batches;
  const int stay = static_cast<int>(b.all.size()) <= b.places ? b.places : b.places - k_turns;
  for (int n = 0; n < static_cast<int>(b.all.size()); ++n) {
    SoilBatch<Space, T, Dim>& batch = b.all[n];
    batch.stays = n < stay;
    batch.place = batch.stays ? n : stay + (n - stay) % k_turns;
    batch.set.points = s.soil.points;  // what is not copied stays at home
    batch.set.points.count = batch.last;
    lay_out(s, b.room.data() + batch.place * bytes_of_place, batch);
  }
}

template <class Space>
std::vector<Space> overlap_streams(const Space& space) {
  if constexpr (is_device<Space>)
    return Kokkos::Experimental::partition_space(space, std::vector<int>(k_turns, 1));
  else
    return std::vector<Space>(k_turns, space);
}

}  // namespace

template <class Space, class T, int Dim>
void store_soil(Core<Space, T, Dim>& s, int count, std::size_t needed_scratch) {
  auto& soil = s.soil.points;
  needed_scratch = std::max(needed_scratch, count * scratch_of_point(soil));
  Cutter cutter;
  const auto cut = [&] {
    const auto field = [&](auto& view) { cutter.cut(view, 0, count); };
    field(soil.cell), field(soil.id), field(s.soil.address), field(s.soil.order);
    for_each_field(soil, field);
    cutter.cut(s.scratch, 0, needed_scratch);
  };
  cut();
  s.batches.store =
      decltype(s.batches.store)(Kokkos::view_alloc("mpm::store", Kokkos::WithoutInitializing), cutter.end);
  cutter = {s.batches.store.data(), 0};
  cut();
}

template <class Space, class T, int Dim>
void drop_batches(Core<Space, T, Dim>& s) {
  s.batches.all.clear();
  s.batches.loaded = false;
  ensure(s.batches.slots, s.soil.bins.last_active);
}

template <class Space, class T, int Dim>
void plan_batches(Core<Space, T, Dim>& s, std::size_t held) {
  auto& b = s.batches;
  const auto first = first_of_slots(s);
  int largest = 1;  // particles of a patch
  for (int slot = 0; slot < s.patches.slots; ++slot)
    largest = std::max(largest, first(slot + 1) - first(slot));
  const double beside = double(held) - b.room.extent(0), least = k_turns * double(bytes_of(s, largest));
  b.least = beside + least;
  if (b.limit < b.least) return;

  // Data beside the batches may grow a little before the batches need other room.
  const double free = std::max(least, b.limit - beside * 17 / 16);
  const double a_particle = bytes_of(s, 1 << 20) / double(1 << 20);
  b.places = static_cast<int>(std::clamp(free / a_particle / std::max(largest, k_worth<Space>),
                                         double(k_turns), double(k_most_places)));
  int most = static_cast<int>(std::min(free / b.places / a_particle, double(s.soil.points.count)));
  most = std::max(most, largest);
  while (most > largest && b.places * double(bytes_of(s, most)) > free) most -= std::max(1, most / 1000);
  cut_into_batches(s, first, most);
  b.places = std::min(b.places, static_cast<int>(b.all.size()));
  const std::size_t place = bytes_of(s, most), room = place * b.places;
  if (b.room.extent(0) < room || beside + b.room.extent(0) > b.limit) {
    b.room = {};  // the old one goes before the new one comes
    b.room = decltype(b.room)(Kokkos::view_alloc("mpm::room", Kokkos::WithoutInitializing), room);
  }
  list_slots(s);
  give_places(s, place);
  if (b.streams.empty()) b.streams = overlap_streams(s.space);
}

#define MPM_INSTANTIATE(Space, T, Dim)                              \
  template void store_soil(Core<Space, T, Dim>&, int, std::size_t); \
  template void drop_batches(Core<Space, T, Dim>&);                 \
  template void plan_batches(Core<Space, T, Dim>&, std::size_t);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
