#pragma once
// The persistent step: one launch does several functions of a step, or many steps one after the other, and
// its teams wait for each other.

#include <cstdint>
#include <type_traits>

#include "device/acquire.hpp"
#include "device/warp.hpp"
#include "loops/end_step.hpp"
#include "loops/gpu/patch_update.hpp"
#include "loops/node_update.hpp"

namespace mpm {

inline constexpr int k_most_rigids = 4;  // with points, which are arguments of the launch

/// Polls after which the last team assumes that the teams are not co-resident on the device: some ms.
inline constexpr int k_patience = 20'000;

/// The launch. The first teams move the points of rigids to their next positions and add their mass to the
/// nodes. Each of the other teams takes a slot. The last team waits for all others, moves the rigids and
/// counts the step.
///
/// If WithNodes, the team of a slot itself updates all nodes that its particles reach, so that no team waits
/// for another team's nodes. The team keeps the motion of the slot's own nodes, and sums the force of these
/// nodes on the rigids. Otherwise the nodes have been updated by an earlier launch.
///
/// A launch does many steps if WithNodes. Between two steps all teams wait for each other, which requires
/// that all teams are co-resident on the device. If some teams have not begun when the others have finished
/// the first step, the launch ends with that step. The last team decides this. The part of the last team goes
/// to the team that begins first, so that it is never one of those that have not begun.
///
/// From the second step on, each team ends the step for itself, on its own copy of the rigids, as soon as all
/// teams have done their parts; all teams compute the same values. No team then waits for the answer of the
/// last team through memory, which would take three times the latency of the L2 cache. The input of the end
/// of a step is kept in turns, because a team may begin the next step before another team has read it. Where
/// loads follow tables, and with laws that may ask for the time, all teams wait for the last team in each
/// step.
template <class Space, class T, int Dim, bool WithNodes, class Laws, ParticleDomain domain>
struct PersistentStep {
  static constexpr int threads = team_threads<Space>;
  static constexpr int k_teams = WithNodes ? 3 : teams_at_once<T, Dim>;  // that share a multiprocessor
  using Update = UpdateParticles<Space, T, Dim, true, PatchKind::any, Laws, domain, k_teams>;
  using NodeUpdate = UpdateNodes<Space, T, Dim, false>;
  using Member = typename Update::Member;
  /// Members of RigidSource that differ between rigids: the arguments of a launch have little room.
  struct PointsOfRigid {
    RigidPoints<Space, T, Dim> points;
    int rigid;
  };
  using Rigids = Kokkos::Array<PointsOfRigid, k_most_rigids>;
  using Sums = NodeSums<Space, T, Dim>;
  static constexpr int cells = Patch<Dim>::cells;
  using Team = typename Update::Team;
  Update update;
  NodeUpdate nodes;
  EndStep<Space, T, Dim> end;
  Rigids rigids;
  int rigid_count, rigid_teams, steps;
  // Sums of the step at hand, of the next step, and of the last step, which are set to zero. They take turns.
  Kokkos::Array<Sums, 3> sums;
  Kokkos::View<LaunchBarrier, typename Space::memory_space> launch_barrier;
  Movements<Space, 3> movements;  // where WithNodes

  static constexpr std::size_t bytes(int values) {
    return (WithNodes ? 2 * scratch_bytes<int>(Update::window) +
                            scratch_bytes<Rigid<Dim>>(values / wrench_size<Dim>(false)) +
                            scratch_bytes<double>(values * cells)
                      : 0) +
           Update::bytes();
  }

  /// Figures of a team's slot, the same in all steps.
  struct Slot {
    int number, contact;  // contact: as ContactSlots::place
    Coord<Dim> from;
    bool empty;
    int* numbers;  // of the images of the window's nodes
    int* images;   // WindowImages::entry of these nodes
  };

  /// How far a team is.
  struct Progress {
    int part, others;   // the last part is number `others`
    unsigned arrivals;  // LaunchBarrier::arrived once all are done with the step at hand
    int step, number;   // of this launch, of all launches
    bool by_all;        // each team ends the step for itself
    StepEnd found;      // where that is so, by the step before
    Rigid<Dim>* bodies;
  };

