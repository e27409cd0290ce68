// Where the points are, and which patches are active.

#include <algorithm>
#include <numeric>
#include <vector>

#include "base/copy.hpp"
#include "physics/ring_domain.hpp"
#include "physics/walls.hpp"
#include "rebuild/batches.hpp"
#include "rebuild/limit_volumes.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

/// Number in the whole grid of the k-th patch round the one of a field with lower cell `at`, -1 where there
/// is none. Round one at a periodic side are those at the opposite one.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION long patch_around(const Grid<T, Dim>& grid, Coord<Dim> at, int field, int k) {
  for (int d = 0; d < Dim; ++d, k /= 3) {
    at[d] = grid.in_period(d, at[d] + (k % 3 - 1) * Patch<Dim>::edge);
    const int patch = (at[d] >> Patch<Dim>::log_edge) + 1;
    if (patch < 0 || patch >= grid.patches[d]) return -1;
  }
  return grid.patch_of(at, field);
}

/// Whether a patch lies beyond a periodic side, where another one stands for it.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool is_beyond_period(const Grid<T, Dim>& grid, const Coord<Dim>& at) {
  bool beyond = false;
  for (int d = 0; d < Dim; ++d) beyond |= grid.in_period(d, at[d]) != at[d];
  return beyond;
}

/// The directions, that with the fewest patches first.
template <class T, int Dim>
Coord<Dim> shortest_first(const Grid<T, Dim>& grid) {
  Coord<Dim> turn;
  std::iota(turn.c, turn.c + Dim, 0);
  std::stable_sort(turn.c, turn.c + Dim, [&](int a, int b) { return grid.patches[a] < grid.patches[b]; });
  return turn;
}
/// Lower cell of the n-th patch of a field, where directions take turns: so the patches round one are near it
/// in memory too.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Coord<Dim> origin_in_turn(const Grid<T, Dim>& grid, const Coord<Dim>& turn, long n) {
  Coord<Dim> c{};
  for (int k = 0; k < Dim; ++k) {
    c[turn[k]] = (static_cast<int>(n % grid.patches[turn[k]]) - 1) * Patch<Dim>::edge;
    n /= grid.patches[turn[k]];
  }
  return c;
}

constexpr int k_soil = 1, k_rigid = 2;  // what a patch is marked to hold

/// Patch of point p, -1 where it has none or the point before lies in the same patch: most do, for they are
/// in the order of the last rebuild, and one of them is enough to mark it.
template <int Dim>
KOKKOS_INLINE_FUNCTION long patch_if_first(const long* address, int p) {
  if (address[p] < 0) return -1;
  const long own = address[p] / Patch<Dim>::cells;
  return p > 0 && address[p - 1] >= 0 && address[p - 1] / Patch<Dim>::cells == own ? -1 : own;
}

/// Marks the patches that hold soil of this rank.
template <class Space, class T, int Dim, class Marks>
void mark_soil(const ContactCore<Space, T, Dim>& s, const Marks& marks) {
  const auto address = s.soil.address;
  Kokkos::parallel_for(
      "mpm::mark_soil", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.all), KOKKOS_LAMBDA(int p) {
        const long own = patch_if_first<Dim>(address.data(), p);
        if (own >= 0) Kokkos::atomic_store(&marks(own), k_soil);
      });
}

/// Marks the patches that this rank has for fields which meet its soil.
template <class Space, class T, int Dim, class Marks>
void mark_borrowed(const ContactCore<Space, T, Dim>& s, const Marks& marks) {
  const auto borrowed = s.interfaces.borrowed;
  Kokkos::parallel_for(
      "mpm::mark_borrowed", Kokkos::RangePolicy<Space>(s.space, 0, borrowed.extent(0)),
      KOKKOS_LAMBDA(int n) { marks(borrowed(n)) = k_soil; });
}

/// Points of all rigid bodies in one row, so that one launch takes them: of many bodies each would wait
/// longer for a launch of its own than for its work. Few bodies go with the kernel, so that rebuilds allocate
/// no memory for them.
template <class Space, class T, int Dim>
struct AllRigidPoints {
  struct Body {
    const Vector<double, Dim>* reference_position;
    Vector<T, Dim>* coordinate;
    long *address, first;  // first: of its points in the row
  };
  struct Point {
    int body, p;  // p: its number among those of the body
  };
  static constexpr int k_few = 16;
  Body few[k_few] = {};
  Kokkos::View<Body*, typename Space::memory_space> many;  // empty where they are few
  int count;
  long all = 0;

