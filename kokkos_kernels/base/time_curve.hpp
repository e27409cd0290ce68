#pragma once
// A quantity in time, given at points, and its mean over a step.

#include <Kokkos_Core.hpp>

namespace mpm {

struct CurvePoint {
  double time, value;  // s; the quantity's unit
};

/// Quantity that a step takes from a curve: its mean value, or its mean rate of change.
enum class CurveUse : int { value, rate };

/// A curve through points whose times increase: straight between them, or smooth, by 3 x^2 - 2 x^3 with x
/// from 0 to 1. Before the first point and after the last it has their values.
struct TimeCurve {
  const CurvePoint* points;
  int count;  // 1 or more
  bool smooth;

  /// The value at a time [s].
  KOKKOS_INLINE_FUNCTION double value(double t) const {
    const int k = interval(t, 0);
    if (outside(k)) return points[k < 0 ? 0 : k].value;
    const double x = share(k, t);
    return points[k].value + rise(k) * (smooth ? x * x * (3 - 2 * x) : x);
  }
  /// The rate of change at a time; at a corner, that after it.
  KOKKOS_INLINE_FUNCTION double rate(double t) const {
    const int k = interval(t, 0);
    return outside(k) ? 0 : rise(k) / length(k) * slope(share(k, t));
  }

  /// The mean from t over a step of dt [s], exactly but for round-off: corners need not fall on steps. A
  /// curve of one value gives this value to the bit. `near`: an interval from which the search begins;
  /// becomes that of t.
  KOKKOS_INLINE_FUNCTION double mean(CurveUse use, double t, double dt, int& near) const {
    const double end = t + dt;
    int k = near = interval(t, near);
    const double first = mean_within(use, k, t, Kokkos::fmin(end, end_of(k, end)));
    double more = 0;  // s times what the mean of later intervals differs from that of the first
    for (; end_of(k, end) < end; ++k) {
      const double from = end_of(k, end), to = Kokkos::fmin(end, end_of(k + 1, end));
      more += (to - from) * (mean_within(use, k + 1, from, to) - first);
    }
    return more == 0 ? first : first + more / dt;
  }

 private:
  /// The interval that begins at or before t: -1 before the first point, count - 1 after the last.
  KOKKOS_INLINE_FUNCTION int interval(double t, int near) const {
    if (holds(near, t)) return near;
    if (holds(near + 1, t)) return near + 1;
    int low = -1, high = count;  // points[low].time <= t < points[high].time
    while (high - low > 1) {
      const int middle = low + (high - low) / 2;
      (points[middle].time <= t ? low : high) = middle;
    }
    return low;
  }
  KOKKOS_INLINE_FUNCTION bool holds(int k, double t) const {
    return k >= -1 && k < count && (k < 0 || points[k].time <= t) &&
           (k + 1 >= count || t < points[k + 1].time);
  }
  KOKKOS_INLINE_FUNCTION bool outside(int k) const { return k < 0 || k + 1 >= count; }
  /// Where interval k ends, if that is before `last`.
  KOKKOS_INLINE_FUNCTION double end_of(int k, double last) const {
    return k + 1 < count ? points[k + 1].time : last;
  }
  KOKKOS_INLINE_FUNCTION double length(int k) const { return points[k + 1].time - points[k].time; }
  KOKKOS_INLINE_FUNCTION double rise(int k) const { return points[k + 1].value - points[k].value; }
  KOKKOS_INLINE_FUNCTION double share(int k, double t) const { return (t - points[k].time) / length(k); }
  /// Slope of the way from 0 to 1.
  KOKKOS_INLINE_FUNCTION double slope(double x) const { return smooth ? 6 * x * (1 - x) : 1; }

  /// The mean between two times within interval k: of cubics and less by Simpson's rule, which is exact.
  KOKKOS_INLINE_FUNCTION double mean_within(CurveUse use, int k, double from, double to) const {
    if (outside(k)) return use == CurveUse::rate ? 0 : points[k < 0 ? 0 : k].value;
    const double a = share(k, from), b = share(k, to), m = (a + b) / 2;
    if (use == CurveUse::rate) {
      const double slopes = smooth ? (slope(a) + 4 * slope(m) + slope(b)) / 6 : 1;
      return rise(k) / length(k) * slopes;
    }
    const auto way = [](double x) { return x * x * (3 - 2 * x); };
    const double ways = smooth ? (way(a) + 4 * way(m) + way(b)) / 6 : m;
    return points[k].value + rise(k) * ways;
  }
};

}  // namespace mpm
