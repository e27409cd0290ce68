#include "functions/update_about_nodes.hpp"

#include "base/copy.hpp"
#include "functions/launch_about_nodes.hpp"
#include "loops/gpu/cell_dilatation.hpp"
#include "loops/interpolation.hpp"

namespace mpm {
namespace {

template <class Space>
using Slots = Kokkos::View<int*, typename Space::memory_space>;

/// Calls f(first, middle, last) for the parts of the slots that hold soil: common ones, and others.
template <class Space, class T, class F>
void for_each_part(const ContactCore<Space, T, 3>& s, const F& f) {
  for (const auto& of : s.split.parts) f(s.split.slots, of.first, of.middle, of.last);
  if (s.split.parts.empty()) f(s.soil.bins.active_slots, 0, 0, s.soil.bins.last_active);
}

/// Calls f(p) for the particles of the slots [first, last).
template <class Space, class T, class F>
void for_each_particle_of(const ContactCore<Space, T, 3>& s, const char* name, const Slots<Space>& slots,
                          int first, int last, const F& f) {
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int bins = Patch<3>::cells, threads = 128;
  const auto begin = s.soil.bins.begin;
  const auto control = s.control;
  if (first < last)
    Kokkos::parallel_for(
        name, light(Team(s.space, last - first, threads)),
        KOKKOS_LAMBDA(const typename Team::member_type& team) {
          if (control().paused) return;
          const int slot = slots(first + team.league_rank());
          Kokkos::parallel_for(Kokkos::TeamThreadRange(team, begin(slot * bins), begin((slot + 1) * bins)),
                               [&](int p) { f(p); });
        });
}

/// A team adds volume, and volume times dilatation rate, of the particles of a patch anywhere to those of
/// their cells.
template <class Space, class T>
struct AddToCells {
  using Update = UpdateParticles<Space, T, 3, false, PatchKind::any, LightMaterials>;
  using Member = typename Update::Member;
  using Motion = KinematicValues<T, 3>;
  Update all;
  CellMeans<Space, T> means;

  static constexpr std::size_t bytes() { return scratch_bytes<Motion>(Update::window); }

  KOKKOS_FUNCTION void operator()(const Member& team) const {
    const int paused = all.control().paused, slot = all.slots(all.first + team.league_rank());
    if (paused) return;
    Scratch scratch(team, bytes());
    Motion* const nodes = scratch.take<Motion>(Update::window);
    const auto images = all.images_at(slot);
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, Update::window), [&](int n) {
      const int number =
          number_at<decltype(all.neighbours), 3>(all.neighbours, slot, window_coord<3>(images(n)));
      Motion motion{};
      if (number >= 0) motion = *reinterpret_cast<const Motion*>(&all.kinematics(number, 0));
      turn_motion(images, n, motion);
      nodes[n] = motion;
    });
    team.team_barrier();
    constexpr int bins = Patch<3>::cells;
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, all.begin(slot * bins), all.begin((slot + 1) * bins)),
                         [&](int p) { add(nodes, p); });
  }
  KOKKOS_INLINE_FUNCTION void add(const Motion* nodes, int p) const {
    const auto& soil = all.source.points;
    const T volume = soil.volume(p);
    T rate = 0;
    with_weights_near(soil.coordinate(p), soil.bodies(soil.body(p)).half_length, [&](const auto& a) {
      rate = dilatation_from_nodes<ParticleDomain::fixed, T, 3>(nodes, coord_of<3>(soil.cell(p)), a,
                                                                all.by.inv_spacing);
    });
    Vector<T, 2>& sum = means.sums(cell_of_corner(all.neighbours, soil.cell(p), means.place(p).corner()));
    Kokkos::atomic_add(&sum[0], volume);
    Kokkos::atomic_add(&sum[1], volume * rate);
  }
};

/// Sets the dilatation of a particle to the mean of its cell.
template <class Space, class T>
struct TakeMean {
  Kokkos::View<int*, typename Space::memory_space> cell;
  decltype(Patches<Space, 3>::neighbours) neighbours;
  CellMeans<Space, T> means;
  Dilatations<Space, T> dilatation;

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    const Vector<T, 2> sum = means.sums(cell_of_corner(neighbours, cell(p), means.place(p).corner()));
    dilatation(p) = CellMean<T>{sum[0], sum[1]}.value();
  }
};

}  // namespace

template <class Space, class T, int Dim>
void update_about_nodes([[maybe_unused]] const ContactCore<Space, T, Dim>& s, [[maybe_unused]] double dt,
                        [[maybe_unused]] const Kokkos::View<int*, typename Space::memory_space>& slots,
                        [[maybe_unused]] const Part<Space>& part) {
  if constexpr (is_device<Space> && Dim == 3) {
    if (part.first == part.last) return;
    if (!light_kernels_do(s)) return launch_laws_about_nodes(s, dt, slots, part);
    if (s.f_bar.fraction > 0) return launch_about_nodes<LightMaterials, true>(s, dt, slots, part);
    launch_about_nodes<LightMaterials, false>(s, dt, slots, part);
  }
}

template <class Space, class T, int Dim>
void sum_others([[maybe_unused]] const ContactCore<Space, T, Dim>& s,
                [[maybe_unused]] const Kokkos::View<int*, typename Space::memory_space>& slots,
                [[maybe_unused]] const Part<Space>& part) {
  if constexpr (is_device<Space> && Dim == 3) {
    using Source = SoilSource<Space, T, Dim>;
    auto bins = bins_of(s.soil.bins, part);
    bins.active_slots = slots;
    interpolate<Source>(s, P2G::tile, bins, {s.soil.points, s.grid.inv_spacing}, s.nodes.soil, part.space);
  }
}

template <class Space, class T, int Dim>
void sum_dilatations([[maybe_unused]] const ContactCore<Space, T, Dim>& s) {
  if constexpr (is_device<Space> && Dim == 3) {
    const auto& means = s.cell_means;
    Kokkos::deep_copy(s.space, bytes_of<char>(means.sums), char(0));
    for_each_part(s, [&](const auto& slots, int first, int middle, int last) {
      using Sum = CellDilatations<Space, T, LightMaterials>;
      if (first < middle)
        launch_large_teams(s.space, middle - first,
                           Sum{update_about_nodes_of<LightMaterials, true>(s, 0, slots, first)});
      using Add = AddToCells<Space, T>;
      using Team = typename Add::Update::Team;
      if (middle < last)
        Kokkos::parallel_for("mpm::sum_dilatations",
                             light(Team(s.space, last - middle, Add::Update::threads)
                                       .set_scratch_size(0, Kokkos::PerTeam(Add::bytes() + k_scratch_slack))),
                             Add{update_of<typename Add::Update>(s, 0, slots, middle), means});
    });
    const TakeMean<Space, T> take{s.soil.points.cell, s.patches.neighbours, means, dilatations_of(s)};
    for_each_part(s, [&](const auto& slots, int first, int middle, int last) {
      const int from = s.plan.sums_ahead ? middle : first;  // a kernel of common patches takes the sums
      for_each_particle_of(s, "mpm::mean_dilatations", slots, from, last, take);
    });
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                   \
  template void update_about_nodes(const ContactCore<Space, T, Dim>&, double,                            \
                                   const Kokkos::View<int*, typename Space::memory_space>&,              \
                                   const Part<Space>&);                                                  \
  template void sum_others(const ContactCore<Space, T, Dim>&,                                            \
                           const Kokkos::View<int*, typename Space::memory_space>&, const Part<Space>&); \
  template void sum_dilatations(const ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
