// Slots where a contact may be until the next rebuild, and the rigid bodies that are near each of them.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/copy.hpp"
#include "physics/contact_site.hpp"
#include "physics/p2g_terms.hpp"
#include "physics/surface.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

/// Largest movement of a point beyond the margin [cells].
inline constexpr double k_step_beyond_margin = 0.5;

/// Half the window of the nodes that particles of a patch reach, with the reach of a contact, a cell along
/// each axis [cells].
template <int Dim>
inline constexpr double k_half_window = 0.5 * Patch<Dim>::edge + 2;
/// The same of the patch's own nodes, and where contact is at sites, of the particles that may be near a
/// face.
template <class Space, class T, int Dim>
double half_of_own(const ContactCore<Space, T, Dim>& s) {
  const double sites = s.at_sites.in_use ? s.p2g.margin + s.p2g.reserve + SiteReach::near : 0;
  return 0.5 * Patch<Dim>::edge + std::max(1.0, sites);
}

/// Whether a rigid body may touch soil in a window round the middle of a slot's patch, until the next
/// rebuild.
template <class Space, class T, int Dim>
struct NearSlot {
  using Memory = typename Space::memory_space;
  Grid<T, Dim> grid;
  decltype(Patches<Space, Dim>::origin) origin;
  Kokkos::View<Rigid<Dim>*, Memory> rigids;
  SurfaceTables<Memory, Dim> vertices;
  NearBodies<Space> near;
  double spacing, moves;  // m; moves: till the next rebuild
  double half;            // cells, of the window
  double far;             // m, of a surface from the middle: half the window's diagonal, and the movement

  NearSlot(const ContactCore<Space, T, Dim>& s, double half_window)
      : grid(s.grid),
        origin(s.patches.origin),
        rigids(s.rigids),
        vertices(s.vertices),
        near(s.contact.near),
        spacing(s.spacing),
        moves((s.p2g.margin + s.p2g.reserve + k_step_beyond_margin) * s.spacing),
        half(half_window),
        far(std::sqrt(static_cast<double>(Dim)) * half * s.spacing + moves) {}

  /// A place of the slot's patch, so many cells from its origin [m], in the body as it was at the start.
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> place(int slot, int r, const Coord<Dim>& from) const {
    return rigids(r).motion.pose.to_body(
        [&](int d) { return grid.coordinate_within(d, origin(slot)[d] + from[d], spacing); });
  }
  /// Whether the surface of body r is so far from the patch that they do not touch. The ground may be much
  /// nearer to one side of a patch than to its middle, so this says nothing of it.
  KOKKOS_INLINE_FUNCTION bool is_far(int slot, int r) const {
    const Rigid<Dim>& rigid = rigids(r);
    if (!rigid.surface_normal || rigid.surface.kind == SurfaceKind::heights) return false;
    const auto middle = place(slot, r, filled<int, Dim>(Patch<Dim>::edge / 2));
    return distance_to(rigid.surface, vertices, middle).value > far;
  }
  /// Whether body r is near a slot, by its surface alone.
  KOKKOS_INLINE_FUNCTION bool operator()(int slot, int r) const {
    const Rigid<Dim>& rigid = rigids(r);
    if (rigid.surface.kind == SurfaceKind::heights) return is_over_ground(slot, r);
    const auto middle = place(slot, r, filled<int, Dim>(Patch<Dim>::edge / 2));
    double squares = 0;
    for (int d = 0; d < Dim; ++d) {
      const double way = middle[d] - near.spheres(r, d);
      squares += way * way;
    }
    const double reach = near.spheres(r, Dim) + far;
    return squares < reach * reach && reaches_window(rigid, distance_to(rigid.surface, vertices, middle));
  }

