#include "advance.hpp"
#include "end_step.hpp"
#include "host_particles.hpp"
#include "step_kernels.hpp"
#include "tile.hpp"

namespace mpm {
namespace {

constexpr int k_rigids_at_once = 4;  // whose points travel as arguments of one launch
constexpr int k_few_slots = 1200;    // teams of patches that an H200 has at once

template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Taken<T, Dim> take_from_nodes(const MotionValues<T, Dim>* window,
                                                     const Coord<Dim>& cell, const AxisWeights<T> (&a)[Dim],
                                                     T inv_spacing) {
  Taken<T, Dim> t{};
  interpolate_by_lines(
      a, [&](const Vector<int, Dim>& k) { return window[window_place(cell, a, k)]; }, t.motion, t.gradient);
  for (int d = 0; d < Dim; ++d)
    for (int e = 0; e < Dim; ++e) t.gradient[d][e] *= inv_spacing;
  return t;
}

/// The dilatation rate alone, sum v_i . grad S_ip [1/s].
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T dilatation_from_nodes(const MotionValues<T, Dim>* window, const Coord<Dim>& cell,
                                               const AxisWeights<T> (&a)[Dim], T inv_spacing) {
  T sum = 0;
  for_each_weight(a, [&](const Vector<int, Dim>& k, T, const Vector<T, Dim>& grad) {
    const MotionValues<T, Dim> node = window[window_place(cell, a, k)];
    for (int d = 0; d < Dim; ++d) sum += node[NodeMotion<Dim>::velocity + d] * grad[d];
  });
  return sum * inv_spacing;
}

/// A team moves the particles of a patch, or of a part of one. If Sums, it adds them where they now are to
/// the nodes for the next step, as the strategy `tile` does: a particle is read and written once a step.
template <class Space, class T, int Dim, bool Sums>
struct UpdateParticles {
  using Source = SoilSource<Space, T, Dim>;
  using Boundary = BoundarySource<Space, T, Dim>;
  using Tile_ = Tile<Source>;
  using Team = PatchTeam<Space, T, Dim>;
  using Member = typename Team::member_type;
  using Memory = typename Space::memory_space;
  static constexpr int cells = Patch<Dim>::cells, window = Patch<Dim>::window;
  static constexpr int threads = team_threads<Space>;
  /// What is left of a tile where nothing is summed.
  struct Nothing {
    KOKKOS_INLINE_FUNCTION explicit Nothing(Scratch&) {}
    KOKKOS_INLINE_FUNCTION void set_node(int, int) const {}
    static constexpr std::size_t bytes() { return 0; }
  };
  using TileOrNothing = std::conditional_t<Sums, Tile_, Nothing>;

  Source source;
  Kokkos::View<int*, Memory> begin, slots;
  decltype(Patches<Space, Dim>::around) around;
  Kokkos::View<Coord<Dim>*, Memory> origin;
  NodeField<Space, T, NodeMotion<Dim>::size> motion;
  NodeField<Space, T, SoilShare<Dim>::size> out;
  NodeField<Space, T, BoundaryShare<Dim>::size> boundary;
  Kokkos::View<int*, Memory> near_rigid;
  ControlView<Space> control;
  Movements<Space> movements;
  Kokkos::View<T*, Memory, Kokkos::MemoryUnmanaged> dilatation;  // 1/s, by particle
  UpdateScalars<T> by;
  double spacing;
  int first;      // of slots
  int parts;      // of a patch, each a team's
  bool one_body;  // no particle needs to be asked which its body is
  bool has_boundary;

  static constexpr std::size_t bytes() {
    const std::size_t own =
        scratch_bytes<MotionValues<T, Dim>>(window) + scratch_bytes<T>(cells) + TileOrNothing::bytes();
    return Sums && Tile<Boundary>::bytes() > own ? Tile<Boundary>::bytes() : own;
  }

  KOKKOS_FUNCTION void operator()(const Member& team) const {
    const int paused = control().paused, slot = slots(first + team.league_rank());  // both asked for at once
    if (!paused) update(team, Scratch(team, bytes()), slot, 0);
  }

