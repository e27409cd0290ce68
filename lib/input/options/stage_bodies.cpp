// Bodies that stages place and remove.

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/presence.hpp"
#include "common/text.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

/// Indices of a list of names: of bodies, and of rigids.
struct Chosen {
  std::vector<int>&bodies, &rigids;
};

/// Reads a list of bodies and rigids. `fault` returns why a name has no place there, as the end of "takes
/// ...".
void read_list(OptionReader& in, const Option& option, const Config& config, const Chosen& chosen,
               const std::function<std::string(const std::string&)>& fault) {
  std::vector<std::string> bodies, rigids, names;
  for (const BodyConfig& body : config.bodies) bodies.push_back(body.name);
  for (const RigidConfig& rigid : config.rigids) rigids.push_back(rigid.name);
  std::vector<std::string> all = bodies;
  all.insert(all.end(), rigids.begin(), rigids.end());
  const std::string takes = in.listing() ? "names of -bodies and -rigid_bodies"
                                         : "names of -bodies and -rigid_bodies: " + join(all, ", ");
  if (!in.list_of(option, takes, names)) return;
  const auto place_in = [](const std::vector<std::string>& list, const std::string& name) {
    const auto found = std::find(list.begin(), list.end(), name);
    return found == list.end() ? -1 : static_cast<int>(found - list.begin());
  };
  for (const std::string& name : names) {
    const int body = place_in(bodies, name), rigid = place_in(rigids, name);
    if (body < 0 && rigid < 0) {
      if (in.is_left_out(name)) continue;
      return in.reject(option.name, takes);
    }
    if (const std::string why = fault(name); !why.empty()) return in.reject(option.name, why);
    std::vector<int>& list = body >= 0 ? chosen.bodies : chosen.rigids;
    const int index = body >= 0 ? body : rigid;
    if (std::find(list.begin(), list.end(), index) == list.end()) list.push_back(index);
  }
}

/// The largest mean stress [Pa] that soil of a body may have under the weight of the mesh's whole height: of
/// soil whose stress is unknown before it gets a new material.
double pressure_of_mesh(const Config& config, const BodyConfig& body) {
  double pressure = 0;
  for (int d = 0; d < config.dim; ++d)
    pressure += std::abs(config.gravity[d]) * (config.mesh.upper[d] - config.mesh.lower[d]);
  return density_of(config, body) * pressure;
}

/// Whether two materials give the same strength at the same height and vertical stress.
bool same_strength(const MaterialConfig& one, const MaterialConfig& other) {
  for (const char* key : {"su", "su_gradient", "su_datum", "su_ratio"}) {
    const double a = parameter_of(one, key), b = parameter_of(other, key);
    if (a != b && !(std::isnan(a) && std::isnan(b))) return false;
  }
  return one.name == other.name;
}

/// Names of what cuts a body as it is placed, because it is placed at the same time, in order.
std::vector<std::string> cutters_of(const Config& config, const BodyConfig& body) {
  std::vector<std::string> names;
  const int placed = placed_at(config.stage, body.name);
  const auto add = [&](const std::string& name) {
    if (placed_at(config.stage, name) == placed) names.push_back(name);
  };
  for (const int rigid : body.cut_out) add(config.rigids[rigid].name);
  for (const int other : body.cut_out_bodies) add(config.bodies[other].name);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

void note_stage_bodies(const OptionReader& in, const std::vector<std::string>& stages, StageConfig& stage) {
  for (std::size_t k = 0; k < stages.size(); ++k)
    for (const auto& [key, table] : {std::pair{"_place", &stage.placed_at}, {"_remove", &stage.removed_at}})
      for (const std::string& name : split(in.given_text(stages[k] + key)))
        table->emplace(lower_case(name), static_cast<int>(k) + 1);
}

void note_presence(const StageConfig& stage, BodyConfig& body) {
  const int placed = placed_at(stage, body.name);
  body.absent = placed > stage.number;
  body.from_before = stage.number > 1 && placed < stage.number;
  body.removed = removed_at(stage, body.name) <= stage.number;
}

void note_presence(const StageConfig& stage, RigidConfig& rigid) {
  rigid.absent = placed_at(stage, rigid.name) > stage.number || removed_at(stage, rigid.name) <= stage.number;
}

void read_stage_bodies(OptionReader& in, const Config& config, StageConfig& stage) {
  const Option place{.name = in.listing() ? "STAGE_place" : "place",
                     .meaning =
                         "bodies and rigid bodies that are not in the run before the stage begins, as "
                         "a fill or a plate",
                     .standard = "none"},
      remove{.name = in.listing() ? "STAGE_remove" : "remove",
             .meaning = "bodies and rigid bodies that are removed when the stage begins, as by an excavation",
             .standard = "none"};
  if (!in.listing() && stage.number == 1) {
    in.not_taken(place.name, "the first stage begins with all that no other stage places");
    in.not_taken(remove.name, "no stage comes before the first one");
    const auto later = [](const BodyConfig& body) { return body.absent; };
    if (!config.bodies.empty() && std::all_of(config.bodies.begin(), config.bodies.end(), later))
      in.reject("bodies", "at least one body that no stage places: the first stage has no soil");
    return;
  }
  read_list(in, place, config, {stage.place, stage.place_rigids}, [&](const std::string& name) {
    if (placed_at(stage, name) < stage.number)
      return "bodies that no earlier stage places; " + name + " is there since stage " +
             config.stages[placed_at(stage, name) - 1];
    if (removed_at(stage, name) <= stage.number)
      return "bodies that are not removed before or at the same stage; " + name + " is, at stage " +
             config.stages[removed_at(stage, name) - 1];
    return std::string();
  });
  read_list(in, remove, config, {stage.remove, stage.remove_rigids}, [&](const std::string& name) {
    if (placed_at(stage, name) < stage.number) return std::string();
    return "bodies that are in the run by then; " + name + " is placed at stage " +
           config.stages[placed_at(stage, name) - 1];
  });
}

void check_cut_kept(OptionReader& in, const Config& first, const Config& now) {
  if (first.bodies.size() != now.bodies.size() || first.rigids.size() != now.rigids.size()) return;
  for (std::size_t b = 0; b < now.bodies.size(); ++b) {
    const std::vector<std::string> wanted = cutters_of(first, first.bodies[b]);
    if (wanted == cutters_of(now, now.bodies[b])) continue;
    in.reject(now.bodies[b].name + "_cut_out",
              wanted.empty() ? "nothing that was placed with it: its particles are there already"
                             : "what the first stage cuts out as the body is placed, " + join(wanted) +
                                   ", and what another stage places");
  }
}

void follow_stage(const Config& before, Config& now) {
  if (before.bodies.size() != now.bodies.size() || before.materials.size() != now.materials.size()) return;
  for (std::size_t b = 0; b < now.bodies.size(); ++b) {
    BodyConfig& body = now.bodies[b];
    const BodyConfig& then = before.bodies[b];
    const int materials = static_cast<int>(now.materials.size());
    if (!body.from_before || body.material >= materials || then.material >= materials) continue;
    if (const double density = density_of(before, then); density != now.materials[body.material].density)
      body.density = density;
    body.stress = then.stress, body.largest_pressure = then.largest_pressure;
    body.keeps_strength = same_strength(before.materials[then.material], now.materials[body.material]);
    if (body.material != then.material)
      body.largest_pressure = std::max(body.largest_pressure, pressure_of_mesh(now, body));
  }
}

}  // namespace mpm
