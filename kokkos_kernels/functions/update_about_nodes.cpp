#include "functions/update_about_nodes.hpp"

#include "base/copy.hpp"
#include "loops/gpu/cell_dilatation.hpp"
#include "loops/gpu/update_about_nodes.hpp"

namespace mpm {
namespace {

template <class Space>
using Slots = Kokkos::View<int*, typename Space::memory_space>;

template <bool HasMeans, class Space, class T>
auto update_of_common(const ContactCore<Space, T, 3>& s, double dt, const Slots<Space>& slots, int first) {
  using Update = UpdateAboutNodes<Space, T, LightMaterials, HasMeans>;
  return Update{update_of<typename Update::Update>(s, dt, slots, first), s.cell_means};
}

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

/// Adds volume, and volume times dilatation rate, of a particle anywhere to its cell's.
template <class Space, class T>
struct AddToCell {
  Soil<Space, T, 3> soil;
  NodePlaces<Space, T, 3> places;
  NodeField<Space, T, NodeKinematics<3>::size> kinematics;
  CellMeans<Space, T> means;
  T inv_spacing;

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    T rate = 0;
    with_weights(soil.coordinate(p), soil.bodies(soil.body(p)).half_length, [&](const auto& a) {
      const Stencil<Kind::motion, T, 3> stencil(places, soil.cell(p), a);
      for_each_weight(a, [&](const Vector<int, 3>& k, T w, const auto& grad) {
        if (!(w > 0)) return;  // such a node may lie where there is no patch
        const int i = stencil.node(places.neighbours, k);
        for (int d = 0; d < 3; ++d)
          rate += grad[d] * stencil.sign(k, d) * kinematics(i, NodeKinematics<3>::velocity + d);
      });
    });
    const T volume = soil.volume(p);
    Vector<T, 2>& sum = means.sums(cell_of_corner(places.neighbours, soil.cell(p), means.corner(p)));
    Kokkos::atomic_add(&sum[0], volume);
    Kokkos::atomic_add(&sum[1], volume * rate * inv_spacing);
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
    const Vector<T, 2> sum = means.sums(cell_of_corner(neighbours, cell(p), means.corner(p)));
    dilatation(p) = CellMean<T>{sum[0], sum[1]}.value();
  }
};

}  // namespace

template <class Space, class T, int Dim>
void update_about_nodes([[maybe_unused]] const ContactCore<Space, T, Dim>& s, [[maybe_unused]] double dt,
                        [[maybe_unused]] const Kokkos::View<int*, typename Space::memory_space>& slots,
                        [[maybe_unused]] const Part<Space>& part) {
  if constexpr (is_device<Space> && Dim == 3) {
    const int teams = part.last - part.first;
    if (teams == 0) return;
    if (s.f_bar.fraction > 0)
      launch_large_teams(part.space, teams, update_of_common<true>(s, dt, slots, part.first));
    else
      launch_large_teams(part.space, teams, update_of_common<false>(s, dt, slots, part.first));
  }
}

template <class Space, class T, int Dim>
void sum_dilatations([[maybe_unused]] const ContactCore<Space, T, Dim>& s) {
  if constexpr (is_device<Space> && Dim == 3) {
    const auto& means = s.cell_means;
    const AddToCell<Space, T> add{
        s.soil.points, {s.grid, s.patches}, s.nodes.kinematics, means, s.grid.inv_spacing};
    Kokkos::deep_copy(s.space, bytes_of<char>(means.sums), char(0));
    for_each_part(s, [&](const auto& slots, int first, int middle, int last) {
      using Sum = CellDilatations<Space, T, LightMaterials>;
      if (first < middle)
        launch_large_teams(s.space, middle - first, Sum{update_of_common<true>(s, 0, slots, first)});
      for_each_particle_of(s, "mpm::sum_dilatations", slots, middle, last, add);
    });
    const TakeMean<Space, T> take{s.soil.points.cell, s.patches.neighbours, means, dilatations_of(s)};
    for_each_part(s, [&](const auto& slots, int, int middle, int last) {
      for_each_particle_of(s, "mpm::mean_dilatations", slots, middle, last, take);
    });
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                      \
  template void update_about_nodes(const ContactCore<Space, T, Dim>&, double,               \
                                   const Kokkos::View<int*, typename Space::memory_space>&, \
                                   const Part<Space>&);                                     \
  template void sum_dilatations(const ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
