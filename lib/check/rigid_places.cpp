#include "check/rigid_places.hpp"

#include <algorithm>
#include <cmath>

namespace mpm {

RigidPlaces::RigidPlaces(const Config& config)
    : config_(config), filled_(config.rigids.size()), by_(config.rigids.size()) {
  for (const RigidConfig& rigid : config.rigids)
    bounds_.push_back(bounds_of(rigid.shape, config.mesh, config.dim));
}

Filled& RigidPlaces::moved(int rigid, const Vec3& by) {
  if (!filled_[rigid])
    filled_[rigid] = std::make_unique<Filled>(config_.rigids[rigid].shape, std::vector<Shape>{}, config_.mesh,
                                              config_.dim);
  Vec3 more{};
  for (int d = 0; d < config_.dim; ++d) more[d] = by[d] - by_[rigid][d];
  filled_[rigid]->move(more);
  by_[rigid] = by;
  return *filled_[rigid];
}

bool RigidPlaces::share_space(int a, int b, const Vec3& by_a, const Vec3& by_b) {
  const int dim = config_.dim, up = dim - 1, count = dim == 2 ? 41 : 15;  // odd: one point is in the middle
  Vec3 lower{}, step{};
  for (int d = 0; d < dim; ++d) {
    lower[d] = std::max(bounds_[a].lower[d] + by_a[d], bounds_[b].lower[d] + by_b[d]);
    const double upper = std::min(bounds_[a].upper[d] + by_a[d], bounds_[b].upper[d] + by_b[d]);
    step[d] = (upper - lower[d]) / count;
    constexpr double k_touch = 1e-3;  // cells
    if (upper - lower[d] < k_touch * config_.mesh.spacing) return false;
  }
  Filled &one = moved(a, by_a), &other = moved(b, by_b);
  Vec3 x{};
  for (int k = 0; k < count; ++k) {
    x[up] = lower[up] + (k + 0.5) * step[up];
    one.enter_row(x[up], x[up]), other.enter_row(x[up], x[up]);
    for (int j = 0; j < (dim == 3 ? count : 1); ++j) {
      if (dim == 3) x[1] = lower[1] + (j + 0.5) * step[1];
      for (int i = 0; i < count; ++i) {
        x[0] = lower[0] + (i + 0.5) * step[0];
        if (one.holds(x) && other.holds(x)) return true;
      }
    }
  }
  return false;
}

}  // namespace mpm
