#pragma once
// Loops that find where soil is in touch with rigid bodies, at sites.

#include "loops/sites.hpp"

namespace mpm {

template <class Space, class T, int Dim>
struct FindSites : Sites<Space, T, Dim> {
  using Base = Sites<Space, T, Dim>;
  using Base::Base;
  using Base::body, Base::node_at, Base::place_of_site, Base::number_of, Base::node_number, Base::sums_of,
      Base::touches;
  using Base::cells, Base::corners, Base::k_whole;
  using Base::update, Base::soil, Base::sites, Base::gaps, Base::contact_place, Base::rank;
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

  /// Begins a site: the nearest place of the body's face. There is one in each column of sites along the axis
  /// to which the face is most nearly normal.
  KOKKOS_INLINE_FUNCTION void find(int n) const {
    gaps(n) = GapKey::none;
    const Place of = place_of_site(n);
    if (of.rigid < 0) return;
    const Rigid<Dim>& rigid = body(of.rigid);
    if (!rigid.law.at_sites) return;
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
  }

  /// Part of a site on these sides of the mesh that is not its mirror image beyond a plane of symmetry.
  KOKKOS_INLINE_FUNCTION T part_in_mesh(unsigned sides) const {
    T part = 1;
    for (int n = update.rings ? 2 : 0; n < 2 * Dim; ++n)
      if ((sides >> n & 1u) && update.places.grid.wall[n / 2][n % 2] == Wall::roller) part /= 2;
    return part;
  }

  /// Brings the gaps of the sites near a particle down to the gap to it.
  KOKKOS_INLINE_FUNCTION void meet(int slot, int p) const {
    const Vector<T, Dim> x = soil.coordinate(p);
    Coord<Dim> cell = coord_of<Dim>(soil.cell(p));
    Vector<T, Dim> half;
    const HalfLength<T> common = soil.properties(p).half_length;
    for (int d = 0; d < Dim; ++d) half[d] = soil.has_domain ? T(soil.half_length(p)[d]) : T(common);
    MPM_ROLLED
    for (int near = 0; near < update.near_bodies.width; ++near) {
      const int r = update.near_bodies.body(slot, near);
      if (r < 0) break;
      const Rigid<Dim>& rigid = body(r);
      if (!rigid.law.at_sites) continue;
      const auto in_space = [&](int d) {
        return (update.places.origin(slot)[d] + cell[d] + double(x[d])) * update.spacing;
      };
      const Distance<Dim> to =
          distance_to(rigid.surface, update.vertices, rigid.motion.pose.to_body(in_space));
      if (!(Kokkos::fabs(to.value) < SiteReach::near * update.spacing)) continue;
      meet_body(slot, r, cell, x, half, rigid.motion.pose.turn_to_world(to.normal));
    }
  }
  /// out: the normal of the face that is nearest to the particle: soil at another face of a thin plate does
  /// not count. Nodes beyond those that the patch's particles reach have none of its sites: all ranks that
  /// reach a site then hold it.
  KOKKOS_INLINE_FUNCTION void meet_body(int slot, int r, const Coord<Dim>& cell, const Vector<T, Dim>& x,
                                        const Vector<T, Dim>& half, const Vector<double, Dim>& out) const {
    Coord<Dim> low, size;
    int all = 1;
    for (int d = 0; d < Dim; ++d) {
      const double reach = SiteReach::inflated * half[d] + SiteReach::ahead - SiteReach::behind - 0.5;
      low[d] = static_cast<int>(Kokkos::ceil(2 * (cell[d] + double(x[d]) - reach)));
      size[d] = static_cast<int>(Kokkos::floor(2 * (cell[d] + double(x[d]) + reach))) - low[d] + 1;
      all *= size[d];
    }
    MPM_ROLLED
    for (int m = 0; m < all; ++m) {
      Coord<Dim> node;
      int corner = 0;
      bool reached = true;
      for (int d = 0, rest = m; d < Dim; rest /= size[d], ++d) {
        const int at = low[d] + rest % size[d];
        node[d] = at >> 1, corner |= (at & 1) << d;
        reached = reached && node[d] >= -1 && node[d] <= Patch<Dim>::edge + 1;
      }
      const int i = reached ? node_number(slot, node) : -1;
      if (i < 0 || contact_place(i / cells) == 0) continue;
      const int near = update.near_bodies.number(i / cells, r);
      if (near < 0) continue;
      const int n = number_of(near, contact_place(i / cells), i % cells, corner);
      if (gaps(n) == GapKey::none) continue;
      const Site& site = sites(n);
      T facing = 0;
      Vector<T, Dim> from;
      for (int d = 0; d < Dim; ++d) {
        from[d] = T(node[d] - cell[d]) + site.place[d] - x[d];
        facing += site.normal[d] * static_cast<T>(out[d]);
      }
      if (!(facing > T(SiteReach::facing))) continue;
      const T gap = gap_to_box(from, site.normal, half);
      if (gap < SiteReach::touch) Kokkos::atomic_min(&gaps(n), GapKey::of(gap, rank));
    }
  }

  /// Couples a site that is in touch with soil of this rank to the nodes round it, and counts it there.
  KOKKOS_INLINE_FUNCTION void couple(int n) const {
    if (gaps(n) == GapKey::none) return;
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
