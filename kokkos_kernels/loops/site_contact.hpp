#pragma once
// Passes of contact at sites in a step: over sites, over the particles near them, and over nodes.

#include "data/state.hpp"
#include "loops/node_update.hpp"
#include "physics/contact_site.hpp"

namespace mpm {

/// Contact of all rigid bodies with `at_sites` in a step of dt [s], behind update_nodes (docs/method.md,
/// "Contact at sites"). Each method is the work of one index of a pass (functions/contact_sites.cpp).
template <class Space, class T, int Dim>
struct SiteContact {
  using Terms = SiteTerms<Dim>;
  using Site = ContactSite<T, Dim>;
  static constexpr int cells = Patch<Dim>::cells, corners = k_sites<Dim>;
  static constexpr int momentum = SiteSums<Dim>::momentum, given = SiteSums<Dim>::given;
  static constexpr double k_faster = 3;      // the mean is of a third of the time at nodes: contact moves on
  static constexpr double k_whole = 0x1p50;  // of a site in SiteSums::sites

  UpdateNodes<Space, T, Dim> update;
  Soil<Space, T, Dim> soil;
  decltype(Bins<Space>::begin) begin;
  ContactPlaces<Space> contact_place;
  Kokkos::View<int*, typename Space::memory_space> contact_slots;
  Kokkos::View<Site*, typename Space::memory_space> sites;
  Kokkos::View<std::uint64_t*, typename Space::memory_space> gaps;
  decltype(ContactSites<Space, T, Dim>::sums) sums;
  int count;    // slots where a contact may be
  double unit;  // kg m/s, of SiteSums::momentum
  T fresh;      // -, weight of a step in the mean normal impulse

  SiteContact(const State<Space, T, Dim>& s, double dt)
      : update(node_update_of(s, dt)),
        soil(s.soil.points),
        begin(s.soil.bins.begin),
        contact_place(s.contact.place),
        contact_slots(s.contact.slots),
        sites(s.at_sites.sites),
        gaps(s.at_sites.gaps),
        sums(s.at_sites.sums),
        count(s.contact.count),
        unit(s.at_sites.mass * s.spacing / dt * 0x1p-52),
        fresh(static_cast<T>(-std::expm1(-k_faster * dt / s.friction_time))) {}

  /// A site: its body, and its node by slot and place.
  struct Place {
    int rigid, slot, k, corner;  // corner: bit d, half a cell along d from the node
  };
  KOKKOS_INLINE_FUNCTION int sites_of_body() const { return count * cells * corners; }
  KOKKOS_INLINE_FUNCTION Place place_of_site(int n) const {
    const int at = n % sites_of_body();
    return {n / sites_of_body(), contact_slots(at / (cells * corners)), at / corners % cells, at % corners};
  }
  /// Number of the site at a corner of a node of a contact slot, by the place of the slot from 1 on.
  KOKKOS_INLINE_FUNCTION int number_of(int rigid, int place, int k, int corner) const {
    return ((rigid * count + place - 1) * cells + k) * corners + corner;
  }
  /// Number of the sums of a node; negative where no contact may be.
  KOKKOS_INLINE_FUNCTION int sums_of(int node) const {
    return node < 0 ? -1 : (contact_place(node / cells) - 1) * cells + node % cells;
  }
  /// Number of the node at c of a slot, where c may reach into the slots around it; -1: there is none.
  KOKKOS_INLINE_FUNCTION int node_number(int slot, const Coord<Dim>& c) const {
    return number_at<decltype(update.places.neighbours), Dim>(update.places.neighbours, slot, c);
  }
  KOKKOS_INLINE_FUNCTION const Rigid<Dim>& body(int r) const { return update.rigids(r); }
  KOKKOS_INLINE_FUNCTION Coord<Dim> node_at(const Place& of) const {
    Coord<Dim> at = coord_of<Dim>(of.k);
    for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(of.slot)[d];
    return at;
  }

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
    for (int r = 0; r < static_cast<int>(update.rigids.extent(0)); ++r) {
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
  /// not count.
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
      for (int d = 0, rest = m; d < Dim; rest /= size[d], ++d) {
        const int at = low[d] + rest % size[d];
        node[d] = at >> 1, corner |= (at & 1) << d;
      }
      const int i = node_number(slot, node);
      if (i < 0 || contact_place(i / cells) == 0) continue;
      const int n = number_of(r, contact_place(i / cells), i % cells, corner);
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
      if (gap < SiteReach::touch) Kokkos::atomic_min(&gaps(n), GapKey::of(gap));
    }
  }

