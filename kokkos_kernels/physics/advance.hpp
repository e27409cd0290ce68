#pragma once
// Update of one particle in a step (Eqs (11)-(13)), or of as many as an instruction of a processor takes at
// once. The real type R of a particle is T, or lanes of T; parameters are T.

#include <type_traits>

#include "base/lanes.hpp"
#include "data/nodes.hpp"
#include "data/particles.hpp"
#include "physics/cell_mean.hpp"
#include "physics/gap_room.hpp"
#include "physics/materials/any.hpp"
#include "physics/pore_water.hpp"
#include "physics/ring_domain.hpp"

namespace mpm {

/// Domain of particle p in the form that a step takes.
template <ParticleDomain domain, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION auto step_domain([[maybe_unused]] const Soil<Space, T, Dim>& soil,
                                        [[maybe_unused]] int p) {
  if constexpr (domain == ParticleDomain::ring)
    return domain_of<domain>(soil, p, soil.bodies(soil.body(p)));
  else
    return PlaneDomain{};
}

/// Sample of the nodes at a particle.
template <class T, int Dim, int Slopes = Dim>
struct GridSample {
  T kinematics[NodeKinematics<Dim>::size];  // m/s, m/s2
  T gradient[Dim][Slopes];                  // 1/s, L_ij = dv_i/dx_j, and of rings sum v_i T S
};

/// Strain increment (symmetric part of L dt, tensor shear strains) and spin increment (skew part) of a
/// velocity gradient L [1/s]. That of a ring also has the hoop's, the last of its first row.
template <class R, class T, int Dim, int Slopes>
KOKKOS_INLINE_FUNCTION Increment<R, T, Dim> increment_of(const R (&L)[Dim][Slopes], T dt,
                                                         const LawClock& clock) {
  Increment<R, T, Dim> by;
  by.dt = dt, by.clock = clock;
  for (int k = 0; k < sym_size<Dim>; ++k) by.strain[k] = 0;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) by.gradient[i][j] = L[i][j];
  for (int i = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) by.strain[sym_index<Dim>(i, j)] = dt * (L[i][j] + L[j][i]) / 2;
  if constexpr (Slopes > Dim) by.strain[2] = dt * L[0][Dim];
  by.spin.c[0] = dt * (L[0][1] - L[1][0]) / 2;
  if constexpr (Dim == 3) {
    by.spin.c[1] = dt * (L[1][2] - L[2][1]) / 2;
    by.spin.c[2] = dt * (L[2][0] - L[0][2]) / 2;
  }
  return by;
}

/// Scalars of the particle update.
template <class T>
struct UpdateScalars {
  T dt, inv_spacing, flip, pic, f_bar;
  T least_volume, most_volume;  // m3
  bool volume_is_fault;         // one that is at a bound
  LawClock clock{};
  bool f_bar_by_material = false;  // FBar::by_material
};

/// Values of a particle that a step changes.
template <class T, int Dim>
struct Particle {
  Vector<T, Dim> x, v;       // cells, m/s
  SymTensor<T, Dim> stress;  // Pa
  T volume;                  // m3
};

/// Calls f(value, field) for each value of a particle and the field of the soil that it is loaded from and
/// stored to, on processors and on GPUs.
template <class F, class Particle_, class Soil_>
KOKKOS_FORCEINLINE_FUNCTION void for_each_value(F&& f, Particle_& q, const Soil_& soil) {
  f(q.x, soil.coordinate), f(q.v, soil.velocity), f(q.volume, soil.volume), f(q.stress, soil.stress);
}

/// The law of particle p, which is one of the list Laws, with its state in memory. A particle that flies
/// freely, being alone, carries no stress, nor an excess pore pressure, and keeps its state.
template <class Space, class T, int Dim, class Laws>
struct ParticleLaw {
  const Soil<Space, T, Dim>& soil;
  int p, material;
  int which;  // index of the law in Materials, or -1 where only the material has it. A kernel that is given
              // the index need not read it from memory before it reads the parameters.
  bool flies;

