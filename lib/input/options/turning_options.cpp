// Rotation of a rigid body: what is free, how fast it turns, and its inertia.

#include <algorithm>
#include <cmath>

#include "common/numbers.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/geometry/mass_properties.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr const char* k_degrees[] = {"x", "y", "z", "rx", "ry", "rz"};
constexpr Range k_spin{.lowest = -1e6, .highest = 1e6};  // rad/s
const std::string k_free_2d = "some of x, y and rz", k_free_3d = "some of x, y, z, rx, ry and rz";

/// Degrees of freedom by their words.
void read_free(OptionReader& in, int dim, RigidConfig& rigid) {
  const std::string takes = dim == 2 ? k_free_2d : k_free_3d, name = rigid.name + "_free";
  std::vector<std::string> words;
  const bool found = in.list_of(
      {.name = name,
       .meaning =
           "dynamic: degrees of freedom that move by forces and moments: along x, y, z, and about "
           "parallels of them through the centre of mass, rx, ry, rz (2D: rz alone). In 3D it turns about "
           "one of them or about all",
       .standard = "x, y and z: it does not turn",
       .change = k_by_choice},
      takes, words);
  if (!found) return;
  rigid.free = {};
  for (const std::string& word : words) {
    const auto at = std::find(std::begin(k_degrees), std::end(k_degrees), lower_case(word));
    const auto k = at - std::begin(k_degrees);
    const bool known = at != std::end(k_degrees) && (dim == 3 || k < 2 || k == 5);
    if (!known) return in.reject(name, takes);
    rigid.free[k] = true;
  }
  const int turns = rigid.free[3] + rigid.free[4] + rigid.free[5];
  if (dim == 3 && turns == 2) in.reject(name, "none, one or all of rx, ry and rz");
}

/// Numbers of a rotation: one in 2D.
bool read_spin(OptionReader& in, int dim, const Option& option, Vec3& value) {
  if (in.listing()) return in.numbers(option, "z", "x,y,z", std::span(value).first(1));
  return dim == 3 ? in.vector(option, 3, value) : in.number(option, value[0]);
}

/// Numbers of a rotation.
int spins_of(const OptionReader& in, int dim) { return dim == 3 || in.listing() ? 3 : 1; }

/// Whether a table of angles turns the body about one axis alone: finite rotations do not add.
bool about_one_axis(const TimeTable& table) {
  int axes = 0;
  for (int d = 0; d < 3; ++d)
    axes += std::any_of(table.values.begin(), table.values.end(), [d](const Vec3& v) { return v[d] != 0; });
  return axes <= 1;
}

/// An angular velocity in time, or an angle.
void read_turning_tables(OptionReader& in, int dim, double end, const Option& spin, RigidConfig& rigid) {
  const int spins = spins_of(in, dim);
  const std::string angle = rigid.name + "_angle";
  Option timed = spin;
  timed.meaning = "prescribed: its angular velocity";
  read_timed(in, timed, true, spins, end, rigid.angular_velocity, rigid.angular_velocity_table);
  read_timed(in,
             {.name = angle,
              .meaning = "prescribed: its rotation since the start, whose changes turn it; in 3D about one "
                         "of the axes",
              .unit = "rad",
              .range = {.lowest = -1e6, .highest = 1e6},
              .change = k_by_choice},
             false, spins, end, {}, rigid.angle_table);
  if (!in.listing() && in.given(angle + "_table"))
    for (const std::string& other : {spin.name, spin.name + "_table"})
      if (in.given(other)) in.reject(other, "nothing beside -" + angle + "_table");
  if (rigid.angle_table && !about_one_axis(*rigid.angle_table))
    in.reject(angle + "_table", "angles about one of the axes, and 0 about the others");
  if (rigid.angular_velocity_table) rigid.angular_velocity = largest_of(*rigid.angular_velocity_table);
  if (rigid.angle_table) rigid.angular_velocity = largest_rate(*rigid.angle_table);
}

void read_moment_point(OptionReader& in, int dim, RigidConfig& rigid) {
  Vec3 point{};
  if (in.vector(
          {.name = rigid.name + "_moment_point",
           .meaning = "a point of the body, at the start, about which the history has the moment of the "
                      "soil",
           .unit = "m",
           .range = {.lowest = -1e7, .highest = 1e7},
           .standard = "the centre of mass"},
          dim, point))
    rigid.moment_point = point;
}

