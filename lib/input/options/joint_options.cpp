// -joints: joints of rigid bodies with one another and with the ground.

#include <algorithm>
#include <cmath>

#include "common/presence.hpp"
#include "common/text.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr double k_degree = 3.14159265358979323846 / 180;

bool has_ends(const JointConfig& joint) {
  return joint.kind == JointKind::rod || joint.kind == JointKind::cable;
}

/// Index of a rigid; k_ground of the ground, and -2 where there is no such name.
int index_of(const Config& config, const std::string& word) {
  if (lower_case(word) == "ground") return JointConfig::k_ground;
  for (std::size_t r = 0; r < config.rigids.size(); ++r)
    if (lower_case(config.rigids[r].name) == lower_case(word)) return static_cast<int>(r);
  return -2;
}

bool is_dynamic(const Config& config, int body) {
  return body != JointConfig::k_ground && config.rigids[body].motion == Motion::dynamic;
}

/// Checks that a stage does not join bodies that may have moved against each other before.
void check_presence(OptionReader& in, const Config& config, const JointConfig& joint,
                    const std::string& option) {
  if (config.stages.empty() || joint.bodies[1] == JointConfig::k_ground) return;
  const RigidConfig &first = config.rigids[joint.bodies[0]], &second = config.rigids[joint.bodies[1]];
  const auto placed = [&](const RigidConfig& rigid) {
    return std::max(1, placed_at(config.stage, rigid.name));
  };
  const RigidConfig& before = placed(first) < placed(second) ? first : second;
  if (placed(first) != placed(second) && before.motion != Motion::fixed)
    in.reject(option, "bodies that are placed at one stage, or one that is fixed; " + before.name +
                          " may have moved before");
}

/// The two bodies. Whether they are sound.
bool read_joined(OptionReader& in, const Config& config, JointConfig& joint) {
  const Option option{.name = joint.name + "_bodies",
                      .meaning =
                          "two rigid bodies, as leg,foot, or a rigid body and the ground, as leg,ground; "
                          "one of them is dynamic",
                      .required = true};
  const std::string takes = "two names of -rigid_bodies, or one and ground";
  std::vector<std::string> words;
  if (!in.list_of(option, takes, words)) return false;
  if (words.size() != 2) return in.reject(option.name, takes), false;
  for (int side = 0; side < 2; ++side) {
    joint.bodies[side] = index_of(config, words[side]);
    const bool wrong = joint.bodies[side] < (side == 0 ? 0 : JointConfig::k_ground);
    if (wrong) return in.reject(option.name, takes), false;
  }
  if (joint.bodies[0] == joint.bodies[1]) return in.reject(option.name, "two different bodies"), false;
  if (!is_dynamic(config, joint.bodies[0]) && !is_dynamic(config, joint.bodies[1]))
    return in.reject(option.name, "a dynamic body among the two: forces move neither of these"), false;
  check_presence(in, config, joint, option.name);
  return true;
}

void read_axis(OptionReader& in, int dim, JointConfig& joint) {
  const bool slides = joint.kind == JointKind::slider, turns = joint.kind == JointKind::hinge && dim == 3;
  const std::string name = joint.name + "_axis";
  if (!slides && !turns && !in.listing())
    return in.not_taken(name, dim == 2 ? "-" + joint.name + "_kind is not slider"
                                       : "-" + joint.name + "_kind is neither hinge nor slider");
  const auto only = in.where(joint.name + "_kind", {"hinge", "slider"});
  const bool found = in.vector({.name = name,
                                .meaning = "hinge in 3D: the axis about which the bodies turn; slider: the "
                                           "direction along which they slide",
                                .unit = "-",
                                .range = k_coordinate,
                                .required = true},
                               dim, joint.axis);
  if (found && joint.axis == Vec3{}) in.reject(name, "a direction other than 0");
}

/// The length of a rod is that of its start, and a cable's at least that.
void read_length(OptionReader& in, int dim, JointConfig& joint) {
  const std::string other = joint.name + "_other_point", length = joint.name + "_length";
  if (!has_ends(joint) && !in.listing()) {
    for (const std::string& option : {other, length})
      in.not_taken(option, "-" + joint.name + "_kind is neither rod nor cable");
    return;
  }
  const auto only = in.where(joint.name + "_kind", {"rod", "cable"});
  const bool found =
      in.vector({.name = other,
                 .meaning = "rod, cable: its end on the second body or the ground, at the start",
                 .unit = "m",
                 .range = k_coordinate,
                 .required = true},
                dim, joint.other_point);
  double square = 0;
  for (int d = 0; d < dim; ++d) square += std::pow(joint.point[d] - joint.other_point[d], 2);
  joint.length = std::sqrt(square);
  const double start = joint.length;
  if (found && !(start > 0)) return in.reject(other, "a point away from -" + joint.name + "_point");
  const bool given = in.number({.name = length,
                                .meaning = "rod, cable: its length; of a cable, that at which it is taut",
                                .unit = "m",
                                .range = k_positive,
                                .standard = "the distance of its ends at the start"},
                               joint.length);
  constexpr double k_round_off = 1e-9;
  if (!given || !found) return;
  if (joint.kind == JointKind::rod && std::fabs(joint.length - start) > k_round_off * start)
    in.reject(length, formatted("the distance of its ends at the start, %.9g m", start));
  if (joint.kind == JointKind::cable && joint.length < start * (1 - k_round_off))
    in.reject(length, formatted("at least the distance of its ends at the start, %.9g m", start));
}

