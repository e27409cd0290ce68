#pragma once
// Update of a node in a step (function 4): its velocity and acceleration, the walls, and contact.

#include <cmath>

#include "base/lanes.hpp"
#include "base/serial_team.hpp"
#include "data/state.hpp"
#include "device/warp.hpp"
#include "loops/particle_to_node.hpp"
#include "loops/window.hpp"
#include "physics/contact.hpp"
#include "physics/light_touch.hpp"
#include "physics/local_damping.hpp"
#include "physics/sides.hpp"
#include "physics/surface.hpp"

namespace mpm {

/// Threads of a team that takes the nodes of a slot.
template <class Space, int Dim>
inline constexpr int node_threads = is_device<Space> ? Patch<Dim>::cells : 1;

/// Sets the sums of a slot's nodes to zero, neighbours in memory by neighbouring threads.
template <class Team, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION void clear_sums(const Team& team, const NodeSums<Space, T, Dim>& nodes, int slot,
                                       bool boundary, int rigids) {
  constexpr int cells = Patch<Dim>::cells;
  const auto clear = [&](T* values, int count) { for_team(team, count, [&](int n) { values[n] = 0; }); };
  clear(&nodes.soil(slot * cells, 0), cells * SoilTerms<Dim>::size);
  if (boundary) clear(&nodes.boundary(slot * cells, 0), cells * BoundaryTerms<Dim>::size);
  for (int r = 0; r < rigids; ++r) clear(&nodes.rigid(r, slot * cells, 0), cells * RigidTerms<Dim>::size);
}

/// The node's part of the step. acts: some side of the mesh acts (data/sides.hpp), local damping does, or a
/// rigid may turn, is light or has several parts; kernels without that take less time on a GPU.
template <class Space, class T, int Dim, bool acts = true>
struct UpdateNodes {
  using S = SoilTerms<Dim>;
  static constexpr int cells = Patch<Dim>::cells;
  /// Nodes whose systems of light bodies are apart in memory: those of a slot, each the work of a thread.
  static constexpr int light_stride = is_device<Space> ? cells : 1;
  int value_count;  // of the wrenches on the rigids near a slot, and on parts
  NodePlaces<Space, T, Dim> places;
  Nodes<Space, T, Dim> nodes;
  Kokkos::View<Rigid<Dim>*, typename Space::memory_space> rigids;
  SurfaceTables<typename Space::memory_space, Dim> vertices;
  NearBodies<Space> near_bodies;
  const Surface<Dim>* parts;      // surfaces of the parts of rigids; null where no forces on parts are wanted
  const LightMotion<Dim>* light;  // velocity of light rigids, by number; null where there are none
  Kokkos::View<double*, typename Space::memory_space> forces;
  Kokkos::View<std::uint64_t*, typename Space::memory_space> owned_nodes;
  Vector<T, Dim> g;
  const Vector<T, Dim>* timed_g;  // of the present step, where gravity follows a table; else null
  struct NoSides {};
  std::conditional_t<acts, ActingSides<Dim>, NoSides> acting_sides;
  T dt,
      inv_dt;  // s, 1/s: of the change of velocities, from the middle of the step before to that of this one
  T share;     // -, dt over the length of the step
  T damping;
  T fresh;  // -, weight of a step in the mean normal impulse
  T mass_cut;
  double spacing;
  int impulse_stride;  // of a rigid in Nodes::impulse
  bool has_boundary, has_friction, has_mass_normals, clears, rings, turns, at_sites;

  /// The nodes of a slot, number n of those near a rigid, under their sums. Leaves the force on each rigid
  /// [N] in `forces`, summed in an order that is always the same. force: [values][cells]
  template <class Team, class Sums>
  KOKKOS_INLINE_FUNCTION void update_near(const Team& team, const Sums& sums, int slot, int n,
                                          double* force) const {
    const int values = near_bodies.listed ? bodies_near(slot) * wrench() : value_count;
    for_team(team, cells, [&](int k) {
      for (int v = 0; v < values; ++v) force[v * cells + k] = 0;
      update<true>(sums, slot * cells + k, force + k);
      if constexpr (acts)
        if (parts != nullptr) share_with_parts(slot * cells + k, force + k);
      if (owned_nodes.extent(0) == 0 || (owned_nodes(slot) >> k & 1) != 0) return;
      for (int v = 0; v < values; ++v) force[v * cells + k] = 0;  // another rank reports it
    });
    team.team_barrier();
    leave_forces(team, force, values, n);
    if (clears) clear_sums(team, nodes, slot, has_boundary, has_mass_normals ? rigids.extent(0) : 0);
  }