  /// Part number `part` of a slot's patch; all: bytes().
  KOKKOS_INLINE_FUNCTION void update(const Member& team, const Scratch& all, int slot, int part) const {
    const BodyProperties<T> body = source.points.bodies(0);  // of all particles if one_body
    const int low = begin(slot * cells + part * (cells / parts)),
              high = begin(slot * cells + (part + 1) * (cells / parts));
    // Cells of other parts are as good as empty.
    const auto cell_begin = [&](int c) {
      return Kokkos::min(Kokkos::max(begin(slot * cells + c), low), high);
    };
    Scratch scratch = all;
    MotionValues<T, Dim>* const nodes = scratch.take<MotionValues<T, Dim>>(window);
    T* const mean = scratch.take<T>(cells);
    const TileOrNothing tile(scratch);
    prefetch_particles(low + team.team_rank(), high);
    for_each_of_window<Dim>(team, around, slot, [&](int n, int number) {
      tile.set_node(n, number);
      nodes[n] = *reinterpret_cast<const MotionValues<T, Dim>*>(&motion(number, 0));
    });
    T moved = 0;
    const auto particle = [&](int p) { return step_particle(nodes, mean, slot, p, body, moved); };
    if constexpr (Sums) {
      tile.clear(team, cell_begin);
      team.team_barrier();
      if (by.f_bar > 0) average_dilatation(team, cell_begin, nodes, mean);
      tile.add(team, particle);
      note_movement(team, slot * parts + part, moved);
      tile.give_window(team, out);
      if (has_boundary && near_rigid(slot) != 0) {
        team.team_barrier();
        sum_patch(team, all, Boundary{source.points, source.inv_spacing, near_rigid}, around, slot,
                  cell_begin, boundary);
      }
    } else {
      team.team_barrier();
      if (by.f_bar > 0) average_dilatation(team, cell_begin, nodes, mean);
      Kokkos::parallel_for(Kokkos::TeamThreadRange(team, low, high), particle);
      note_movement(team, slot, moved);
    }
  }

  /// Asks the memory for what the particles of a thread hold, before their nodes are there.
  KOKKOS_INLINE_FUNCTION void prefetch_particles(int p, int end) const {
    const auto& soil = source.points;
    for (; is_device<Space> && p < end; p += threads) {
      prefetch(&soil.coordinate(p)), prefetch(&soil.velocity(p)), prefetch(&soil.stress(p));
      prefetch(&soil.volume(p)), prefetch(&soil.strength(p)), prefetch(&soil.plastic_strain(p));
    }
  }

  /// Notes the largest of the movements [cells] of each warp.
  KOKKOS_INLINE_FUNCTION void note_movement(const Member& team, int slot, T moved) const {
    const T most = largest_of_warp(moved);
    if (team.team_rank() % k_warp == 0) movements.note(slot, most);
  }

  /// Mean dilatation rate of each cell [1/s], weighted by volume.
  template <class Begin>
  KOKKOS_INLINE_FUNCTION void average_dilatation(const Member& team, const Begin& cell_begin,
                                                 const MotionValues<T, Dim>* nodes, T* mean) const {
    const auto& soil = source.points;
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, cell_begin(0), cell_begin(cells)), [&](int p) {
      with_weights_near(soil.coordinate(p), soil.bodies(one_body ? 0 : soil.body(p)).half_length,
                        [&](const AxisWeights<T>(&a)[Dim]) {
                          dilatation(p) = dilatation_from_nodes<T, Dim>(nodes, coord_of<Dim>(soil.cell(p)), a,
                                                                        by.inv_spacing);
                        });
    });
    team.team_barrier();
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, cells), [&](int c) {
      T volume = 0, sum = 0;
      for (int p = cell_begin(c); p < cell_begin(c + 1); ++p) {
        volume += soil.volume(p);
        sum += soil.volume(p) * dilatation(p);
      }
      mean[c] = volume > 0 ? sum / volume : T(0);
    });
    team.team_barrier();
  }

  /// Moves particle p; `moved` [cells] becomes the largest movement so far. Returns what it then gives.
  KOKKOS_INLINE_FUNCTION typename Tile_::Entry step_particle(const MotionValues<T, Dim>* nodes, const T* mean,
                                                             int slot, int p, const BodyProperties<T>& common,
                                                             T& moved) const {
    const auto& soil = source.points;
    const BodyProperties<T> body = one_body ? common : soil.bodies(soil.body(p));
    const int place = soil.cell(p) - slot * cells;
    const Coord<Dim> cell = coord_of<Dim>(place);
    Particle<T, Dim> q{soil.coordinate(p),
                       soil.velocity(p),
                       soil.volume(p),
                       {soil.stress(p), soil.plastic_strain(p), soil.strength(p)}};
    const T plastic_strain = q.material.plastic_strain;
    T own = 0;
    with_weights_near(q.x, body.half_length, [&](const AxisWeights<T>(&a)[Dim]) {
      own = advance(q, soil.materials(body.material), take_from_nodes(nodes, cell, a, by.inv_spacing),
                    by.f_bar > 0 ? mean[place] : T(0), by);
    });
    soil.coordinate(p) = q.x;
    soil.velocity(p) = q.v;
    soil.volume(p) = q.volume;
    soil.stress(p) = q.material.stress;
    if (q.material.plastic_strain != plastic_strain) soil.plastic_strain(p) = q.material.plastic_strain;
    const FaultKind fault = fault_of(q, own);
    if (fault != FaultKind::none) {
      double position[3] = {};
      for (int d = 0; d < Dim; ++d) position[d] = (double(origin(slot)[d]) + cell[d] + q.x[d]) * spacing;
      report(control, fault, soil.id(p), position, Dim);
    }
    moved = Kokkos::fmax(moved, own);
    return {q.x, source.point(body, q.v, q.material.stress, q.volume)};
  }
};

