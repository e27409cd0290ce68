#include "step_kernels.hpp"
#include "window.hpp"

namespace mpm {
namespace {

/// What a particle takes from the nodes.
template <class T, int Dim>
struct Taken {
  Vector<T, Dim> velocity, acceleration;  // m/s, m/s2
  T gradient[Dim][Dim];                   // 1/s, L_ij = dv_i/dx_j
};

template <class T, int Dim, class Motion>
KOKKOS_INLINE_FUNCTION Taken<T, Dim> take_from_nodes(const Motion* window, const Coord<Dim>& cell,
                                                     const AxisWeights<T> (&a)[Dim], T inv_spacing) {
  Taken<T, Dim> t{};
  for_each_weight(a, [&](const Vector<int, Dim>& k, T w, const Vector<T, Dim>& grad) {
    const Motion* const node = window + window_place(cell, a, k) * NodeMotion<Dim>::size;
    for (int d = 0; d < Dim; ++d) {
      const T v_i = node[NodeMotion<Dim>::velocity + d];
      t.velocity[d] += w * v_i;
      t.acceleration[d] += w * node[NodeMotion<Dim>::acceleration + d];
      for (int e = 0; e < Dim; ++e) t.gradient[d][e] += v_i * grad[e];
    }
  });
  for (int d = 0; d < Dim; ++d)
    for (int e = 0; e < Dim; ++e) t.gradient[d][e] *= inv_spacing;
  return t;
}

/// The dilatation rate alone, sum v_i . grad S_ip [1/s].
template <class T, int Dim, class Motion>
KOKKOS_INLINE_FUNCTION T dilatation_from_nodes(const Motion* window, const Coord<Dim>& cell,
                                               const AxisWeights<T> (&a)[Dim], T inv_spacing) {
  T sum = 0;
  for_each_weight(a, [&](const Vector<int, Dim>& k, T, const Vector<T, Dim>& grad) {
    const Motion* const node = window + window_place(cell, a, k) * NodeMotion<Dim>::size;
    for (int d = 0; d < Dim; ++d) sum += node[NodeMotion<Dim>::velocity + d] * grad[d];
  });
  return sum * inv_spacing;
}

/// Strain increment (symmetric part of L dt, tensor shear strains) and spin increment (skew part).
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void increments(const T (&L)[Dim][Dim], T dt, SymTensor<T, Dim>& strain,
                                       Spin<T, Dim>& spin) {
  for (int k = 0; k < sym_size<Dim>; ++k) strain[k] = 0;
  for (int i = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) strain[sym_index<Dim>(i, j)] = dt * (L[i][j] + L[j][i]) / 2;
  spin.c[0] = dt * (L[0][1] - L[1][0]) / 2;
  if constexpr (Dim == 3) {
    spin.c[1] = dt * (L[1][2] - L[2][1]) / 2;
    spin.c[2] = dt * (L[2][0] - L[0][2]) / 2;
  }
}

/// Scalars of the particle update.
template <class T>
struct UpdateScalars {
  T dt, inv_spacing, flip, pic, f_bar;
};

/// One particle's step (Eqs (11)-(13)): strain and stress, volume, velocity, position. The share f_bar of its
/// dilatation is that of its cell, `mean_dilatation` [1/s]. Returns the largest component of its movement
/// [cells].
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION T advance(const Soil<Space, T, Dim>& soil, int p, const Taken<T, Dim>& t,
                                 T mean_dilatation, const UpdateScalars<T>& by) {
  SymTensor<T, Dim> d_strain;
  Spin<T, Dim> d_spin;
  increments(t.gradient, by.dt, d_strain, d_spin);
  T trace = 0;
  for (int d = 0; d < Dim; ++d) trace += d_strain[d];
  const T correction = by.f_bar * (by.dt * mean_dilatation - trace);
  for (int d = 0; d < 3; ++d) d_strain[d] += correction * T(1.0 / 3);
  trace += correction;

  MaterialState<T, Dim> state{soil.stress(p), soil.plastic_strain(p), soil.strength(p)};
  soil.materials(soil.bodies(soil.body(p)).material).visit([&](const auto& law) {
    law.update(state, d_strain, d_spin, by.dt);
  });
  soil.stress(p) = state.stress;
  soil.plastic_strain(p) = state.plastic_strain;

  soil.volume(p) *= (2 + trace) / (2 - trace);  // exp(trace) to second order: no drift in rotation

  Vector<T, Dim> v_p = soil.velocity(p), x_p = soil.coordinate(p);
  T moved = 0;
  for (int d = 0; d < Dim; ++d) {
    v_p[d] = by.flip * (v_p[d] + by.dt * t.acceleration[d]) + by.pic * t.velocity[d];
    const T movement = by.dt * t.velocity[d] * by.inv_spacing;
    x_p[d] += movement;
    moved = Kokkos::fmax(moved, Kokkos::fabs(movement));
  }
  soil.velocity(p) = v_p;
  soil.coordinate(p) = x_p;
  return moved;
}

/// Reports a particle that is not finite, has no volume, or moved so far in a step that the computation
/// cannot be trusted. `moved` [cells].
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION void check(const Soil<Space, T, Dim>& soil, int p, T moved, const Coord<Dim>& origin,
                                  const Coord<Dim>& cell, double spacing, const ControlView<Space>& control) {
  const Vector<T, Dim> x = soil.coordinate(p), v = soil.velocity(p);
  const SymTensor<T, Dim> s = soil.stress(p);
  T sum = soil.volume(p);
  for (int d = 0; d < Dim; ++d) sum += x[d] + v[d];
  for (int k = 0; k < sym_size<Dim>; ++k) sum += s[k];
  const bool finite = 0 * sum == 0;  // 0 times what is not finite is not zero
  if (finite && soil.volume(p) > 0 && moved <= 1) return;
  double position[3] = {};
  for (int d = 0; d < Dim; ++d) position[d] = (double(origin[d]) + cell[d] + x[d]) * spacing;
  const FaultKind kind =
      !finite ? FaultKind::not_finite : (moved <= 1 ? FaultKind::inverted : FaultKind::too_fast);
  report(control, kind, soil.id(p), position, Dim);
}

}  // namespace

template <class Space, class T, int Dim>
void update_particles(State<Space, T, Dim>& s, double dt_) {
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int size = NodeMotion<Dim>::size, window = Patch<Dim>::window, cells = Patch<Dim>::cells;
  using Window = Kokkos::View<T*, typename Space::scratch_memory_space, Kokkos::MemoryUnmanaged>;
  const auto soil = s.soil.points;
  const auto begin = s.soil.bins.begin;
  const auto around = s.patches.around;
  const auto origin = s.patches.origin;
  const auto motion = s.nodes.motion;
  const auto control = s.control;
  const double spacing = s.spacing;
  const Kokkos::View<T*, typename Space::memory_space, Kokkos::MemoryUnmanaged> dilatation(
      reinterpret_cast<T*>(s.spare.data()), soil.count);
  const double flip = s.xpic_order > 0 ? 1 : s.flip_share;  // XPIC has changed the velocities already
  const UpdateScalars<T> by{T(dt_), s.grid.inv_spacing, T(flip), T(1 - flip), T(s.f_bar_share)};
  Kokkos::parallel_for(
      "mpm::update_particles",
      light(Team(s.space, s.patches.slots, team_threads<Space>)
                .set_scratch_size(
                    0, Kokkos::PerTeam(Window::shmem_size(window * size) + Window::shmem_size(cells)))),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (control().paused) return;
        // in the order of memory, so that threads of the host keep to their part
        const int slot = team.league_rank();
        const int from = begin(slot * Patch<Dim>::cells), to = begin((slot + 1) * Patch<Dim>::cells);
        if (from == to) return;
        const Window nodes(team.team_scratch(0), window * size), mean(team.team_scratch(0), cells);
        Kokkos::parallel_for(Kokkos::TeamThreadRange(team, window), [&](int n) {
          const int i = number_at<decltype(around), Dim>(around, slot, window_coord<Dim>(n));
          for (int k = 0; k < size; ++k) nodes(n * size + k) = motion(i, k);
        });
        team.team_barrier();
        if (by.f_bar > 0) {
          Kokkos::parallel_for(Kokkos::TeamThreadRange(team, from, to), [&](int p) {
            with_weights(soil.coordinate(p), soil.bodies(soil.body(p)).half_length,
                         [&](const AxisWeights<T>(&a)[Dim]) {
                           dilatation(p) = dilatation_from_nodes<T, Dim>(
                               nodes.data(), coord_of<Dim>(soil.cell(p)), a, by.inv_spacing);
                         });
          });
          team.team_barrier();
          Kokkos::parallel_for(Kokkos::TeamThreadRange(team, cells), [&](int c) {
            T volume = 0, sum = 0;
            for (int p = begin(slot * cells + c); p < begin(slot * cells + c + 1); ++p) {
              volume += soil.volume(p);
              sum += soil.volume(p) * dilatation(p);
            }
            mean(c) = volume > 0 ? sum / volume : T(0);
          });
          team.team_barrier();
        }
        T moved = 0;
        const auto particle = [&](int p, T& furthest) {
          const Coord<Dim> cell = coord_of<Dim>(soil.cell(p));
          with_weights(
              soil.coordinate(p), soil.bodies(soil.body(p)).half_length, [&](const AxisWeights<T>(&a)[Dim]) {
                const T own = advance(soil, p, take_from_nodes<T, Dim>(nodes.data(), cell, a, by.inv_spacing),
                                      by.f_bar > 0 ? mean(soil.cell(p) - slot * cells) : T(0), by);
                check(soil, p, own, origin(slot), cell, spacing, control);
                furthest = Kokkos::fmax(furthest, own);
              });
        };
        Kokkos::parallel_reduce(Kokkos::TeamThreadRange(team, from, to), particle, Kokkos::Max<T>(moved));
        Kokkos::single(Kokkos::PerTeam(team), [&] {
          if (moved > Kokkos::atomic_load(&control().moved))
            Kokkos::atomic_max(&control().moved, static_cast<double>(moved));
        });
      });
}

#define MPM_INSTANTIATE(Space, T, Dim) template void update_particles(State<Space, T, Dim>&, double);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