void read_inertia(OptionReader& in, int dim, RigidConfig& rigid) {
  in.number({.name = rigid.name + "_mass",
             .meaning = "dynamic: its mass, instead of that of its shape by the density",
             .unit = "kg",
             .range = {.lowest = 0, .highest = 1e15, .open_lowest = true},
             .standard = "by its density"},
            rigid.mass);
  std::array<double, 6> inertia{};
  const Option option{.name = rigid.name + "_inertia",
                      .meaning =
                          "dynamic: its inertia about the centre of mass: xx,yy,zz,xy,yz,zx of the "
                          "tensor; in 2D one number",
                      .unit = "kg m2",
                      .range = {.lowest = dim == 2 ? 0 : -1e18, .highest = 1e18, .open_lowest = true},
                      .standard = "that of its shape"};
  const std::string tensor = "xx,yy,zz,xy,yz,zx";
  const std::span<double> all(inertia);
  const bool found = in.listing() ? in.numbers(option, "I", tensor, all.first(1))
                     : dim == 3   ? in.numbers(option, tensor, "", all)
                                  : in.number(option, inertia[0]);
  if (!found) return;
  const auto& [xx, yy, zz, xy, yz, zx] = inertia;
  const double minor = xx * yy - xy * xy;
  const double determinant = zz * minor - xx * yz * yz + 2 * xy * yz * zx - yy * zx * zx;
  if (dim == 3 && !(xx > 0 && minor > 0 && determinant > 0))
    return in.reject(option.name, "the tensor of a body, whose principal moments are greater than 0");
  rigid.inertia = inertia;
}

/// A body that a plane of symmetry cuts turns with its mirror image: in 3D about the normal of the plane, and
/// the two have their centre in it. Returns whether it may turn as the options say.
bool check_cut_turning(OptionReader& in, const std::string& option, const MeshConfig& mesh, int dim,
                       const RigidConfig& rigid) {
  const bool dynamic = rigid.motion == Motion::dynamic;
  const Cuts cuts = cuts_of(rigid.shape, mesh, dim);
  int planes = 0;
  for (const auto& sides : cuts) planes += sides[0] + sides[1];
  const bool may_turn = dim == 3 && planes == 1;
  for (int d = 0; d < dim; ++d) {
    if (!cuts[d][0] && !cuts[d][1]) continue;
    const std::string where =
        std::string(" where the plane of symmetry across ") + "xyz"[d] + " cuts the shape";
    const std::string about =
        may_turn ? std::string("a rotation about ") + "xyz"[d] + " alone" : "no rotation";
    bool sound = may_turn;
    for (int e = 0; e < 3; ++e)
      if (e != d) sound = sound && rigid.angular_velocity[e] == 0 && !(dynamic && rigid.free[3 + e]);
    if (!sound) return in.reject(option, about + where), false;
    const double plane = cuts[d][0] ? mesh.lower[d] : mesh.upper[d], slack = 1e-6 * mesh.spacing;
    const auto whole = whole_properties(rigid.shape, mesh, dim);
    const std::string there = std::string(" at ") + "xyz"[d] + " = " + text_of(plane);
    if (rigid.centre_of_mass && std::abs((*rigid.centre_of_mass)[d] - plane) > slack)
      return in.reject(rigid.name + "_centre_of_mass", "a point of the plane of symmetry" + there), false;
    const bool given = rigid.centre_of_mass && (rigid.inertia || !dynamic);
    if (!given && std::abs(whole->centre[d] - plane) > slack)
      return in.reject(option, "a shape that is its own image in the plane of symmetry" + there + ", or -" +
                                   rigid.name + "_centre_of_mass" +
                                   (dynamic ? " and -" + rigid.name + "_inertia" : "") + " beside it"),
             false;
  }
  return true;
}

}  // namespace

const std::vector<std::string>& turning_keys() {
  static const std::vector<std::string> keys{"free",
                                             "angular_velocity",
                                             "angular_velocity_table",
                                             "angular_velocity_table_interpolation",
                                             "angle_table",
                                             "angle_table_interpolation",
                                             "centre_of_mass",
                                             "moment",
                                             "moment_table",
                                             "moment_table_interpolation",
                                             "moment_point",
                                             "mass",
                                             "inertia"};
  return keys;
}

