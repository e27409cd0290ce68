#pragma once
// Loops that find where soil is in touch with rigid bodies, at sites.

#include "loops/sites.hpp"
#include "physics/face_distance.hpp"

namespace mpm {

template <class Space, class T, int Dim>
struct FindSites : Sites<Space, T, Dim> {
  using Base = Sites<Space, T, Dim>;
  using Base::Base;
  using Base::body, Base::node_at, Base::place_of_site, Base::node_in_list, Base::node_number, Base::sums_of,
      Base::touches;
  using Base::cells, Base::corners, Base::k_whole;
  using Base::update, Base::soil, Base::sites, Base::gaps, Base::list, Base::contact_place,
      Base::contact_slots, Base::rank;
  using typename Base::Place, typename Base::Site;

  /// Whether a point is nearest to an edge of the body, or to a place close to one. An edge that is rounded
  /// by more than a cell is a face.
  KOKKOS_INLINE_FUNCTION bool is_at_edge(const Rigid<Dim>& rigid, const Vector<double, Dim>& point,
                                         const Distance<Dim>& to) const {
    if (rigid.surface.radius > SiteReach::round * update.spacing) return false;
    bool at_edge = to.at_edge;
    MPM_ROLLED
    for (int n = 0; n < 2 * Dim && !at_edge; ++n) {
      Vector<double, Dim> beside = point;
      beside[n / 2] += (n % 2 == 0 ? -1 : 1) * SiteReach::edge * update.spacing;
      at_edge = distance_to(rigid.surface, update.vertices, beside).at_edge;
    }
    return at_edge;
  }

  /// Begins the sites of node number n of the list.
  KOKKOS_INLINE_FUNCTION void find_of_node(int n) const {
    const bool far = is_far(n);
    for (int corner = 0; corner < corners; ++corner)
      if (far)
        gaps(n * corners + corner) = GapKey::none;
      else
        find(n * corners + corner);
  }
  /// Whether no site of node number n of the list is near the face.
  KOKKOS_INLINE_FUNCTION bool is_far(int n) const {
    const Place of = place_of_site(n * corners);
    const Coord<Dim> at = node_at(of);
    const Rigid<Dim>& rigid = body(of.rigid);
    const auto point = rigid.motion.pose.to_body([&](int d) { return (at[d] + 0.25) * update.spacing; });
    constexpr double far = SiteReach::layer + SiteReach::of_node<Dim> + SiteReach::distance;
    return distance_to_faces(rigid.surface, update.vertices, point) > far * update.spacing;
  }

  /// Begins a site: the nearest place of the body's face. There is one in each column of sites along the axis
  /// to which the face is most nearly normal.
  KOKKOS_INLINE_FUNCTION void find(int n) const {
    gaps(n) = GapKey::none;
    const Place of = place_of_site(n);
    const Rigid<Dim>& rigid = body(of.rigid);
    const Coord<Dim> at = node_at(of);
    const Grid<T, Dim>& grid = update.places.grid;
    Coord<Dim> half;  // place of the site, in half cells
    Vector<double, Dim> x;
    for (int d = 0; d < Dim; ++d) {
      half[d] = 2 * at[d] + (of.corner >> d & 1);
      if (half[d] < 0 || half[d] > 2 * grid.cells[d] - (grid.period[d] > 0)) return;
      x[d] = half[d] * update.spacing / 2;
    }
    const Vector<double, Dim> point = rigid.motion.pose.to_body([&](int d) { return x[d]; });
    const Distance<Dim> to = distance_to(rigid.surface, update.vertices, point);
    const Vector<double, Dim> out = rigid.motion.pose.turn_to_world(to.normal);
    double most = 0;
    for (int d = 0; d < Dim; ++d) most = Kokkos::fmax(most, Kokkos::fabs(out[d]));
    const double away = to.value / update.spacing;  // cells
    if (!(away > k_on_edge && away <= SiteReach::layer * most * (1 + k_on_edge))) return;
    if (is_at_edge(rigid, point, to)) return;
    Site& site = sites(n);
    unsigned sides = 0;
    for (int d = 0; d < Dim; ++d) {
      site.place[d] = static_cast<T>(0.5 * (of.corner >> d & 1) - away * out[d]);
      sides |= unsigned(half[d] == 0) << (2 * d) | unsigned(half[d] == 2 * grid.cells[d]) << (2 * d + 1);
      site.normal[d] = static_cast<T>(out[d]);
    }
    cancel_at_rollers(grid, sides, site.normal);
    const T length = Kokkos::sqrt(dot(site.normal, site.normal));
    if (!(length > T(k_on_edge))) return;
    site.part = part_in_mesh(sides);
    for (int d = 0; d < Dim; ++d) site.normal[d] /= length;
    gaps(n) = GapKey::open;
    const int node = list.node(n / corners);
    Kokkos::atomic_or(&list.open(node / cells), std::uint64_t(1) << node % cells);
  }

