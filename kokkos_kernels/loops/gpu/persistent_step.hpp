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
/// A launch does many steps if WithNodes. Between two steps all teams wait for the last team, which requires
/// that all teams are co-resident on the device. If some teams have not begun when the others have finished
/// the first step, the launch ends with that step. The last team decides this. The part of the last team goes
/// to the team that begins first, so that it is never one of those that have not begun.
template <class Space, class T, int Dim, bool WithNodes, class Laws, ParticleDomain domain>
struct PersistentStep {
  static constexpr int threads = team_threads<Space>;
  static constexpr int k_teams = WithNodes ? 3 : teams_at_once<T, Dim>;  // that share a multiprocessor
  using Update = UpdateParticles<Space, T, Dim, true, PatchKind::any, Laws, domain, k_teams>;
  using NodeUpdate = UpdateNodes<Space, T, Dim, false>;
  using Member = typename Update::Member;
  using Rigids = Kokkos::Array<RigidSource<Space, T, Dim>, k_most_rigids>;
  using Sums = NodeSums<Space, T, Dim>;
  static constexpr int cells = Patch<Dim>::cells;
  using Team = typename Update::Team;
  Update update;
  NodeUpdate nodes;
  EndStep<Space, T, Dim> end;
  Rigids rigids;
  int rigid_count, rigid_teams, steps;
  // Of the step at hand, of the next one, and of the last one, which are set to zero. They take turns.
  Kokkos::Array<Sums, 3> sums;
  Kokkos::View<LaunchBarrier, typename Space::memory_space> launch_barrier;

  static constexpr std::size_t bytes(int values) {
    return (WithNodes ? 2 * scratch_bytes<int>(Update::window) + scratch_bytes<Rigid<Dim>>(values / Dim) +
                            scratch_bytes<double>(values * cells)
                      : 0) +
           Update::bytes();
  }

  /// What a team knows of its slot in all steps.
  struct Slot {
    int number, near;  // near: a rigid, as in State::near_rigid
    Coord<Dim> from;
    bool empty;
    int* numbers;  // of the images of the window's nodes
    int* images;   // WindowImages::entry of these nodes
  };

  KOKKOS_FUNCTION void operator()(const Member& team) const {
    const Control& control = update.control();
    const int before = launch_barrier().signal.ended, others = team.league_size() - 1;
    if ((control.paused & ~Pause::last) != 0) return;
    int part = team.league_rank();
    if (steps > 1)
      Kokkos::single(
          Kokkos::PerTeam(team),
          [&](int& taken) {
            taken = (Kokkos::atomic_fetch_add(&launch_barrier().begun, 1) + others) % (others + 1);
          },
          part);
    Scratch scratch(team, bytes(nodes.value_count));
    Slot slot{};
    if (WithNodes && part >= rigid_teams && part < others) slot = slot_of(team, scratch, part - rigid_teams);
    for (int k = 0; k < steps; ++k) {
      int paused = 0;
      if (part < others) {
        step(team, scratch, part, slot, k);
        paused = arrive(team, before + k, k + 1 < steps);
      } else {
        paused = end_step(team, scratch, others, before + k, k == 0 && steps > 1);
      }
      if (paused != 0) return;
    }
  }