  /// Adds the force of node i on each rigid to that on the nearest of its parts. force: as in kinematics.
  MPM_SELDOM_FUNCTION void share_with_parts(int i, double* force) const {
    Coord<Dim> at = coord_of<Dim>(i);
    const Coord<Dim> from = places.origin(i / cells);
    for (int d = 0; d < Dim; ++d) at[d] += from[d];
    for (int r = 0; r < near_bodies.width; ++r) {
      const auto x = rigids(r).motion.pose.to_body(place_at(at));
      const int part = nearest_part(rigids(r).surface, parts, vertices, x);
      for (int k = 0; k < wrench() && part >= 0; ++k)
        force[((near_bodies.width + part) * wrench() + k) * cells] += force[(r * wrench() + k) * cells];
    }
  }

  /// Number of rigid bodies near a slot; without lists, of all.
  KOKKOS_INLINE_FUNCTION int bodies_near(int slot) const {
    int n = near_bodies.listed ? 0 : near_bodies.width;
    while (n < near_bodies.width && near_bodies.of(slot * near_bodies.width + n) >= 0) ++n;
    return n;
  }

  /// Sums the forces on the rigids of a slot's nodes, number n of those near a rigid: a warp each. Only the
  /// first `values` are there.
  template <class Team>
  KOKKOS_INLINE_FUNCTION void leave_forces(const Team& team, const double* force, int values, int n) const {
    const int thread = team.team_rank(), size = team.team_size(), lanes = size < k_warp ? size : k_warp;
    for (int v = thread / k_warp; v < value_count; v += (size + k_warp - 1) / k_warp) {
      double sum = 0;
      for (int k = thread % k_warp; v < values && k < cells; k += lanes) sum += force[v * cells + k];
      sum = sum_of_warp(sum);
      if (thread % k_warp == 0) forces(n * value_count + v) = sum;
    }
  }

  /// Updates node i. near: a rigid may touch it; the kernel of the nodes far from all has no contact in it.
  template <bool near, class Sums>
  KOKKOS_INLINE_FUNCTION void update(const Sums& sums, int i, double* force) const {
    Coord<Dim> at = coord_of<Dim>(i);
    const Coord<Dim> from = places.origin(i / cells);
    for (int d = 0; d < Dim; ++d) at[d] += from[d];
    keep(i, kinematics<near>(sums, rigids.data(), i, at, near, force));
  }
  /// Rigids, of which value_count has the numbers of their wrenches.
  KOKKOS_INLINE_FUNCTION int rigid_count() const { return value_count / wrench(); }
  /// Numbers of a wrench.
  KOKKOS_INLINE_FUNCTION int wrench() const { return wrench_size<Dim>(acts && turns); }

  /// Mass [kg] below which a node is at rest: so little that 1 / m_i might overflow.
  KOKKOS_INLINE_FUNCTION T at_rest() const { return T(1e-12) * mass_cut; }

  /// Gravity in this step [m/s2].
  KOKKOS_INLINE_FUNCTION Vector<T, Dim> gravity() const { return timed_g == nullptr ? g : *timed_g; }

  /// Deceleration by local damping where the acceleration is a and the velocity was v_old, by number or by
  /// lane [m/s2].
  template <class R>
  KOKKOS_FORCEINLINE_FUNCTION Vector<R, Dim> braking(const Vector<R, Dim>& a,
                                                     const Vector<R, Dim>& v_old) const {
    return local_damping<T>(acts ? damping : T(0), dt, a, v_old);
  }

  /// Velocity of a node before the step, and its acceleration by internal force and gravity, by number or by
  /// lane. inv_m: 1 / its mass
  template <class R>
  KOKKOS_FORCEINLINE_FUNCTION void accelerate(const R (&soil)[S::size], R inv_m, Vector<R, Dim>& v_old,
                                              Vector<R, Dim>& a) const {
    const Vector<T, Dim> g_now = gravity();
    const R inv_m_force = select(soil[S::mass] > mass_cut, inv_m, R(0));  // on less mass it is round-off
    for (int d = 0; d < Dim; ++d) {
      v_old[d] = soil[S::momentum + d] * inv_m;            // Eq. (6)
      a[d] = soil[S::force + d] * inv_m_force + g_now[d];  // Eq. (8)
    }
  }