  explicit AllRigidPoints(const ContactCore<Space, T, Dim>& s)
      : count(static_cast<int>(s.rigid_points.size())) {
    std::vector<Body> bodies;
    for (const auto& set : s.rigid_points) {
      bodies.push_back(
          {set.points.reference_position.data(), set.points.coordinate.data(), set.address.data(), all});
      all += set.points.all;
    }
    std::copy_n(bodies.begin(), std::min(count, k_few), few);
    if (count <= k_few) return;
    many = decltype(many)(Kokkos::view_alloc("mpm::all_rigid_points", Kokkos::WithoutInitializing), count);
    const auto host = Kokkos::create_mirror_view(many);
    std::copy(bodies.begin(), bodies.end(), host.data());
    copy(many, host);
  }
  KOKKOS_INLINE_FUNCTION const Body& body(int r) const { return count <= k_few ? few[r] : many(r); }
  KOKKOS_INLINE_FUNCTION Point at(long n) const {
    int low = 0, high = count;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (body(middle).first <= n ? low : high) = middle;
    }
    return {low, static_cast<int>(n - body(low).first)};
  }
  auto range(const Space& space) const {
    return Kokkos::RangePolicy<Space, Kokkos::IndexType<long>>(space, 0, all);
  }
};

/// Marks the patches of the first velocity field that hold points of a rigid and lie at those of the soil: no
/// other point of it reaches a node that soil reaches before the next rebuild. Contact in the other fields
/// asks the rigid's surface alone.
template <class Space, class T, int Dim, class Marks>
void mark_rigids(const ContactCore<Space, T, Dim>& s, const Marks& marks) {
  const AllRigidPoints<Space, T, Dim> points(s);
  const auto grid = s.grid;
  Kokkos::parallel_for(
      "mpm::mark_rigids", points.range(s.space), KOKKOS_LAMBDA(long n) {
        const auto [r, p] = points.at(n);
        const long own = patch_if_first<Dim>(points.body(r).address, p);
        if (own < 0 || Kokkos::atomic_load(&marks(own)) != 0) return;
        const Coord<Dim> at = grid.origin_of(own);
        for (int k = 0; k < Patch<Dim>::neighbours; ++k) {
          const long other = patch_around(grid, at, 0, k);
          if (other < 0 || Kokkos::atomic_load(&marks(other)) != k_soil) continue;
          Kokkos::atomic_store(&marks(own), k_rigid);
          return;
        }
      });
}

}  // namespace

template <class Space, class T, int Dim>
void locate_rigids(ContactCore<Space, T, Dim>& s) {
  const auto grid = s.grid;
  const auto control = s.control;
  const double spacing = s.spacing;
  const auto rigids = s.rigids;
  const AllRigidPoints<Space, T, Dim> points(s);
  Kokkos::parallel_for(
      "mpm::locate_rigids", points.range(s.space), KOKKOS_LAMBDA(long n) {
        const auto [r, p] = points.at(n);
        const auto& body = points.body(r);
        Coord<Dim> c{};
        double position[3] = {};
        if (p == 0) rigids(r).binned = rigids(r).motion.pose;
        const auto x = rigids(r).motion.pose.in_cells(spacing).to_world(body.reference_position[p]);
        for (int d = 0; d < Dim; ++d) {
          c[d] = static_cast<int>(Kokkos::floor(x[d]));
          body.coordinate[p][d] = static_cast<T>(x[d] - Kokkos::floor(x[d]));
          position[d] = x[d] * spacing;
          if (grid.period[d] > 0) c[d] = grid.in_period(d, c[d] % grid.period[d]);
        }
        if (!grid.holds(c)) return report(control, FaultKind::outside, -1 - r, position, Dim);
        body.address[p] = grid.address_of(c);
      });
}

