#pragma once
// Loads and motions that follow tables in time: gravity, velocities of sides, velocities and forces of rigid
// bodies, ends of joints, and loads on surfaces. The end of a step sets those of the next step on the device,
// so that one launch can do many steps.

#include "base/spaces.hpp"
#include "base/time_curve.hpp"
#include "base/types.hpp"
#include "data/rigid.hpp"

namespace mpm {

/// A number that is constant or the mean of a curve over the step.
struct TimedNumber {
  double constant;
  int first, count;  // of the points; count 0: constant
  int near;          // interval of the present step
  CurveUse use;
  bool smooth;

  KOKKOS_INLINE_FUNCTION double mean(const CurvePoint* points, double t, double dt) {
    if (count == 0) return constant;
    return TimeCurve{points + first, count, smooth}.mean(use, t, dt, near);
  }
};

enum class LoadTarget : int { gravity, velocity, force, side, pressure, traction, spin, moment, joint };

/// A component of a quantity that follows a table: own + factor * gravity. For a rigid's force, the factor is
/// the mass whose weight the force carries [kg]; 0 elsewhere.
struct TimedLoad {
  LoadTarget target;
  int rigid, component;  // where `place` is null
  TimedNumber own, gravity;
  double factor;
  double*
      place;  // on the device, of the value; null: of gravity or a rigid, of which kernels may hold copies
};

/// The times of steps: step k of those that Control::steps counts begins at origin + (first + k) dt. With the
/// same origin, a step begins at the same bits, whichever steps before it the host has waited for.
struct LoadClock {
  double origin, dt;  // s
  long first;
  double before;  // s, length of the step before the first; 0: there is none
};

/// Whether a load changes velocities of the soil, which are means over steps: it acts from the middle of the
/// step before to that of the present one.
constexpr bool acts_on_soil(LoadTarget target) {
  return target == LoadTarget::gravity || target == LoadTarget::pressure || target == LoadTarget::traction;
}

/// The mean of a load over the step that follows `steps` steps of a clock. Two kernels call it: the first
/// step after the host has looked and the others must take the same bits.
MPM_SAME_BITS_FUNCTION double mean_of_load(TimedLoad& load, const CurvePoint* points, const LoadClock& by,
                                           int steps) {
  const bool on_soil = acts_on_soil(load.target);
  const double before = on_soil ? (steps == 0 ? by.before : by.dt) / 2 : 0;
  const double begin = by.origin + double(by.first + steps) * by.dt - before;
  const double length = on_soil ? before + by.dt / 2 : by.dt;
  const double own = load.own.mean(points, begin, length);
  return load.target == LoadTarget::force ? own + load.factor * load.gravity.mean(points, begin, length)
                                          : own;
}

/// All of them, for kernels. `gravity`: of the present step, which kernels read in lieu of State::gravity;
/// null where gravity follows no table.
template <class T, int Dim>
struct LoadsOfStep {
  TimedLoad* loads;
  const CurvePoint* points;
  LoadClock* clock;
  Vector<T, Dim>* gravity;
  int count;

  /// Sets load n for the step that follows `steps` steps of a clock.
  KOKKOS_INLINE_FUNCTION void set(int n, const LoadClock& by, int steps, Rigid<Dim>* rigids) const {
    TimedLoad& load = loads[n];
    const double value = mean_of_load(load, points, by, steps);
    const int d = load.component;
    if (load.place != nullptr)
      *load.place = value;
    else if (load.target == LoadTarget::gravity)
      (*gravity)[d] = static_cast<T>(value);
    else if (load.target == LoadTarget::velocity)
      rigids[load.rigid].motion.velocity[d] = value;
    else if (load.target == LoadTarget::spin)
      rigids[load.rigid].motion.spin[d] = value;
    else if (load.target == LoadTarget::moment)
      rigids[load.rigid].force[Wrench<Dim>::moment + d] = value;
    else
      rigids[load.rigid].force[Wrench<Dim>::force + d] = value;
  }
};

template <class Space, class T, int Dim>
struct TimedLoads {
  using Memory = typename Space::memory_space;
  Kokkos::View<TimedLoad*, Memory> loads;
  Kokkos::View<CurvePoint*, Memory> points;
  Kokkos::View<LoadClock, Memory> clock;  // allocated with loads
  Kokkos::View<Vector<T, Dim>, Memory> gravity;
  bool moves_gravity = false, moves_sides = false;

  int count() const { return static_cast<int>(loads.extent(0)); }
  LoadsOfStep<T, Dim> of_step() const {
    return {loads.data(), points.data(), clock.data(), moves_gravity ? gravity.data() : nullptr, count()};
  }
};

}  // namespace mpm
