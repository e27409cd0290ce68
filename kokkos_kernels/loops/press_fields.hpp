#pragma once
// Contact of the velocity fields that share a node, in a step.

#include "loops/node_update.hpp"
#include "physics/interface.hpp"

namespace mpm {

/// The nodes of a place, a patch in which several velocity fields are active. Most: fields that a node may
/// have; with two, what a thread holds of them fits in registers.
template <class Space, class T, int Dim, int Most>
struct PressFields {
  using S = SoilTerms<Dim>;
  using B = BoundaryTerms<Dim>;
  using Side = InterfaceSide<T, Dim>;
  using Terms = InterfaceTerms<Dim>;
  using Traction = InterfaceTraction<Dim>;
  static constexpr int cells = Patch<Dim>::cells;
  UpdateNodes<Space, T, Dim> update;
  Interfaces<Space, Dim> of;
  bool has_strength, owns_all;
  /// InterfaceTraction: [place][row][value][node]; empty where no frame wants them.
  Kokkos::View<double*, typename Space::memory_space> tractions;

  /// A node's cell, and where its InterfaceTerms and InterfaceTraction of each row go, values
  /// `cells` apart.
  struct Results {
    NodeCell<T> cell;
    double *sums, *tractions;
  };

  /// Node k of a place. sums: InterfaceTerms of each row, `cells` apart.
  KOKKOS_INLINE_FUNCTION void operator()(int place, int k, double* sums) const {
    Side sides[Most];
    unsigned at_sides = 0;
    Coord<Dim> at{};
    const int found = find_sides(place, k, sides, at, at_sides);
    for (int f = 0; f < of.fields; ++f)
      for (int d = 0; d < Dim; ++d) of.force(force_at(place, f, d, k)) = 0;
    if (found < 2) return;
    const int count = Most == 2 ? 2 : found;
    const std::size_t first = std::size_t(place) * of.rows * Traction::size * cells + k;
    const Results out{cell_of(at, at_sides), sums,
                      tractions.extent(0) > 0 ? tractions.data() + first : nullptr};
    join_welded(sides, count, out);
    solve(sides, count, out);
    for (int n = 0; n < count; ++n)
      for (int d = 0; d < Dim; ++d) {
        of.force(force_at(place, sides[n].field, d, k)) = sides[n].force[d];
        update.nodes.soil(sides[n].i, S::force + d) += static_cast<T>(sides[n].force[d]);
      }
  }

 private:
  KOKKOS_INLINE_FUNCTION NodeCell<T> cell_of(const Coord<Dim>& at, unsigned sides) const {
    const T spacing = update.places.grid.spacing;
    return {spacing, update.face(at, sides), update.rings ? T(at[0]) * spacing : T(0)};
  }
  KOKKOS_INLINE_FUNCTION std::size_t force_at(int place, int field, int d, int k) const {
    return ((std::size_t(place) * of.fields + field) * Dim + d) * cells + k;
  }

  /// The fields with soil at node k of a place, with their velocities as walls and other forces leave them.
  KOKKOS_INLINE_FUNCTION int find_sides(int place, int k, Side* sides, Coord<Dim>& at,
                                        unsigned& at_sides) const {
    constexpr T k_round_off = 64 * Kokkos::Experimental::epsilon<T>::value;
    int count = 0;
    for (int f = 0; f < of.fields; ++f) {
      const int slot = of.slots(place * of.fields + f);
      if (slot < 0) continue;
      at = coord_of<Dim>(k);
      for (int d = 0; d < Dim; ++d) at[d] += update.places.origin(slot)[d];
      const auto node = update.node_of(update.nodes, slot * cells + k, at, true);
      if (!(node.soil[S::mass] > update.mass_cut)) continue;
      at_sides = node.sides;
      Side side;
      side.field = f, side.i = node.i, side.mass = side.moving = node.soil[S::mass], side.welded = count;
      Vector<T, Dim> v_old, a;
      update.accelerate(node.soil, node.inv_m, v_old, a);
      for (int d = 0; d < Dim; ++d) {
        side.velocity[d] = v_old[d] + a[d] * update.dt;
        side.area[d] = node.boundary[B::area + d], side.force[d] = 0;
      }
      const T change = update.dt * Kokkos::sqrt(dot(a, a));
      side.round_off = k_round_off * side.mass * (Kokkos::sqrt(dot(v_old, v_old)) + change);
      apply_walls(update.places.grid, node.sides, side.velocity);
      cancel_at_rollers(update.places.grid, node.sides, side.area);
      side.volume = node.boundary[B::volume];
      side.cloud = cloud_of(side.i, side.volume, at_sides);
      side.strength = has_strength ? update.mean_strength(node.i) : T(0);
      put(sides, count++, side);
    }
    return count;
  }

