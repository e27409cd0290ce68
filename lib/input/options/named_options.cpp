// -materials, -bodies, -rigid_bodies, -joints, -loads, -probes, and what each named thing owns.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "common/text.hpp"
#include "input/deck/petsc_names.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

bool is_name(const std::string& word) {
  const auto plain = [](unsigned char c) { return c < 128 && (std::isalnum(c) || c == '_'); };
  return !word.empty() && static_cast<unsigned char>(word[0]) < 128 &&
         std::isalpha(static_cast<unsigned char>(word[0])) && std::all_of(word.begin(), word.end(), plain);
}

/// The names in use so far (lower case, since case does not matter in options), and the words that no name
/// may be.
struct Names {
  std::set<std::string> used, reserved;

  explicit Names(const OptionReader& in) {
    for (const auto& option : in.known()) reserved.insert(split(option, '_')[0]);
    // of -wall_time_limit, -rigid_bodies and -rebuild_margin, which none of these good names can have
    for (const char* free : {"wall", "rigid", "rebuild"}) reserved.erase(free);
    for (const auto& option : petsc_names()) reserved.insert(split(option, '_')[0]);
  }
  /// Fault of a name; empty where there is none.
  std::string fault(const std::string& name) const {
    const std::string key = lower_case(name);
    if (!is_name(name)) return "names of letters, digits and _ that begin with a letter, as sand,clay";
    if (reserved.count(key) || is_petsc_name(key + "_"))
      return "names other than " + name + ", which begins other options";
    if (used.count(key))
      return "names that no other material, body, rigid, joint, load or probe has; " + name + " is taken";
    return "";
  }
};

/// The good names of a list. A bad one is reported, and its own options are left unread.
std::vector<std::string> read_names(OptionReader& in, const Option& option, Names& names) {
  std::vector<std::string> given, good;
  if (option.required || !in.none(option)) in.list_of(option, "names, as sand,clay", given);
  if (in.listing()) return {"NAME"};
  for (const auto& name : given) {
    if (name.empty()) continue;  // reported
    const std::string fault = names.fault(name);
    if (fault.empty()) {
      names.used.insert(lower_case(name));
      good.push_back(name);
    } else {
      in.reject(option.name, fault);
      if (!names.used.count(lower_case(name))) in.ignore(name + "_");
    }
  }
  return good;
}

/// The good names of bodies and rigids.
struct Listed {
  std::vector<std::string> bodies, rigids;
};

/// Names of a list that a later one, as of the command line, replaced: the deck may still speak of them.
void leave_out(OptionReader& in, const std::string& list, const Names& names) {
  for (const auto& value : in.replaced(list))
    for (const auto& name : split(value))
      if (names.fault(name).empty() && !in.is_left_out(name)) in.leave_out(list, name);
}

/// Where a whole list was forgotten, that is the one mistake: what is given for its names is none.
void forgive_unlisted(OptionReader& in, const Names& names) {
  const auto pass = [&](const char* key) {
    for (const auto& owner : in.owners_of(key))
      if (!names.used.count(owner)) in.ignore(owner + "_");
  };
  if (!in.given("materials")) pass("model"), pass("density");
  if (!in.given("bodies")) pass("material"), pass("shape");
  if (in.given("rigid_bodies") || !in.given("bodies")) return;
  for (const auto& owner : in.owners_of("shape")) {
    constexpr int k_few = 2;  // a misspelt name begins fewer options
    if (in.count_of(owner + "_") <= k_few || names.used.count(owner) || in.is_left_out(owner)) continue;
    in.reject("rigid_bodies", "names, as plate,pipe; " + owner + " has a shape, and no list has it");
    in.ignore(owner + "_");
  }
}

/// The rigids and bodies out of whose shapes the body is cut.
void read_cut_out(OptionReader& in, const Listed& listed, BodyConfig& body) {
  const Option option{.name = body.name + "_cut_out",
                      .meaning =
                          "rigids and other bodies in whose shapes the body has no particles, as they are at "
                          "the start or when a stage places the later of the two",
                      .change = k_at_stages};
  std::vector<std::string> others = listed.rigids, names;
  for (const auto& name : listed.bodies)
    if (name != body.name) others.push_back(name);
  const std::string takes = in.listing()     ? "names of -rigid_bodies and -bodies, as pipe,plate"
                            : others.empty() ? "names of -rigid_bodies and -bodies, which list no other"
                                             : "names of -rigid_bodies and -bodies: " + join(others, ", ");
  if (!in.list_of(option, takes, names)) return;
  const auto place_in = [](const std::vector<std::string>& list, const std::string& name) {
    const auto found = std::find(list.begin(), list.end(), name);
    return found == list.end() ? -1 : static_cast<int>(found - list.begin());
  };
  for (const auto& name : names) {
    const int rigid = place_in(listed.rigids, name), other = place_in(listed.bodies, name);
    if (rigid >= 0)
      body.cut_out.push_back(rigid);
    else if (other >= 0 && name != body.name)
      body.cut_out_bodies.push_back(other);
    else if (!in.is_left_out(name))
      return in.reject(option.name, takes);
  }
}