  KOKKOS_INLINE_FUNCTION void keep(int i, const KinematicValues<T, Dim>& kinematics) const {
    *reinterpret_cast<KinematicValues<T, Dim>*>(&nodes.kinematics(i, 0)) = kinematics;
  }

  /// A node and what it was given.
  struct Node {
    int i;
    Coord<Dim> at;
    unsigned sides, acting;  // sides of the mesh that it lies on, and those of them that act
    int touching;            // rigids that may touch it: the first of those near its slot
    bool near;               // it is in a slot where a contact may be
    T soil[S::size], boundary[BoundaryTerms<Dim>::size];
    T inv_m;

    /// Whether more than walls may hold it.
    KOKKOS_INLINE_FUNCTION bool is_held() const { return touching > 0 || acting != 0; }
  };

  /// Node i, which is `at`, under its sums, with the forces of sides; near: a rigid may touch it.
  template <class Sums>
  KOKKOS_INLINE_FUNCTION Node node_of(const Sums& sums, int i, const Coord<Dim>& at, bool near) const {
    Node node{i, at, 0, 0, 0, near, {}, {}, 0};
    for (int n = 0; n < S::size; ++n) node.soil[n] = sums.soil(i, n);  // all asked for at once
    if (near && has_boundary)
      for (int n = 0; n < BoundaryTerms<Dim>::size; ++n) node.boundary[n] = sums.boundary(i, n);
    const T m_i = node.soil[S::mass];
    if (!(m_i > at_rest())) return node;
    node.inv_m = 1 / m_i;
    node.sides = sides_of(places.grid, at);
    if (near && m_i > mass_cut) node.touching = near_bodies.width;
    if constexpr (acts) {
      node.acting = node.sides & acting_sides.mask;
      if (node.acting != 0) add_reactions(acting_sides, side_node(node, false), &node.soil[S::force]);
    }
    return node;
  }

  /// Motion of a node after the step; bodies: the rigids; near: one of them may touch the node. Without
  /// `touches` the kernel has no contact. Adds component k of the wrench on the rigid that is number n near
  /// the slot to force[(n Wrench::size + k) cells], unless it is null.
  template <bool touches = true, class Sums>
  KOKKOS_INLINE_FUNCTION KinematicValues<T, Dim> kinematics(const Sums& sums, const Rigid<Dim>* bodies, int i,
                                                            const Coord<Dim>& at, bool near,
                                                            double* force) const {
    MPM_ROLLED
    for (int m = 0; m < near_bodies.width && has_friction; ++m) {
      const int r = near_bodies.body(i / cells, m);
      if constexpr (is_device<Space>)
        if (r < 0) break;  // of a list; processors do without, since gcc then contracts other products
      if (r >= 0 && bodies[r].law.at_sites) continue;  // sites keep numbers of their own
      for (int n = 0; n < ImpulseTerms::size; ++n)
        nodes.impulse(impulse_stride * m + n, i) *= kept_share(n, fresh);
    }
    const Node node = node_of(sums, i, at, near);
    Vector<T, Dim> v_old = filled<T, Dim>(0), v = v_old, a, brake;
    if (node.inv_m > 0) {
      accelerate(node.soil, node.inv_m, v_old, a);
      v = advanced<touches>(sums, bodies, node, v_old, a, true, force, brake);
    }
    KinematicValues<T, Dim> kinematics;
    for (int d = 0; d < Dim; ++d) {
      kinematics.c[NodeKinematics<Dim>::velocity + d] = v[d];
      kinematics.c[NodeKinematics<Dim>::acceleration + d] =
          (v[d] - v_old[d]) * inv_dt * share;  // feels contact and walls
    }
    return kinematics;
  }

