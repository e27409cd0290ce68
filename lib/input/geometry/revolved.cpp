#include "input/geometry/revolved.hpp"

#include <algorithm>
#include <cmath>

namespace mpm {

std::array<double, 2> ends_of(const Shape& shape) {
  const double z = shape.centre[2];
  if (shape.kind == ShapeKind::cone && shape.tip_up) return {z - shape.height, z};
  return {z, z + shape.height};
}

Polygon section_of(const Shape& shape, double below, double above) {
  const auto [low, high] = ends_of(shape);
  const double r = shape.radius, tip = shape.kind == ShapeKind::cone ? shape.height : shape.tip_height;
  const bool tip_below = tip > 0 && !shape.tip_up, tip_above = tip > 0 && shape.tip_up;
  Polygon side;  // from the lower end to the upper one
  side.push_back(tip_below ? Point2{0, low} : Point2{r, low - below});
  if (tip_below && low + tip < high + above) side.push_back({r, low + tip});
  if (tip_above && below > 0) side.push_back({r, low});
  side.push_back(tip_above ? Point2{0, high} : Point2{r, high + above});
  Polygon section = side;
  for (std::size_t k = side.size(); k-- > 0;)
    if (side[k][0] > 0) section.push_back({-side[k][0], side[k][1]});
  return section;
}

bool revolved_holds(const Shape& shape, const Vec3& x, double slack) {
  const auto [low, high] = ends_of(shape);
  const double off = std::hypot(x[0] - shape.centre[0], x[1] - shape.centre[1]);
  if (x[2] < low - slack || x[2] > high + slack || off > shape.radius + slack) return false;
  const double tip = shape.kind == ShapeKind::cone ? shape.height : shape.tip_height;
  if (tip == 0) return true;
  const double from_tip = shape.tip_up ? high - x[2] : x[2] - low;
  // along the normal of the cone's side
  return tip * off - shape.radius * from_tip <= slack * std::hypot(tip, shape.radius);
}

}  // namespace mpm
