// Sites of contact that may act until the next rebuild (data/site_list.hpp).

#include <cmath>

#include "base/ensure.hpp"
#include "physics/contact_site.hpp"
#include "physics/face_distance.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

/// Which particles may meet sites until the next rebuild, and which nodes have such sites. Points move by no
/// more than `drift` cells along each axis, so distances change by no more than `far`.
template <class Space, class T, int Dim>
struct NearSites {
  using Memory = typename Space::memory_space;
  static constexpr int cells = Patch<Dim>::cells, edge = Patch<Dim>::edge;
  static constexpr double k_half_diagonal = Dim == 2 ? 0.71 : 0.87;  // cells
  Patches<Space, Dim> patches;
  Kokkos::View<Rigid<Dim>*, Memory> rigids;
  SurfaceTables<Memory, Dim> tables;
  NearBodies<Space> near_bodies;
  ContactPlaces<Space> contact_place;
  Kokkos::View<int*, Memory> contact_slots;
  Soil<Space, T, Dim> soil;
  decltype(Bins<Space>::begin) begin;
  decltype(Nodes<Space, T, Dim>::impulse) impulse;
  Kokkos::View<std::uint64_t*, Memory> marks;
  double spacing;            // m
  double drift, far;         // cells
  int count, stride, keeps;  // contact slots; of a body in `impulse`; nodes of which `impulse` has numbers

  explicit NearSites(const ContactCore<Space, T, Dim>& s)
      : patches(s.patches),
        rigids(s.rigids),
        tables(s.vertices),
        near_bodies(s.contact.near),
        contact_place(s.contact.place),
        contact_slots(s.contact.slots),
        soil(s.soil.points),
        begin(s.soil.bins.begin),
        impulse(s.nodes.impulse),
        marks(s.at_sites.list.marks),
        spacing(s.spacing),
        drift(s.p2g.margin + s.p2g.reserve),
        far(std::sqrt(double(Dim)) * drift),
        count(s.contact.count),
        stride(impulse_stride(s)),
        keeps(static_cast<int>(s.nodes.impulse.extent(1))) {}

  /// Distance [cells] of a place [cells from the mesh's lower corner] to the faces of body r, or less.
  template <class Component>
  KOKKOS_INLINE_FUNCTION double distance(int r, const Component& x) const {
    const Rigid<Dim>& rigid = rigids(r);
    const auto point = rigid.motion.pose.to_body([&](int d) { return x(d) * spacing; });
    return distance_to_faces(rigid.surface, tables, point) / spacing;
  }

  /// Calls f(pair) for the particles of cell number c of the contact slots that may meet sites.
  template <class F>
  KOKKOS_INLINE_FUNCTION void for_each_pair(int c, F&& f) const {
    constexpr double reach = SiteReach::near + SiteReach::distance;
    const int n = c / cells, slot = contact_slots(n), cell = slot * cells + c % cells;
    const int first = begin(cell), last = begin(cell + 1);
    const Coord<Dim> from = patches.origin(slot), in_patch = coord_of<Dim>(c % cells);
    MPM_ROLLED
    for (int near = 0; first < last && near < near_bodies.width; ++near) {
      const int r = near_bodies.body(slot, near);
      if (r < 0) break;
      if (!rigids(r).law.at_sites) continue;
      const double to_cell = distance(r, [&](int d) { return from[d] + in_patch[d] + 0.5; });
      if (to_cell > reach + 3 * far + k_half_diagonal) continue;
      for (int p = first; p < last; ++p) {
        const Vector<T, Dim> x = soil.coordinate(p);
        if (distance(r, [&](int d) { return from[d] + in_patch[d] + double(x[d]); }) <= reach + 2 * far)
          f(SitePair{near * count + n, p});
      }
    }
  }

  /// Marks the nodes whose sites a particle may meet, and those of the sites next to them.
  KOKKOS_INLINE_FUNCTION void mark(const SitePair& pair) const {
    constexpr double k_site = 0.5;  // cells, from a node to its farthest site, and from a site to the next
    const int slot = contact_slots(pair.group % count), r = near_bodies.body(slot, pair.group / count);
    const Coord<Dim> cell = coord_of<Dim>(soil.cell(pair.particle));
    const Vector<T, Dim> x = soil.coordinate(pair.particle);
    const double half =
        soil.has_domain ? k_most_half_length : double(soil.properties(pair.particle).half_length);
    const double reach =
        SiteReach::inflated * half + SiteReach::ahead - SiteReach::behind - 0.5 + k_site + drift;
    Coord<Dim> low, high;
    for (int d = 0; d < Dim; ++d) {
      const double at = cell[d] + double(x[d]);
      low[d] = Kokkos::max(-edge, static_cast<int>(Kokkos::ceil(at - reach - k_site)));
      high[d] = Kokkos::min(2 * edge - 1, static_cast<int>(Kokkos::floor(at + reach)));
    }
    MPM_ROLLED
    for (int k = 0; k < Patch<Dim>::neighbours; ++k) {
      const int other = patches.neighbours(slot, k);
      const int place = other < 0 ? 0 : contact_place(other);
      const int near = place == 0 ? -1 : near_bodies.number(other, r);
      if (near >= 0) Kokkos::atomic_or(&marks(near * count + place - 1), nodes_between(k, low, high));
    }
  }

