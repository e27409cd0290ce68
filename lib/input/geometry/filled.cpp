#include "input/geometry/filled.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm {
namespace {

constexpr double k_slack = 1e-9;  // of a length, so that round-off never decides

}  // namespace

PlacesOfParticles::PlacesOfParticles(std::vector<double> position, double width, int dim)
    : position_(std::move(position)), width_(width), dim_(dim) {
  constexpr double k_far = std::numeric_limits<double>::max();
  for (int d = 0; d < dim; ++d) bounds_.lower[d] = k_far, bounds_.upper[d] = -k_far;
  particles_.reserve(position_.size() / dim);
  for (std::size_t n = 0; n < position_.size(); n += dim) {
    std::array<long, 3> cell{};
    for (int d = 0; d < dim; ++d) {
      cell[d] = cell_of(position_[n + d], d);
      bounds_.lower[d] = std::min(bounds_.lower[d], position_[n + d] - width / 2);
      bounds_.upper[d] = std::max(bounds_.upper[d], position_[n + d] + width / 2);
    }
    particles_.insert({key_of(cell), n});
  }
}

long PlacesOfParticles::cell_of(double x, int) const { return std::lround(std::floor(x / width_)); }

std::size_t PlacesOfParticles::key_of(const std::array<long, 3>& cell) const {
  std::size_t key = 0;
  for (const long c : cell) key = (key ^ static_cast<std::size_t>(c)) * 0x9E3779B97F4A7C15ULL;
  return key;
}

bool PlacesOfParticles::hold(const Vec3& x) const {
  const double reach = width_ / 2 * (1 + k_slack);
  int neighbours = 1;
  for (int d = 0; d < dim_; ++d) neighbours *= 3;
  for (int k = 0; k < neighbours; ++k) {
    std::array<long, 3> cell{};
    for (int d = 0, rest = k; d < dim_; ++d, rest /= 3) cell[d] = cell_of(x[d], d) + rest % 3 - 1;
    const auto [first, last] = particles_.equal_range(key_of(cell));
    for (auto found = first; found != last; ++found) {
      bool near = true;
      for (int d = 0; d < dim_; ++d) near = near && std::abs(position_[found->second + d] - x[d]) <= reach;
      if (near) return true;
    }
  }
  return false;
}

Filled::Filled(const Shape& shape, const std::vector<Shape>& cut_out, const MeshConfig& mesh, int dim)
    : bounds(bounds_of(shape, mesh, dim)),
      volume(shape_volume(shape, mesh, dim)),
      width(mesh.spacing / shape.particles_per_cell),
      shape_(shape),
      mesh_(mesh),
      dim_(dim),
      cut_shapes_(cut_out) {
  region_.emplace_back(shape_, dim, k_slack * mesh.spacing);
  measure();
}

Filled::Filled(const Shape& shape, std::vector<double> position, bool has_moved,
               const std::vector<Shape>& cut_out, const MeshConfig& mesh, int dim)
    : width(mesh.spacing / shape.particles_per_cell),
      listed(true),
      shape_(shape),
      mesh_(mesh),
      dim_(dim),
      cut_shapes_(cut_out),
      has_moved_(has_moved) {
  volume = static_cast<double>(position.size()) / dim * std::pow(width, dim);
  places_.emplace_back(std::move(position), width, dim);
  bounds = places_[0].bounds();
  measure();
}

void Filled::move(const Vec3& by) {
  for (int d = 0; d < dim_; ++d) moved_[d] += by[d], bounds.lower[d] += by[d], bounds.upper[d] += by[d];
}

void Filled::measure() {
  for (const Shape& hole : cut_shapes_) holes_.emplace_back(hole, dim_, k_slack * mesh_.spacing);
  thinnest = bounds.upper[0] - bounds.lower[0];
  for (int d = 1; d < dim_; ++d) thinnest = std::min(thinnest, bounds.upper[d] - bounds.lower[d]);
}

/// Particles that have moved leave gaps of less than their width, which are soil too: a point with soil near
/// it on two opposite sides.
bool Filled::soil_holds(const Vec3& x) const {
  if (places_[0].hold(x)) return true;
  for (int d = 0; d < dim_ && has_moved_; ++d) {
    Vec3 low = x, high = x;
    low[d] -= width / 2, high[d] += width / 2;
    if (places_[0].hold(low) && places_[0].hold(high)) return true;
  }
  return false;
}

void Filled::enter_row(double low, double high) {
  low -= moved_[dim_ - 1], high -= moved_[dim_ - 1];
  const double reach = shape_.fill == Fill::cell ? mesh_.spacing : 0;  // holds_cell() tests whole cells
  for (Region& region : region_) region.enter_row(low - reach, high + reach);
  for (Region& hole : holes_) hole.enter_row(low, high);
}

bool Filled::holds(const Vec3& place) const {
  Vec3 x = place;
  for (int d = 0; d < dim_; ++d) x[d] -= moved_[d];
  if (!places_.empty()) {
    if (!soil_holds(x)) return false;
  } else if (shape_.fill == Fill::cell) {
    Vec3 corner{};
    for (int d = 0; d < dim_; ++d)
      corner[d] = mesh_.lower[d] + std::floor((x[d] - mesh_.lower[d]) / mesh_.spacing) * mesh_.spacing;
    if (!region_[0].holds_cell(corner, mesh_.spacing)) return false;
  } else if (!region_[0].holds(x)) {
    return false;
  }
  return std::none_of(holes_.begin(), holes_.end(), [&x](const Region& hole) { return hole.holds(x); });
}

}  // namespace mpm