  /// Part of a site on these sides of the mesh that is not its mirror image beyond a plane of symmetry.
  KOKKOS_INLINE_FUNCTION T part_in_mesh(unsigned sides) const {
    T part = 1;
    for (int n = update.rings ? 2 : 0; n < 2 * Dim; ++n)
      if ((sides >> n & 1u) && update.places.grid.wall[n / 2][n % 2] == Wall::roller) part /= 2;
    return part;
  }

  /// A particle near the face of a body. out: the normal of the face that is nearest to the particle: soil at
  /// another face of a thin plate does not count.
  struct Near {
    int rigid;  // negative: the particle is not near
    int slot;
    Coord<Dim> cell;
    Vector<T, Dim> x, half;
    Vector<double, Dim> out;
  };
  /// Pairs of a particle and a body that a team takes.
  static constexpr int k_pairs = 64;

  /// Brings the gaps of the sites near particles down to those to them, for the pairs of number `part` of
  /// the parts of the list. near: k_pairs
  template <class Team>
  KOKKOS_INLINE_FUNCTION void meet(const Team& team, int part, Near* near) const {
    for_team(team, k_pairs, [&](int k) {
      const int m = part * k_pairs + k;
      near[k].rigid = -1;
      if (m < list.pairs) look(list.pair(m), near[k]);
    });
    team.team_barrier();
    MPM_ROLLED
    for (int k = 0; k < k_pairs; ++k)
      if (near[k].rigid >= 0) meet_body(team, near[k]);
  }
  /// Sets what a particle near a body is, and near.rigid where it is.
  KOKKOS_INLINE_FUNCTION void look(const SitePair& pair, Near& near) const {
    near.slot = contact_slots(pair.group % this->count);
    near.cell = coord_of<Dim>(soil.cell(pair.particle));
    near.x = soil.coordinate(pair.particle);
    const HalfLength<T> common = soil.properties(pair.particle).half_length;
    for (int d = 0; d < Dim; ++d)
      near.half[d] = soil.has_domain ? T(soil.half_length(pair.particle)[d]) : T(common);
    const int r = update.near_bodies.body(near.slot, pair.group / this->count);
    const Rigid<Dim>& rigid = body(r);
    const auto in_space = [&](int d) {
      return (update.places.origin(near.slot)[d] + near.cell[d] + double(near.x[d])) * update.spacing;
    };
    const Distance<Dim> to = distance_to(rigid.surface, update.vertices, rigid.motion.pose.to_body(in_space));
    if (!(Kokkos::fabs(to.value) < SiteReach::near * update.spacing)) return;
    near.out = rigid.motion.pose.turn_to_world(to.normal);
    near.rigid = r;
  }
  /// Sites round a particle, in half cells from the lower corner of its patch.
  struct Around {
    Coord<Dim> low, size;
  };
  /// Nodes beyond those that the patch's particles reach have none of a particle's sites: all ranks that
  /// reach a site then hold it. On a GPU each thread of a team asks for a node; a processor asks the list.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void meet_body(const Team& team, const Near& near) const {
    Around around;
    Coord<Dim> low, high;
    int nodes = 1;
    for (int d = 0; d < Dim; ++d) {
      const double reach = SiteReach::inflated * near.half[d] + SiteReach::ahead - SiteReach::behind - 0.5;
      around.low[d] = static_cast<int>(Kokkos::ceil(2 * (near.cell[d] + double(near.x[d]) - reach)));
      around.size[d] =
          static_cast<int>(Kokkos::floor(2 * (near.cell[d] + double(near.x[d]) + reach))) - around.low[d] + 1;
      low[d] = Kokkos::max(-1, around.low[d] >> 1);
      high[d] = Kokkos::min(Patch<Dim>::edge + 1, (around.low[d] + around.size[d] - 1) >> 1);
      nodes *= Kokkos::max(0, high[d] - low[d] + 1);
    }
    if constexpr (is_device<Space>)
      for_team(team, nodes, [&](int m) {
        Coord<Dim> node;
        for (int d = 0, rest = m; d < Dim; rest /= high[d] - low[d] + 1, ++d)
          node[d] = low[d] + rest % (high[d] - low[d] + 1);
        const int i = node_number(near.slot, node);
        const int group = i < 0 ? -1 : group_of(near.rigid, i / cells);
        const bool open = group >= 0 && (list.marks(group) & list.open(group)) >> i % cells & 1;
        if (open) meet_node(near, around, node, list.number(group, i % cells));
      });
    else
      for (int k = 0; k < Patch<Dim>::neighbours && nodes > 0; ++k)
        meet_patch(near, around, k, nodes_between(k, low, high));
  }
  /// Group of a body at a slot; negative where no contact of it may be.
  KOKKOS_INLINE_FUNCTION int group_of(int rigid, int slot) const {
    const int place = contact_place(slot), near = place == 0 ? -1 : update.near_bodies.number(slot, rigid);
    return near < 0 ? -1 : near * this->count + place - 1;
  }
  /// The nodes `bits` of the patch that is neighbour number k of a particle's.
  KOKKOS_INLINE_FUNCTION void meet_patch(const Near& near, const Around& around, int k,
                                         std::uint64_t bits) const {
    const int slot = bits == 0 ? -1 : update.places.neighbours(near.slot, k);
    const int group = slot < 0 ? -1 : group_of(near.rigid, slot);
    if (group < 0) return;
    MPM_ROLLED
    for (bits &= list.marks(group) & list.open(group); bits != 0; bits &= bits - 1) {
      const int place = Kokkos::Experimental::countr_zero_builtin(bits);
      Coord<Dim> node = coord_of<Dim>(place);
      for (int d = 0, rest = k; d < Dim; rest /= 3, ++d) node[d] += (rest % 3 - 1) * Patch<Dim>::edge;
      meet_node(near, around, node, list.number(group, place));
    }
  }
  /// Node number `number` of the list, which is at `node` from the lower corner of a particle's patch.
  KOKKOS_INLINE_FUNCTION void meet_node(const Near& near, const Around& around, const Coord<Dim>& node,
                                        int number) const {
    MPM_ROLLED
    for (int corner = 0; corner < corners; ++corner) {
      const int n = number * corners + corner;
      if (gaps(n) == GapKey::none || !is_around(around, node, corner)) continue;
      const Site& site = sites(n);
      T facing = 0;
      Vector<T, Dim> from;
      for (int d = 0; d < Dim; ++d) {
        from[d] = T(node[d] - near.cell[d]) + site.place[d] - near.x[d];
        facing += site.normal[d] * static_cast<T>(near.out[d]);
      }
      if (!(facing > T(SiteReach::facing)) || !may_meet_box(from, site.normal, near.half)) continue;
      const T gap = gap_to_box(from, site.normal, near.half);
      if (gap < SiteReach::touch) Kokkos::atomic_min(&gaps(n), GapKey::of(gap, rank));
    }
  }
  KOKKOS_INLINE_FUNCTION static bool is_around(const Around& sites, const Coord<Dim>& node, int corner) {
    bool is = true;
    for (int d = 0; d < Dim; ++d) {
      const int half = 2 * node[d] + (corner >> d & 1) - sites.low[d];
      is = is && half >= 0 && half < sites.size[d];
    }
    return is;
  }

