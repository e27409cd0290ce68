#include "element/drive.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "common/text.hpp"
#include "element/least_squares.hpp"
#include "element/path_file.hpp"

namespace mpm {
namespace {

constexpr int k_most_halvings = 10, k_most_iterations = 40;

/// A sum that a row governs: of stresses [Pa], or of strains since the start [-].
struct Equation {
  std::string name;  // for messages, syy or sxx+syy+szz
  bool of_strain = false;
  Sym6 weight{};            // -, over the largest of the path's
  double size = 1;          // -, the largest
  double from = 0, to = 0;  // the sum at the start and at the end of the row, over `size`

  double at(const Sym6& stress, const Sym6& strain) const {
    double sum = 0;
    for (int c = 0; c < 6; ++c) sum += weight[c] * (of_strain ? strain[c] : stress[c]);
    return sum;
  }
};

/// Goals of a part of a row: strain increments where the strain governs, and the equations' sums at its end.
struct Part {
  Sym6 strain{};
  std::vector<double> goal;
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
  Solver(const PointLaw& law, const std::vector<Equation>& equations, const std::vector<int>& unknown,
         double tolerance)
      : law_(law), equations_(equations), unknown_(unknown), tolerance_(tolerance) {}

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
    for (std::size_t k = 0; k < equations_.size(); ++k)
      first.goal[k] = (equations_[k].at(point.now.stress, point.strain) + part.goal[k]) / 2;
    for (const int c : unknown_) guess[c] /= 2;
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
    std::vector<double> misfit;  // Pa, of the equations; of strains times the wave modulus
    double size = 0;             // Pa, their largest
    bool sound = false;
  };

  /// Factor from a misfit of an equation to a stress.
  double to_stress(const Equation& equation) const { return equation.of_strain ? modulus_ : 1; }

  Trial try_strain(const Part& part, const DrivenPoint& point, const Sym6& increment) const {
    Trial trial;
    trial.point = law_.update(point.now, {increment, part.dt, point.time});
    trial.sound = is_finite(trial.point) && !law_.failed(trial.point);
    Sym6 strain = point.strain;
    for (int c = 0; c < 6; ++c) strain[c] += increment[c];
    for (std::size_t k = 0; k < equations_.size(); ++k) {
      const double off = equations_[k].at(trial.point.stress, strain) - part.goal[k];
      trial.misfit.push_back(off * to_stress(equations_[k]));
      trial.size = std::max(trial.size, std::fabs(trial.misfit.back()));
    }
    return trial;
  }

  /// Derivative of the equations by the unknown strain increments [Pa], by differences.
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
    for (std::size_t k = 0; k < equations_.size(); ++k)
      if (std::fabs(trial.misfit[k]) > std::fabs(trial.misfit[worst])) worst = k;
    const Equation& equation = equations_[worst];
    const char* const unit = equation.of_strain ? "" : " Pa";
    why_ = formatted(
        "no strain increment was found that brings %s to %.9g%s; the nearest leaves a residual of %.4g%s. "
        "The "
        "law may not bear that stress",
        equation.name.c_str(), equation.size * part.goal[worst], unit,
        equation.size * trial.misfit[worst] / to_stress(equation), unit);
    return false;
  }

  /// Pa, of the stresses that a part begins with and leads to.
  double strength_in(const Part& part, const DrivenPoint& point) const {
    double strength = largest_of(point.now.stress);
    for (std::size_t k = 0; k < equations_.size(); ++k) {
      if (equations_[k].of_strain) continue;
      double weights = 0;
      for (const double weight : equations_[k].weight) weights += std::fabs(weight);
      strength = std::max(strength, std::fabs(part.goal[k]) / weights);
    }
    return strength;
  }

