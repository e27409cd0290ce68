#pragma once
// Update of the particles of a patch by a team of a device (function 5), and of the nodes of the next step.

#include "data/contact_core.hpp"
#include "device/warp.hpp"
#include "loops/gpu/tile.hpp"
#include "physics/advance.hpp"

namespace mpm {

template <ParticleDomain domain, class T, int Dim, class Weights>
KOKKOS_INLINE_FUNCTION GridSample<T, Dim, k_slopes<Dim, domain>> sample_nodes(
    const KinematicValues<T, Dim>* window, const Coord<Dim>& cell, const Weights& a, T inv_spacing) {
  GridSample<T, Dim, k_slopes<Dim, domain>> t{};
  interpolate_by_lines(
      a, [&](const Vector<int, Dim>& k) { return window[window_place(cell, a, k)]; }, t.kinematics,
      t.gradient);
  for (int d = 0; d < Dim; ++d)
    for (int e = 0; e < k_slopes<Dim, domain>; ++e) t.gradient[d][e] *= inv_spacing;
  return t;
}

/// The dilatation rate alone, sum v_i . grad S_ip [1/s], of rings with that of the hoop.
template <ParticleDomain domain, class T, int Dim, class Weights>
KOKKOS_INLINE_FUNCTION T dilatation_from_nodes(const KinematicValues<T, Dim>* window, const Coord<Dim>& cell,
                                               const Weights& a, T inv_spacing) {
  T sum = 0;
  for_each_weight(a, [&](const Vector<int, Dim>& k, T, const auto& grad) {
    const KinematicValues<T, Dim> node = window[window_place(cell, a, k)];
    for (int d = 0; d < Dim; ++d) sum += node[NodeKinematics<Dim>::velocity + d] * grad[d];
    if constexpr (domain == ParticleDomain::ring) sum += node[NodeKinematics<Dim>::velocity] * grad[Dim];
  });
  return sum * inv_spacing;
}

/// The patches that a kernel is for. A patch is common if its window holds no node at a wall or beyond it,
/// and none of its particles is alone.
enum class PatchKind { common, any };

/// Teams that share a multiprocessor. Fewer of them leave a thread more registers, which a kernel for one
/// heavy law needs, and one for patches that are not common, which are few.
template <class T, int Dim>
constexpr int teams_for(PatchKind kind, bool heavy) {
  const int fewer = heavy ? (sizeof(T) == sizeof(float) ? 2 : 1) : (kind == PatchKind::common ? 0 : 1);
  return teams_at_once<T, Dim> - fewer;
}

/// A team moves the particles of a patch, whose laws are of the list Laws. If Sums, it adds them where they
/// now are to the nodes for the next step, as the strategy `tile` does: a particle is read and written once a
/// step.
/// teams: those that share a multiprocessor.
template <class Space, class T, int Dim, bool Sums, PatchKind kind, class Laws,
          ParticleDomain domain = ParticleDomain::fixed,
          int teams = teams_for<T, Dim>(kind, Laws::k_size == 1)>
struct UpdateParticles {
  using Source = SoilSource<Space, T, Dim, domain>;
  using Boundary = BoundarySource<Space, T, Dim, domain>;
  using Tile_ = Tile<Source, teams>;
  using Team = Kokkos::TeamPolicy<Space, Kokkos::LaunchBounds<team_threads<Space>, teams>>;
  using Member = typename Team::member_type;
  using Memory = typename Space::memory_space;
  using Images = std::conditional_t<kind == PatchKind::common, NoImages, WindowImages<T, Dim>>;
  static constexpr int cells = Patch<Dim>::cells, window = Patch<Dim>::window;
  static constexpr int threads = team_threads<Space>;
  /// Stand-in for a tile where nothing is summed.
  struct Nothing {
    KOKKOS_INLINE_FUNCTION explicit Nothing(Scratch&) {}
    KOKKOS_INLINE_FUNCTION void set_node(int, int) const {}
    static constexpr std::size_t bytes() { return 0; }
  };
  using TileOrNothing = std::conditional_t<Sums, Tile_, Nothing>;
  using Domain = DomainOf<T, Dim, domain>;