  /// Calls f(node, weight [-]) for the nodes round a site's place.
  template <class F>
  KOKKOS_INLINE_FUNCTION void for_each_hat(const Place& of, const Site& site, F&& f) const {
    Coord<Dim> first = coord_of<Dim>(of.k);
    Vector<T, Dim> upper;
    for (int d = 0; d < Dim; ++d) {
      const T below = Kokkos::floor(site.place[d]);
      first[d] += static_cast<int>(below);
      upper[d] = site.place[d] - below;
    }
    for (int m = 0; m < corners; ++m) {
      Coord<Dim> c = first;
      T weight = 1;
      for (int d = 0; d < Dim; ++d) {
        c[d] += m >> d & 1;
        weight *= m >> d & 1 ? upper[d] : 1 - upper[d];
      }
      f(m, node_number(of.slot, c), weight);
    }
  }

  /// Whether the soil is in touch, with which nodes, and how many sites share these.
  KOKKOS_INLINE_FUNCTION void couple(int n) const {
    if (gaps(n) == GapKey::none) return;
    Site& site = sites(n);
    site.inverse_mass = 0;
    if (gaps(n) == GapKey::open) return;
    const Place of = place_of_site(n);
    const T gap = static_cast<T>(GapKey::gap(gaps(n)));
    const ContactLaw& law = body(of.rigid).law;
    if (!law.separates && !(gap < T(SiteReach::cling))) return;
    for (int d = 0; d < Dim; ++d) site.place[d] += gap * site.normal[d];
    site.gap = gap * update.places.grid.spacing;
    constexpr T k_round_off = T(1e-6);  // of a weight: the place is on a row of nodes
    T sum = 0;
    for_each_hat(of, site, [&](int m, int i, T weight) {
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
    for_each_hat(of, site, [&](int m, int i, T) {
      if (site.share[m] > 0) add(i, SiteSums<Dim>::sites, double(site.part) * site.share[m] * k_whole);
    });
  }

  /// Whether a site has a contact in this step.
  KOKKOS_INLINE_FUNCTION bool acts(int n) const {
    return gaps(n) != GapKey::none && gaps(n) != GapKey::open && sites(n).inverse_mass > 0;
  }

  /// Begins the impulse of a site with that of the step before, and gives it to the nodes.
  KOKKOS_INLINE_FUNCTION void begin_impulse(int n) const {
    if (!acts(n)) return;
    const Place of = place_of_site(n);
    Site& site = sites(n);
    T inverse_mass = 0;
    for_each_hat(of, site, [&](int m, int i, T) {
      if (site.share[m] > 0)
        inverse_mass += site.share[m] * static_cast<T>(sums(sums_of(i), SiteSums<Dim>::sites) / k_whole) /
                        update.nodes.soil(i, SoilTerms<Dim>::mass);
    });
    site.inverse_mass = inverse_mass / site.part;
    load(of, site);
    Impulse<T, Dim> whole;
    for (int d = 0; d < Dim; ++d) whole[d] = site.press * site.normal[d] + site.shear[d];
    give(of, site, whole);
  }

  /// Brings an impulse of a site towards contact without interpenetration, from the velocities of its nodes.
  KOKKOS_INLINE_FUNCTION void sweep(int n) const {
    if (!acts(n)) return;
    const Place of = place_of_site(n);
    Site& site = sites(n);
    Vector<T, Dim> v = filled<T, Dim>(0);
    T pressed = 0;
    for_each_hat(of, site, [&](int m, int i, T) {
      if (!(site.share[m] > 0)) return;
      for (int d = 0; d < Dim; ++d) {
        v[d] += site.share[m] * update.nodes.kinematics(i, NodeKinematics<Dim>::velocity + d);
        pressed += site.share[m] * static_cast<T>(sums(sums_of(i), given + d) * unit) * site.normal[d];
      }
    });
    for (int d = 0; d < Dim; ++d) v[d] -= site.velocity[d];
    const ContactLaw& law = body(of.rigid).law;
    const SiteInterface<T> interface {
      shear_limit(of, site, law), fresh, update.inv_dt* update.share, pressed
    };
    give(of, site, resolve(site, law, v, interface));
  }

  /// Gives node number k of the contact slots what the sites have for it. Walls hold what they held.
  KOKKOS_INLINE_FUNCTION void take(int k) const {
    const int i = contact_slots(k / cells) * cells + k % cells;
    bool moves = false;
    for (int d = 0; d < Dim; ++d) moves = moves || sums(k, momentum + d) != 0;
    if (!moves) return;
    const T m_i = update.nodes.soil(i, SoilTerms<Dim>::mass);
    Vector<T, Dim> v;
    for (int d = 0; d < Dim; ++d) {
      v[d] = update.nodes.kinematics(i, NodeKinematics<Dim>::velocity + d) +
             static_cast<T>(sums(k, momentum + d) * unit / m_i);
      sums(k, given + d) += sums(k, momentum + d);
      sums(k, momentum + d) = 0;
    }
    Coord<Dim> at = coord_of<Dim>(i);
    for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(i / cells)[d];
    apply_walls(update.places.grid, sides_of(update.places.grid, at), v);
    for (int d = 0; d < Dim; ++d) update.nodes.kinematics(i, NodeKinematics<Dim>::velocity + d) = v[d];
  }

  /// Brakes node number k of the contact slots by local damping of the acceleration that contact leaves.
  KOKKOS_INLINE_FUNCTION void brake(int k) const {
    const auto [node, v_old] = node_and_velocity(k);
    if (!(node.inv_m > 0)) return;
    Vector<T, Dim> a;
    for (int d = 0; d < Dim; ++d)
      a[d] = (update.nodes.kinematics(node.i, NodeKinematics<Dim>::velocity + d) - v_old[d]) * update.inv_dt;
    const Vector<T, Dim> brake = update.braking(a, v_old);
    for (int d = 0; d < Dim; ++d)
      update.nodes.kinematics(node.i, NodeKinematics<Dim>::velocity + d) -= brake[d] * update.dt;
  }

  /// Force of the sites on a node over its mass [m/s2], after begin_impulse alone.
  KOKKOS_INLINE_FUNCTION T reaction(int i, T inv_m, int d) const {
    return sums_of(i) < 0 ? T(0)
                          : static_cast<T>(sums(sums_of(i), momentum + d) * unit) * inv_m * update.inv_dt;
  }

  /// Ends node number k of the contact slots: sides that act, and its acceleration.
  KOKKOS_INLINE_FUNCTION void end_node(int k) const {
    const auto [node, v_old] = node_and_velocity(k);
    if (!(node.inv_m > 0)) return;
    KinematicValues<T, Dim> kinematics;
    Vector<T, Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = update.nodes.kinematics(node.i, NodeKinematics<Dim>::velocity + d);
    if (node.acting != 0) v = by_sides(update.acting_sides, update.side_node(node, true), v_old, v, false);
    apply_walls(update.places.grid, node.sides, v);
    for (int d = 0; d < Dim; ++d) {
      kinematics.c[NodeKinematics<Dim>::velocity + d] = v[d];
      kinematics.c[NodeKinematics<Dim>::acceleration + d] = (v[d] - v_old[d]) * update.inv_dt * update.share;
    }
    update.keep(node.i, kinematics);
  }

  /// Ends the sites of body r in contact slot number n, and leaves the force of the soil on it there. force:
  /// [Wrench::size][cells]
  template <class Team>
  KOKKOS_INLINE_FUNCTION void end_body(const Team& team, int r, int n, double* force) const {
    if (!body(r).law.at_sites) return;
    const int size = update.wrench();
    for_team(team, cells, [&](int k) {
      for (int v = 0; v < size; ++v) force[v * cells + k] = 0;
      const int i = contact_slots(n) * cells + k;
      const auto& owned = update.owned_nodes;
      end_sites(r, n + 1, k, force + k);
      if (owned.extent(0) == 0 || (owned(i / cells) >> (i % cells) & 1) != 0) return;
      for (int v = 0; v < size; ++v) force[v * cells + k] = 0;  // another rank reports it
    });
    team.team_barrier();
    for_team(team, size, [&](int v) {
      double sum = 0;
      for (int k = 0; k < cells; ++k) sum += force[v * cells + k];
      update.forces(n * update.value_count + r * size + v) = sum;
    });
  }

 private:
  /// Keeps the impulses of the sites of a node for the next step, and adds those on body r to
  /// force[0], force[cells] ... [N].
  KOKKOS_INLINE_FUNCTION void end_sites(int r, int place, int k, double* force) const {
    for (int corner = 0; corner < corners; ++corner) {
      const int n = number_of(r, place, k, corner);
      const bool in_touch = acts(n);
      const Place of = place_of_site(n);
      keep(of, in_touch ? &sites(n) : nullptr);
      if (in_touch) add_force(of, sites(n), force);
    }
  }

  struct NodeAndVelocity {
    typename UpdateNodes<Space, T, Dim>::Node node;
    Vector<T, Dim> v_old;
  };
  KOKKOS_INLINE_FUNCTION NodeAndVelocity node_and_velocity(int k) const {
    const int i = contact_slots(k / cells) * cells + k % cells;
    Coord<Dim> at = coord_of<Dim>(i);
    for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(i / cells)[d];
    NodeAndVelocity of{update.node_of(update.nodes, i, at, true), {}};
    Vector<T, Dim> a;
    if (of.node.inv_m > 0) update.accelerate(of.node.soil, of.node.inv_m, of.v_old, a);
    return of;
  }

  KOKKOS_INLINE_FUNCTION void add(int node, int term, double value) const {
    Kokkos::atomic_add(&sums(sums_of(node), term), static_cast<std::int64_t>(Kokkos::round(value)));
  }
  KOKKOS_INLINE_FUNCTION void give(const Place& of, const Site& site, const Impulse<T, Dim>& impulse) const {
    for_each_hat(of, site, [&](int m, int i, T) {
      if (!(site.share[m] > 0)) return;
      for (int d = 0; d < Dim; ++d)
        if (impulse[d] != 0) add(i, momentum + d, double(site.share[m]) * impulse[d] / unit);
    });
  }

  /// Largest shear impulse [N s] of the interface at a site by its shear limit, infinite without one.
  KOKKOS_INLINE_FUNCTION T shear_limit(const Place& of, const Site& site, const ContactLaw& law) const {
    T limit = static_cast<T>(law.shear_limit);
    if (law.shear_fraction >= 0) {
      T strength = 0, volume = 0;
      for_each_hat(of, site, [&](int m, int i, T) {
        if (!(site.share[m] > 0)) return;
        strength += site.share[m] * update.nodes.strength(i, StrengthTerms::strength);
        volume += site.share[m] * update.nodes.strength(i, StrengthTerms::volume);
      });
      limit = volume > 0 ? static_cast<T>(law.shear_fraction) * (strength / volume) : T(0);
    }
    if (!(limit < Kokkos::Experimental::infinity<T>::value) || limit == 0) return limit;
    return limit * area(of, site) * update.dt;
  }
  /// Area of the soil's boundary at a site, towards the body [m2; m in 2D]: the sites of a node share its
  /// area, as they share its mass.
  KOKKOS_INLINE_FUNCTION T area(const Place& of, const Site& site) const {
    T area = 0;
    for_each_hat(of, site, [&](int m, int i, T) {
      if (!(site.share[m] > 0)) return;
      Coord<Dim> at = coord_of<Dim>(i);
      Vector<T, Dim> boundary;
      for (int d = 0; d < Dim; ++d) {
        at[d] += update.places.origin(i / cells)[d];
        boundary[d] = update.nodes.boundary(i, BoundaryTerms<Dim>::area + d);
      }
      cancel_at_rollers(update.places.grid, sides_of(update.places.grid, at), boundary);
      const T sharing = static_cast<T>(sums(sums_of(i), SiteSums<Dim>::sites) / k_whole);
      area += site.share[m] * Kokkos::fmax(T(0), -dot(boundary, site.normal)) / sharing;
    });
    return site.part * area;
  }

  KOKKOS_INLINE_FUNCTION T& kept(const Place& of, int node, int corner, int term) const {
    return update.nodes.impulse(update.impulse_stride * of.rigid + corner * Terms::size + term, node);
  }
  KOKKOS_INLINE_FUNCTION bool is_in_touch(int rigid, int node, int corner) const {
    const int place = contact_place(node / cells);
    return place > 0 && acts(number_of(rigid, place, node % cells, corner));
  }
  /// Loads what a site kept. One that had no contact takes what the next one along the normal had, where that
  /// has none now: the face has moved on.
  KOKKOS_INLINE_FUNCTION void load(const Place& of, Site& site) const {
    int node = of.slot * cells + of.k, corner = of.corner;
    if (kept(of, node, corner, Terms::weight) == 0) {
      T most = 0;
      for (int sign = -1; sign <= 1; sign += 2) {
        Coord<Dim> c = coord_of<Dim>(of.k);
        int there = 0;
        for (int d = 0; d < Dim; ++d) {
          const int step = site.normal[d] > T(0.5) ? 1 : site.normal[d] < T(-0.5) ? -1 : 0;
          const int half = 2 * c[d] + (of.corner >> d & 1) + sign * step;
          c[d] = half >> 1, there |= (half & 1) << d;
        }
        const int i = node_number(of.slot, c);
        if (i < 0 || !(kept(of, i, there, Terms::normal) > most) || is_in_touch(of.rigid, i, there)) continue;
        most = kept(of, i, there, Terms::normal);
        node = i, corner = there;
      }
    }
    site.press = kept(of, node, corner, Terms::normal) * update.dt;
    for (int d = 0; d < Dim; ++d) site.shear[d] = kept(of, node, corner, Terms::shear + d) * update.dt;
    const T across = dot(site.shear, site.normal);
    for (int d = 0; d < Dim; ++d) site.shear[d] -= across * site.normal[d];
    site.sum = kept(of, node, corner, Terms::sum) * (1 - fresh);
    site.weight = kept(of, node, corner, Terms::weight) * (1 - fresh);
    site.store = kept(of, node, corner, Terms::store) * kept_share(ImpulseTerms::store, update.fresh);
  }
  /// Keeps what a site has for the next step; null: it has no contact.
  KOKKOS_INLINE_FUNCTION void keep(const Place& of, const Site* site) const {
    T values[Terms::size] = {};
    const T friction = static_cast<T>(body(of.rigid).law.friction);
    if (site != nullptr) {
      values[Terms::normal] = site->press * update.inv_dt;
      for (int d = 0; d < Dim; ++d) values[Terms::shear + d] = site->shear[d] * update.inv_dt;
      Pressed<T> pressed{site->sum, site->weight, site->store};
      usable_impulse(pressed, fresh, site->press);
      values[Terms::sum] = pressed.sum, values[Terms::weight] = pressed.weight;
      if (friction > 0)
        values[Terms::store] =
            Kokkos::fmax(T(0), pressed.store - Kokkos::sqrt(dot(site->shear, site->shear)) / friction);
    }
    for (int term = 0; term < Terms::size; ++term)
      kept(of, of.slot * cells + of.k, of.corner, term) = values[term];
  }
  KOKKOS_INLINE_FUNCTION void add_force(const Place& of, const Site& site, double* force) const {
    Vector<double, Dim> given;  // N, to the soil
    for (int d = 0; d < Dim; ++d) {
      given[d] = (double(site.press) * site.normal[d] + site.shear[d]) * update.inv_dt;
      force[(Wrench<Dim>::force + d) * cells] -= given[d];
    }
    const RigidPose<Dim>& pose = body(of.rigid).motion.pose;
    if (!update.turns || !pose.turns) return;
    const Coord<Dim> at = node_at(of);
    const auto in_space = [&](int d) { return (at[d] + double(site.place[d])) * update.spacing; };
    const AngularVector<Dim> moment = moment_of(pose.arm_to(in_space), given);
    for (int k = 0; k < k_turning_axes<Dim>; ++k) force[(Wrench<Dim>::moment + k) * cells] -= moment[k];
  }
};

}  // namespace mpm