  /// Makes `side` number n of the sides, by a number that the compiler has where there are but two.
  KOKKOS_INLINE_FUNCTION static void put(Side* sides, int n, const Side& side) {
    if constexpr (Most > 2) {
      sides[n] = side;
    } else if (n == 0) {
      sides[0] = side;
    } else {
      sides[1] = side;
    }
  }

  /// SoilCloud of node i. A plane of symmetry leaves half of the soil in the mesh: the other half is its
  /// image.
  KOKKOS_INLINE_FUNCTION SoilCloud<T, Dim> cloud_of(int i, T volume, unsigned at_sides) const {
    using C = CloudTerms<Dim>;
    SoilCloud<T, Dim> cloud;
    const T scale = volume > 0 ? 1 / volume : T(0);
    for (int d = 0; d < Dim; ++d) cloud.centre[d] = scale * update.nodes.cloud(i, C::way + d);
    Vector<T, Dim> kept = filled<T, Dim>(1);  // 0 across planes of symmetry
    cancel_at_rollers(update.places.grid, at_sides, kept);
    for (int d = 0; d < Dim; ++d) cloud.centre[d] *= kept[d];
    for (int d = 0; d < Dim; ++d)
      for (int e = 0; e < Dim; ++e)
        cloud.spread[d][e] =
            (d == e ? T(1) : kept[d] * kept[e]) * scale * update.nodes.cloud(i, C::spread + C::place(d, e)) -
            cloud.centre[d] * cloud.centre[e];
    return cloud;
  }

  KOKKOS_INLINE_FUNCTION const InterfaceLaw& law_of(const Side& a, const Side& b) const {
    return of.laws(a.field * of.fields + b.field);
  }