  Source source;
  Kokkos::View<int*, Memory> begin, slots;
  decltype(Patches<Space, Dim>::neighbours) neighbours;
  Kokkos::View<Coord<Dim>*, Memory> origin;
  NodeField<Space, T, NodeKinematics<Dim>::size> kinematics;
  NodeSums<Space, T, Dim> sums;  // of the next step
  ContactPlaces<Space> contact;
  ControlView<Space> control;
  Movements<Space> movements;
  Dilatations<Space, T> dilatation;
  Grid<T, Dim> grid;
  WallReach<Dim> reach;
  decltype(Strays<Space>::alone) alone;
  decltype(Strays<Space>::put_back) put_back;
  UpdateScalars<T> by;
  double spacing;
  int first;      // of slots
  int law;        // index in Materials of that of all bodies; -1: they differ
  bool one_body;  // no particle needs to be asked which its body is
  bool has_boundary;
  bool has_means = false;  // `dilatation` holds the mean of each particle's cell (sum_dilatations)
  static constexpr bool may_have_means = Dim == 3 && domain == ParticleDomain::fixed;

  static constexpr std::size_t bytes() {
    const std::size_t own =
        scratch_bytes<KinematicValues<T, Dim>>(window) + scratch_bytes<T>(cells) + TileOrNothing::bytes();
    return Sums && Tile<Boundary>::bytes() > own ? Tile<Boundary>::bytes() : own;
  }

  KOKKOS_FUNCTION void operator()(const Member& team) const {
    const int paused = control().paused, slot = slots(first + team.league_rank());  // both asked for at once
    if (!paused) update(team, Scratch(team, bytes()), slot);
  }

  KOKKOS_INLINE_FUNCTION Images images_at([[maybe_unused]] int slot) const {
    if constexpr (kind == PatchKind::common)
      return {};
    else
      return Images(grid, reach, origin(slot));
  }

  KOKKOS_INLINE_FUNCTION void update(const Member& team, const Scratch& all, int slot) const {
    prefetch_particles(team, slot);
    const Images images = images_at(slot);
    const auto number_of = [&](int n) {
      return number_at<decltype(neighbours), Dim>(neighbours, slot, window_coord<Dim>(images(n)));
    };
    update(team, all, slot, sums, movements.of(0), images, number_of, [&](int, int number) {
      if constexpr (may_have_means)  // about nodes at an upper wall some lie outside the grid, where no
                                     // particle reaches
        if (number < 0) return KinematicValues<T, Dim>{};
      return *reinterpret_cast<const KinematicValues<T, Dim>*>(&kinematics(number, 0));
    });
  }