  /// Adds what contact at node i does to the light bodies near it to system[0], system[light_stride] ...,
  /// as LightTerms for each body near the slot. Nothing is kept. damps: with local damping.
  template <class Sums>
  KOKKOS_INLINE_FUNCTION void rehearse(const Sums& sums, int i, bool damps, double* system) const {
    Coord<Dim> at = coord_of<Dim>(i);
    const Coord<Dim> from = places.origin(i / cells);
    for (int d = 0; d < Dim; ++d) at[d] += from[d];
    const Node node = node_of(sums, i, at, true);
    if (!(node.inv_m > 0 && node.touching > 0)) return;
    Vector<T, Dim> v_old, a, v, brake;
    accelerate(node.soil, node.inv_m, v_old, a);
    if (damps) {
      advanced<true, true>(sums, rigids.data(), node, v_old, a, true, system, brake);
    } else {
      for (int d = 0; d < Dim; ++d) v[d] = v_old[d] + a[d] * dt;
      constrain<true, true>(sums, rigids.data(), node, v_old, v, false, system);
    }
  }

  /// Acceleration a of a node as contact and sides leave it, without damping [m/s2].
  template <bool touches = true, class Sums>
  KOKKOS_INLINE_FUNCTION Vector<T, Dim> held_acceleration(const Sums& sums, const Rigid<Dim>* bodies,
                                                          const Node& node, const Vector<T, Dim>& v_old,
                                                          Vector<T, Dim> a) const {
    Vector<T, Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = v_old[d] + a[d] * dt;
    constrain<touches>(sums, bodies, node, v_old, v, false, nullptr);
    for (int d = 0; d < Dim; ++d) a[d] = (v[d] - v_old[d]) * inv_dt;
    return a;
  }

  /// Velocity of a node with the acceleration a at the end of the step. `brake` [m/s2] is the deceleration by
  /// local damping. It brakes the acceleration that contact and sides leave, which a rehearsal without
  /// damping finds: at rest there is none, and each reaction is that of the soil. ends: the step itself,
  /// after which walls, sides and friction keep what they took; else the rehearsal alone, for `brake`.
  /// of_light: the step is a rehearsal for light bodies, and `force` their system.
  template <bool touches = true, bool of_light = false, class Sums>
  KOKKOS_INLINE_FUNCTION Vector<T, Dim> advanced(const Sums& sums, const Rigid<Dim>* bodies, const Node& node,
                                                 const Vector<T, Dim>& v_old, const Vector<T, Dim>& a,
                                                 bool ends, double* force, Vector<T, Dim>& brake) const {
    brake = filled<T, Dim>(0);
    if constexpr (acts)
      if (damping > 0 && !(at_sites && node.near))
        brake = braking(node.is_held() ? held_acceleration<touches>(sums, bodies, node, v_old, a) : a, v_old);
    Vector<T, Dim> v = v_old;
    if (!ends) return v;
    for (int d = 0; d < Dim; ++d) v[d] += (a[d] - brake[d]) * dt;  // Eq. (9)
    constrain<touches, of_light>(sums, bodies, node, v_old, v, !of_light, force);
    return v;
  }

  /// Applies walls, sides that act and contact to the velocity v of a node.
  template <bool touches, bool of_light = false, class Sums>
  KOKKOS_INLINE_FUNCTION void constrain(const Sums& sums, const Rigid<Dim>* bodies, const Node& node,
                                        const Vector<T, Dim>& v_old, Vector<T, Dim>& v, bool keeps,
                                        double* force) const {
    apply_walls(places.grid, node.sides, v);
    if constexpr (acts)
      if (node.acting != 0) v = by_sides(acting_sides, side_node(node, keeps), v_old, v, true);
    MPM_ROLLED
    for (int n = 0; touches && n < node.touching; ++n) {
      const int r = near_bodies.body(node.i / cells, n);
      if (r < 0) break;
      constexpr int system = LightTerms<Dim>::size;
      const int numbers = of_light ? system * light_stride : wrench() * cells;
      if (!bodies[r].law.at_sites)
        touch<of_light>(sums, node, bodies[r], r, n, v, keeps,
                        force == nullptr ? force : force + n * numbers);
    }
    if constexpr (acts)
      if (node.acting != 0 && node.touching > 0)
        v = by_sides(acting_sides, side_node(node, keeps), v_old, v, false);
    apply_walls(places.grid, node.sides, v);
  }

