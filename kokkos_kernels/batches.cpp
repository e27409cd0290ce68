#include "batches.hpp"

#include <algorithm>
#include <array>

#include "download.hpp"
#include "particle_to_node.hpp"
#include "rebuild.hpp"
#include "step_kernels.hpp"

namespace mpm {
namespace {

constexpr int k_turns = 3;  // places that batches share: one copied in, one updated, one copied out
constexpr int k_most_places = 64;
/// Particles of a batch below which starting kernels and copies takes longer than they do.
template <class Space>
constexpr int k_worth = is_device<Space> ? 1 << 18 : 1 << 10;
constexpr long k_apart_every = 50, k_first_apart = 2;  // steps that are taken apart

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

/// Calls f(home, there, changes) for the fields that the update of the particles looks at.
template <class Home, class There, class F>
void for_each_of_step(Home& home, There& there, F&& f) {
  f(home.coordinate, there.coordinate, true), f(home.velocity, there.velocity, true);
  f(home.stress, there.stress, true), f(home.volume, there.volume, true);
  f(home.plastic_strain, there.plastic_strain, true);
  f(home.strength, there.strength, false), f(home.cell, there.cell, false);
  if (home.bodies.extent(0) > 1) f(home.body, there.body, false);
}

/// Lays a batch's place out; returns its bytes.
template <class Space, class T, int Dim>
std::size_t lay_out(const State<Space, T, Dim>& s, char* from, SoilBatch<Space, T, Dim>& batch) {
  Cutter cutter{from};
  for_each_of_step(s.soil.points, batch.set.points,
                   [&](const auto&, auto& there, bool) { cutter.cut(there, batch.first, batch.last); });
  Kokkos::View<T*, typename Space::memory_space> dilatation;
  if (s.f_bar_share > 0) cutter.cut(dilatation, batch.first, batch.last);
  batch.spare =
      decltype(batch.spare)(reinterpret_cast<char*>(dilatation.data()), dilatation.extent(0) * sizeof(T));
  return cutter.end;
}
template <class Space, class T, int Dim>
std::size_t bytes_of(const State<Space, T, Dim>& s, int particles) {
  SoilBatch<Space, T, Dim> batch;
  batch.last = particles;
  return lay_out(s, nullptr, batch);
}

template <class Space, class View>
void copy(const Space& space, const View& to, const View& from, int first, int last, double& bytes) {
  using Part = Kokkos::View<typename View::value_type*, typename View::memory_space, Kokkos::MemoryUnmanaged>;
  const std::size_t count = last - first;
  Kokkos::deep_copy(space, Part(to.data() + first, count), Part(from.data() + first, count));
  bytes += count * sizeof(typename View::value_type);
}

/// Copies a batch to the device; returns bytes.
template <class Space, class T, int Dim>
double copy_in(const Space& space, const State<Space, T, Dim>& s, const SoilBatch<Space, T, Dim>& batch) {
  double bytes = 0;
  for_each_of_step(s.soil.points, batch.set.points, [&](const auto& home, const auto& there, bool) {
    copy(space, there, home, batch.first, batch.last, bytes);
  });
  return bytes;
}
/// And back what a step changes.
template <class Space, class T, int Dim>
double copy_out(const Space& space, const State<Space, T, Dim>& s, const SoilBatch<Space, T, Dim>& batch) {
  double bytes = 0;
  for_each_of_step(s.soil.points, batch.set.points, [&](const auto& home, const auto& there, bool changes) {
    if (changes) copy(space, home, there, batch.first, batch.last, bytes);
  });
  return bytes;
}

template <class View>
auto on_host(const View& view, int count) {
  return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(),
                                             Kokkos::subview(view, Kokkos::make_pair(0, count)));
}

/// First particle of each slot, and behind the last.
template <class Space, class T, int Dim>
Kokkos::View<int*, Kokkos::HostSpace> first_of_slots(const State<Space, T, Dim>& s) {
  const int slots = s.patches.slots;
  const Kokkos::View<int*, typename Space::memory_space> first("mpm::first_of_slots", slots + 1);
  const auto begin = s.soil.bins.begin;
  Kokkos::parallel_for(
      "mpm::first_of_slots", Kokkos::RangePolicy<Space>(s.space, 0, slots + 1),
      KOKKOS_LAMBDA(int slot) { first(slot) = begin(slot * Patch<Dim>::cells); });
  s.space.fence("mpm::first_of_slots");
  return on_host(first, slots + 1);
}

/// Puts whole patches together as long as they have at most `most` particles.
template <class Space, class T, int Dim, class First>
void cut_into_batches(State<Space, T, Dim>& s, const First& first, int most) {
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

/// Bins::by_colour of every batch.
template <class Space, class T, int Dim>
void list_slots(State<Space, T, Dim>& s) {
  constexpr int colours = Patch<Dim>::colours;
  const auto& whole = s.soil.bins;
  auto& b = s.batches;
  const int count = whole.colour_begin[colours];
  ensure(b.slots, count);
  const auto by_colour = on_host(whole.by_colour, count);
  std::vector<std::array<std::vector<int>, colours>> lists(b.all.size());
  for (int colour = 0, n = 0; colour < colours; ++colour)
    for (std::size_t batch = 0; n < whole.colour_begin[colour + 1]; ++n) {  // slots rise within a colour
      while (by_colour(n) >= b.all[batch].set.bins.last_slot) ++batch;
      lists[batch][colour].push_back(by_colour(n));
    }
  const auto slots = Kokkos::create_mirror_view(b.slots);
  int end = 0;
  for (std::size_t n = 0; n < lists.size(); ++n) {
    Bins<Space>& bins = b.all[n].set.bins;
    const int begin = end;
    bins.begin = whole.begin;
    for (int colour = 0; colour < colours; ++colour) {
      for (const int slot : lists[n][colour]) slots(end++) = slot;
      bins.colour_begin[colour + 1] = end - begin;
    }
    bins.by_colour = Kokkos::subview(b.slots, Kokkos::make_pair(begin, end));
  }
  Kokkos::deep_copy(b.slots, slots);
}

/// Gives each batch its place. As many as can stay on the device.
template <class Space, class T, int Dim>
void give_places(State<Space, T, Dim>& s, std::size_t bytes_of_place) {
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

/// Whether a batch that was updated is summed to the nodes while it is there, where update_particles does not
/// do so itself. The threads of a processor sum colour by colour, and not batch by batch.
template <class Space>
constexpr bool sums_in_batches = backend_of<Space> != Backend::openmp;

/// The batch that s.soil now is, to the nodes.
template <class Space, class T, int Dim>
void sum_batch(const State<Space, T, Dim>& s) {
  using Source = SoilSource<Space, T, Dim>;
  const Source source{s.soil.points, s.grid.inv_spacing};
  particle_to_node(s.p2g.strategy, Interpolation<Source>{s.space, s.grid, s.patches, s.soil.bins, source,
                                                         s.nodes.soil, s.control, s.p2g.mosaic_cells});
}

template <class Space>
std::vector<Space> streams_beside(const Space& space) {
  if constexpr (is_device<Space>)
    return Kokkos::Experimental::partition_space(space, std::vector<int>(k_turns, 1));
  else
    return std::vector<Space>(k_turns, space);
}

}  // namespace

template <class Space, class T, int Dim>
void store_soil(State<Space, T, Dim>& s, int count, std::size_t spare_bytes) {
  auto& soil = s.soil.points;
  spare_bytes = std::max(spare_bytes, count * spare_of_point(soil));
  Cutter cutter;
  const auto cut = [&] {
    const auto field = [&](auto& view) { cutter.cut(view, 0, count); };
    field(soil.coordinate), field(soil.cell), field(soil.id), field(s.soil.address), field(s.soil.order);
    for_each_field(soil, field);
    cutter.cut(s.spare, 0, spare_bytes);
  };
  cut();
  s.batches.store =
      decltype(s.batches.store)(Kokkos::view_alloc("mpm::store", Kokkos::WithoutInitializing), cutter.end);
  cutter = {s.batches.store.data(), 0};
  cut();
}

template <class Space, class T, int Dim>
void plan_batches(State<Space, T, Dim>& s) {
  auto& b = s.batches;
  const auto first = first_of_slots(s);
  int largest = 1;  // particles of a patch
  for (int slot = 0; slot < s.patches.slots; ++slot)
    largest = std::max(largest, first(slot + 1) - first(slot));
  b.all.clear();
  b.loaded = false;
  ensure(b.slots, s.soil.bins.colour_begin[Patch<Dim>::colours]);
  const double beside = double(memory_of(s)) - b.room.extent(0),
               least = k_turns * double(bytes_of(s, largest));
  b.least = beside + least;
  if (b.limit < b.least) return;

  // What is beside the batches may grow a little without that they need other room.
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
  if (b.streams.empty()) b.streams = streams_beside(s.space);
}

template <class Space, class T, int Dim>
void update_by_batches(State<Space, T, Dim>& s, double dt) {
  auto& b = s.batches;
  if (look(s).paused) return;  // this also waits for the nodes
  BatchCost& cost = b.cost;
  const bool apart = cost.steps++ % k_apart_every == k_first_apart;
  const auto timed = [&](const Space& space, double& seconds, auto&& work) {
    const Kokkos::Timer timer;
    work();
    if (!apart) return;
    space.fence("mpm::part of a batch");
    seconds += timer.seconds();
  };
  const Kokkos::Timer timer;
  const bool sums = sums_in_batches<Space> && !sums_ahead(s);
  if (sums) {
    reset_nodes(s);
    s.space.fence("mpm::before the sums of batches");
  }
  const auto whole = s.soil;
  const auto spare = s.spare;
  const Space space = s.space;
  for (const auto& batch : b.all) {
    const Space& stream = batch.stays ? space : b.streams[batch.place % k_turns];
    timed(stream, cost.in_seconds, [&] {
      if (!batch.stays || !b.loaded) cost.copied_in += copy_in(stream, s, batch);
    });
    timed(stream, cost.kernel_seconds, [&] {
      s.soil = batch.set, s.spare = batch.spare, s.space = stream;
      update_particles(s, dt);
      if (sums) sum_batch(s);
      s.soil = whole, s.spare = spare, s.space = space;
    });
    timed(stream, cost.out_seconds, [&] {
      if (!batch.stays) cost.copied_out += copy_out(stream, s, batch);
    });
  }
  b.loaded = true;
  s.soil_summed = s.soil_summed || sums;
  for (const Space& stream : b.streams) stream.fence("mpm::update_by_batches");
  space.fence("mpm::update_by_batches");
  cost.apart += apart;
  if (!apart) cost.seconds += timer.seconds();
}

template <class Space, class T, int Dim>
void collect_soil(const State<Space, T, Dim>& s) {
  if (!s.batches.loaded) return;
  for (const auto& batch : s.batches.all)
    if (batch.stays) copy_out(s.space, s, batch);
  s.space.fence("mpm::collect_soil");
}

#define MPM_INSTANTIATE(Space, T, Dim)                               \
  template void store_soil(State<Space, T, Dim>&, int, std::size_t); \
  template void plan_batches(State<Space, T, Dim>&);                 \
  template void update_by_batches(State<Space, T, Dim>&, double);    \
  template void collect_soil(const State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