void read_stop(OptionReader& in, int dim, JointConfig& joint) {
  const std::string name = joint.name + "_stop_deg";
  const bool turns = joint.kind == JointKind::hinge || (dim == 2 && joint.kind == JointKind::ball);
  if (!turns && !in.listing()) return in.not_taken(name, "-" + joint.name + "_kind is not hinge");
  const auto only = in.where(joint.name + "_kind", {"hinge", "ball"});
  std::array<double, 2> stop{};
  constexpr double k_most = 179;  // degrees: half a turn has two signs
  if (!in.numbers({.name = name,
                   .meaning = "hinge: least and largest angle of the first body against the second, or the "
                              "ground, about the axis, from the start on",
                   .unit = "degrees",
                   .range = {.lowest = -k_most, .highest = k_most},
                   .standard = "no stops"},
                  "lower,upper", "lower,upper", std::span<double>(stop)))
    return;
  if (!(stop[0] <= 0 && stop[1] >= 0 && stop[0] < stop[1]))
    return in.reject(name, "two angles, of which the first is at most 0 and the second at least 0");
  joint.stop = {stop[0] * k_degree, stop[1] * k_degree};
}

/// Motion of the end on the ground.
void read_drive(OptionReader& in, int dim, double end, JointConfig& joint) {
  const Option velocity{.name = joint.name + "_velocity",
                        .meaning = "velocity of the end on the ground, as of a tow line",
                        .unit = "m/s",
                        .range = k_speed,
                        .change = k_by_choice};
  const std::string displaced = joint.name + "_displacement";
  if (joint.bodies[1] != JointConfig::k_ground && !in.listing()) {
    for (const char* key : {"_velocity", "_velocity_table", "_displacement_table"})
      in.not_taken(joint.name + key, "-" + joint.name + "_bodies does not end with ground");
    return;
  }
  const auto only = in.where(joint.name + "_bodies", {"ground"});
  in.vector(velocity, dim, joint.velocity);
  read_timed(in, velocity, true, dim, end, joint.velocity, joint.velocity_table);
  read_timed(in,
             {.name = displaced,
              .meaning = "displacement of the end on the ground since the start, whose changes move it",
              .unit = "m",
              .range = k_coordinate,
              .change = k_by_choice},
             false, dim, end, {}, joint.displacement_table);
  if (!in.listing() && in.given(displaced + "_table"))
    for (const std::string& other : {velocity.name, velocity.name + "_table"})
      if (in.given(other)) in.reject(other, "nothing beside -" + displaced + "_table");
}

void check_run(OptionReader& in, const MeshConfig& mesh, const Config& config, const std::string& option) {
  if (config.geometry == Geometry::axisymmetric)
    in.reject(option, "nothing here: -geometry axisymmetric has no joints");
  else if (is_periodic(mesh))
    in.reject(option, "nothing here: a mesh with periodic sides has no joints");
}

}  // namespace

void read_joint(OptionReader& in, const MeshConfig* mesh, const Config& config, JointConfig& joint) {
  in.section("Each joint NAME", {"joints"});
  const int dim = config.dim;
  const bool known =
      in.word({.name = joint.name + "_kind",
               .meaning = "ball: two points stay together; hinge: and the bodies turn about an "
                          "axis alone; slider: they slide along an axis and do not turn "
                          "against each other; weld: they move as one; rod: two points keep "
                          "their distance; cable: it is at most the length",
               .required = true},
              Words<JointKind>{{"ball", JointKind::ball},
                               {"hinge", JointKind::hinge},
                               {"slider", JointKind::slider},
                               {"weld", JointKind::weld},
                               {"rod", JointKind::rod},
                               {"cable", JointKind::cable}},
              joint.kind);
  const bool joined = read_joined(in, config, joint);
  if ((!known || !joined) && !in.listing()) return in.ignore(joint.name + "_");  // these decide of the others
  in.vector({.name = joint.name + "_point",
             .meaning = "the joint's point of the first body, at the start",
             .unit = "m",
             .range = k_coordinate,
             .required = true},
            dim, joint.point);
  read_length(in, dim, joint);
  read_axis(in, dim, joint);
  read_stop(in, dim, joint);
  read_drive(in, dim, config.time.end, joint);
  if (mesh) check_run(in, *mesh, config, joint.name + "_kind");
}

}  // namespace mpm