  KOKKOS_INLINE_FUNCTION void operator()(SymTensor<T, Dim>& stress, const Increment<T, T, Dim>& by) const {
    const AnyMaterial<T>& of = material_in(soil.materials(material));
    // Kernels of light laws alone are for soil that drains (State::light_laws).
    const bool undrained =
        !std::is_same_v<Laws, LightMaterials> && soil.history.pore >= 0 && of.has_pore_pressure();
    if (flies) {
      for (int k = 0; k < sym_size<Dim>; ++k) stress[k] = 0;
      if (undrained) soil.history.column[soil.history.pore](p) = 0;
      return;
    }
    T excess = 0;
    if (undrained) {
      excess = soil.history.column[soil.history.pore](p);
      add_isotropic(stress, excess);  // effective: the law's own
    }
    of.visit_as(Laws{}, which >= 0 ? which : of.which, [&](const auto& law) {
      using Law = std::decay_t<decltype(law)>;
      const auto was = soil.state_of(law, p);
      auto state = was;
      if constexpr (has_called_update<Law>() && Laws::k_size > 1) {  // alone it spills less than a call
        const auto after = called_update<Law, Dim>(law, {stress, state}, by);
        stress = after.stress, state = after.state;
      } else {
        law.update(stress, state, by);
      }
      for (int k = 0; k < state.size; ++k)
        if (Law::state()[k].changes && state[k] != was[k]) soil.history.column[k](p) = state[k];
      if constexpr (can_fail<Law>())
        if (law.failed(state)) stress[0] = Kokkos::Experimental::quiet_NaN_v<T>;  // fault_of() finds it
    });
    if (undrained) {
      excess = undrained_pressure(excess, of.pore_stiffness, by.strain);
      soil.history.column[soil.history.pore](p) = excess;
      add_isotropic(stress, -excess);
    }
  }
  /// gap_room(), after the law. Laws that cannot part do without: its registers would spill in their kernel.
  KOKKOS_INLINE_FUNCTION T room() const requires(can_part(Laws{})) { return gap_room<Laws>(soil, p); }
};

/// A bound of the volume of a particle [m3], which of a ring is one of its section.
template <class R, class T, int Dim, class Domain>
KOKKOS_INLINE_FUNCTION auto volume_bound(T bound, [[maybe_unused]] const Particle<R, Dim>& q,
                                         [[maybe_unused]] const Domain& domain,
                                         [[maybe_unused]] const UpdateScalars<T>& by) {
  if constexpr (std::is_same_v<Domain, RingDomain<R>>)
    return bound * revolved_length(q.x[0], domain, R(1 / by.inv_spacing));
  else
    return bound;
}

/// One particle's step (Eqs (11)-(13)): strain and stress, volume, velocity, position. The fraction f_bar of
/// its dilatation is that of its cell, `mean_dilatation` [1/s], or what mean_for() makes of it. law(stress,
/// increment) changes the stress; law.room() is gap_room(). domain: PlaneDomain, or RingDomain before the
/// step. Returns the largest component of the particle's movement [cells].
template <class R, class T, int Dim, int Slopes, class Law, class Domain>
KOKKOS_FORCEINLINE_FUNCTION R advance(Particle<R, Dim>& q, const Law& law,
                                      const GridSample<R, Dim, Slopes>& t, R mean_dilatation,
                                      const UpdateScalars<T>& by, const Domain& domain) {
  Increment<R, T, Dim> increment = increment_of(t.gradient, by.dt, by.clock);
  R trace = 0;
  for (int d = 0; d < Slopes; ++d) trace += increment.strain[d];
  const R correction = by.f_bar * (by.dt * mean_dilatation - trace);
  for (int d = 0; d < 3; ++d) increment.strain[d] += correction * T(1.0 / 3);
  trace += correction;
  law(q.stress, increment);

  // exp(trace) to second order: no drift in rotation
  q.volume *= (2 + trace) / (2 - trace);
  [[maybe_unused]] const R x_before = q.x[0];
  R moved = 0;
  for (int d = 0; d < Dim; ++d) {
    const R v_i = t.kinematics[NodeKinematics<Dim>::velocity + d],
            a_i = t.kinematics[NodeKinematics<Dim>::acceleration + d];
    q.v[d] = by.flip * (q.v[d] + by.dt * a_i) + by.pic * v_i;
    R movement;
    if constexpr (Slopes > Dim)
      movement = by.dt * ring_velocity(x_before, domain, d, t.gradient[d][Dim]);
    else
      movement = by.dt * v_i * by.inv_spacing;
    q.x[d] += movement;
    moved = Kokkos::fmax(moved, Kokkos::fabs(movement));
  }
  q.volume = Kokkos::fmax(volume_bound(by.least_volume, q, domain, by), q.volume);
  const auto most = volume_bound(by.most_volume, q, domain, by);
  if constexpr (requires { law.room(); }) {
    if (any_of(q.volume > most)) q.volume = Kokkos::fmin(q.volume, most * law.room());
  } else {
    q.volume = Kokkos::fmin(q.volume, R(most));
  }
  return moved;
}