 private:
  /// Whether a surface, of which the middle of the patch has this distance, comes near the nodes of the
  /// window. A convex one lies behind the plane through its nearest point, so that the window's corner before
  /// this plane decides; of others the window's diagonal does.
  KOKKOS_INLINE_FUNCTION bool reaches_window(const Rigid<Dim>& rigid, const Distance<Dim>& middle) const {
    const SurfaceKind kind = rigid.surface.kind;
    if (kind != SurfaceKind::disc && kind != SurfaceKind::box && kind != SurfaceKind::half_plane)
      return middle.value <= far;
    const Vector<double, Dim> out = rigid.motion.pose.turn_to_world(middle.normal);
    double corner = 0;  // of the window, along the normal [cells]
    for (int d = 0; d < Dim; ++d) corner += half * Kokkos::fabs(out[d]);
    return middle.value <= corner * spacing + moves;
  }
  /// Whether the ground is near at any column of nodes of the patch's window.
  KOKKOS_INLINE_FUNCTION bool is_over_ground(int slot, int r) const {
    constexpr int width = Patch<Dim>::edge + 3;
    MPM_ROLLED
    for (int n = 0; n < (Dim == 3 ? width * width : width); ++n) {
      Coord<Dim> from = filled<int, Dim>(Patch<Dim>::edge / 2);
      from[0] = n % width - 1;
      if (Dim == 3) from[1] = n / width - 1;
      if (distance_to(rigids(r).surface, vertices, place(slot, r, from)).value <= far) return true;
    }
    return false;
  }
};

/// Marks the slots that body r may touch, by the patches round them that hold its points.
template <class Space, class T, int Dim>
void mark_by_points(const ContactCore<Space, T, Dim>& s, int r) {
  const auto marks = s.contact.place;
  const auto neighbours = s.patches.neighbours;
  const auto number = s.patches.number;
  const auto grid = s.grid;
  const auto begin = s.rigid_points[r].bins.begin;
  const NearSlot<Space, T, Dim> near(s, k_half_window<Dim>);
  Kokkos::parallel_for(
      "mpm::mark_contacts", Kokkos::RangePolicy<Space>(s.space, 0, s.patches.slots), KOKKOS_LAMBDA(int slot) {
        bool holds = grid.field_of(number(slot)) > 0;  // where no rigid has points
        for (int k = 0; k < Patch<Dim>::neighbours; ++k) {
          const int other = neighbours(slot, k);
          holds |= other >= 0 && begin(other * Patch<Dim>::cells) < begin((other + 1) * Patch<Dim>::cells);
        }
        if (holds && !near.is_far(slot, r)) marks(slot) = 1;
      });
}

/// Marks the slots in patches where several velocity fields are active.
template <class Space, class T, int Dim>
void mark_interfaces(const ContactCore<Space, T, Dim>& s) {
  const auto marks = s.contact.place, entry = s.interfaces.entry;
  Kokkos::parallel_for(
      "mpm::mark_interfaces", Kokkos::RangePolicy<Space>(s.space, 0, s.patches.slots),
      KOKKOS_LAMBDA(int slot) {
        if (entry(slot) > 0) marks(slot) = 1;
      });
}

/// Marks the slots whose particles reach nodes that a body may touch, and lists the bodies near the nodes of
/// each of them, which are fewer.
template <class Space, class T, int Dim>
void list_bodies(ContactCore<Space, T, Dim>& s) {
  using Range = Kokkos::RangePolicy<Space>;
  NearBodies<Space>& list = s.contact.near;
  const auto marks = s.contact.place;
  const NearSlot<Space, T, Dim> near_window(s, k_half_window<Dim>), near(s, half_of_own(s));
  const int slots = s.patches.slots, bodies = static_cast<int>(s.rigid_points.size());
  Kokkos::parallel_reduce(
      "mpm::count_near_bodies", Range(s.space, 0, slots),
      KOKKOS_LAMBDA(int slot, int& most) {
        int count = 0;
        marks(slot) = 0;
        for (int r = 0; r < bodies; ++r) {
          if (!near_window(slot, r)) continue;
          marks(slot) = 1;
          count += near(slot, r) ? 1 : 0;
        }
        most = Kokkos::max(most, count);
      },
      Kokkos::Max<int>(list.width));
  s.space.fence("mpm::count_near_bodies");
  list.width = std::max(list.width, 1);
  ensure(list.of, std::size_t(slots) * list.width);
  const auto of = list.of;
  const int width = list.width;
  Kokkos::parallel_for(
      "mpm::list_near_bodies", Range(s.space, 0, slots), KOKKOS_LAMBDA(int slot) {
        int count = 0;
        for (int r = 0; r < bodies && marks(slot) != 0; ++r)
          if (near(slot, r)) of(slot * width + count++) = r;
        for (; count < width; ++count) of(slot * width + count) = -1;
      });
}

