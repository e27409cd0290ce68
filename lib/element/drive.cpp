#include "element/drive.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/text.hpp"
#include "element/least_squares.hpp"
#include "element/path_file.hpp"

namespace mpm {
namespace {

constexpr int k_most_halvings = 10, k_most_iterations = 40;

/// What a part of a row wants: strain increments where the strain governs, else the stress at its end.
struct Part {
  Sym6 strain{}, goal{};
  double dt = 0;
};

double largest_of(const Sym6& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::fabs(value));
  return largest;
}

bool is_finite(const PointState& point) {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::all_of(point.stress.begin(), point.stress.end(), finite) &&
         std::all_of(point.state.begin(), point.state.end(), finite);
}

/// Solves one part after the other.
class Solver {
 public:
  Solver(const PointLaw& law, const std::vector<int>& unknown, double tolerance)
      : law_(law), unknown_(unknown), tolerance_(tolerance) {}

  /// Does a part, in halves where it must. `guess` are the strain increments of the part before, and becomes
  /// those of this one.
  bool advance(const Part& part, Sym6& guess, DrivenPoint& point, int halvings = 0) {
    Sym6 increment = part.strain;
    for (const int c : unknown_) increment[c] = guess[c];
    if (solve(part, point, increment)) {
      guess = increment;
      return true;
    }
    if (halvings == k_most_halvings) return false;
    Part first = part, second = part;
    first.dt = second.dt = part.dt / 2;
    for (int c = 0; c < 6; ++c) first.strain[c] = second.strain[c] = part.strain[c] / 2;
    for (const int c : unknown_) first.goal[c] = (point.now.stress[c] + part.goal[c]) / 2, guess[c] /= 2;
    if (!advance(first, guess, point, halvings + 1)) return false;
    if (!advance(second, guess, point, halvings + 1)) return false;
    for (const int c : unknown_) guess[c] *= 2;
    return true;
  }

  /// Why the last part could not be done.
  std::string why() const { return why_; }

 private:
  struct Trial {
    PointState point;
    std::vector<double> misfit;  // Pa, of the components that the stress governs
    double size = 0;             // Pa, their largest
    bool sound = false;
  };

  Trial try_strain(const Part& part, const DrivenPoint& point, const Sym6& increment) const {
    Trial trial;
    trial.point = law_.update(point.now, {increment, part.dt, point.time});
    trial.sound = is_finite(trial.point) && !law_.failed(trial.point);
    for (const int c : unknown_) {
      trial.misfit.push_back(trial.point.stress[c] - part.goal[c]);
      trial.size = std::max(trial.size, std::fabs(trial.misfit.back()));
    }
    return trial;
  }

  /// Derivative of the governed stresses by their strain increments [Pa], by differences.
  std::vector<double> tangent(const Part& part, const DrivenPoint& point, const Sym6& increment,
                              const Trial& at, double difference) const {
    const std::size_t n = unknown_.size();
    std::vector<double> rows(n * n);
    for (std::size_t j = 0; j < n; ++j) {
      Sym6 other = increment;
      const double by = other[unknown_[j]] < 0 ? -difference : difference;
      other[unknown_[j]] += by;
      const Trial beside = try_strain(part, point, other);
      for (std::size_t i = 0; i < n; ++i) rows[i * n + j] = (beside.misfit[i] - at.misfit[i]) / by;
    }
    return rows;
  }

  bool accept(const Part& part, const Trial& trial, const Sym6& increment, DrivenPoint& point) const {
    point.now = trial.point;
    for (int c = 0; c < 6; ++c) point.strain[c] += increment[c];
    point.time += part.dt;
    return true;
  }