  KOKKOS_INLINE_FUNCTION Slot slot_of(const Member& team, Scratch& scratch, int number) const {
    const bool empty = update.begin(number * cells) == update.begin((number + 1) * cells);
    const Slot slot{number,
                    nodes.value_count > 0 ? update.near_rigid(number) : 0,
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

  KOKKOS_INLINE_FUNCTION void step(const Member& team, const Scratch& scratch, int part, const Slot& slot,
                                   int k) const {
    if (part < rigid_teams)
      rigids_to_nodes(team, part, Scratch(scratch).template take<double>(0), sums[(k + 1) % 3]);
    else if constexpr (WithNodes)
      step_slot(team, scratch, slot, sums[k % 3], sums[(k + 1) % 3], sums[(k + 2) % 3]);
    else
      update.update(team, scratch, update.slots(part - rigid_teams));
  }

  /// Says that the team is done with its part of a step, and waits for its end if there is another. Returns
  /// why the steps are paused.
  KOKKOS_INLINE_FUNCTION int arrive(const Member& team, int ended, bool waits) const {
    team.team_barrier();
    int paused = 0;
    Kokkos::single(
        Kokkos::PerTeam(team),
        [&](int& why) {
          fence_of_teams();  // what this team noted is there for the last one
          Kokkos::atomic_inc(&launch_barrier().arrived);
          Signal signal{ended, 0};
          while (waits && signal.ended == ended && (signal.paused & Pause::last) == 0)
            signal = Kokkos::bit_cast<Signal>(acquire_of_others(signal_bits()));
          why = signal.paused;
        },
        paused);
    return paused;
  }

  KOKKOS_INLINE_FUNCTION long long* signal_bits() const {
    return reinterpret_cast<long long*>(&launch_barrier().signal);
  }
  KOKKOS_INLINE_FUNCTION void tell(const Signal& signal) const {
    store_for_others(signal_bits(), Kokkos::bit_cast<long long>(signal));
  }

  /// Waits for all others and ends their step, the one after so many of all launches.
  KOKKOS_INLINE_FUNCTION int end_step(const Member& team, Scratch scratch, int others, int ended,
                                      bool impatient) const {
    Control& control = update.control();
    Kokkos::single(Kokkos::PerTeam(team), [&] {
      for (int looks = 0; acquire_of_others(&launch_barrier().arrived) < others; ++looks)
        if (impatient && looks == k_patience) {
          control.paused |= Pause::last;
          tell({ended, Pause::last});
        }
    });
    team.team_barrier();
    int paused = end(team, scratch.template take<double>(0));
    Kokkos::single(
        Kokkos::PerTeam(team),
        [&](int& why) {
          if ((paused & Pause::last) != 0) control.paused = paused += Pause::not_co_resident - Pause::last;
          why = paused;
          launch_barrier().begun = launch_barrier().arrived = 0;
          fence_of_teams();
          tell({ended + 1, paused});
        },
        paused);
    return paused;
  }

  KOKKOS_INLINE_FUNCTION void rigids_to_nodes(const Member& team, int part, double* room,
                                              const Sums& next) const {
    MPM_ROLLED
    for (int k = 0; k < rigid_count; ++k) {
      const auto& source = rigids[k];
      const Vector<double, Dim> to = end.template next_displacement<!WithNodes>(team, source.rigid, room);
      const int all = rigid_teams * threads;
      MPM_ROLLED
      for (int p = part * threads + team.team_rank(); p < source.points.count; p += all) {
        source.move(p, to);
        give_to_nodes(source, nodes.places, p, [&](int i, int v, T value) {
          Kokkos::atomic_add(&next.rigid(source.rigid, i, v), value);
        });
      }
    }
  }

  /// The nodes that matter to a slot, and its particles if it has any.
  KOKKOS_INLINE_FUNCTION void step_slot(const Member& team, Scratch scratch, const Slot& slot,
                                        const Sums& present, const Sums& next, const Sums& last) const {
    const int rigid_bodies = nodes.value_count / Dim;
    Rigid<Dim>* const bodies = scratch.take<Rigid<Dim>>(rigid_bodies);
    double* const force = scratch.take<double>(nodes.value_count * cells);
    if (slot.near > 0) copy_rigids(team, bodies, rigid_bodies);
    typename Update::Images images(update.grid, update.reach, slot.from);
    images.table = slot.images;
    const auto motion_of = [&](int n, int number) {
      const int image = images(n);
      const Coord<Dim> place = window_coord<Dim>(n), at = in_mesh(slot.from, window_coord<Dim>(image));
      bool own = true;
      for (int d = 0; d < Dim; ++d) own = own && place[d] >= 0 && place[d] < Patch<Dim>::edge;
      if (slot.empty && !own) return KinematicValues<T, Dim>{};
      double* const told = own && slot.near > 0 ? force + place_of<Dim>(place) : nullptr;
      for (int v = 0; v < nodes.value_count && told != nullptr; ++v) told[v * cells] = 0;
      const bool beyond = image != n;  // of a wall, where a node has no motion of its own
      const KinematicValues<T, Dim> kinematics =
          nodes.kinematics(present, bodies, number, at, slot.near > 0, beyond ? nullptr : told);
      if (own)
        nodes.keep(slot.number * cells + place_of<Dim>(place),
                   beyond ? KinematicValues<T, Dim>{} : kinematics);
      return kinematics;
    };
    update.update(
        team, scratch, slot.number, next, images, [&](int n) { return slot.numbers[n]; }, motion_of);
    clear_sums(team, last, slot.number, nodes.has_boundary, nodes.has_mass_normals ? rigid_bodies : 0);
    if (slot.near == 0) return;
    team.team_barrier();
    nodes.leave_forces(team, force, slot.near - 1);
  }

  /// To scratch memory, where a node may look at one value of theirs after the other.
  KOKKOS_INLINE_FUNCTION void copy_rigids(const Member& team, Rigid<Dim>* bodies, int count) const {
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
