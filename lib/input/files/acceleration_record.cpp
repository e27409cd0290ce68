#include "input/files/acceleration_record.hpp"

#include <algorithm>
#include <cmath>

#include "common/text.hpp"
#include "common/time_table.hpp"

namespace mpm {
namespace {

/// An interval of a record in one component: accelerations at its ends [m/s2], its length [s], and velocity
/// [m/s] and displacement [m] where it begins.
struct Interval {
  double a, b, length, v, u;
  bool smooth;

  /// The share x of the interval further.
  double velocity(double x) const {
    const double way = smooth ? x * x * x * (1 - x / 2) : x * x / 2;
    return v + length * (a * x + (b - a) * way);
  }
  double displacement_at_end() const {
    return u + length * (v + length * (a / 2 + (b - a) * (smooth ? 0.15 : 1.0 / 6)));
  }
};

/// One component of a record: its intervals, and what it comes to.
struct Component {
  std::vector<Interval> intervals;
  double velocity = 0, displacement = 0;

  Component(const TimeTable& record, int d) {
    for (std::size_t k = 1; k < record.times.size(); ++k) {
      intervals.push_back({record.values[k - 1][d], record.values[k][d],
                           record.times[k] - record.times[k - 1], velocity, displacement, record.smooth});
      displacement = intervals.back().displacement_at_end();
      velocity = intervals.back().velocity(1);
    }
  }
};

/// The acceleration c0 + c1 t [m/s2] that is taken out of one component, t [s] since the record began.
struct Baseline {
  double c0 = 0, c1 = 0;

  Baseline(BaselineCorrection correction, double velocity, double displacement, double duration) {
    const double by_velocity = velocity / duration, by_way = displacement / (duration * duration);
    if (correction == BaselineCorrection::linear) c0 = by_velocity;
    if (correction == BaselineCorrection::quadratic)
      c0 = 6 * by_way - 2 * by_velocity, c1 = (6 * by_velocity - 12 * by_way) / duration;
  }
  double acceleration(double t) const { return c0 + c1 * t; }
  double velocity(double t) const { return t * (c0 + c1 * t / 2); }
  double displacement(double t) const { return t * t * (c0 / 2 + c1 * t / 6); }
};

double larger(double a, double b) { return std::fabs(b) > std::fabs(a) ? b : a; }

/// Parts of interval k of which the chords are close to the velocities.
int parts_of(const std::vector<Component>& components, const std::vector<Baseline>& baselines,
             const Vec3& largest, std::size_t k) {
  constexpr double k_close = 1e-4, k_most = 1000;
  double parts = 1;
  for (std::size_t d = 0; d < components.size(); ++d) {
    const Interval& of = components[d].intervals[k];
    const double bend =
        (of.smooth ? 1.5 : 1.0) * std::fabs(of.b - of.a) + std::fabs(baselines[d].c1) * of.length;
    if (largest[d] != 0)
      parts = std::max(parts, std::sqrt(bend * of.length / (8 * k_close * std::fabs(largest[d]))));
  }
  return static_cast<int>(std::ceil(std::min(parts, k_most)));
}

std::string numbers(const Vec3& of, int dim, const char* unit) {
  std::string text;
  for (int d = 0; d < dim; ++d) text += formatted("%s%.4g", d == 0 ? "" : ", ", of[d]);
  return text + " " + unit;
}

}  // namespace

IntegratedRecord integrate(const TimeTable& accelerations, BaselineCorrection correction) {
  const auto& times = accelerations.times;
  const double begin = times.front(), duration = times.back() - begin;
  IntegratedRecord result;
  std::vector<Component> components;
  std::vector<Baseline> baselines;
  Vec3 largest{};  // m/s, at the points
  for (int d = 0; d < 3; ++d) {
    const Component& of = components.emplace_back(accelerations, d);
    const Baseline& less = baselines.emplace_back(correction, of.velocity, of.displacement, duration);
    result.before.velocity[d] = of.velocity, result.before.displacement[d] = of.displacement;
    const bool corrected = correction != BaselineCorrection::none;
    result.after.velocity[d] = corrected ? 0 : of.velocity;
    result.after.displacement[d] =
        correction == BaselineCorrection::quadratic ? 0 : of.displacement - less.displacement(duration);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const double t = times[k] - begin, a = accelerations.values[k][d];
      result.before.largest[d] = larger(result.before.largest[d], a);
      result.after.largest[d] = larger(result.after.largest[d], a - less.acceleration(t));
      for (const double x : {0.0, 0.25, 0.5, 0.75, 1.0})
        if (k + 1 < times.size())
          largest[d] = larger(largest[d],
                              of.intervals[k].velocity(x) - less.velocity(t + x * (times[k + 1] - times[k])));
    }
  }
  TimeTable& table = result.velocities;
  table.file = accelerations.file;
  table.times = {begin}, table.values = {Vec3{}};
  for (std::size_t k = 0; k + 1 < times.size(); ++k)
    for (int part = 1, parts = parts_of(components, baselines, largest, k); part <= parts; ++part) {
      const double x = double(part) / parts,
                   t = part == parts ? times[k + 1] : times[k] + x * (times[k + 1] - times[k]);
      Vec3 v{};
      for (int d = 0; d < 3; ++d)
        v[d] = components[d].intervals[k].velocity(x) - baselines[d].velocity(t - begin);
      if (k + 2 == times.size() && part == parts) v = result.after.velocity;
      if (t > table.times.back()) table.times.push_back(t), table.values.push_back(v);
    }
  return result;
}

std::string report_of(const IntegratedRecord& record, BaselineCorrection correction, int dim) {
  const auto& [times, values, smooth, file] = record.velocities;
  const auto end = [&](const RecordFigures& of) {
    return numbers(of.velocity, dim, "m/s") + " and " + numbers(of.displacement, dim, "m");
  };
  const std::string what = formatted("the record of %.6g s ends with ", times.back() - times.front()) +
                           end(record.before) + ", its largest acceleration is " +
                           numbers(record.before.largest, dim, "m/s2");
  if (correction == BaselineCorrection::none) return what + "; not corrected";
  return what + "; corrected (" + (correction == BaselineCorrection::linear ? "linear" : "quadratic") +
         "): " + end(record.after) + ", " + numbers(record.after.largest, dim, "m/s2");
}

}  // namespace mpm