/// sound_materials: there are some, and no mistake was found in them.
void read_body(OptionReader& in, const MeshConfig* mesh, const Config& config, const Listed& names,
               bool sound_materials, BodyConfig& body) {
  const auto errors = in.errors();
  in.section("Each body or rigid NAME: its shape and particles", {"bodies", "rigid_bodies"});
  const bool sound = read_shape(in, body.name, config, /*body*/ true, body.shape);
  const bool from_file = body.shape.kind == ShapeKind::particles;
  if (sound && mesh && !from_file) check_shape(in, body.name, body.shape, *mesh, config.dim);

  in.section("Each body NAME", {"bodies"});
  std::vector<std::string> materials;
  for (const auto& material : config.materials) materials.push_back(material.name);
  if (materials.empty() && !in.listing())
    in.ignore(body.name + "_material");  // the list is wrong, which is reported
  else
    in.word({.name = body.name + "_material",
             .meaning = "its material",
             .required = true,
             .aside = ", of -materials",
             .change = k_by_choice,
             .names_of = "materials"},
            materials, body.material);
  read_start(in, config.dim, body);
  read_pore_pressure(in, config, body);
  read_body_field(in, body.name, from_file, body);
  read_cut_out(in, names, body);
  if (!sound || !mesh) return;
  ParticleTable listed;
  if (from_file) {
    check_particles(in, body, config, *mesh, listed);
    check_density(in, body, config, listed);
  }
  const bool keeps_none = body.from_before && !takes_field(body, config);  // its law was changed
  if (sound_materials && in.errors() == errors && !keeps_none) check_body_field(in, *mesh, config, body);
  if (sound_materials && in.errors() == errors && !body.k0) check_starts(in, *mesh, config, listed, body);
}

/// The names of the parts of a rigid body, where it has several.
void read_part_names(OptionReader& in, Names& names, RigidConfig& rigid) {
  if (in.listing()) in.section("Each rigid NAME", {"rigid_bodies"});
  const Option option{.name = rigid.name + "_parts",
                      .meaning =
                          "names of its parts, instead of a shape: each has the options of a shape, as "
                          "-fluke_shape; the body is their union"};
  if (!in.listing() && !in.given(option.name)) return;
  const auto parts = read_names(in, option, names);
  if (!in.listing()) rigid.shape.part_names = parts;
}

/// Whether the history has the forces on the parts of a rigid body.
void read_part_forces(OptionReader& in, RigidConfig& rigid) {
  const std::string name = rigid.name + "_part_forces";
  const bool one_shape = rigid.shape.part_names.empty() && !in.listing();
  if (one_shape && !in.given(name)) return;
  const auto only = in.where(rigid.name + "_parts");
  in.word({.name = name, .meaning = "whether the history has the force of the soil on each of its parts"},
          Words<bool>{{"on", true}, {"off", false}}, rigid.part_forces);
  if (one_shape && rigid.part_forces)
    in.reject(name, "off where the body has one shape; -" + rigid.name + "_parts gives it several");
}

void read_rigid(OptionReader& in, const MeshConfig* mesh, const Config& config, RigidConfig& rigid) {
  const int dim = config.dim;
  rigid.shape.particles_per_cell = 4;
  // listed with the bodies'
  const bool sound = !in.listing() && read_shape(in, rigid.name, config, /*body*/ false, rigid.shape);
  if (sound && mesh) check_shape(in, rigid.name, rigid.shape, *mesh, dim);
  in.section("Each rigid NAME", {"rigid_bodies"});
  read_motion(in, dim, config.time.end, rigid);
  if (sound && mesh) check_cut_motion(in, *mesh, dim, rigid);
  if (sound && mesh) check_in_water(in, config, rigid);
  read_contact(in, config, rigid);
  read_part_forces(in, rigid);
  if (!sound || !mesh) return;
  if (rigid.mass) rigid.density = *rigid.mass / shape_volume(rigid.shape, *mesh, dim);
  check_turning(in, config, *mesh, rigid);
}

}  // namespace