  /// all: bytes(). out: the sums of the next step. noted: for the movements of this one. number_of(n): of the
  /// image of node n of the window.
  /// motion_of(n, number): what becomes of that image.
  template <class Number, class Motion>
  KOKKOS_INLINE_FUNCTION void update(const Member& team, const Scratch& all, int slot,
                                     const NodeSums<Space, T, Dim>& out, const MovementPlaces<Space>& noted,
                                     const Images& images, const Number& number_of,
                                     const Motion& motion_of) const {
    const BodyProperties<T> body = source.points.bodies(0);  // of all particles if one_body
    const auto cell_begin = [&](int c) { return begin(slot * cells + c); };
    Scratch scratch = all;
    KinematicValues<T, Dim>* const nodes = scratch.take<KinematicValues<T, Dim>>(window);
    T* const mean = scratch.take<T>(cells);
    const TileOrNothing tile(scratch);
    const std::uint64_t lone = kind == PatchKind::common ? 0 : alone(slot);
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, window), [&](int n) {
      const int number = number_of(n);
      tile.set_node(n, number);
      KinematicValues<T, Dim> motion = motion_of(n, number);
      turn_motion(images, n, motion);
      nodes[n] = motion;
    });
    T moved = 0;
    const auto particle = [&](int p) {
      return step_particle(nodes, mean, images, slot, lone, p, body, moved);
    };
    if constexpr (Sums) {
      tile.clear(team, cell_begin);
      team.team_barrier();
      if (by.f_bar > 0 && !(may_have_means && has_means)) average_dilatation(team, cell_begin, nodes, mean);
      tile.add(team, particle);
      note_movement(team, noted, slot, moved);
      tile.give_window(team, out.soil, images);
      if (has_boundary && contact(slot) != 0) {
        team.team_barrier();
        sum_patch(team, all, Boundary{source.points, source.inv_spacing, contact}, number_of, cell_begin,
                  images, out.boundary);
      }
    } else {
      team.team_barrier();
      if (by.f_bar > 0 && !(may_have_means && has_means)) average_dilatation(team, cell_begin, nodes, mean);
      Kokkos::parallel_for(Kokkos::TeamThreadRange(team, cell_begin(0), cell_begin(cells)), particle);
      note_movement(team, noted, slot, moved);
    }
  }

  /// Asks the memory for what the particles of a thread hold, before their nodes are there.
  KOKKOS_INLINE_FUNCTION void prefetch_particles(const Member& team, int slot) const {
    const auto& soil = source.points;
    const int end = begin((slot + 1) * cells);
    for (int p = begin(slot * cells) + team.team_rank(); is_device<Space> && p < end; p += threads) {
      Particle<T, Dim> q;
      for_each_value([&](auto&, const auto& field) { prefetch(&field(p)); }, q, soil);
      if constexpr (domain == ParticleDomain::stretch) prefetch(&soil.half_length(p));
      if constexpr (Dim == 2) {  // the forms that spill least: scripts/bench/law_registers
        for (int k = 0; k < most_state(Laws{}, true); ++k)
          if (k < soil.history.columns) prefetch(&soil.history.column[k](p));
      } else {
        for (int k = 0; k < soil.history.columns; ++k) prefetch(&soil.history.column[k](p));
      }
    }
  }

  /// Notes the largest of the movements [cells] of each warp.
  KOKKOS_INLINE_FUNCTION static void note_movement(const Member& team, const MovementPlaces<Space>& noted,
                                                   int slot, T moved) {
    const T most = largest_of_warp(moved);
    if (team.team_rank() % k_warp == 0) noted.note(slot, most);
  }

  /// Mean dilatation rate of each cell [1/s], weighted by volume; where materials have means of their own,
  /// the mean for each particle takes the place of its `dilatation`.
  template <class Begin>
  KOKKOS_INLINE_FUNCTION void average_dilatation(const Member& team, const Begin& cell_begin,
                                                 const KinematicValues<T, Dim>* nodes, T* mean) const {
    const auto& soil = source.points;
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, cell_begin(0), cell_begin(cells)), [&](int p) {
      with_weights_near(
          soil.coordinate(p), domain_of<domain>(soil, p, soil.bodies(one_body ? 0 : soil.body(p))),
          [&](const auto& a) {
            dilatation(p) =
                dilatation_from_nodes<domain, T, Dim>(nodes, coord_of<Dim>(soil.cell(p)), a, by.inv_spacing);
          });
    });
    team.team_barrier();
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, cells), [&](int c) {
      if (averages_by_material()) return average_cell(cell_begin(c), cell_begin(c + 1));
      CellMean<T> of_cell;
      for (int p = cell_begin(c); p < cell_begin(c + 1); ++p)
        of_cell.add(soil.volume(p), soil.volume(p) * dilatation(p));
      mean[c] = of_cell.value();
    });
    team.team_barrier();
  }

  /// Kernels of light laws alone, which have no registers for it, are not for it (light_kernels_do).
  KOKKOS_INLINE_FUNCTION bool averages_by_material() const {
    return !std::is_same_v<Laws, LightMaterials> && by.f_bar_by_material;
  }
  /// The particles [first, last) of a cell, by material.
  KOKKOS_INLINE_FUNCTION void average_cell(int first, int last) const {
    const auto& soil = source.points;
    average_by_material(
        soil, first, last, [&](int p) { return soil.volume(p) * dilatation(p); },
        [&](int p, T of_cell) {
          dilatation(p) = mean_for(soil.materials(soil.material_of(p)).f_bar_share, of_cell, dilatation(p));
        });
  }
  /// Result of average_dilatation for particle p in this cell of the patch [1/s].
  KOKKOS_INLINE_FUNCTION T mean_dilatation(const T* mean, int place, int p) const {
    return averages_by_material() || (may_have_means && has_means) ? dilatation(p) : mean[place];
  }

  /// Moves particle p; `moved` [cells] becomes the largest movement so far. lone: Strays::alone of the slot.
  /// Returns what the particle then gives.
  KOKKOS_INLINE_FUNCTION typename Tile_::Entry step_particle(const KinematicValues<T, Dim>* nodes,
                                                             const T* mean, const Images& images, int slot,
                                                             std::uint64_t lone, int p,
                                                             const BodyProperties<T>& common,
                                                             T& moved) const {
    const auto& soil = source.points;
    const BodyProperties<T> body = one_body ? common : soil.bodies(soil.body(p));
    const int place = soil.cell(p) - slot * cells;
    const Coord<Dim> cell = coord_of<Dim>(place);
    Particle<T, Dim> q;
    for_each_value([&](auto& value, const auto& field) { value = field(p); }, q, soil);
    const bool flies = kind != PatchKind::common && (lone >> place & 1) != 0;
    T own = 0;
    const Domain half_length = domain_of<domain>(soil, p, body);
    with_weights_near(q.x, half_length, [&](const auto& a) {
      const ParticleLaw<Space, T, Dim, Laws> of_particle{soil, p, body.material, law, flies};
      own = advance(q, of_particle, sample_nodes<domain, T, Dim>(nodes, cell, a, by.inv_spacing),
                    by.f_bar > 0 ? mean_dilatation(mean, place, p) : T(0), by, step_domain<domain>(soil, p));
    });
    if (flies) q.volume = soil.volume(p);
    for_each_value([&](auto& value, const auto& field) { field(p) = value; }, q, soil);
    if constexpr (kind != PatchKind::common) put_back_particle(images, slot, place, p, q);
    FaultKind fault = fault_of(q, own, by, step_domain<domain>(soil, p));
    if (fault != FaultKind::none) {
      if (fault == FaultKind::not_finite) fault = cause_of<Laws>(soil, p);
      double position[3] = {};
      for (int d = 0; d < Dim; ++d) position[d] = (double(origin(slot)[d]) + cell[d] + q.x[d]) * spacing;
      report(control, fault, soil.id(p), position, Dim);
      own = Kokkos::Experimental::infinity_v<T>;  // ends the steps
    }
    moved = Kokkos::fmax(moved, own);
    return {q.x, source.point(half_length, soil.mass_of(p, body), q.v, q.stress, q.volume)};
  }

  /// Brings particle p, which may have passed a wall, back to it. In memory, where that takes few registers.
  KOKKOS_INLINE_FUNCTION void put_back_particle(const Images& images, int slot, int place, int p,
                                                Particle<T, Dim>& q) const {
    const auto& soil = source.points;
    // The loops of put_on_walls read the patch's place from memory: indexed by a variable, `images` and with
    // it the kernel's arguments would be copied to the memory of each thread.
    const auto in_patch = [&](int d) { return place >> (d * Patch<Dim>::log_edge) & (Patch<Dim>::edge - 1); };
    const auto cell_along = [&](int d) { return origin(slot)[d] + in_patch(d); };
    if (!images.at_wall || !is_beyond_walls(grid, in_mesh(images.origin, coord_of<Dim>(place)), q.x)) return;
    if (put_on_walls(grid, cell_along, soil.coordinate(p), soil.velocity(p)))
      Kokkos::atomic_inc(&put_back(soil.body(p)));
    q.x = soil.coordinate(p), q.v = soil.velocity(p);
  }
};