  KOKKOS_FUNCTION void operator()(const Member& team) const {
    if ((update.control().paused & ~Pause::last) != 0) return;
    Progress at{.part = team.league_rank(),
                .others = team.league_size() - 1,
                .arrivals = launch_barrier().before,
                .step = 0,
                .number = launch_barrier().signal.ended,
                .by_all = false,
                .found = StepEnd(update.control()),
                .bodies = nullptr};
    if (steps > 1)
      Kokkos::single(
          Kokkos::PerTeam(team),
          [&](int& taken) {
            taken = (Kokkos::atomic_fetch_add(&launch_barrier().begun, 1) + at.others) % (at.others + 1);
          },
          at.part);
    Scratch scratch(team, bytes(nodes.value_count));
    Slot slot{};
    if (WithNodes && at.part >= rigid_teams && at.part < at.others)
      slot = slot_of(team, scratch, at.part - rigid_teams);
    if (WithNodes) at.bodies = scratch.take<Rigid<Dim>>(nodes.rigid_count());
    for (; at.step < steps; ++at.step, ++at.number) {
      if (at.part < at.others) step(team, scratch, slot, at);
      if (end_step(team, scratch, at) != 0) return;
      if (at.step == 0 && steps > 1) begin_by_all(team, at);
    }
  }