  /// A node on sides that act.
  KOKKOS_INLINE_FUNCTION SideNode<Dim> side_node(const Node& node, bool keeps) const {
    const bool counts =
        owned_nodes.extent(0) == 0 || (owned_nodes(node.i / cells) >> (node.i % cells) & 1) != 0;
    unsigned ends = node.sides;
    for (int d = 0; d < Dim; ++d)
      if (places.grid.period[d] > 0) ends &= ~(3u << (2 * d));
    return {node.at, node.acting, ends, double(node.soil[S::mass]), double(dt), double(fresh), counts, keeps};
  }

  /// The nodes of a slot far from every rigid.
  template <class Team, class Sums>
  KOKKOS_INLINE_FUNCTION void update_far(const Team& team, const Sums& sums, int slot) const {
    for_team(team, cells, [&](int k) { update<false>(sums, slot * cells + k, nullptr); });
    team.team_barrier();
    if (clears) clear_sums(team, nodes, slot, false, 0);
  }

  /// Updates nodes far from rigids and walls, without friction, for the lanes of a processor: a row at once.
  template <class Team, class Sums>
  void update_rows(const Team& team, const Sums& sums, int slot) const {
    using Row = typename Sums::Row;
    for (int k = 0; k < sums.rows; ++k) {
      const auto& soil = sums.of_soil[k];
      Vector<Row, Dim> v_old, a;
      const auto moves = soil[S::mass] > at_rest();
      accelerate(soil, select(moves, T(1) / soil[S::mass], T(0)), v_old, a);
      const Vector<Row, Dim> brake = braking(a, v_old);
      Row kinematics[NodeKinematics<Dim>::size];
      for (int d = 0; d < Dim; ++d) {
        const Row v = select(moves, v_old[d] + (a[d] - brake[d]) * dt, T(0));
        kinematics[NodeKinematics<Dim>::velocity + d] = v;
        kinematics[NodeKinematics<Dim>::acceleration + d] = (v - v_old[d]) * inv_dt * share;
      }
      store_groups(kinematics, &nodes.kinematics((slot * sums.rows + k) * Row::k_count, 0));
    }
    if (clears) clear_sums(team, nodes, slot, false, 0);
  }