  /// Takes a node's mark away where it is far from the face, and marks it where a site of it kept numbers of
  /// the step before: one that has no contact any more then loses them. n: group * cells + place in the slot
  KOKKOS_INLINE_FUNCTION void judge(int n) const {
    const int group = n / cells, near = group / count, k = n % cells;
    const int slot = contact_slots(group % count), r = near_bodies.body(slot, near);
    if (r < 0 || !rigids(r).law.at_sites) return;
    const std::uint64_t bit = std::uint64_t(1) << k;
    const bool wanted = keeps_numbers(near, slot * cells + k);
    if (wanted) {
      Kokkos::atomic_or(&marks(group), bit);
    } else if ((marks(group) & bit) != 0) {
      const Coord<Dim> from = patches.origin(slot), in_patch = coord_of<Dim>(k);
      constexpr double reach = SiteReach::layer + SiteReach::of_node<Dim> + SiteReach::distance;
      if (distance(r, [&](int d) { return from[d] + in_patch[d] + 0.25; }) > reach + far)
        Kokkos::atomic_and(&marks(group), ~bit);
    }
  }

 private:
  KOKKOS_INLINE_FUNCTION bool keeps_numbers(int near, int node) const {
    using Terms = SiteTerms<Dim>;
    bool any = false;
    for (int corner = 0; corner < k_sites<Dim> && node < keeps; ++corner)
      any = any || impulse(stride * near + corner * Terms::size + Terms::weight, node) != 0;
    return any;
  }
};

/// Lists the pairs of particles and bodies.
template <class Space, class T, int Dim>
void list_pairs_of(ContactCore<Space, T, Dim>& s, const NearSites<Space, T, Dim>& near) {
  using Range = Kokkos::RangePolicy<Space>;
  SiteList<Space>& list = s.at_sites.list;
  const int all = s.contact.count * Patch<Dim>::cells;
  const Kokkos::View<int*, typename Space::memory_space> first(
      Kokkos::view_alloc("mpm::first_pair", Kokkos::WithoutInitializing), all);
  Kokkos::parallel_for(
      "mpm::count_site_pairs", Range(s.space, 0, all), KOKKOS_LAMBDA(int c) {
        int n = 0;
        near.for_each_pair(c, [&](const SitePair&) { ++n; });
        first(c) = n;
      });
  Kokkos::parallel_scan(
      "mpm::begin_of_site_pairs", Range(s.space, 0, all),
      KOKKOS_LAMBDA(int c, int& sum, bool last) {
        const int n = first(c);
        if (last) first(c) = sum;
        sum += n;
      },
      list.pairs);
  ensure(list.pair, list.pairs);
  const auto pair = list.pair;
  Kokkos::parallel_for(
      "mpm::list_site_pairs", Range(s.space, 0, all), KOKKOS_LAMBDA(int c) {
        int n = first(c);
        near.for_each_pair(c, [&](const SitePair& found) { pair(n++) = found; });
      });
}

/// Marks the nodes of each group.
template <class Space, class T, int Dim>
void mark_nodes(ContactCore<Space, T, Dim>& s, const NearSites<Space, T, Dim>& near, int groups) {
  using Range = Kokkos::RangePolicy<Space>;
  const auto pair = s.at_sites.list.pair;
  Kokkos::deep_copy(s.space, s.at_sites.list.marks, std::uint64_t(0));
  Kokkos::parallel_for(
      "mpm::mark_site_nodes", Range(s.space, 0, s.at_sites.list.pairs),
      KOKKOS_LAMBDA(int n) { near.mark(pair(n)); });
  Kokkos::parallel_for(
      "mpm::judge_site_nodes", Range(s.space, 0, groups * Patch<Dim>::cells),
      KOKKOS_LAMBDA(int n) { near.judge(n); });
}

/// Lists the marked nodes, and the groups that have some.
template <class Space>
void list_marked(const Space& space, SiteList<Space>& list, int groups, int cells) {
  using Range = Kokkos::RangePolicy<Space>;
  const auto marks = list.marks;
  ensure(list.first, groups + 1);
  ensure(list.group, groups);
  const auto first = list.first, group = list.group;
  Kokkos::parallel_scan(
      "mpm::first_site_nodes", Range(space, 0, groups + 1),
      KOKKOS_LAMBDA(int g, int& sum, bool last) {
        if (last) first(g) = sum;
        if (g < groups) sum += Kokkos::Experimental::popcount_builtin(marks(g));
      },
      list.nodes);
  Kokkos::parallel_scan(
      "mpm::list_site_groups", Range(space, 0, groups),
      KOKKOS_LAMBDA(int g, int& sum, bool last) {
        if (marks(g) == 0) return;
        if (last) group(sum) = g;
        ++sum;
      },
      list.groups);
  ensure(list.node, list.nodes);
  const auto node = list.node;
  Kokkos::parallel_for(
      "mpm::list_site_nodes", Range(space, 0, list.groups), KOKKOS_LAMBDA(int n) {
        const int g = group(n);
        int at = first(g);
        for (int k = 0; k < cells; ++k)
          if (marks(g) >> k & 1) node(at++) = g * cells + k;
      });
}

}  // namespace

template <class Space, class T, int Dim>
void list_sites(ContactCore<Space, T, Dim>& s) {
  SiteList<Space>& list = s.at_sites.list;
  if (!s.at_sites.in_use || list.made) return;
  const int groups = s.contact.count * s.contact.near.width;
  ensure(list.marks, groups);
  ensure(list.open, groups);
  const NearSites<Space, T, Dim> near(s);
  list_pairs_of(s, near);
  mark_nodes(s, near, groups);
  list_marked(s.space, list, groups, Patch<Dim>::cells);
  ensure(s.at_sites.sites, std::size_t(list.nodes) * k_sites<Dim>);
  ensure(s.at_sites.gaps, std::size_t(list.nodes) * k_sites<Dim>);
  list.made = true;
}

#define MPM_INSTANTIATE(Space, T, Dim) template void list_sites(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