/// Whether a team has room for the update and the sums that follow.
template <class Space, class T, int Dim>
inline constexpr bool sums_fit =
    scratch_fits<Space, T, Dim>(UpdateParticles<Space, T, Dim, true, PatchKind::any, Materials>::bytes());

template <class Space, class T, int Dim>
UpdateScalars<T> update_scalars(const ContactCore<Space, T, Dim>& s, double dt) {
  const double flip =
      s.scheme.xpic_order > 0 ? 1 : s.scheme.flip_fraction;  // XPIC has changed the velocities already
  return {.dt = T(dt),
          .inv_spacing = s.grid.inv_spacing,
          .flip = T(flip),
          .pic = T(1 - flip),
          .f_bar = T(s.f_bar.fraction),
          .least_volume = T(s.strays.least_volume),
          .most_volume = T(s.strays.most_volume),
          .volume_is_fault = s.strays.rule == StrayRule::stop,
          .clock = {.start = s.time, .dt = dt, .steps = &s.control.data()->steps},
          .f_bar_by_material = s.f_bar.by_material && s.f_bar.fraction > 0};
}

/// Whether the kernels of light laws alone do all that this run asks for.
template <class Space, class T, int Dim>
bool light_kernels_do(const ContactCore<Space, T, Dim>& s) {
  return s.light_laws && !(s.f_bar.by_material && s.f_bar.fraction > 0);
}

template <class Update, class Space, class T, int Dim>
Update update_of(const ContactCore<Space, T, Dim>& s, double dt,
                 const Kokkos::View<int*, typename Space::memory_space>& slots, int first) {
  const auto& set = s.soil;
  return {.source = {set.points, s.grid.inv_spacing},
          .begin = set.bins.begin,
          .slots = slots,
          .neighbours = s.patches.neighbours,
          .origin = s.patches.origin,
          .kinematics = s.nodes.kinematics,
          .sums = s.nodes,
          .contact = s.contact.place,
          .control = s.control,
          .movements = s.movements,
          .dilatation = dilatations_of(s),
          .grid = s.grid,
          .reach = WallReach<Dim>(s.grid),
          .alone = s.strays.alone,
          .put_back = s.strays.put_back,
          .by = update_scalars(s, dt),
          .spacing = s.spacing,
          .first = first,
          .law = s.law,
          .one_body = set.points.bodies.extent(0) == 1,
          .has_boundary = s.soil_boundary,
          .has_means = s.p2g.about_nodes && s.f_bar.fraction > 0};
}

}  // namespace mpm
