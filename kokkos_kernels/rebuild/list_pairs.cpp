#include "rebuild/list_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/copy.hpp"
#include "physics/pair_contact.hpp"

namespace mpm {
namespace {

/// Fills a view from the host. It is made anew unless it has its memory already.
template <class View, class Get>
void fill(View& view, const std::string& label, int count, const Get& get) {
  if (static_cast<int>(view.extent(0)) != count)
    view = View(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), count);
  const auto host = Kokkos::create_mirror_view(view);
  for (int n = 0; n < count; ++n) host(n) = get(n);
  copy(view, host);
}

/// Tables of surfaces on the host. Samples may be many: they are copied where `samples` asks for them.
template <class Memory, int Dim>
SurfaceTables<Kokkos::HostSpace, Dim> on_host(const SurfaceTables<Memory, Dim>& tables, bool samples) {
  SurfaceTables<Kokkos::HostSpace, Dim> host;
  host.vertices = mirror_of(tables.vertices), host.parts = mirror_of(tables.parts);
  if (!samples) return host;
  host.grids = mirror_of(tables.grids), host.blocks = mirror_of(tables.blocks);
  host.samples = mirror_of(tables.samples), host.edges = mirror_of(tables.edges);
  return host;
}

/// Bodies of pairs with their poses, on the host.
template <class Space, class T, int Dim>
struct Meetings {
  using Bodies = decltype(mirror_of(PairViews<Space, Dim>().bodies));
  const RigidPairs<Space, Dim>& pairs;
  int rigids;
  Bodies bodies;
  SurfaceTables<Kokkos::HostSpace, Dim> vertices;
  std::vector<RigidPose<Dim>> poses;
  std::vector<Vector<double, Dim>> centres;  // m
  double margin;                             // m: farther apart they cannot meet

  Meetings(const ContactCore<Space, T, Dim>& s, double m, bool samples)
      : pairs(s.pairs),
        rigids(static_cast<int>(s.rigid_points.size())),
        bodies(mirror_of(s.pairs.bodies)),
        vertices(on_host(s.pairs.vertices, samples)),
        margin(m) {
    const auto host = mirror_of(s.rigids);
    for (int n = 0; n < static_cast<int>(bodies.extent(0)); ++n) {
      poses.push_back(pose_of(host.data(), rigids, n));
      centres.push_back(poses.back().to_world(bodies(n).centre));
    }
  }

  bool ends(int n) const { return bodies(n).reach < HUGE_VAL; }
  /// Whether two bodies, a < b, may have contact at all.
  bool may_meet(int a, int b) const {
    if (a >= rigids || bodies(a).reach < 0 || bodies(b).reach < 0 ||
        !(bodies(a).dynamic || bodies(b).dynamic))
      return false;
    if (b >= rigids) return bodies(a).dynamic && (bodies(a).sides >> (b - rigids) & 1) != 0;
    return !std::binary_search(pairs.parts.begin(), pairs.parts.end(), std::pair(a, b));
  }
  /// Whether the sphere around a body is near the surface of another one.
  bool sphere_near(int n, int other) const {
    if (!ends(n) || bodies(other).sampled) return true;
    const auto x = poses[other].to_body([&](int d) { return centres[n][d]; });
    return distance_to(bodies(other).surface, vertices, x).value - bodies(n).reach < margin;
  }
  bool near(int a, int b) const {
    if (ends(a) && ends(b)) {
      double square = 0;
      for (int d = 0; d < Dim; ++d) square += std::pow(centres[a][d] - centres[b][d], 2);
      if (square > std::pow(bodies(a).reach + bodies(b).reach + margin, 2)) return false;
    }
    return sphere_near(a, b) && sphere_near(b, a);
  }
  /// Coordinates along x between which a body may meet another one.
  double first_x(int n) const { return ends(n) ? centres[n][0] - bodies(n).reach - margin : -HUGE_VAL; }
  double last_x(int n) const { return ends(n) ? centres[n][0] + bodies(n).reach : HUGE_VAL; }