  /// Contact with rigid r, number n near the slot; adds the force of the soil on it (Eq. 10) to force[0],
  /// force[cells] ..., unless it is null. keeps: friction uses up normal impulse. of_light: as in advanced.
  template <bool of_light = false, class Sums>
  KOKKOS_INLINE_FUNCTION void touch(const Sums& sums, const Node& node, const Rigid<Dim>& rigid, int r, int n,
                                    Vector<T, Dim>& v, bool keeps, double* force) const {
    T given[RigidTerms<Dim>::size] = {};  // read before the test of the rigid, to hide the latency
    for (int k = 0; k < RigidTerms<Dim>::size && has_mass_normals; ++k) given[k] = sums.rigid(r, node.i, k);
    const T m_i = node.soil[S::mass];
    Opponent<T, Dim> other;
    Vector<T, Dim> boundary;
    const auto place = place_at(node.at);
    Vector<double, Dim> velocity = rigid.motion.template velocity_at<acts>(place);
    if constexpr (acts)
      if (light != nullptr && light[r].light) {
        const bool for_damping = !keeps && !of_light;  // held_acceleration
        const Twist<Dim>& twist = for_damping ? light[r].undamped : light[r].end;
        velocity = RigidMotion<Dim>{rigid.motion.pose, twist.velocity, twist.spin}.velocity_at(place);
      }
    for (int d = 0; d < Dim; ++d) {
      other.velocity[d] = static_cast<T>(velocity[d]);
      boundary[d] = node.boundary[BoundaryTerms<Dim>::area + d];
    }
    cancel_at_rollers(places.grid, node.sides, boundary);
    double distance = 0;
    Vector<double, Dim> out{};
    const bool reaches = rigid.surface_normal || rigid.law.reach > 0
                             ? surface_contact(rigid, node, boundary, distance, out)
                             : true;
    if (rigid.surface_normal ? !(reaches && surface_normal(out, node.sides, other.normal))
                             : !mass_normal(rigid, given, node.sides, other.normal))
      return;
    other.area = Kokkos::fmax(T(0), dot(boundary, other.normal));
    const ContactLaw& law = rigid.law;
    Interface<T> interface { Kokkos::Experimental::infinity<T>::value, static_cast<T>(law.friction) };
    const T limit = shear_limit(law, node.i);
    if (limit < Kokkos::Experimental::infinity<T>::value)
      interface.shear_speed = limit * other.area * dt * node.inv_m;
    const Vector<T, Dim> g_now = gravity();
    T pressing = 0;
    for (int d = 0; d < Dim; ++d)
      pressing += (node.soil[S::force + d] * node.inv_m + g_now[d]) * other.normal[d];
    interface.pressing = pressing * dt;
    interface.separates = law.separates;
    // A node in the soil, most of a cell from the surface, feels its part of the shear; were it stopped as
    // well, the body would act thicker than it is. Round-off does not choose where a node lies half a cell
    // away.
    other.within_soil = rigid.surface_normal && distance > spacing / 2 + rigid.surface.round_off;
    if (law.reach > 0) {
      const T depth =
          surface_depth(node.boundary[BoundaryTerms<Dim>::volume] / places.grid.spacing, other.area);
      other.gap = static_cast<T>(distance) + depth * places.grid.spacing;
      interface.gap_scaling = gap_scaling(other.gap, T(law.reach), T(law.exponent));
      // The gap of a rough boundary differs from node to node: shear acts at all that are about in touch.
      if (other.gap > Kokkos::fmax(T(law.reach), places.grid.spacing / 2)) return;
    }
    if constexpr (acts)
      if (light != nullptr && light[r].light)
        interface.shear = shear_of_light(rigid.motion.velocity_at(place), v, other, interface);
    const int row = impulse_stride * n;
    if (has_friction) {
      interface.pressed = {nodes.impulse(row + ImpulseTerms::sum, node.i),
                           nodes.impulse(row + ImpulseTerms::weight, node.i),
                           nodes.impulse(row + ImpulseTerms::store, node.i) * node.inv_m};
      if constexpr (of_light)
        interface.pressed = {interface.pressed.sum * kept_share(ImpulseTerms::sum, fresh),
                             interface.pressed.weight * kept_share(ImpulseTerms::weight, fresh),
                             interface.pressed.store * kept_share(ImpulseTerms::store, fresh)};
      interface.fresh = fresh;
    }
    if constexpr (acts)
      if (has_friction && nodes.flux.extent(0) > 0) interface.carried = carried_by_water(node.i, m_i, other);
    const Vector<T, Dim> change = contact_correction(v, other, interface);
    if (has_friction && keeps) {
      nodes.impulse(row + ImpulseTerms::sum, node.i) = interface.pressed.sum;
      nodes.impulse(row + ImpulseTerms::weight, node.i) = interface.pressed.weight;
      nodes.impulse(row + ImpulseTerms::store, node.i) = interface.pressed.store * m_i;
    }
    for (int d = 0; d < Dim; ++d) {
      v[d] += change[d];
      if (force != nullptr && !of_light)
        force[(Wrench<Dim>::force + d) * cells] -= static_cast<double>(m_i) * change[d] * inv_dt;
    }
    if constexpr (acts)
      if (force != nullptr && !of_light && turns && rigid.motion.pose.turns)
        add_moment(rigid, place, m_i, change, force);
    if constexpr (of_light)
      if (light[r].open)
        add_touch(Touch<T, Dim>{other.normal, change, m_i, interface.stopped, interface.held},
                  rigid.motion.pose, place, light_stride, force);
  }

  /// Whether shear acts between a light body and a node of velocity v, by the body's velocity at the
  /// beginning of the step. Were shear decided by the velocity at the end, which is solved for, some steps
  /// would have no solution.
  KOKKOS_INLINE_FUNCTION static typename Interface<T>::Shear shear_of_light(const Vector<double, Dim>& begin,
                                                                            const Vector<T, Dim>& v,
                                                                            const Opponent<T, Dim>& other,
                                                                            const Interface<T>& interface) {
    Vector<T, Dim> slip;
    for (int d = 0; d < Dim; ++d) slip[d] = v[d] - static_cast<T>(begin[d]);
    const T approach = dot(slip, other.normal);
    for (int d = 0; d < Dim; ++d) slip[d] -= approach * other.normal[d];
    const T speed = Kokkos::sqrt(dot(slip, slip));
    return feels_shear(approach, speed, other.within_soil, interface) ? Interface<T>::Shear::acts
                                                                      : Interface<T>::Shear::none;
  }