void read_turning(OptionReader& in, int dim, double end, RigidConfig& rigid) {
  const bool dynamic = rigid.motion == Motion::dynamic || in.listing();
  const std::string motion = rigid.name + "_motion";
  if (const auto only = in.where(motion, {"dynamic"}); dynamic) read_free(in, dim, rigid);
  const auto moves = in.where(motion, {"prescribed", "dynamic"});
  const Option spin{
      .name = rigid.name + "_angular_velocity",
      .meaning =
          "prescribed: the velocity at which it turns about its centre of mass; dynamic: that at "
          "the start; in 2D one number, counter-clockwise",
      .unit = "rad/s",
      .range = k_spin,
      .change = k_by_choice};
  read_spin(in, dim, spin, rigid.angular_velocity);
  if (const auto only = in.where(motion, {"prescribed"}); rigid.motion == Motion::prescribed || in.listing())
    read_turning_tables(in, dim, end, spin, rigid);
  read_moment_point(in, dim, rigid);
  Vec3 centre{};
  const bool has_centre = in.given(rigid.name + "_centre_of_mass");
  if ((has_centre || in.listing()) && in.vector({.name = rigid.name + "_centre_of_mass",
                                                 .meaning = "the point about which it turns, at the start",
                                                 .unit = "m",
                                                 .range = {.lowest = -1e7, .highest = 1e7},
                                                 .standard = "that of its shape"},
                                                dim, centre))
    rigid.centre_of_mass = centre;
  if (!dynamic) return;
  const auto only = in.where(motion, {"dynamic"});
  const Option moment{.name = rigid.name + "_moment",
                      .meaning = "dynamic: external moment on it about the centre of mass; in 2D one number",
                      .unit = "N m",
                      .range = k_stress,
                      .change = k_by_choice};
  read_spin(in, dim, moment, rigid.moment);
  read_timed(in, moment, true, spins_of(in, dim), end, rigid.moment, rigid.moment_table);
  read_inertia(in, dim, rigid);
}

void check_turning(OptionReader& in, const Config& config, const MeshConfig& mesh, const RigidConfig& rigid) {
  const std::string spin = rigid.name + "_angular_velocity";
  const bool free = rigid.motion == Motion::dynamic && (rigid.free[3] || rigid.free[4] || rigid.free[5]);
  if (!rigid.turns()) {
    const std::string beside =
        rigid.motion == Motion::dynamic ? "_free with a rotation" : "_angular_velocity";
    for (const std::string key : {"_moment", "_moment_table", "_inertia", "_centre_of_mass", "_moment_point"})
      if (in.given(rigid.name + key) && in.is_read(rigid.name + key) &&
          (rigid.motion == Motion::dynamic || key == "_centre_of_mass" || key == "_moment_point"))
        in.refuse(rigid.name + key, "a -" + rigid.name + beside + " beside it");
    return;
  }
  const std::string option = free ? rigid.name + "_free" : spin, none = free ? "no rotation" : "0";
  if (rigid.motion == Motion::dynamic && !free)
    return in.reject(spin, "a -" + rigid.name + "_free with a rotation beside it, for the body is dynamic");
  const bool one_axis = free && config.dim == 3 && !(rigid.free[3] && rigid.free[4]);
  for (int d = 0; d < 3 && one_axis; ++d)
    if (!rigid.free[3 + d] && rigid.angular_velocity[d] != 0)
      return in.reject(spin, std::string("0 about ") + "xyz"[d] + ", for only r" +
                                 (rigid.free[3]   ? "x"
                                  : rigid.free[4] ? "y"
                                                  : "z") +
                                 " is free");
  if (config.geometry == Geometry::axisymmetric)
    return in.reject(option, none + " with -geometry axisymmetric");
  const ShapeKind kind = rigid.shape.kind;
  if (kind == ShapeKind::layer || kind == ShapeKind::half_plane || kind == ShapeKind::particles)
    return in.reject(option, none + " of a layer, a half plane or a list of particles");
  if (rigid.contact_normal == ContactNormal::gradient)
    return in.reject(option, none + " where -" + rigid.name + "_contact_normal is gradient");
  if (!check_cut_turning(in, option, mesh, config.dim, rigid)) return;
  if (rigid.centre_of_mass && config.water.level && rigid.motion == Motion::dynamic)
    in.reject(rigid.name + "_centre_of_mass",
              "nothing where -water_level is given: the buoyancy acts at the centre of the shape");
}

}  // namespace mpm