  /// Couples a site that is in touch with soil of this rank to the nodes round it, and counts it there.
  KOKKOS_INLINE_FUNCTION void couple(int n) const {
    if (gaps(n) == GapKey::none || gaps(n) == GapKey::open) return;
    Site& site = sites(n);
    site.inverse_mass = 0;
    const Place of = place_of_site(n);
    if (!touches(of.rigid, n) || GapKey::rank(gaps(n)) != rank) return;
    const T gap = static_cast<T>(GapKey::gap(gaps(n)));
    for (int d = 0; d < Dim; ++d) site.place[d] += gap * site.normal[d];
    site.gap = gap * update.places.grid.spacing;
    constexpr T k_round_off = T(1e-6);  // of a weight: the place is on a row of nodes
    T sum = 0;
    this->for_each_hat(of, site, [&](int m, int i, T weight) {
      const bool takes = weight > k_round_off && sums_of(i) >= 0 &&
                         update.nodes.soil(i, SoilTerms<Dim>::mass) > update.mass_cut;
      site.share[m] = takes ? weight : T(0);
      sum += site.share[m];
    });
    constexpr T k_most_of_it = T(0.3);  // of a site's nodes have soil, or the site is beside it
    if (!(sum > k_most_of_it)) return;
    const Coord<Dim> at = node_at(of);
    const auto in_space = [&](int d) { return (at[d] + double(site.place[d])) * update.spacing; };
    const Vector<double, Dim> velocity = body(of.rigid).motion.velocity_at(in_space);
    for (int d = 0; d < Dim; ++d) site.velocity[d] = static_cast<T>(velocity[d]);
    for (int m = 0; m < corners; ++m) site.share[m] /= sum;
    site.inverse_mass = 1;  // begin_impulse replaces it
    this->for_each_hat(of, site, [&](int m, int i, T) {
      if (site.share[m] > 0) this->add(i, SiteSums<Dim>::sites, double(site.part) * site.share[m] * k_whole);
    });
  }
};

}  // namespace mpm