  /// Gives fields that are welded, one to the other, the velocity and the acceleration of one field: so the
  /// halves of a body are equal to the whole.
  KOKKOS_INLINE_FUNCTION void join_welded(Side* sides, int count, const Results& out) const {
    for (int n = 0; n < count; ++n)
      for (int m = 0; m < n; ++m)
        if (law_of(sides[m], sides[n]).welded) unite(sides, count, sides[m].welded, sides[n].welded);
    for (int n = 0; n < count; ++n)
      if (sides[n].welded == n) share(sides, count, n, out);
  }
  /// Makes two groups of sides one, with the smaller number.
  KOKKOS_INLINE_FUNCTION static void unite(Side* sides, int count, int a, int b) {
    const int first = a < b ? a : b, second = a < b ? b : a;
    for (int n = 0; n < count; ++n)
      if (sides[n].welded == second) sides[n].welded = first;
  }
  /// Shares momentum and force among the sides of a group by their masses.
  KOKKOS_INLINE_FUNCTION void share(Side* sides, int count, int group, const Results& out) const {
    double mass = 0;
    Vector<double, Dim> momentum{}, force{}, moved{};
    int members = 0;
    for (int n = 0; n < count; ++n) {
      if (sides[n].welded != group) continue;
      ++members, mass += sides[n].mass;
      for (int d = 0; d < Dim; ++d) {
        momentum[d] += update.nodes.soil(sides[n].i, S::momentum + d);
        force[d] += update.nodes.soil(sides[n].i, S::force + d);
        moved[d] += double(sides[n].mass) * sides[n].velocity[d];
      }
    }
    if (members < 2) return;
    for (int n = 0; n < count; ++n)
      for (int m = 0; m < n; ++m)
        if (sides[n].welded == group && sides[m].welded == group) add_shared(sides[m], sides[n], mass, out);
    for (int n = 0; n < count; ++n) {
      if (sides[n].welded != group) continue;
      const double part = sides[n].mass / mass;
      for (int d = 0; d < Dim; ++d) {
        update.nodes.soil(sides[n].i, S::momentum + d) = static_cast<T>(part * momentum[d]);
        sides[n].force[d] += part * force[d] - double(update.nodes.soil(sides[n].i, S::force + d));
        sides[n].velocity[d] = static_cast<T>(moved[d] / mass);
      }
      sides[n].moving = static_cast<T>(mass);
    }
  }
  /// Adds the force that passes from one welded side to another.
  KOKKOS_INLINE_FUNCTION void add_shared(const Side& a, const Side& b, double mass,
                                         const Results& out) const {
    const InterfaceLaw& law = law_of(a, b);
    if (law.row < 0 || !counts(a.i)) return;
    InterfaceImpulse<T, Dim> impulse;
    for (int d = 0; d < Dim; ++d)
      impulse.on_first[d] = static_cast<T>((a.mass * double(update.nodes.soil(b.i, S::force + d)) -
                                            b.mass * double(update.nodes.soil(a.i, S::force + d))) /
                                           mass * update.dt);
    add(law, a, b, impulse, out);
  }

