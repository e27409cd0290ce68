// -materials, -bodies, -rigids, and what each named thing owns.

#include <algorithm>
#include <cctype>
#include <set>

#include "input/groups.hpp"
#include "input/petsc_names.hpp"
#include "input/shapes.hpp"
#include "input/text.hpp"

namespace mpm {
namespace {

bool is_name(const std::string& word) {
  const auto plain = [](unsigned char c) { return c < 128 && (std::isalnum(c) || c == '_'); };
  return !word.empty() && static_cast<unsigned char>(word[0]) < 128 &&
         std::isalpha(static_cast<unsigned char>(word[0])) && std::all_of(word.begin(), word.end(), plain);
}

/// The names in use so far (lower case, since options know no case), and the words that no name may be.
struct Names {
  std::set<std::string> used, reserved;

  explicit Names(const OptionReader& in) {
    for (const auto& option : in.known()) reserved.insert(split(option, '_')[0]);
    reserved.erase("wall");  // of -wall_time_limit, which no rigid of that good name has
    for (const auto& option : petsc_names()) reserved.insert(split(option, '_')[0]);
  }
  /// What is wrong with a name; empty where nothing is.
  std::string fault(const std::string& name) const {
    const std::string key = lower_case(name);
    if (!is_name(name)) return "names of letters, digits and _ that begin with a letter, as sand,clay";
    if (reserved.count(key) || is_petsc_name(key + "_"))
      return "names other than " + name + ", which begins other options";
    if (used.count(key)) return "names that no other material, body or rigid has; " + name + " is taken";
    return "";
  }
};

/// The good names of a list. A bad one is reported, and its own options are left unread.
std::vector<std::string> read_names(OptionReader& in, const Option& option, Names& names) {
  std::vector<std::string> given, good;
  in.list_of(option, "names, as sand,clay", given);
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

/// What the particles start with, but for what their file gives.
void read_start(OptionReader& in, int dim, const ParticleTable& listed, BodyConfig& body) {
  const std::string velocity = body.name + "_velocity", stress = body.name + "_stress";
  const std::string why = body.name + "_file gives it for every particle";
  if (listed.velocity.empty())
    in.vector({.name = velocity, .meaning = "initial velocity", .unit = "m/s"}, dim, body.velocity);
  else
    in.not_taken(velocity, why);
  if (listed.stress.empty())
    in.tensor({.name = stress, .meaning = "initial stress, tension positive", .unit = "Pa"}, dim,
              body.stress);
  else
    in.not_taken(stress, why);
}

/// The rigids out of whose shapes the body is cut.
void read_cut_out(OptionReader& in, const std::vector<std::string>& rigids, BodyConfig& body) {
  const Option option{
      .name = body.name + "_cut_out",
      .meaning = "rigids in whose shapes, as they are at the start, the body has no particles"};
  const std::string takes = in.listing()     ? "names of -rigids, as pipe,plate"
                            : rigids.empty() ? "names of -rigids, which lists none"
                                             : "names of -rigids: " + join(rigids, ", ");
  if (!in.listing() && body.shape.kind == ShapeKind::particles)
    return in.not_taken(option.name, "the particles are those of " + body.name + "_file");
  std::vector<std::string> names;
  if (!in.list_of(option, takes, names)) return;
  for (const auto& name : names) {
    const auto found = std::find(rigids.begin(), rigids.end(), name);
    if (found == rigids.end()) return in.reject(option.name, takes);
    body.cut_out.push_back(static_cast<int>(found - rigids.begin()));
  }
}

/// Checks that the shapes cut out of a body leave a particle.
void check_cut_out(OptionReader& in, const MeshConfig& mesh, const Config& config, const BodyConfig& body) {
  if (body.cut_out.empty() || holds_particle(body.shape, mesh, config.dim, cut_out_of(config, body))) return;
  in.reject(body.name + "_cut_out", "rigids that leave a particle of " + body.name);
}

void read_body(OptionReader& in, const MeshConfig* mesh, const Config& config,
               const std::vector<std::string>& rigids, BodyConfig& body) {
  in.section("Each body or rigid NAME: its shape and particles");
  const bool sound = read_shape(in, body.name, config.dim, /*listed*/ true, body.shape);
  const bool from_file = body.shape.kind == ShapeKind::particles;
  ParticleTable listed;
  if (sound && mesh && from_file) check_particles(in, body.name, body.shape, *mesh, config.dim, listed);
  if (sound && mesh && !from_file) check_shape(in, body.name, body.shape, *mesh, config.dim);

  in.section("Each body NAME");
  std::vector<std::string> materials;
  for (const auto& material : config.materials) materials.push_back(material.name);
  in.word({.name = body.name + "_material",
           .meaning = "its material",
           .required = true,
           .aside = materials.empty() ? "a name of -materials, which lists none" : ", of -materials"},
          materials, body.material);
  read_start(in, config.dim, listed, body);
  read_cut_out(in, rigids, body);
}

/// What moves a rigid: each motion takes its own options.
void read_motion(OptionReader& in, int dim, RigidConfig& rigid) {
  static const std::vector<std::pair<std::string, Motion>> motions = {
      {"fixed", Motion::fixed}, {"prescribed", Motion::prescribed}, {"dynamic", Motion::dynamic}};
  const auto errors = in.errors();
  in.word({.name = rigid.name + "_motion",
           .meaning = "none, by its velocity, or by its density, force and gravity"},
          motions, rigid.motion);
  if (in.errors() != errors) {
    for (const char* key : {"velocity", "density", "force"}) in.ignore(rigid.name + "_" + key);
    return;
  }
  const bool prescribed = rigid.motion == Motion::prescribed, dynamic = rigid.motion == Motion::dynamic;
  const std::string why = rigid.name + "_motion is " + motions[static_cast<int>(rigid.motion)].first;
  if (prescribed || dynamic || in.listing())
    in.vector({.name = rigid.name + "_velocity",
               .meaning = "prescribed: its velocity (required); dynamic: its initial velocity",
               .unit = "m/s",
               .required = prescribed},
              dim, rigid.velocity);
  else
    in.not_taken(rigid.name + "_velocity", why);
  if (dynamic || in.listing()) {
    in.number({.name = rigid.name + "_density",
               .meaning = "dynamic: its density",
               .unit = "kg/m3",
               .range = k_positive,
               .required = true},
              rigid.density);
    in.vector({.name = rigid.name + "_force",
               .meaning = "dynamic: external force on it, beside gravity",
               .unit = "N"},
              dim, rigid.force);
  } else {
    in.not_taken(rigid.name + "_density", why);
    in.not_taken(rigid.name + "_force", why);
  }
}

/// The gap counts by default where it is known and may open.
void read_penalty(OptionReader& in, RigidConfig& rigid) {
  const std::string name = rigid.name + "_contact_penalty";
  rigid.penalty = rigid.separates && rigid.contact_normal == ContactNormal::surface;
  if (rigid.separates || in.listing())
    in.word(
        {.name = name,
         .meaning = "geo: the normal correction decreases with the gap g as 1 - (g/reach)^exponent; none is "
                    "the default with normals of the mass gradient"},
        std::vector<std::pair<std::string, bool>>{{"none", false}, {"geo", true}}, rigid.penalty);
  else
    in.not_taken(name, rigid.name + "_separation is none");
  const Option reach{.name = rigid.name + "_penalty_reach",
                     .meaning = "geo: the gap at which contact ends, in cells",
                     .unit = "-",
                     .range = {.lowest = 0, .highest = 2, .open_lowest = true}},
      exponent{.name = rigid.name + "_penalty_exponent",
               .meaning = "geo: exponent of the decrease",
               .unit = "-",
               .range = {.lowest = 0.1, .highest = 100}};
  if (rigid.penalty || in.listing()) {
    in.number(reach, rigid.penalty_reach);
    in.number(exponent, rigid.penalty_exponent);
  } else {
    in.not_taken(reach.name, rigid.name + "_contact_penalty is none");
    in.not_taken(exponent.name, rigid.name + "_contact_penalty is none");
  }
}

void read_rigid(OptionReader& in, const MeshConfig* mesh, int dim, RigidConfig& rigid) {
  rigid.shape.particles_per_cell = 4;
  if (!in.listing()) {  // listed with the bodies'
    const bool sound = read_shape(in, rigid.name, dim, /*listed*/ false, rigid.shape);
    if (sound && mesh) check_shape(in, rigid.name, rigid.shape, *mesh, dim);
  }
  in.section("Each rigid NAME");
  read_motion(in, dim, rigid);
  rigid.has_shear_limit = in.number({.name = rigid.name + "_shear_limit",
                                     .meaning = "largest shear stress of the interface; 0 is smooth",
                                     .unit = "Pa",
                                     .range = k_not_negative},
                                    rigid.shear_limit);
  in.number(
      {.name = rigid.name + "_friction",
       .meaning = "Coulomb coefficient of the interface; the shear limit, where given, bounds the shear too",
       .unit = "-",
       .range = {.lowest = 0, .highest = 10}},
      rigid.friction);
  in.word({.name = rigid.name + "_contact_normal",
           .meaning = "contact normals: of the body's own surface, or of its nodal mass gradient (Eq. 3)"},
          std::vector<std::pair<std::string, ContactNormal>>{{"surface", ContactNormal::surface},
                                                             {"gradient", ContactNormal::gradient}},
          rigid.contact_normal);
  in.word({.name = rigid.name + "_separation",
           .meaning = "whether the soil may part from it; none: contact pulls as well (suction)"},
          std::vector<std::pair<std::string, bool>>{{"free", true}, {"none", false}}, rigid.separates);
  read_penalty(in, rigid);
}

}  // namespace

void read_named(OptionReader& in, const MeshConfig* mesh, Config& config) {
  Names names(in);
  in.section("Names");
  const auto materials = read_names(in, {.name = "materials", .meaning = "names of the materials"}, names);
  const auto bodies = read_names(
      in, {.name = "bodies", .meaning = "names of the deformable bodies", .required = true}, names);
  const auto rigids = read_names(in, {.name = "rigids", .meaning = "names of the rigid bodies"}, names);
  for (const auto& name : materials) read_material(in, name, config.materials.emplace_back());
  const auto errors = in.errors();
  for (const auto& name : bodies) {
    config.bodies.emplace_back().name = name;
    read_body(in, mesh, config, rigids, config.bodies.back());
  }
  for (const auto& name : rigids) {
    config.rigids.emplace_back().name = name;
    read_rigid(in, mesh, config.dim, config.rigids.back());
  }
  if (mesh && in.errors() == errors)
    for (const auto& body : config.bodies) check_cut_out(in, *mesh, config, body);
}

}  // namespace mpm