template <class Space, class T, int Dim>
void locate(ContactCore<Space, T, Dim>& s) {
  collect_soil(s);
  const auto grid = s.grid;
  const auto origin = s.patches.origin;
  const auto number = s.patches.number;
  const auto control = s.control;
  const auto soil = s.soil.points;
  const auto address = s.soil.address;
  const auto alone = s.strays.alone;
  const auto put_back = s.strays.put_back;
  const bool removes = s.strays.rule == StrayRule::remove;
  const double spacing = s.spacing;
  const T least = static_cast<T>(s.strays.least_volume), most = static_cast<T>(s.strays.most_volume);
  const auto start_volume = s.strays.start_volume;
  Kokkos::parallel_for(
      "mpm::locate_soil", Kokkos::RangePolicy<Space>(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
        const int cell = soil.cell(p);
        Coord<Dim> c = coord_of<Dim>(cell);
        const Coord<Dim> from = origin(cell / Patch<Dim>::cells);
        Vector<T, Dim> x = soil.coordinate(p);
        if (put_on_walls(grid, in_mesh(from, c), x, soil.velocity(p)))
          Kokkos::atomic_inc(&put_back(soil.body(p)));
        for (int d = 0; d < Dim; ++d) {
          const T whole = Kokkos::floor(x[d]);
          c[d] += from[d] + static_cast<int>(whole);
          x[d] -= whole;
          if (x[d] >= 1) x[d] = 0, ++c[d];  // -tiny + 1 rounds to 1
          const int passed = c[d] - grid.in_period(d, c[d]);
          if (passed == 0) continue;
          soil.periods(p)[d] += passed > 0 ? 1 : -1;
          c[d] -= passed;
        }
        bool leaves = removes && (is_alone(alone, cell) ||
                                  is_volume_at_bound({least, most}, own_volume_bounds(start_volume, soil, p),
                                                     soil, p, T(spacing)));
        leaves = leaves || !grid.holds(c);
        soil.coordinate(p) = x;
        address(p) = leaves ? -1 : grid.address_of(c, grid.field_of(number(cell / Patch<Dim>::cells)));
        if (leaves) Kokkos::atomic_inc(&control().lost);
      });
  locate_rigids(s);
}

template <class Space, class T, int Dim>
void activate_patches(ContactCore<Space, T, Dim>& s) {
  using Range = Kokkos::RangePolicy<Space>;
  const auto grid = s.grid;
  const int patch_count = static_cast<int>(grid.patch_count());
  auto& patches = s.patches;
  ensure(s.marks, patch_count);
  ensure(patches.slot_of, patch_count);
  const auto marks = s.marks;
  const auto slot_of = patches.slot_of;
  Kokkos::deep_copy(s.space, marks, 0);
  mark_soil(s, marks);
  if (s.interfaces.borrowed.extent(0) > 0) mark_borrowed(s, marks);
  mark_rigids(s, marks);

  const Coord<Dim> turn = patches.turn = shortest_first(grid);
  patches.wraps = grid.is_periodic();
  Kokkos::parallel_scan(
      "mpm::number_patches", Range(s.space, 0, patch_count),
      KOKKOS_LAMBDA(int n, int& slot, bool last) {
        const int field = grid.field_of(n);
        const Coord<Dim> at = origin_in_turn(grid, turn, n - field * grid.patches_of_field());
        bool active = false;
        const int around = is_beyond_period(grid, at) ? 0 : Patch<Dim>::neighbours;
        for (int k = 0; k < around && !active; ++k) {
          const long other = patch_around(grid, at, field, k);
          active = other >= 0 && marks(other) != 0;
        }
        if (last) slot_of(grid.patch_of(at, field)) = active ? slot : -1;
        slot += active;
      },
      patches.slots);

  ensure(patches.number, patches.slots);
  ensure(patches.origin, patches.slots);
  ensure(patches.neighbours, patches.slots);
  const auto number = patches.number;
  const auto origin = patches.origin;
  const auto neighbours = patches.neighbours;
  Kokkos::parallel_for(
      "mpm::link_patches", Range(s.space, 0, patch_count), KOKKOS_LAMBDA(int n) {
        const int slot = slot_of(n);
        if (slot < 0) return;
        const Coord<Dim> at = grid.origin_of(n);
        number(slot) = n;
        origin(slot) = at;
        for (int k = 0; k < Patch<Dim>::neighbours; ++k) {
          const long other = patch_around(grid, at, grid.field_of(n), k);
          neighbours(slot, k) = other < 0 ? -1 : slot_of(other);
        }
      });
  if (s.soil.points.rings) s.soil.points.patch_origin = origin.data();
}

#define MPM_INSTANTIATE(Space, T, Dim)                      \
  template void locate(ContactCore<Space, T, Dim>&);        \
  template void locate_rigids(ContactCore<Space, T, Dim>&); \
  template void activate_patches(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