std::string name_fault(const OptionReader& known, const std::string& name) {
  return Names(known).fault(name);
}

void read_only_material(OptionReader& in, Config& config) {
  Names names(in);
  const auto materials =
      read_names(in, {.name = "materials", .meaning = "names of the materials", .required = true}, names);
  leave_out(in, "materials", names);
  if (materials.size() > 1) {
    in.reject(
        "materials",
        "the name of one material with -element_path; give the one to drive, as -materials " + materials[0]);
    for (const auto& name : materials) in.ignore(name + "_");
  } else if (!materials.empty()) {
    read_material(in, materials[0], nullptr, config, config.materials.emplace_back());
  }
}

void read_named(OptionReader& in, const MeshConfig* mesh, Config& config, const Config* before) {
  Names names(in);
  in.section("Names");
  const auto materials =
      read_names(in, {.name = "materials", .meaning = "names of the materials", .required = true}, names);
  const auto bodies = read_names(
      in, {.name = "bodies", .meaning = "names of the deformable bodies", .required = true}, names);
  const auto rigids = read_names(in, {.name = "rigid_bodies", .meaning = "names of the rigid bodies"}, names);
  const auto loads = read_names(
      in, {.name = "loads", .meaning = "names of the loads on parts of the surface of bodies"}, names);
  const auto regions = read_names(
      in, {.name = "water_regions", .meaning = "names of boxes in which the water has a level of its own"},
      names);
  const auto joints =
      read_names(in, {.name = "joints", .meaning = "names of the joints of rigid bodies"}, names);
  const auto probes = read_names(
      in, {.name = "probes", .meaning = "names of the probes, places that the history reports"}, names);
  if (!in.listing()) {
    for (const char* list :
         {"materials", "bodies", "rigid_bodies", "loads", "water_regions", "joints", "probes"})
      leave_out(in, list, names);
    forgive_unlisted(in, names);
  }
  auto errors = in.errors();
  for (const auto& name : materials) read_material(in, name, mesh, config, config.materials.emplace_back());
  const auto reduces = [](const MaterialConfig& material) {
    return !std::isnan(parameter_of(material, "strength_factor"));
  };
  if (!in.listing() && in.errors() == errors &&
      std::none_of(config.materials.begin(), config.materials.end(), reduces))
    in.not_taken("strength_factor", "no material has a strength that it divides");
  const bool sound_materials = mesh && !config.materials.empty() && in.errors() == errors && !in.listing();
  if (sound_materials)
    for (MaterialConfig& material : config.materials) prepare_material(material, mesh->spacing, 0);
  errors = in.errors();
  for (const auto& name : bodies) {
    config.bodies.emplace_back().name = name;
    note_presence(config.stage, config.bodies.back());
    read_body(in, mesh, config, {bodies, rigids}, sound_materials, config.bodies.back());
  }
  for (const auto& name : rigids) {
    config.rigids.emplace_back().name = name;
    note_presence(config.stage, config.rigids.back());
    read_part_names(in, names, config.rigids.back());
    read_rigid(in, mesh, config, config.rigids.back());
  }
  read_rigid_contact(in, config);
  read_contact_pairs(in, config);
  for (const auto& name : joints) {
    config.joints.emplace_back().name = name;
    read_joint(in, mesh, config, config.joints.back());
  }
  for (const auto& name : loads) {
    config.loads.emplace_back().name = name;
    read_load(in, config, config.loads.back());
  }
  for (const auto& name : regions) {
    config.water.regions.emplace_back().name = name;
    read_water_region(in, config, config.water.regions.back());
  }
  if (mesh && in.errors() == errors) check_water_regions(in, config);
  for (const auto& name : probes) {
    config.probes.emplace_back().name = name;
    read_probe(in, mesh, config, config.probes.back());
  }
  check_probes(in, config);
  if (sound_materials && in.errors() == errors) check_level_ground(in, *mesh, config);
  if (sound_materials && before && in.errors() == errors) follow_stage(*before, config);
  if (sound_materials) prepare_for_pressure(mesh->spacing, config);
  if (mesh && in.errors() == errors)
    for (const auto& body : config.bodies) check_cut_out(in, *mesh, config, body);
}

}  // namespace mpm