  bool refuse(const Part& part, const Trial& trial) {
    if (!trial.sound) {
      why_ = "the law fails, or its stress is not finite; smaller increments may help (-element_parts)";
      return false;
    }
    std::size_t worst = 0;
    for (std::size_t k = 0; k < unknown_.size(); ++k)
      if (std::fabs(trial.misfit[k]) > std::fabs(trial.misfit[worst])) worst = k;
    const int c = unknown_[worst];
    why_ = formatted(
        "no strain increment was found that brings s%s to %.9g Pa; the nearest leaves a residual of %.4g "
        "Pa. The law may not bear that stress",
        k_components[c], part.goal[c], trial.misfit[worst]);
    return false;
  }

  bool solve(const Part& part, DrivenPoint& point, Sym6& increment) {
    const double modulus = std::max(law_.wave_modulus(point.now), 1e-300);
    const double strength = std::max(largest_of(point.now.stress), largest_of(part.goal));
    const double share = std::sqrt(tolerance_) * 0.3;  // of the strains that matter, as a difference
    double damping = 1e-14;
    Trial now = try_strain(part, point, increment);
    if (!now.sound) {  // the part before was another one
      for (const int c : unknown_) increment[c] = 0;
      now = try_strain(part, point, increment);
    }
    for (int n = 0; n < k_most_iterations && now.sound; ++n) {
      const double scale = std::max(strength, modulus * largest_of(increment));
      if (now.size <= tolerance_ * scale) return accept(part, now, increment, point);
      const auto rows = tangent(part, point, increment, now, share * scale / modulus);
      bool better = false;
      for (; !better && damping < 1e6; damping = std::max(100 * damping, 1e-10)) {
        const auto step = damped_least_squares(rows, now.misfit, damping);
        Sym6 next = increment;
        for (std::size_t k = 0; k < unknown_.size(); ++k) next[unknown_[k]] -= step[k];
        Trial trial = try_strain(part, point, next);
        better = trial.sound && trial.size < now.size;
        if (!better) continue;
        now = std::move(trial), increment = next;
      }
      if (!better) break;
      damping = std::max(1e-14, damping * 1e-4);
    }
    return refuse(part, now);
  }

  const PointLaw& law_;
  const std::vector<int>& unknown_;
  double tolerance_;
  std::string why_;
};

/// The stress at which components that the stress governs end, and the strain increments of the others.
Part whole_row(const ElementRow& row, DrivenPoint& point) {
  Part whole;
  whole.dt = row.dt;
  for (int c = 0; c < 6; ++c) {
    const bool by_stress = row.drive[c] == Drive::stress;
    const double from = by_stress && point.has_goal[c] ? point.goal[c] : point.now.stress[c];
    if (by_stress)
      whole.goal[c] = from + row.value[c];
    else
      whole.strain[c] = row.value[c] - (row.drive[c] == Drive::total_strain ? point.strain[c] : 0);
    point.goal[c] = whole.goal[c];
    point.has_goal[c] = by_stress;
  }
  return whole;
}

}  // namespace

std::string drive_row(const PointLaw& law, const ElementRow& row, int parts, double tolerance,
                      DrivenPoint& point) {
  const DrivenPoint before = point;
  const Part whole = whole_row(row, point);
  std::vector<int> unknown;
  for (int c = 0; c < 6; ++c)
    if (row.drive[c] == Drive::stress) unknown.push_back(c);
  Solver solver(law, unknown, tolerance);
  Sym6 guess{};
  for (int n = 0; n < parts; ++n) {
    Part part{.dt = row.dt / parts};
    for (int c = 0; c < 6; ++c) part.strain[c] = whole.strain[c] / parts;
    for (const int c : unknown) {
      const double from = before.has_goal[c] ? before.goal[c] : before.now.stress[c];
      part.goal[c] = from + (whole.goal[c] - from) * ((n + 1.0) / parts);
    }
    if (!solver.advance(part, guess, point)) return solver.why();
  }
  for (int c = 0; c < 6; ++c)
    if (row.drive[c] == Drive::total_strain) point.strain[c] = row.value[c];
  point.time = before.time + row.dt;
  return "";
}

}  // namespace mpm
