#include "rebuild/migrate.hpp"

#include <algorithm>

#include "base/copy.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

/// Calls f(view, place in the record) for every view that a particle's record is made of.
template <class Space, class T, int Dim, class F>
std::size_t for_each_part(const Core<Space, T, Dim>& s, F&& f) {
  std::size_t size = 0;
  const auto part = [&](const auto& view) {
    using Value = std::remove_reference_t<decltype(view.data()[0])>;
    size = (size + alignof(Value) - 1) / alignof(Value) * alignof(Value);
    f(view, size);
    size += sizeof(Value);
  };
  auto points = s.soil.points;
  part(s.soil.address), part(points.id);
  for_each_field(points, part);
  constexpr std::size_t k_widest = 16;  // alignment of any field
  return (size + k_widest - 1) / k_widest * k_widest;
}

template <class Value, class Space>
using Unmanaged = Kokkos::View<Value*, typename Space::memory_space, Kokkos::MemoryUnmanaged>;

/// Room for n values and `more` bytes in the scratch memory of sorting, which keeps its size: to ask a device
/// for memory and give it back takes longer than all else that is done here.
template <class Value, class Space, class T, int Dim>
Unmanaged<Value, Space> scratch_of(Core<Space, T, Dim>& s, std::size_t n, std::size_t more = 0) {
  ensure(s.scratch, n * sizeof(Value) + more);
  return Unmanaged<Value, Space>(reinterpret_cast<Value*>(s.scratch.data()), n);
}

template <class Space, class View>
void pack_part(const Space& space, const View& view, std::size_t place, std::size_t size,
               const Unmanaged<int, Space>& which, const Unmanaged<char, Space>& records) {
  using Value = typename View::value_type;
  Kokkos::parallel_for(
      "mpm::pack_part", Kokkos::RangePolicy<Space>(space, 0, which.extent(0)),
      KOKKOS_LAMBDA(int n) { *reinterpret_cast<Value*>(&records(n * size + place)) = view(which(n)); });
}

template <class Space, class View>
void unpack_part(const Space& space, const View& view, std::size_t place, std::size_t size, int first,
                 int count, const Unmanaged<char, Space>& records) {
  using Value = typename View::value_type;
  Kokkos::parallel_for(
      "mpm::unpack_part", Kokkos::RangePolicy<Space>(space, 0, count), KOKKOS_LAMBDA(int n) {
        view(first + n) = *reinterpret_cast<const Value*>(&records(n * size + place));
      });
}

/// A view of at least n entries that keeps its first `kept` ones.
template <class View>
void grow(View& view, int n, int kept) {
  if (static_cast<int>(view.extent(0)) >= n) return;
  View larger(Kokkos::view_alloc(view.label(), Kokkos::WithoutInitializing), n + n / 8);
  const auto range = Kokkos::make_pair(0, kept);
  if (kept > 0) copy(Kokkos::subview(larger, range), Kokkos::subview(view, range));
  view = larger;
}

}  // namespace

template <class Space, class T, int Dim>
std::size_t record_size(const Core<Space, T, Dim>& s) {
  return for_each_part(s, [](const auto&, std::size_t) {});
}

template <class Space, class T, int Dim>
std::vector<Leaver> find_leavers(Core<Space, T, Dim>& s,
                                 const Kokkos::View<int*, typename Space::memory_space>& owner, int own) {
  using Range = Kokkos::RangePolicy<Space>;
  const auto address = s.soil.address;
  const long patches = s.grid.patches_of_field();
  const int count = s.soil.points.count;
  int found = 0;
  Kokkos::parallel_reduce(
      "mpm::count_leavers", Range(s.space, 0, count),
      KOKKOS_LAMBDA(int p, int& n) {
        n += address(p) >= 0 && owner(address(p) / Patch<Dim>::cells % patches) != own;
      },
      found);
  if (found == 0) return {};
  const Unmanaged<Leaver, Space> leavers = scratch_of<Leaver>(s, found);
  Kokkos::parallel_scan(
      "mpm::find_leavers", Range(s.space, 0, count), KOKKOS_LAMBDA(int p, int& n, bool last) {
        const int rank = address(p) >= 0 ? owner(address(p) / Patch<Dim>::cells % patches) : own;
        if (rank == own) return;
        if (last) leavers(n) = {p, rank};
        ++n;
      });
  const auto host = mirror_of(leavers);
  return {host.data(), host.data() + found};
}