/// The same by parts of patches, and the end of the step in one launch: the first teams move the points of
/// rigids to where they will be and give their mass to the nodes, and the team that is done last moves the
/// rigids and counts the step.
template <class Space, class T, int Dim>
struct UpdateAndEnd {
  using Update = UpdateParticles<Space, T, Dim, true>;
  using Member = typename Update::Member;
  using Rigids = Kokkos::Array<RigidSource<Space, T, Dim>, k_rigids_at_once>;
  static constexpr int threads = Update::threads;
  Update update;
  EndStep<Space, T, Dim> end;
  Rigids rigids;
  int rigid_count, rigid_teams;
  decltype(Nodes<Space, T, Dim>::rigid) out;
  Kokkos::View<int, typename Space::memory_space> arrived;

  KOKKOS_FUNCTION void operator()(const Member& team) const {
    const int n = team.league_rank() - rigid_teams;
    if (update.control().paused) return;
    Scratch scratch(team, Update::bytes());
    if (n < 0)
      rigids_to_nodes(team, Scratch(scratch).template take<double>(0));
    else
      update.update(team, scratch, update.slots(update.first + n / update.parts), n % update.parts);
    team.team_barrier();
    int earlier = 0;
    Kokkos::single(
        Kokkos::PerTeam(team),
        [&](int& teams) {
          Kokkos::memory_fence();  // what this team noted is there for the last one
          teams = Kokkos::atomic_fetch_add(&arrived(), 1);
        },
        earlier);
    if (earlier + 1 < team.league_size()) return;
    end(team, scratch.template take<double>(0));
    arrived() = 0;
  }

  KOKKOS_INLINE_FUNCTION void rigids_to_nodes(const Member& team, double* part) const {
    for (int k = 0; k < rigid_count; ++k) {
      const auto& source = rigids[k];
      const Vector<double, Dim> to = end.next_displacement(team, source.rigid, part);
      const int all = rigid_teams * threads;
      for (int p = team.league_rank() * threads + team.team_rank(); p < source.points.count; p += all) {
        source.move(p, to);
        give_to_nodes(source, update.around, p,
                      [&](int i, int v, T value) { Kokkos::atomic_add(&out(source.rigid, i, v), value); });
      }
    }
  }
};

/// Only on a device: a processor's caches hold the particles of a patch between the two functions anyway.
template <class Space, class T, int Dim>
inline constexpr bool sums_fit =
    is_device<Space>&& scratch_fits<Space, T, Dim>(UpdateParticles<Space, T, Dim, true>::bytes());

template <class Space, class T, int Dim>
UpdateScalars<T> update_scalars(const State<Space, T, Dim>& s, double dt) {
  const double flip = s.xpic_order > 0 ? 1 : s.flip_share;  // XPIC has changed the velocities already
  return {T(dt), s.grid.inv_spacing, T(flip), T(1 - flip), T(s.f_bar_share)};
}

template <bool Sums, class Space, class T, int Dim>
UpdateParticles<Space, T, Dim, Sums> update_of(const State<Space, T, Dim>& s, double dt, int first,
                                               int parts) {
  const auto& set = s.soil;
  const Kokkos::View<T*, typename Space::memory_space, Kokkos::MemoryUnmanaged> dilatation(
      reinterpret_cast<T*>(s.spare.data()), set.points.count);
  return {{set.points, s.grid.inv_spacing},
          set.bins.begin,
          set.bins.by_colour,
          s.patches.around,
          s.patches.origin,
          s.nodes.motion,
          s.nodes.soil,
          s.nodes.boundary,
          s.near_rigid,
          s.control,
          s.movements,
          dilatation,
          update_scalars(s, dt),
          s.spacing,
          first,
          parts,
          set.points.bodies.extent(0) == 1,
          s.soil_boundary};
}

