#include "check/warnings_rigids.hpp"

#include <algorithm>
#include <cmath>

#include "check/rigid_places.hpp"
#include "common/rigid_contact.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/geometry/light_rigids.hpp"
#include "input/geometry/mass_properties.hpp"
#include "input/geometry/shapes.hpp"

namespace mpm {
namespace {

using Lines = std::vector<std::string>;

/// Bounds that have moved.
Bounds moved(Bounds bounds, const Vec3& by) {
  for (int d = 0; d < 3; ++d) bounds.lower[d] += by[d], bounds.upper[d] += by[d];
  return bounds;
}

/// A rigid body on its way through a stage. A dynamic one flies freely until it comes to soil.
struct Way {
  const Config& config;
  const RigidConfig& rigid;
  Bounds bounds;        // m, at the start
  Vec3 acceleration{};  // m/s2, dynamic
  double end;           // s: of the stage, or till it comes to soil
  int soil = -1;        // the body that it comes to first

  Way(const Config& c, const RigidConfig& r)
      : config(c), rigid(r), bounds(bounds_of(r.shape, c.mesh, c.dim)), end(c.time.end) {
    if (rigid.motion != Motion::dynamic) return;
    const double mass = mass_of(config, rigid);
    for (int d = 0; d < config.dim; ++d) acceleration[d] = config.gravity[d] + rigid.force[d] / mass;
    constexpr int k_times = 400;
    for (int k = 0; k <= k_times && soil < 0; ++k) {
      const double time = config.time.end * k / k_times;
      soil = soil_near(moved(bounds, at(time)));
      if (soil >= 0) end = time;
    }
  }
  /// Displacement [m] by a time [s].
  Vec3 at(double time) const {
    Vec3 by{};
    for (int d = 0; d < config.dim && rigid.motion != Motion::fixed; ++d)
      by[d] = rigid.motion == Motion::prescribed ? travel(rigid, d, time)
                                                 : rigid.velocity[d] * std::min(time, end) +
                                                       acceleration[d] / 2 * std::pow(std::min(time, end), 2);
    return by;
  }
  /// A body of soil whose bounds are less than half a cell from these; -1 where there is none.
  int soil_near(const Bounds& place) const {
    for (std::size_t b = 0; b < config.bodies.size(); ++b) {
      const BodyConfig& body = config.bodies[b];
      if (body.absent || body.removed) continue;
      const Bounds other = bounds_of(body.shape, config.mesh, config.dim);
      bool near = true;
      for (int d = 0; d < config.dim; ++d)
        near = near && std::min(place.upper[d], other.upper[d]) - std::max(place.lower[d], other.lower[d]) >
                           -config.mesh.spacing / 2;
      if (near) return static_cast<int>(b);
    }
    return -1;
  }
  bool moves() const { return rigid.motion != Motion::fixed; }
  /// Whether something presses a dynamic body on soil for longer than an impact.
  bool is_loaded() const { return acceleration != Vec3{} || rigid.force_table; }
  /// Whether a dynamic body goes sideways: by its velocity or what pushes it, or down soil that is not level.
  bool goes_sideways() const {
    for (int d = 0; d < config.dim - 1; ++d)
      if (rigid.velocity[d] != 0 || acceleration[d] != 0 || rigid.force_table) return true;
    if (soil < 0) return false;
    const Shape& ground = config.bodies[soil].shape;
    return ground.kind != ShapeKind::box || ground.angle != 0;
  }
};

/// Rigid bodies that come into each other, and those that leave the mesh.
void warn_of_meetings(const Config& config, const std::vector<Way>& ways, Lines& lines) {
  RigidPlaces places(config);
  constexpr int k_times = 200;
  const int count = static_cast<int>(ways.size());
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) {
      if (ways[a].rigid.absent || ways[b].rigid.absent || !(ways[a].moves() || ways[b].moves())) continue;
      if (have_contact(config, ways[a].rigid, ways[b].rigid)) {
        if (places.share_space(a, b, {}, {}))
          lines.push_back(
              formatted("warning: rigid %s and rigid %s have space in common at the start: they do not touch "
                        "each other",
                        ways[a].rigid.name.c_str(), ways[b].rigid.name.c_str()));
        continue;
      }
      if (places.share_space(a, b, {}, {})) continue;  // parts of one body
      for (int k = 1; k <= k_times; ++k) {
        const double time = config.time.end * k / k_times;
        if (!places.share_space(a, b, ways[a].at(time), ways[b].at(time))) continue;
        const bool first = ways[a].moves();  // the name of one that moves
        lines.push_back(
            formatted("warning: rigid %s goes into rigid %s after %.3g s: these two do not touch "
                      "each other",
                      ways[first ? a : b].rigid.name.c_str(), ways[first ? b : a].rigid.name.c_str(), time));
        break;
      }
    }
}

/// Whether sides of the mesh that are not free stop a rigid body.
bool stops_at_sides(const Config& config, const Way& way) {
  return config.rigid_contact && way.rigid.motion == Motion::dynamic && is_touchable(way.rigid);
}

/// The run fails where a particle of a rigid body leaves the mesh.
void warn_of_leaving(const Config& config, const Way& way, Lines& lines) {
  const Shape& shape = way.rigid.shape;
  if (!way.moves() || shape.kind == ShapeKind::half_plane || config.stage.end == StageEnd::displacement)
    return;
  const Bounds inside = within(way.bounds, config.mesh, config.dim);
  const double edge = config.mesh.spacing / shape.particles_per_cell / 2;
  constexpr int k_times = 400;
  for (int k = 1; k <= k_times; ++k) {
    const double time = config.time.end * k / k_times;
    const Bounds place = moved(inside, way.at(time));
    for (int d = 0; d < config.dim; ++d) {
      if (place.lower[d] > config.mesh.lower[d] - edge && place.upper[d] < config.mesh.upper[d] + edge)
        continue;
      if (is_periodic(config.mesh, d)) continue;
      const bool upper = place.upper[d] >= config.mesh.upper[d] + edge;
      if (stops_at_sides(config, way) && !is_open(config.mesh.walls[d][upper])) return;
      lines.push_back(formatted("warning: rigid %s leaves the mesh after %.3g s, where the run fails",
                                way.rigid.name.c_str(), time));
      return;
    }
  }
}

/// Whether symmetry keeps a body from turning.
bool is_held_by_symmetry(const Config& config, const Way& way) {
  if (config.geometry == Geometry::axisymmetric) return true;
  const double slack = 1e-6 * config.mesh.spacing;
  int planes = 0;
  for (int d = 0; d < config.dim - 1; ++d) {
    const bool low = way.bounds.lower[d] <= config.mesh.lower[d] + slack &&
                     config.mesh.walls[d][0] == Wall::roller,
               high = way.bounds.upper[d] >= config.mesh.upper[d] - slack &&
                      config.mesh.walls[d][1] == Wall::roller;
    planes += low || high;
  }
  return planes == config.dim - 1;
}

/// Whether the soil that a body comes to lies to one side of its middle.
bool is_eccentric(const Config& config, const Way& way) {
  const Bounds soil = bounds_of(config.bodies[way.soil].shape, config.mesh, config.dim),
               place = moved(way.bounds, way.at(way.end));
  for (int d = 0; d < config.dim - 1; ++d) {
    const double low = std::max(soil.lower[d], place.lower[d]),
                 high = std::min(soil.upper[d], place.upper[d]),
                 aside = (low + high - place.lower[d] - place.upper[d]) / 2;
    constexpr double k_share = 0.05;  // of the body's width
    if (std::abs(aside) > k_share * (place.upper[d] - place.lower[d])) return true;
  }
  return false;
}

void warn_of_turning(const Config& config, const Way& way, Lines& lines) {
  const RigidConfig& rigid = way.rigid;
  if (rigid.motion != Motion::dynamic || rigid.turns() || way.soil < 0 || is_held_by_symmetry(config, way))
    return;
  const bool rough = rigid.friction.value_or(0) > 0 || rigid.shear_limit > 0 ||
                     rigid.shear_fraction.value_or(0) > 0,
             round = rigid.shape.kind == ShapeKind::disc,
             upright = rigid.shape.kind == ShapeKind::box && rigid.shape.angle == 0;
  if (rough || (!round && (!upright || way.goes_sideways() || is_eccentric(config, way))))
    lines.push_back("warning: rigid " + rigid.name + " does not turn; -" + rigid.name + "_free with " +
                    (config.dim == 2 ? "rz" : "rx,ry,rz") + " lets it");
}

/// The resistance to sliding of a surface that is not along the mesh, in docs/method.md.
void warn_of_drag(const Config& config, const Way& way, Lines& lines) {
  const RigidConfig& rigid = way.rigid;
  const bool flat = rigid.shape.kind == ShapeKind::box && rigid.shape.angle == 0 && rigid.shape.fillet == 0;
  if (rigid.motion != Motion::dynamic || way.soil < 0 || flat || !way.goes_sideways() || !way.is_loaded())
    return;
  if (rigid.contact_at_sites) return;
  constexpr double k_enough = 20;  // cells over the radius
  const double cells = rigid.shape.radius / config.mesh.spacing;
  if (cells > k_enough) return;
  const std::string size = rigid.shape.kind == ShapeKind::disc
                               ? formatted(", which has %.3g cells over its radius,", cells)
                               : std::string();
  lines.push_back(
      "warning: rigid " + rigid.name + size +
      " moves too slowly where it slides on soil: contact of a curved or tilted surface drags; -" +
      rigid.name + "_contact sites does not");
}

void warn_of_gradient(const RigidConfig& rigid, Lines& lines) {
  if (rigid.contact_normal != ContactNormal::gradient) return;
  lines.push_back(
      "warning: rigid " + rigid.name +
      ": with contact normals of the gradient the force on a footing is too large, by 8 % (strip) "
      "to 30 % (square)" +
      "; -" + rigid.name + "_contact_normal surface does not do this");
}

/// Faces have no sites beside sharp edges.
void warn_of_narrow_faces(const Config& config, const RigidConfig& rigid, Lines& lines) {
  if (!rigid.contact_at_sites || is_wide_for_sites(rigid.shape, config.mesh, config.dim)) return;
  const double cells = narrowest(rigid.shape, config.mesh, config.dim) / config.mesh.spacing;
  const std::string what = cells < k_wide_for_sites * (1 - 1e-6)
                               ? formatted("the rigid is %.3g cells across", cells)
                               : std::string("a twentieth of it or more is less than 2 cells thick");
  lines.push_back(
      formatted("warning: -%s_contact: given \"sites\", but %s: faces of less than 1.1 cells let soil "
                "through; take nodes or smaller cells",
                rigid.name.c_str(), what.c_str()));
}

/// Light bodies that contact takes as infinitely heavy: at sites, or where a joint or a spring acts.
void warn_of_lightness(const Config& config, const RigidConfig& rigid, Lines& lines) {
  const Lightness of = lightness_of(config, rigid);
  if (!of.is_light() || solves_for_velocity(config, rigid)) return;
  if (of.mass >= of.layer)
    return lines.push_back(formatted(
        "warning: rigid %s has %.3g of the moment of inertia of a layer of soil one cell thick that "
        "sticks to it: contact may turn it more and more; take smaller cells or a heavier body",
        rigid.name.c_str(), of.turning));
  lines.push_back(
      formatted("warning: rigid %s has %.4g kg, less than a layer of soil one cell thick at its face, "
                "%.4g kg: contact may throw it up; take smaller cells or a heavier body",
                rigid.name.c_str(), of.mass, of.layer));
}

}  // namespace

std::vector<std::string> warnings_of_rigids(const Config& config) {
  Lines lines;
  std::vector<Way> ways;
  for (const RigidConfig& rigid : config.rigids) ways.emplace_back(config, rigid);
  warn_of_meetings(config, ways, lines);
  for (const Way& way : ways) {
    if (way.rigid.absent) continue;
    warn_of_leaving(config, way, lines);
    warn_of_turning(config, way, lines);
    warn_of_drag(config, way, lines);
    warn_of_gradient(way.rigid, lines);
    warn_of_narrow_faces(config, way.rigid, lines);
    warn_of_lightness(config, way.rigid, lines);
  }
  return lines;
}

}  // namespace mpm
