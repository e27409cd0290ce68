#pragma once
// Drives a single material point over the rows of a path. Where the stress governs components, their strain
// increments are unknowns, which the law's own update decides.

#include <optional>
#include <string>
#include <vector>

#include "mpm/config.hpp"
#include "physics/materials/point.hpp"

namespace mpm {

/// A point on its way along a path.
struct DrivenPoint {
  PointState now;
  Sym6 strain{};  // -, since the start, tensor shear strains
  /// Goals of the row before at its end: the stress components [Pa], then the sums of stresses [Pa] and of
  /// strains since the start [-].
  std::vector<std::optional<double>> goals{};
  double time = 0;  // s
};

/// Drives a point over a row in equal parts. The unknown strain increments of a part are found by Newton's
/// method with a numerical tangent of the update, damped by Levenberg and Marquardt (Nocedal & Wright 2006,
/// ch. 10); a part without a solution is done in halves, quarters and so on. `tolerance` [-] is of the
/// stress, beside what the increment could change. The row governs as many stresses and `sums` as it leaves
/// strains unknown. Returns why the row cannot be done; empty where it was.
std::string drive_row(const PointLaw& law, const ElementRow& row, int parts, double tolerance,
                      DrivenPoint& point, const std::vector<ElementSum>& sums = {});

/// Tolerances that suit the round-off of a precision.
inline constexpr double k_element_tolerance_double = 1e-9, k_element_tolerance_single = 1e-5;

}  // namespace mpm