template <class Space, class T, int Dim>
std::vector<char> take_particles(Core<Space, T, Dim>& s, const std::vector<int>& particles) {
  const int count = static_cast<int>(particles.size());
  if (count == 0) return {};
  const std::size_t size = record_size(s);  // a multiple of any alignment
  const Unmanaged<char, Space> records = scratch_of<char>(s, count * size, count * sizeof(int));
  const Unmanaged<int, Space> which(reinterpret_cast<int*>(records.data() + count * size), count);
  copy(which, Kokkos::View<const int*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(particles.data(), count));
  for_each_part(
      s, [&](const auto& view, std::size_t place) { pack_part(s.space, view, place, size, which, records); });
  const auto address = s.soil.address;
  Kokkos::parallel_for(
      "mpm::forget_leavers", Kokkos::RangePolicy<Space>(s.space, 0, count),
      KOKKOS_LAMBDA(int n) { address(which(n)) = -1; });
  s.space.fence("mpm::take_particles");
  const auto host = mirror_of(records);
  return {host.data(), host.data() + host.extent(0)};
}

template <class Space, class T, int Dim>
void add_particles(Core<Space, T, Dim>& s, const std::vector<char>& records) {
  const std::size_t size = record_size(s);
  const int count = static_cast<int>(records.size() / size);
  if (count == 0) return;
  const int first = s.soil.points.all;
  reserve_particles(s, first + count);
  const Unmanaged<char, Space> here = scratch_of<char>(s, records.size());
  copy(here,
       Kokkos::View<const char*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(records.data(), records.size()));
  for_each_part(s, [&](const auto& view, std::size_t place) {
    unpack_part(s.space, view, place, size, first, count, here);
  });
  s.soil.points.all = first + count;
  s.space.fence("mpm::add_particles");
}

template <class Space, class T, int Dim>
void reserve_particles(Core<Space, T, Dim>& s, int n) {
  auto& points = s.soil.points;
  const int kept = points.all;
  s.space.fence("mpm::reserve_particles");
  grow(points.cell, n, kept), grow(points.id, n, kept), grow(s.soil.address, n, kept);
  for_each_field(points, [&](auto& field) { grow(field, n, kept); });
}

template <class Space, class T, int Dim>
std::vector<int> count_by_patch(const Core<Space, T, Dim>& s) {
  const long patches = s.grid.patches_of_field();
  const Kokkos::View<int*, typename Space::memory_space> counts("mpm::count_by_patch", patches);
  const auto address = s.soil.address;
  Kokkos::parallel_for(
      "mpm::count_by_patch", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.all), KOKKOS_LAMBDA(int p) {
        if (address(p) >= 0) Kokkos::atomic_inc(&counts(address(p) / Patch<Dim>::cells % patches));
      });
  s.space.fence("mpm::count_by_patch");
  const auto host = mirror_of(counts);
  return {host.data(), host.data() + host.extent(0)};
}

template <class Space, class T, int Dim>
std::vector<std::uint8_t> occupied_by_field(const Core<Space, T, Dim>& s) {
  const Kokkos::View<int*, typename Space::memory_space> marks("mpm::occupied_by_field",
                                                               s.grid.patch_count());
  const auto address = s.soil.address;
  Kokkos::parallel_for(
      "mpm::occupied_by_field", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.all),
      KOKKOS_LAMBDA(int p) {
        if (address(p) >= 0) Kokkos::atomic_store(&marks(address(p) / Patch<Dim>::cells), 1);
      });
  s.space.fence("mpm::occupied_by_field");
  const auto host = mirror_of(marks);
  return {host.data(), host.data() + host.extent(0)};
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                     \
  template std::size_t record_size(const Core<Space, T, Dim>&);                                            \
  template std::vector<Leaver> find_leavers(Core<Space, T, Dim>&,                                          \
                                            const Kokkos::View<int*, typename Space::memory_space>&, int); \
  template std::vector<char> take_particles(Core<Space, T, Dim>&, const std::vector<int>&);                \
  template void add_particles(Core<Space, T, Dim>&, const std::vector<char>&);                             \
  template void reserve_particles(Core<Space, T, Dim>&, int);                                              \
  template std::vector<int> count_by_patch(const Core<Space, T, Dim>&);                                    \
  template std::vector<std::uint8_t> occupied_by_field(const Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