  KOKKOS_INLINE_FUNCTION Slot slot_of(const Member& team, Scratch& scratch, int number) const {
    const bool empty = update.begin(number * cells) == update.begin((number + 1) * cells);
    const Slot slot{number,
                    nodes.value_count > 0 ? update.contact(number) : 0,
                    update.origin(number),
                    empty,
                    scratch.take<int>(Update::window),
                    scratch.take<int>(Update::window)};
    const auto images = update.images_at(number);
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, Update::window), [&](int n) {
      slot.images[n] = images.entry(n);
      slot.numbers[n] = number_at<decltype(update.neighbours), Dim>(update.neighbours, number,
                                                                    window_coord<Dim>(images(n)));
    });
    return slot;
  }

  KOKKOS_INLINE_FUNCTION void step(const Member& team, const Scratch& scratch, const Slot& slot,
                                   const Progress& at) const {
    if (at.part < rigid_teams)
      rigids_to_nodes(team, Scratch(scratch).template take<double>(0), at);
    else if constexpr (WithNodes)
      step_slot(team, scratch, slot, at);
    else
      update.update(team, scratch, update.slots(at.part - rigid_teams));
  }

  /// The state in which the first step has left all that a team needs to end the next ones.
  KOKKOS_INLINE_FUNCTION void begin_by_all(const Member& team, Progress& at) const {
    if constexpr (WithNodes && std::is_same_v<Laws, LightMaterials>) {
      if (end.timed.count > 0) return;
      at.by_all = true;
      at.found = StepEnd(update.control());
      at.found.fault = false;  // another team may have met one in the next step; its movements report it
      copy_rigids(team, at.bodies);
    }
  }

  /// Waits until all parts of a step are done, and ends it. Returns why the steps are paused.
  KOKKOS_INLINE_FUNCTION int end_step(const Member& team, const Scratch& scratch, Progress& at) const {
    at.arrivals += at.others + at.by_all;
    team.team_barrier();
    if (!at.by_all && at.part < at.others) return wait_for_answer(team, at);
    wait_for_all(team, at);
    auto left = end.left();
    if (WithNodes) {
      left.forces += force_turn(at) * end.slots * nodes.value_count;
      left.movements = movements_of(at.number);
      if (at.part == (at.by_all ? 0 : at.others)) clear(team, movements_of(at.number + 2));
    }
    if (at.by_all) {
      left.rigids = at.bodies;
      if (at.part < at.others) left.sums = nullptr;
    }
    if (!at.by_all) at.found = StepEnd(update.control());
    const double damping = WithNodes ? 0 : end.damping;  // local damping excludes many steps
    at.found = end.template move<false>(team, at.found, left, !at.by_all,
                                        Scratch(scratch).template take<double>(0), damping);
    if (!at.by_all)
      answer(team, at);
    else if (at.part == at.others && (at.found.paused != 0 || at.step + 1 == steps))
      leave(team, at);
    team.team_barrier();  // before the room of `end` is used again
    return at.found.paused;
  }

  /// Where a step notes movements, by its number; with number + 2, where the step before it did. By value:
  /// nvcc would copy all arguments of the kernel to memory for a reference to one of an array of views.
  KOKKOS_INLINE_FUNCTION MovementPlaces<Space> movements_of(int number) const {
    return movements.of(number % 3);
  }
  KOKKOS_INLINE_FUNCTION static void clear(const Member& team, const MovementPlaces<Space>& movements) {
    for_team(team, movements.places, [&](int n) { movements.begin(n); });
  }
  /// Which half of the forces of slots belongs to a step.
  KOKKOS_INLINE_FUNCTION static int force_turn(const Progress& at) { return WithNodes ? at.number & 1 : 0; }

  /// Says that the team is done with its part, and waits for the last team's answer if there is another step.
  KOKKOS_INLINE_FUNCTION int wait_for_answer(const Member& team, const Progress& at) const {
    int paused = 0;
    Kokkos::single(
        Kokkos::PerTeam(team),
        [&](int& why) {
          fence_of_teams();  // what this team noted is there for the last one
          Kokkos::atomic_inc(&launch_barrier().arrived);
          Signal signal{at.number, 0};
          while (at.step + 1 < steps && signal.ended == at.number && (signal.paused & Pause::last) == 0)
            signal = Kokkos::bit_cast<Signal>(acquire_of_others(signal_bits()));
          why = signal.paused;
        },
        paused);
    return paused;
  }

  /// Waits until so many have arrived; this team is one of them where each ends the step for itself.
  KOKKOS_INLINE_FUNCTION void wait_for_all(const Member& team, const Progress& at) const {
    const bool impatient = at.step == 0 && steps > 1;
    Kokkos::single(Kokkos::PerTeam(team), [&] {
      if (at.by_all) {
        fence_of_teams();
        Kokkos::atomic_inc(&launch_barrier().arrived);
      }
      const auto missing = [&] {
        return static_cast<int>(acquire_of_others(&launch_barrier().arrived) - at.arrivals) < 0;
      };
      for (int looks = 0; missing(); ++looks)
        if (impatient && looks == k_patience) {
          update.control().paused |= Pause::last;
          publish({at.number, Pause::last});
        }
    });
    team.team_barrier();
  }

  KOKKOS_INLINE_FUNCTION long long* signal_bits() const {
    return reinterpret_cast<long long*>(&launch_barrier().signal);
  }
  KOKKOS_INLINE_FUNCTION void publish(const Signal& signal) const {
    store_for_others(signal_bits(), Kokkos::bit_cast<long long>(signal));
  }

  /// The last team's answer to all others.
  KOKKOS_INLINE_FUNCTION void answer(const Member& team, Progress& at) const {
    Control& control = update.control();
    const int done = control.steps + 1;
    if ((at.found.paused & Pause::last) != 0) at.found.paused += Pause::not_co_resident - Pause::last;
    end.set_timed(team, done);
    team.team_barrier();
    Kokkos::single(Kokkos::PerTeam(team), [&] {
      at.found.keep_in(control);
      control.steps = done;
      launch_barrier().begun = 0;
      launch_barrier().before = at.arrivals;
      fence_of_teams();
      if (WithNodes) publish({at.number + 1, at.found.paused});
    });
  }

  /// Stores the results of the steps for the host and the next launch, after every team has ended its steps.
  KOKKOS_INLINE_FUNCTION void leave(const Member& team, const Progress& at) const {
    for (int r = team.team_rank(); r < end.count; r += team.team_size())
      at.bodies[r].template keep_in<false>(nodes.rigids(r));
    Kokkos::single(Kokkos::PerTeam(team), [&] {
      at.found.keep_in(update.control());
      update.control().steps += at.step;
      launch_barrier().before = at.arrivals;
      publish({at.number + 1, at.found.paused});
    });
  }

  KOKKOS_INLINE_FUNCTION void rigids_to_nodes(const Member& team, double* room, const Progress& at) const {
    const Sums& next = sums[(at.step + 1) % 3];
    MPM_ROLLED
    for (int k = 0; k < rigid_count; ++k) {
      const RigidSource<Space, T, Dim> source{rigids[k].points, nodes.rigids, rigids[k].rigid,
                                              nodes.places.origin, nodes.spacing};
      const Rigid<Dim>& body = at.by_all ? at.bodies[source.rigid] : nodes.rigids(source.rigid);
      const RigidPose<Dim> to = end.template pose_after<!WithNodes>(team, source.rigid, body, room);
      const int all = rigid_teams * threads;
      MPM_ROLLED
      for (int p = at.part * threads + team.team_rank(); p < source.points.count; p += all) {
        source.move(p, to);
        give_to_nodes(source, nodes.places, p, [&](int i, int v, T value) {
          Kokkos::atomic_add(&next.rigid(source.rigid, i, v), value);
        });
      }
    }
  }

  /// The nodes that matter to a slot, and its particles if it has any.
  KOKKOS_INLINE_FUNCTION void step_slot(const Member& team, Scratch scratch, const Slot& slot,
                                        const Progress& at) const {
    const Sums &present = sums[at.step % 3], &next = sums[(at.step + 1) % 3], &last = sums[(at.step + 2) % 3];
    const int rigid_bodies = nodes.rigid_count();
    const Rigid<Dim>* const bodies = at.bodies;
    double* const force = scratch.take<double>(nodes.value_count * cells);
    if (slot.contact > 0 && !at.by_all) copy_rigids(team, at.bodies);
    typename Update::Images images(update.grid, update.reach, slot.from);
    images.table = slot.images;
    const auto motion_of = [&](int n, int number) {
      const int image = images(n);
      const Coord<Dim> place = window_coord<Dim>(n), in = in_mesh(slot.from, window_coord<Dim>(image));
      bool own = true;
      for (int d = 0; d < Dim; ++d) own = own && place[d] >= 0 && place[d] < Patch<Dim>::edge;
      if (slot.empty && !own) return KinematicValues<T, Dim>{};
      double* const on_rigids = own && slot.contact > 0 ? force + place_of<Dim>(place) : nullptr;
      for (int v = 0; v < nodes.value_count && on_rigids != nullptr; ++v) on_rigids[v * cells] = 0;
      const bool beyond = image != n;  // of a wall, where a node has no motion of its own
      const KinematicValues<T, Dim> kinematics =
          nodes.kinematics(present, bodies, number, in, slot.contact > 0, beyond ? nullptr : on_rigids);
      if (own)
        nodes.keep(slot.number * cells + place_of<Dim>(place),
                   beyond ? KinematicValues<T, Dim>{} : kinematics);
      return kinematics;
    };
    update.update(
        team, scratch, slot.number, next, movements_of(at.number), images,
        [&](int n) { return slot.numbers[n]; }, motion_of);
    clear_sums(team, last, slot.number, nodes.has_boundary, nodes.has_mass_normals ? rigid_bodies : 0);
    if (slot.contact == 0) return;
    team.team_barrier();
    nodes.leave_forces(team, force, nodes.value_count, slot.contact - 1 + force_turn(at) * end.slots);
  }

  /// Copies the rigids to scratch memory, where a node may read their values one after the other.
  KOKKOS_INLINE_FUNCTION void copy_rigids(const Member& team, Rigid<Dim>* bodies) const {
    const int count = nodes.rigid_count();
    using Word = std::uint64_t;
    static_assert(sizeof(Rigid<Dim>) % sizeof(Word) == 0 && std::is_trivially_copyable_v<Rigid<Dim>>);
    const Word* const from = reinterpret_cast<const Word*>(nodes.rigids.data());
    Word* const to = reinterpret_cast<Word*>(bodies);
    const int words = count * static_cast<int>(sizeof(Rigid<Dim>) / sizeof(Word));
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, words), [&](int n) { to[n] = from[n]; });
    team.team_barrier();
  }
};

}  // namespace mpm