/// The launch of teams that work on patches.
template <class Update, class Space, class Functor>
void launch(const Space& space, int teams, const Functor& f) {
  if (teams == 0) return;
  Kokkos::parallel_for("mpm::update_particles",
                       light(typename Update::Team(space, teams, Update::threads)
                                 .set_scratch_size(0, Kokkos::PerTeam(Update::bytes() + k_scratch_slack))),
                       f);
}

template <bool Sums, class Space, class T, int Dim>
void launch_update(State<Space, T, Dim>& s, double dt, const Part<Space>& part) {
  launch<UpdateParticles<Space, T, Dim, Sums>>(part.space, part.last - part.first,
                                               update_of<Sums>(s, dt, part.first, 1));
}

}  // namespace

template <class Space, class T, int Dim>
bool sums_ahead(const State<Space, T, Dim>& s) {
  return sums_fit<Space, T, Dim> && chosen(s.p2g.strategy, backend_of<Space>) == P2G::tile &&
         s.xpic_order == 0 && !s.affine;
}

template <class Space, class T, int Dim>
bool ends_at_once(const State<Space, T, Dim>& s) {
  int with_points = 0;
  for (const auto& set : s.rigid_points) with_points += !set.points.surface_normal;
  const std::size_t bytes = EndStep<Space, T, Dim>(s, 0).room(team_threads<Space>) * sizeof(double);
  return sums_ahead(s) && few_patches(s) && !s.batches.in_use() && with_points <= k_rigids_at_once &&
         bytes <= UpdateParticles<Space, T, Dim, true>::bytes();
}

template <class Space, class T, int Dim>
void update_and_end(State<Space, T, Dim>& s, double dt) {
  if constexpr (sums_fit<Space, T, Dim>) {
    using Update = UpdateParticles<Space, T, Dim, true>;
    const auto& colours = s.soil.bins.colour_begin;
    const int first = colours[0], slots = colours[Patch<Dim>::colours] - first;
    const int parts = slots <= k_few_slots / 4 ? 4 : slots <= k_few_slots / 2 ? 2 : 1;
    UpdateAndEnd<Space, T, Dim> f{update_of<true>(s, dt, first, parts),
                                  EndStep<Space, T, Dim>(s, dt),
                                  {},
                                  0,
                                  0,
                                  s.nodes.rigid,
                                  s.arrived};
    for (int r = 0; r < static_cast<int>(s.rigid_points.size()); ++r) {
      const auto& points = s.rigid_points[r].points;
      if (points.surface_normal) continue;
      f.rigids[f.rigid_count++] = {points, s.rigids, r, s.patches.origin, s.spacing};
      f.rigid_teams += (points.count + Update::threads - 1) / Update::threads;
    }
    launch<Update>(s.space, slots * parts + f.rigid_teams, f);
    s.summed = {true, s.soil_boundary, true};
  }
}

template <class Space, class T, int Dim>
void update_particles(State<Space, T, Dim>& s, double dt, [[maybe_unused]] const Part<Space>& part) {
  const bool sums = sums_ahead(s);
  s.summed = {sums, sums && s.soil_boundary, false};
  if constexpr (is_device<Space>) {
    if constexpr (sums_fit<Space, T, Dim>)
      if (sums) return launch_update<true>(s, dt, part);
    launch_update<false>(s, dt, part);
  } else {
    move_on_host(s, update_scalars(s, dt));
  }
}

template <class Space, class T, int Dim>
void update_particles(State<Space, T, Dim>& s, double dt) {
  update_particles(s, dt, Part<Space>{s.space, 0, s.soil.bins.colour_begin[Patch<Dim>::colours]});
}

#define MPM_INSTANTIATE(Space, T, Dim)                           \
  template bool sums_ahead(const State<Space, T, Dim>&);         \
  template bool ends_at_once(const State<Space, T, Dim>&);       \
  template void update_and_end(State<Space, T, Dim>&, double);   \
  template void update_particles(State<Space, T, Dim>&, double); \
  template void update_particles(State<Space, T, Dim>&, double, const Part<Space>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