  /// The pairs that may meet, in order: by a sweep along x.
  std::vector<RigidPair> all() const {
    std::vector<int> order(poses.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = static_cast<int>(n);
    std::stable_sort(order.begin(), order.end(), [&](int m, int n) { return first_x(m) < first_x(n); });
    std::vector<RigidPair> found;
    std::vector<int> open;
    for (const int n : order) {
      std::erase_if(open, [&](int m) { return last_x(m) < first_x(n); });
      for (const int m : open) {
        const int a = std::min(m, n), b = std::max(m, n);
        if (may_meet(a, b) && near(a, b)) found.push_back(pair_of(a, b));
      }
      open.push_back(n);
    }
    std::sort(found.begin(), found.end(), [](const RigidPair& p, const RigidPair& q) {
      return std::pair(p.a, p.b) < std::pair(q.a, q.b);
    });
    return found;
  }

 private:
  /// The smaller of two numbers, or the one that is given; `none` where neither is.
  static double smaller(double a, double b, double none) {
    if (a < 0 && b < 0) return none;
    return a < 0 ? b : b < 0 ? a : std::min(a, b);
  }
  RigidPair pair_of(int a, int b) const {
    const double friction =
        pairs.friction >= 0 && b < rigids
            ? pairs.friction
            : smaller(bodies(a).friction, bodies(b).friction, std::max(0.0, pairs.friction));
    return {a, b, friction, smaller(bodies(a).restitution, bodies(b).restitution, 0)};
  }
};

/// Puts the pairs in an order of colours: no two pairs of one move the same body. Returns where each begins.
template <class IsDynamic>
std::vector<int> sort_by_colours(std::vector<RigidPair>& pairs, int bodies, const IsDynamic& is_dynamic) {
  std::vector<std::vector<char>> taken(bodies);  // colours of the pairs of each body that moves
  std::vector<std::vector<RigidPair>> of_colour;
  const auto is_free = [&](int n, std::size_t colour) {
    return !is_dynamic(n) || taken[n].size() <= colour || taken[n][colour] == 0;
  };
  const auto take = [&](int n, std::size_t colour) {
    if (!is_dynamic(n)) return;
    taken[n].resize(std::max(taken[n].size(), colour + 1));
    taken[n][colour] = 1;
  };
  for (const RigidPair& pair : pairs) {
    std::size_t colour = 0;
    while (!is_free(pair.a, colour) || !is_free(pair.b, colour)) ++colour;
    if (colour == of_colour.size()) of_colour.emplace_back();
    of_colour[colour].push_back(pair);
    take(pair.a, colour), take(pair.b, colour);
  }
  std::vector<int> begin{0};
  pairs.clear();
  for (const std::vector<RigidPair>& some : of_colour) {
    pairs.insert(pairs.end(), some.begin(), some.end());
    begin.push_back(static_cast<int>(pairs.size()));
  }
  return begin;
}

}  // namespace

template <class Space, class T, int Dim>
std::vector<PairImpulse> pair_impulses(const ContactCore<Space, T, Dim>& s) {
  std::vector<PairImpulse> out = s.pairs.saved;
  if (!s.pairs.in_use()) return out;
  const auto list = mirror_of(s.pairs.list);
  const auto held = mirror_of(s.pairs.held);
  const auto contacts = mirror_of(s.pairs.contacts);
  for (int m = 0; m < s.pairs.count; ++m)
    for (int k = 0; k < held(m); ++k) {
      const PairContact<Dim>& at = contacts(std::size_t(m) * k_pair_contacts<Dim> + k);
      PairImpulse row{list(m).a, list(m).b, at.point, {}};
      for (int d = 0; d < Dim; ++d) row.impulse[d] = at.impulse[d];
      if (dot(at.impulse, at.impulse) > 0) out.push_back(row);
    }
  return out;
}

template <class Space, class T, int Dim>
void list_pairs(ContactCore<Space, T, Dim>& s) {
  RigidPairs<Space, Dim>& pairs = s.pairs;
  if (!pairs.may_meet) return;
  const std::vector<PairImpulse> kept = pair_impulses(s);
  pairs.saved.clear();
  // The margin is the way by which two bodies may come nearer until the next rebuild, and in a step.
  const Meetings<Space, T, Dim> meetings(s, 2 * (s.p2g.margin + 1) * s.spacing, false);
  std::vector<RigidPair> found = meetings.all();
  const int bodies = static_cast<int>(meetings.poses.size());
  const std::vector<int> begin =
      sort_by_colours(found, bodies, [&](int n) { return meetings.bodies(n).dynamic; });
  pairs.count = static_cast<int>(found.size()), pairs.colours = static_cast<int>(begin.size()) - 1;
  std::map<std::pair<int, int>, int> place;
  for (int m = 0; m < pairs.count; ++m) place[{found[m].a, found[m].b}] = m;
  std::vector<std::vector<PairImpulse>> of(pairs.count);
  for (const PairImpulse& row : kept)
    if (const auto at = place.find({row.a, row.b}); at != place.end()) of[at->second].push_back(row);
  fill(pairs.list, "mpm::pair_list", pairs.count, [&](int m) { return found[m]; });
  fill(pairs.begin, "mpm::pair_begin", pairs.colours + 1, [&](int c) { return begin[c]; });
  fill(pairs.held, "mpm::pair_held", pairs.count, [&](int m) { return static_cast<int>(of[m].size()); });
  constexpr int most = k_pair_contacts<Dim>;
  fill(pairs.contacts, "mpm::pair_contacts", pairs.count * most, [&](int n) {
    PairContact<Dim> at{};
    const std::vector<PairImpulse>& rows = of[n / most];
    if (n % most >= static_cast<int>(rows.size())) return at;
    at.point = rows[n % most].point;
    for (int d = 0; d < Dim; ++d) at.impulse[d] = rows[n % most].impulse[d];
    return at;
  });
  if (pairs.motions.extent(0) != pairs.bodies.extent(0))
    pairs.motions = decltype(pairs.motions)("mpm::pair_motions", pairs.bodies.extent(0));
}

template <class Space, class T, int Dim>
void find_parts(ContactCore<Space, T, Dim>& s) {
  constexpr double k_overlap = 0.01;  // cells
  RigidPairs<Space, Dim>& pairs = s.pairs;
  pairs.parts.clear();
  if (!pairs.may_meet) return;
  const Meetings<Space, T, Dim> meetings(s, 0, true);
  const auto points = mirror_of(pairs.points);
  std::vector<std::pair<int, int>> parts;
  for (const RigidPair& pair : meetings.all()) {
    const PairPlaces<Dim> places{meetings.bodies(pair.a), meetings.bodies(pair.b), meetings.poses[pair.a],
                                 meetings.poses[pair.b]};
    bool overlap = false;
    for (int n = places.begin(); n < places.end() && !overlap; ++n)
      overlap = places(n, points, meetings.vertices).gap < -k_overlap * s.spacing;
    if (overlap) parts.emplace_back(pair.a, pair.b);
  }
  pairs.parts = std::move(parts);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                \
  template std::vector<PairImpulse> pair_impulses(const ContactCore<Space, T, Dim>&); \
  template void list_pairs(ContactCore<Space, T, Dim>&);                              \
  template void find_parts(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