/// Lists the entries of each body, in the order of slots. The host goes through them once for all bodies.
template <class Space, class T, int Dim>
void list_entries(ContactCore<Space, T, Dim>& s) {
  NearBodies<Space>& list = s.contact.near;
  const int bodies = static_cast<int>(s.rigid_points.size()), width = list.width;
  ensure(list.first, bodies + 1);
  ensure(list.place, std::size_t(s.contact.count) * width);
  const auto slots = mirror_of(s.contact.slots), of = mirror_of(list.of);
  const auto first = Kokkos::create_mirror_view(list.first), place = Kokkos::create_mirror_view(list.place);
  const auto for_each_entry = [&](auto&& f) {
    for (int n = 0; n < s.contact.count; ++n)
      for (int m = 0; m < width && of(slots(n) * width + m) >= 0; ++m)
        f(of(slots(n) * width + m), n * width + m);
  };
  std::vector<int> begin(bodies + 1, 0);
  for_each_entry([&](int body, int) { ++begin[body + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::copy(begin.begin(), begin.end(), first.data());
  for_each_entry([&](int body, int entry) { place(begin[body]++) = entry; });
  copy(list.first, first), copy(list.place, place);
}

template <class Space, class T, int Dim>
void make_room_for_contact(ContactCore<Space, T, Dim>& s) {
  const std::size_t nodes = std::size_t(s.contact.count) * Patch<Dim>::cells, width = s.contact.near.width;
  if (s.soil_boundary && has_windows(s.space)) {
    s.contact.boundary.place = s.contact.place;
    ensure(s.contact.boundary.sums, window_bytes<BoundarySource<Space, T, Dim>> * s.contact.count);
  }
  s.contact.strength.place = s.contact.place;
  if (s.shear_fraction && has_windows(s.space))
    ensure(s.contact.strength.sums, window_bytes<PairSource<Space, T, Dim>> * s.contact.count);
  s.contact.cloud.place = s.contact.place;
  if (s.interfaces.in_use() && has_windows(s.space))
    ensure(s.contact.cloud.sums, window_bytes<CloudSource<Space, T, Dim>> * s.contact.count);
  if (s.at_sites.in_use) ensure(s.at_sites.sums, nodes);
  if (s.light_rigids.in_use)
    ensure(s.light_rigids.of_slots, std::size_t(s.contact.count) * LightTerms<Dim>::size * width);
  ensure(s.contact.forces, 2 * std::size_t(s.contact.count) * Wrench<Dim>::size * wrenches_of_slot(s));
}

}  // namespace

template <class Space, class T, int Dim>
void list_contacts(ContactCore<Space, T, Dim>& s) {
  const int slots = s.patches.slots;
  ensure(s.contact.place, slots);
  Kokkos::deep_copy(s.space, s.contact.place, 0);
  if (s.contact.near.listed)
    list_bodies(s);
  else
    for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) mark_by_points(s, r);
  if (s.interfaces.in_use()) mark_interfaces(s);
  ensure(s.contact.slots, slots);
  const auto list = s.contact.slots, place = s.contact.place;
  Kokkos::parallel_scan(
      "mpm::list_contacts", Kokkos::RangePolicy<Space>(s.space, 0, slots),
      KOKKOS_LAMBDA(int slot, int& n, bool last) {
        if (place(slot) == 0) return;
        if (last) list(n) = slot, place(slot) = n + 1;
        ++n;
      },
      s.contact.count);
  s.contact.near.widest = s.contact.near.width;
  if (s.contact.near.listed) list_entries(s);
  make_room_for_contact(s);
  s.at_sites.list.made = false;
}

#define MPM_INSTANTIATE(Space, T, Dim) template void list_contacts(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