  /// Part of the normal impulse on a rigid body at node i that the water in the pores carries, over the mass
  /// of the node [m/s]. CoupleFlow has left the normal of the body that the water does not pass and the
  /// impulse with grains that stay at rest.
  KOKKOS_INLINE_FUNCTION T carried_by_water(int i, T m_i, const Opponent<T, Dim>& other) const {
    using F = FluxTerms<Dim>;
    T along = 0;
    for (int d = 0; d < Dim; ++d) along += nodes.flux(i, F::flux + d) * other.normal[d];
    if (!(along > 0)) return 0;
    const T share = nodes.flow(i, FlowTerms<Dim>::water) / m_i;
    return along * (nodes.flux(i, F::rate) - share * dot(other.velocity, other.normal));
  }

  /// Adds the moment about the centre of a rigid of the force that changes a node's velocity (touch).
  template <class Component>
  KOKKOS_INLINE_FUNCTION void add_moment(const Rigid<Dim>& rigid, const Component& place, T m_i,
                                         const Vector<T, Dim>& change, double* force) const {
    Vector<double, Dim> given;  // N
    for (int d = 0; d < Dim; ++d) given[d] = static_cast<double>(m_i) * change[d] * inv_dt;
    const AngularVector<Dim> moment = moment_of(rigid.motion.pose.arm_to(place), given);
    for (int k = 0; k < k_turning_axes<Dim>; ++k) force[(Wrench<Dim>::moment + k) * cells] -= moment[k];
  }

  /// Largest shear stress of the interface at node i [Pa], infinite where only the friction limits.
  KOKKOS_INLINE_FUNCTION T shear_limit(const ContactLaw& law, int i) const {
    if (law.shear_fraction < 0) return static_cast<T>(law.shear_limit);
    return static_cast<T>(law.shear_fraction) * mean_strength(i);
  }
  /// Mean strength of the soil at node i [Pa].
  KOKKOS_INLINE_FUNCTION T mean_strength(int i) const {
    const T volume = nodes.strength(i, StrengthTerms::volume);
    return volume > 0 ? nodes.strength(i, StrengthTerms::strength) / volume : T(0);
  }

  /// Place of a node [m], by component.
  KOKKOS_INLINE_FUNCTION auto place_at(const Coord<Dim>& at) const {
    return [this, &at](int d) { return places.grid.coordinate_within(d, at[d], spacing); };
  }

  /// Area of a cell's face [m^2; m in 2D] at a node, of which rollers leave a half; where the soil is
  /// revolved, of the ring [m^2].
  KOKKOS_INLINE_FUNCTION T face(const Coord<Dim>& at, unsigned sides) const {
    T area = power(places.grid.spacing, Dim - 1);
    for (int d = rings ? 1 : 0; d < Dim; ++d)
      for (int side = 0; side < 2; ++side)
        if ((sides >> (2 * d + side) & 1u) && places.grid.wall[d][side] == Wall::roller) area /= 2;
    constexpr T k_on_axis = T(1.0 / 6);  // cells, of a node on the axis: the integral of N r dr
    if constexpr (Dim == 2)
      if (rings) area *= T(2 * Kokkos::numbers::pi) * Kokkos::fmax(T(at[0]), k_on_axis) * places.grid.spacing;
    return area;
  }

  /// Inward unit normal from the rigid's mass gradient; false where it is out of touch. given: RigidTerms.
  KOKKOS_INLINE_FUNCTION bool mass_normal(const Rigid<Dim>& rigid, const T* given, unsigned sides,
                                          Vector<T, Dim>& n) const {
    const T m_r = given[RigidTerms<Dim>::mass];
    for (int d = 0; d < Dim; ++d) n[d] = given[RigidTerms<Dim>::normal + d];
    return m_r > rigid.mass_cut && inward_normal(places.grid, sides, m_r, n);
  }

  /// Distance of x from a surface, as distance_to. Kernels without `acts` have no bodies of several parts.
  KOKKOS_INLINE_FUNCTION Distance<Dim> distance_from(const Surface<Dim>& surface,
                                                     const Vector<double, Dim>& x) const {
    if constexpr (acts)
      return distance_to(surface, vertices, x);
    else
      return distance_to_part(surface, vertices, x);
  }

