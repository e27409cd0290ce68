#include "input/geometry/round_volume.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "input/geometry/revolved.hpp"

namespace mpm {
namespace {

constexpr double k_pi = std::numbers::pi;

/// A rectangle round the origin [m].
struct Window {
  double low[2], high[2];
};

/// Integral of min(h, sqrt(r^2 - t^2)) over t from 0 to x, |x| <= r.
double under_arc(double r, double h, double x) {
  const auto quarter = [r](double t) {
    // As a product: the difference of squares, with one multiplication fused, would not be 0 at the end.
    return (t * std::sqrt(std::max(0.0, (r - t) * (r + t))) + r * r * std::asin(std::min(1.0, t / r))) / 2;
  };
  const double flat = h < r ? std::sqrt((r - h) * (r + h)) : 0, to = std::abs(x);
  const double area = h < r ? (to <= flat ? h * to : h * flat + quarter(to) - quarter(flat)) : quarter(to);
  return std::copysign(area, x);
}

/// Area of a disc of radius r about the origin in a rectangle that holds the origin.
double disc_area(double r, const Window& in) {
  if (r <= 0) return 0;
  const double from = std::max(in.low[0], -r), to = std::min(in.high[0], r);
  double area = 0;
  for (const double h : {in.high[1], -in.low[1]}) area += under_arc(r, h, to) - under_arc(r, h, from);
  return area;
}

/// Integral from a to b of what is smooth but for its ends (Takahasi & Mori 1974).
template <class StepPhase>
double integral(double a, double b, StepPhase&& f) {
  constexpr double k_step = 0.08;
  constexpr int k_points = 40;
  double sum = 0;
  for (int k = -k_points; k <= k_points; ++k) {
    const double t = k * k_step, u = k_pi / 2 * std::sinh(t);
    sum += std::cosh(t) / std::pow(std::cosh(u), 2) * f((a + b) / 2 + (b - a) / 2 * std::tanh(u));
  }
  return sum * k_step * k_pi / 2 * (b - a) / 2;
}

/// Profile that turns about a vertical axis: its radius at heights, and heights where it has a given radius.
class Profile {
 public:
  explicit Profile(const Shape& shape) : shape_(shape) {
    if (shape.kind == ShapeKind::disc)
      low_ = shape.centre[2] - shape.radius, high_ = shape.centre[2] + shape.radius;
    else
      low_ = ends_of(shape)[0], high_ = ends_of(shape)[1];
    cone_ = shape.kind == ShapeKind::cone ? shape.height : shape.tip_height;
  }
  double low() const { return low_; }
  double high() const { return high_; }
  double radius(double z) const {
    if (shape_.kind == ShapeKind::disc) return std::sqrt(std::max(0.0, (z - low_) * (high_ - z)));
    const double from_tip = shape_.tip_up ? high_ - z : z - low_;
    return from_tip < cone_ ? shape_.radius * from_tip / cone_ : shape_.radius;
  }
  void add_heights(double radius, std::vector<double>& heights) const {
    if (radius > shape_.radius) return;
    if (shape_.kind == ShapeKind::disc) {
      const double off = std::sqrt((shape_.radius - radius) * (shape_.radius + radius));
      heights.insert(heights.end(), {shape_.centre[2] - off, shape_.centre[2] + off});
    } else {
      const double from_tip = cone_ * radius / shape_.radius;
      heights.push_back(shape_.tip_up ? high_ - from_tip : low_ + from_tip);
    }
  }

 private:
  const Shape& shape_;
  double low_, high_, cone_;  // m; the last is the height of the conical part
};

}  // namespace

double round_volume(const Shape& shape, const MeshConfig& mesh, int dim) {
  Window in;
  for (int d = 0; d < 2; ++d)
    in.low[d] = mesh.lower[d] - shape.centre[d], in.high[d] = mesh.upper[d] - shape.centre[d];
  if (dim == 2) return disc_area(shape.radius, in);
  const Profile profile(shape);
  const double low = std::max(profile.low(), mesh.lower[2]), high = std::min(profile.high(), mesh.upper[2]);
  std::vector<double> heights{low, high};
  profile.add_heights(shape.radius, heights);
  for (const double x : {-in.low[0], in.high[0]}) {
    profile.add_heights(x, heights);
    for (const double y : {-in.low[1], in.high[1]})
      profile.add_heights(y, heights), profile.add_heights(std::hypot(x, y), heights);
  }
  for (double& z : heights) z = std::clamp(z, low, std::max(low, high));
  std::sort(heights.begin(), heights.end());
  double volume = 0;
  for (std::size_t k = 1; k < heights.size(); ++k)
    if (heights[k] > heights[k - 1])
      volume +=
          integral(heights[k - 1], heights[k], [&](double z) { return disc_area(profile.radius(z), in); });
  return volume;
}

}  // namespace mpm