/// Whether all values of a particle are finite; by lane where R is lanes.
template <class R, int Dim>
KOKKOS_INLINE_FUNCTION auto is_finite(const Particle<R, Dim>& q) {
  R sum = q.volume;
  for (int d = 0; d < Dim; ++d) sum += q.x[d] + q.v[d];
  for (int k = 0; k < sym_size<Dim>; ++k) sum += q.stress[k];
  return 0 * sum == 0;  // 0 times what is not finite is not zero
}

/// Whether the volume of a particle is at a bound; by lane where R is lanes.
template <class R, class T, int Dim, class Domain>
KOKKOS_INLINE_FUNCTION auto is_volume_limited(const Particle<R, Dim>& q, const UpdateScalars<T>& by,
                                              const Domain& domain) {
  return !((q.volume > volume_bound(by.least_volume, q, domain, by)) &
           (q.volume < volume_bound(by.most_volume, q, domain, by)));
}

/// Why particle p is not finite: its law, one of the list Laws, calls the particle's state a failure, which
/// may itself not be finite. The stress is then not finite, so that only particles whose stress is not finite
/// need be asked.
template <class Laws = Materials, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION FaultKind cause_of(const Soil<Space, T, Dim>& soil, int p) {
  FaultKind cause = FaultKind::not_finite;
  const AnyMaterial<T>& of = material_in(soil.materials(soil.bodies(soil.body(p)).material));
  of.visit_as(Laws{}, of.which, [&](const auto& law) {
    if constexpr (can_fail<std::decay_t<decltype(law)>>()) {
      const auto state = soil.state_of(law, p);
      if (!law.failed(state)) return;
      T sum = 0;
      for (int k = 0; k < state.size; ++k) sum += 0 * state[k];  // 0 times what is not finite is not zero
      cause = sum == 0 ? FaultKind::law : FaultKind::state;
    }
  });
  return cause;
}

/// Fault of a particle that moved by `moved` [cells] in the step: not finite, a volume that the run does not
/// allow, or so fast that the computation cannot be trusted.
template <class T, int Dim, class Domain>
KOKKOS_INLINE_FUNCTION FaultKind fault_of(const Particle<T, Dim>& q, T moved, const UpdateScalars<T>& by,
                                          const Domain& domain) {
  if (!is_finite(q)) return FaultKind::not_finite;
  if (by.volume_is_fault && is_volume_limited(q, by, domain)) return FaultKind::volume;
  return moved <= 1 ? FaultKind::none : FaultKind::too_fast;
}

/// Reports what is wrong with particle p after a step, if anything is. q: the particle, which moved by
/// `moved` [cells]; origin: lower corner of its patch [cells].
template <ParticleDomain domain, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION void report_fault(const ControlView<Space>& control, const Soil<Space, T, Dim>& soil,
                                         int p, const Particle<T, Dim>& q, T moved,
                                         const UpdateScalars<T>& by, const Coord<Dim>& origin,
                                         double spacing) {
  FaultKind fault = fault_of(q, moved, by, step_domain<domain>(soil, p));
  if (fault == FaultKind::none) return;
  if (fault == FaultKind::not_finite) fault = cause_of(soil, p);
  const Coord<Dim> cell = coord_of<Dim>(soil.cell(p));
  double position[3] = {};
  for (int d = 0; d < Dim; ++d) position[d] = (double(origin[d]) + cell[d] + q.x[d]) * spacing;
  report(control, fault, soil.id(p), position, Dim);
}

}  // namespace mpm