  /// Brings the fields of a node together, pair by pair, until impulses are a thousandth of the first ones.
  KOKKOS_INLINE_FUNCTION void solve(Side* sides, int count, const Results& out) const {
    if (Most == 2 || count == 2) {
      SharedImpulse<T, Dim> so_far;
      press(sides, count, 0, 1, so_far, out);
      return;
    }
    constexpr int k_rounds = 8;
    constexpr T k_small = T(1e-3);
    SharedImpulse<T, Dim> so_far[Most * (Most - 1) / 2];
    T first = 0;
    for (int round = 0; round < k_rounds; ++round) {
      T largest = 0;
      for (int m = 0, pair = 0; m < count; ++m)
        for (int n = m + 1; n < count; ++n, ++pair)
          largest = Kokkos::fmax(largest, press(sides, count, m, n, so_far[pair], out));
      if (largest <= k_small * first) break;
      if (round == 0) first = largest;
    }
  }
  /// Takes contact of two fields, and of those that are welded to them, into their velocities and forces.
  /// so_far: what the two have had in this step. Returns the largest component of the impulse [N s].
  KOKKOS_INLINE_FUNCTION T press(Side* sides, int count, int m, int n, SharedImpulse<T, Dim>& so_far,
                                 const Results& out) const {
    const Side &a = sides[m], &b = sides[n];
    if (a.welded == b.welded) return 0;
    const InterfaceLaw& law = law_of(a, b);
    Meeting<T, Dim> meeting;
    if (!meet(a, b, out.cell, meeting)) return 0;
    const T part = part_of(sides, count, m, n, sharing_area(meeting, out.cell.spacing), out);
    const auto impulse = impulse_between(law, a, b, meeting, out.cell.spacing, update.dt, so_far, part);
    T largest = 0;
    for (int d = 0; d < Dim; ++d) largest = Kokkos::fmax(largest, Kokkos::fabs(impulse.on_first[d]));
    if (law.row >= 0 && counts(a.i)) add(law, a, b, impulse, out);
    Vector<T, Dim> back;
    for (int d = 0; d < Dim; ++d) back[d] = -impulse.on_first[d];
    push(sides, count, m, impulse.on_first, out);
    push(sides, count, n, back, out);
    return largest;
  }
  /// Part that a pair takes of what two groups of welded sides do to each other and the pairs before it have
  /// left: its area [m2] over that of itself and the pairs of the same groups after it. So all have parts by
  /// their areas; one without an area has a part where no pair has one.
  KOKKOS_INLINE_FUNCTION T part_of(const Side* sides, int count, int m, int n, T area,
                                   const Results& out) const {
    const int one = sides[m].welded, other = sides[n].welded;
    T before = 0, after = 0;
    for (int k = 0; k < count; ++k)
      for (int l = k + 1; l < count; ++l) {
        const int a = sides[k].welded, b = sides[l].welded;
        const bool same = (a == one && b == other) || (a == other && b == one);
        Meeting<T, Dim> meeting;
        if (!same || (k == m && l == n) || !meet(sides[k], sides[l], out.cell, meeting)) continue;
        (k < m || (k == m && l < n) ? before : after) += sharing_area(meeting, out.cell.spacing);
      }
    if (area > 0) return area / (area + after);
    return before + after > 0 ? T(0) : T(1);
  }
  /// Gives an impulse [N s] on a side to all that are welded to it, by their masses.
  KOKKOS_INLINE_FUNCTION void push(Side* sides, int count, int m, const Vector<T, Dim>& impulse,
                                   const Results& out) const {
    const int group = sides[m].welded;
    const T inverse = 1 / sides[m].moving;
    for (int k = 0; k < count; ++k) {
      Side& side = sides[k];
      if (side.welded != group) continue;
      const double part = double(side.mass) * inverse;
      for (int d = 0; d < Dim; ++d) {
        side.velocity[d] += impulse[d] * inverse;
        side.force[d] += part * double(impulse[d]) * update.inv_dt;
      }
      if (k != m)
        add_passed(sides[Kokkos::min(k, m)], sides[Kokkos::max(k, m)], impulse, k < m ? part : -part, out);
    }
  }
  /// Adds what a weld passes on: a part of an impulse, on its first side.
  KOKKOS_INLINE_FUNCTION void add_passed(const Side& a, const Side& b, const Vector<T, Dim>& impulse,
                                         double part, const Results& out) const {
    const InterfaceLaw& law = law_of(a, b);
    if (law.row < 0 || !counts(a.i)) return;
    InterfaceImpulse<T, Dim> passed;
    for (int d = 0; d < Dim; ++d) passed.on_first[d] = static_cast<T>(part * double(impulse[d]));
    add(law, a, b, passed, out);
  }
  /// Whether this rank reports a node.
  KOKKOS_INLINE_FUNCTION bool counts(int i) const {
    return owns_all || (update.owned_nodes(i / cells) >> (i % cells) & 1) != 0;
  }
  KOKKOS_INLINE_FUNCTION void add(const InterfaceLaw& law, const Side& a, const Side& b,
                                  const InterfaceImpulse<T, Dim>& impulse, const Results& out) const {
    double* const own = out.sums + law.row * Terms::size * cells;
    for (int d = 0; d < Dim; ++d) own[(Terms::impulse + d) * cells] += law.sign * double(impulse.on_first[d]);
    own[Terms::area * cells] += double(impulse.area) * update.dt;
    own[Terms::work * cells] += impulse.work;
    if (out.tractions != nullptr) show(law, a, b, impulse, out);
  }
  /// Stores the traction of a pair at a node, for a frame.
  KOKKOS_INLINE_FUNCTION void show(const InterfaceLaw& law, const Side& a, const Side& b,
                                   const InterfaceImpulse<T, Dim>& impulse, const Results& out) const {
    Meeting<T, Dim> meeting;
    if (!meet(a, b, out.cell, meeting)) return;
    double* const own = out.tractions + law.row * Traction::size * cells;
    for (int d = 0; d < Dim; ++d) {
      own[(Traction::force + d) * cells] += law.sign * double(impulse.on_first[d]) * update.inv_dt;
      own[(Traction::normal + d) * cells] = law.sign * double(meeting.normal[d]);
    }
    own[Traction::area * cells] = meeting.area;
  }
};

}  // namespace mpm