  bool solve(const Part& part, DrivenPoint& point, Sym6& increment) {
    modulus_ = std::max(law_.wave_modulus(point.now), 1e-300);
    const double strength = strength_in(part, point);
    const double share = std::sqrt(tolerance_) * 0.3;  // of the strains that matter, as a difference
    double damping = 1e-14;
    Trial now = try_strain(part, point, increment);
    if (!now.sound) {  // the part before was another one
      for (const int c : unknown_) increment[c] = 0;
      now = try_strain(part, point, increment);
    }
    for (int n = 0; n < k_most_iterations && now.sound; ++n) {
      const double scale = std::max(strength, modulus_ * largest_of(increment));
      const bool solved = now.size <= tolerance_ * scale;
      if (now.size == 0) return accept(part, now, increment, point);
      const auto rows = tangent(part, point, increment, now, share * scale / modulus_);
      bool better = false;
      for (; !better && damping < 1e6; damping = std::max(100 * damping, 1e-10)) {
        const auto step = damped_least_squares(rows, now.misfit, damping);
        Sym6 next = increment;
        for (std::size_t k = 0; k < unknown_.size(); ++k) next[unknown_[k]] -= step[k];
        Trial trial = try_strain(part, point, next);
        better = trial.sound && trial.size < now.size;
        if (better) now = std::move(trial), increment = next;
        if (solved) break;  // one step more: it costs little, and brings the residual to round-off
      }
      if (solved) return accept(part, now, increment, point);
      if (!better) break;
      damping = std::max(1e-14, damping * 1e-4);
    }
    return refuse(part, now);
  }

  const PointLaw& law_;
  const std::vector<Equation>& equations_;
  const std::vector<int>& unknown_;
  double tolerance_;
  double modulus_ = 0;  // Pa, of the law where the part begins
  std::string why_;
};

/// The equation of a sum over a row, from where the row before wanted it, or from where the point is.
Equation equation_of(const ElementSum& sum, double change, const DrivenPoint& point,
                     const std::optional<double>& goal) {
  Equation equation{.name = sum.name, .of_strain = sum.of_strain, .weight = sum.weight};
  equation.size = largest_of(sum.weight);
  for (double& weight : equation.weight) weight /= equation.size;
  equation.from = goal ? *goal / equation.size : equation.at(point.now.stress, point.strain);
  equation.to = equation.from + change / equation.size;
  for (auto at = equation.name.find('d'); at != std::string::npos; at = equation.name.find('d', at))
    equation.name.erase(at, 1);  // not the increment: the stress or the strain
  return equation;
}

/// Equations that a row governs beside strains. The point's goals become those of the row.
std::vector<Equation> equations_of(const ElementRow& row, const std::vector<ElementSum>& sums,
                                   DrivenPoint& point) {
  std::vector<Equation> equations;
  const auto before = std::exchange(point.goals, std::vector<std::optional<double>>(6 + sums.size()));
  const auto govern = [&](std::size_t k, const ElementSum& sum, double change) {
    equations.push_back(equation_of(sum, change, point, k < before.size() ? before[k] : std::nullopt));
    point.goals[k] = equations.back().to * equations.back().size;
  };
  for (int c = 0; c < 6; ++c) {
    ElementSum alone{.name = std::string("ds") + k_components[c]};
    alone.weight[c] = 1;
    if (row.drive[c] == Drive::stress) govern(c, alone, row.value[c]);
  }
  for (std::size_t k = 0; k < row.sums.size(); ++k)
    if (row.sums[k]) govern(6 + k, sums[k], *row.sums[k]);
  return equations;
}

/// The strain increments of a row's components that their strains govern.
Sym6 strains_of(const ElementRow& row, const DrivenPoint& point) {
  Sym6 strain{};
  for (int c = 0; c < 6; ++c) {
    if (row.drive[c] == Drive::strain) strain[c] = row.value[c];
    if (row.drive[c] == Drive::total_strain) strain[c] = row.value[c] - point.strain[c];
  }
  return strain;
}

}  // namespace

std::string drive_row(const PointLaw& law, const ElementRow& row, int parts, double tolerance,
                      DrivenPoint& point, const std::vector<ElementSum>& sums) {
  const double start = point.time;
  const Sym6 strain = strains_of(row, point);
  const auto equations = equations_of(row, sums, point);
  std::vector<int> unknown;
  for (int c = 0; c < 6; ++c)
    if (row.drive[c] == Drive::stress || row.drive[c] == Drive::free) unknown.push_back(c);
  Solver solver(law, equations, unknown, tolerance);
  Sym6 guess{};
  for (int n = 0; n < parts; ++n) {
    Part part;
    part.dt = row.dt / parts;
    for (int c = 0; c < 6; ++c) part.strain[c] = strain[c] / parts;
    for (const Equation& e : equations) part.goal.push_back(e.from + (e.to - e.from) * ((n + 1.0) / parts));
    if (!solver.advance(part, guess, point)) return solver.why();
  }
  for (int c = 0; c < 6; ++c)
    if (row.drive[c] == Drive::total_strain) point.strain[c] = row.value[c];
  point.time = start + row.dt;
  return "";
}

}  // namespace mpm