  /// Distance [m] of a node from the rigid's own surface, and the normal out of it that contact takes. Where
  /// the soil's boundary says that the soil is at another face, as in a thin plate, or where no face is the
  /// nearest (the normal is then zero), the node looks a second time, from a cell's edge further towards the
  /// soil. False where the rigid does not reach into the node's cells.
  KOKKOS_INLINE_FUNCTION bool surface_contact(const Rigid<Dim>& rigid, const Node& node,
                                              const Vector<T, Dim>& boundary, double& distance,
                                              Vector<double, Dim>& out) const {
    constexpr double k_overlap = 1e-3;  // cells: less is no touch
    // Not at a right angle, as a footing's edge is to the soil under it: there round-off would decide.
    constexpr T k_facing = T(0.1);   // cosine
    constexpr T k_bounds = T(1e-3);  // of a cell's face: less is the soil's interior
    constexpr T k_aside = T(1e-3);   // of its length: less is round-off, which leaves a plane of symmetry
    Vector<double, Dim> x = rigid.motion.pose.template to_body<acts>(place_at(node.at));
    bool reaches = true;
    MPM_ROLLED
    for (int look = 0; look < 2; ++look) {
      const Distance<Dim> to = distance_from(rigid.surface, x);
      out = rigid.motion.pose.template turn_to_world<acts>(to.normal);
      if (look > 0) break;
      distance = to.value;
      double reach = -k_overlap, against = 0;
      for (int d = 0; d < Dim; ++d) {
        reach += Kokkos::fabs(out[d]);
        against += boundary[d] * out[d];
      }
      reaches = distance <= Kokkos::fmax(0.0, reach) * spacing;
      const T length = Kokkos::sqrt(dot(boundary, boundary));
      if (!reaches || !(against > -k_facing * length && length > k_bounds * face(node.at, node.sides))) break;
      Vector<double, Dim> back{};
      for (int d = 0; d < Dim; ++d)
        if (Kokkos::fabs(boundary[d]) > k_aside * length) back[d] = spacing * boundary[d] / length;
      back = rigid.motion.pose.template turn_to_body<acts>(back);
      for (int d = 0; d < Dim; ++d) x[d] -= back[d];
    }
    return reaches;
  }

  /// The inward unit normal, of one out of the surface.
  KOKKOS_INLINE_FUNCTION bool surface_normal(const Vector<double, Dim>& out, unsigned sides,
                                             Vector<T, Dim>& n) const {
    for (int d = 0; d < Dim; ++d) n[d] = static_cast<T>(out[d]);
    return inward_normal(places.grid, sides, T(1), n);
  }
};

template <bool acts = true, class Space, class T, int Dim>
UpdateNodes<Space, T, Dim, acts> node_update_of(const State<Space, T, Dim>& s, double dt) {
  UpdateNodes<Space, T, Dim, acts> update{
      .value_count = wrench_size<Dim>(s.rigid_turns) * wrenches_of_slot(s),
      .places = {s.grid, s.patches},
      .nodes = s.nodes,
      .rigids = s.rigids,
      .vertices = s.vertices,
      .near_bodies = s.contact.near,
      .parts = s.part_forces.count > 0 ? s.part_forces.surfaces.data() : nullptr,
      .light = s.light_rigids.in_use ? s.light_rigids.motions.data() : nullptr,
      .forces = s.contact.forces,
      .owned_nodes = s.owned_nodes,
      .g = {},
      .timed_g = s.timed.of_step().gravity,
      .acting_sides = {},
      .dt = T(s.scheme.kick * dt),
      .inv_dt = T(1 / (s.scheme.kick * dt)),
      .share = T(s.scheme.kick),
      .damping = T(s.scheme.damping),
      .fresh = T(-std::expm1(-dt / s.friction_time)),
      .mass_cut = T(s.scheme.mass_cut),
      .spacing = s.spacing,
      .impulse_stride = impulse_stride(s),
      .has_boundary = s.soil_boundary,
      .has_friction = s.has_friction,
      .has_mass_normals = s.mass_normals,
      .clears = s.plan.sums_ahead && !s.plan.writes_sums,
      .rings = s.soil.points.rings,
      .turns = s.rigid_turns,
      .at_sites = s.at_sites.in_use};
  for (int d = 0; d < Dim; ++d) update.g[d] = static_cast<T>(s.gravity[d]);
  if constexpr (acts) update.acting_sides = acting(s.sides);
  return update;
}

}  // namespace mpm
