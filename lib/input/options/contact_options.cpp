// Contact of rigid bodies with soil: where it acts, its normals, its shear, and whether it may open.

#include <algorithm>

#include "input/geometry/light_rigids.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

void read_contact_normal(OptionReader& in, RigidConfig& rigid) {
  const Option option{
      .name = rigid.name + "_contact_normal",
      .meaning = "contact normals: of the body's own surface, or of its nodal mass gradient (Eq. 3)",
      .standard = in.listing() ? "surface" : ""};
  in.word(option,
          Words<ContactNormal>{{"surface", ContactNormal::surface}, {"gradient", ContactNormal::gradient}},
          rigid.contact_normal);
}

/// Where soil and body exchange impulses.
void read_contact_points(OptionReader& in, RigidConfig& rigid) {
  const Option option{.name = rigid.name + "_contact",
                      .meaning =
                          "where it touches the soil: at nodes near it, or at sites, points of its face "
                          "half a cell apart",
                      .standard = in.listing() ? "sites where forces alone move it, else nodes" : ""};
  in.word(option, Words<bool>{{"nodes", false}, {"sites", true}}, rigid.contact_at_sites);
  if (rigid.contact_at_sites && rigid.contact_normal == ContactNormal::gradient)
    in.reject(option.name, "nodes where " + rigid.name + "_contact_normal is gradient");
}

/// The gap counts by default where it is known and may open.
void read_gap_scaling(OptionReader& in, RigidConfig& rigid) {
  const std::string name = rigid.name + "_contact_gap_scaling";
  rigid.contact_gap_scaling = rigid.scales_by_gap();
  const auto nodes = in.where(rigid.name + "_contact", {"nodes"});
  const auto parts = in.where(rigid.name + "_separation", {"free"});
  if ((rigid.separates && !rigid.contact_at_sites) || in.listing())
    in.word(
        {.name = name,
         .meaning = "geo: the normal correction decreases with the gap g as 1 - (g/reach)^exponent; none is "
                    "the default with normals of the mass gradient",
         .change = k_by_choice},
        Words<bool>{{"none", false}, {"geo", true}}, rigid.contact_gap_scaling);
  else
    in.not_taken(name, rigid.name + (rigid.contact_at_sites ? "_contact is sites" : "_separation is none"));
  const Option reach{.name = rigid.name + "_contact_gap_reach",
                     .meaning = "geo: the gap at which contact ends, in cells",
                     .unit = "-",
                     .range = {.lowest = 0, .highest = 2, .open_lowest = true},
                     .change = k_by_choice},
      exponent{.name = rigid.name + "_contact_gap_exponent",
               .meaning = "geo: exponent of the decrease",
               .unit = "-",
               .range = {.lowest = 0.1, .highest = 100},
               .change = k_by_choice};
  if (const auto only = in.where(name, {"geo"}); rigid.contact_gap_scaling || in.listing()) {
    in.number(reach, rigid.contact_gap_reach);
    in.number(exponent, rigid.contact_gap_exponent);
  } else {
    in.not_taken(reach.name, rigid.name + "_contact_gap_scaling is none");
    in.not_taken(exponent.name, rigid.name + "_contact_gap_scaling is none");
  }
}

/// The shear limit as a fraction of the strength of the soil at it, instead of one for all of the interface.
void read_shear_fraction(OptionReader& in, const Config& config, RigidConfig& rigid) {
  const std::string name = rigid.name + "_shear_fraction";
  if (rigid.has_shear_limit && !in.listing()) return in.not_taken(name, rigid.name + "_shear_limit is given");
  const auto only = in.unless(rigid.name + "_shear_limit");
  const bool found =
      in.number({.name = name,
                 .meaning = "shear limit as a fraction of the soil's strength there (su), instead "
                            "of the shear limit",
                 .unit = "-",
                 .range = {.lowest = 0, .highest = 1},
                 .change = k_by_choice},
                rigid.shear_fraction);
  const auto strong = [&](const BodyConfig& body) { return has_strength(config, body); };
  if (found && std::none_of(config.bodies.begin(), config.bodies.end(), strong))
    in.reject(name, "nothing here: no body has a material with a strength");
}

/// The options of a rigid that contact at nodes alone has, without its name.
constexpr const char* k_gap_keys[] = {"_contact_gap_scaling", "_contact_gap_reach", "_contact_gap_exponent"};

/// Rigid bodies up to which contact at sites is the default: with many more each patch has sites of many.
constexpr std::size_t k_few_for_sites = 8;

/// Whether contact at sites is the better for a rigid by default: it moves by forces, so that the drag of
/// contact at nodes would slow it down, and nothing of the run or of the body needs nodes.
bool wants_sites(const OptionReader& in, const Config& config, const RigidConfig& rigid) {
  if (config.rigids.size() > k_few_for_sites || water_flows(config)) return false;
  if (rigid.motion != Motion::dynamic || rigid.is_sprung() || is_jointed(config, rigid)) return false;
  if (rigid.contact_normal != ContactNormal::surface || config.device_memory_limit) return false;
  for (const char* key : k_gap_keys)
    if (in.given(rigid.name + key)) return false;
  RigidConfig placed = rigid;  // a later stage may place it
  placed.absent = false;
  return is_wide_for_sites(rigid.shape, config.mesh, config.dim) && !lightness_of(config, placed).is_light();
}

}  // namespace

void read_contact(OptionReader& in, const Config& config, RigidConfig& rigid) {
  rigid.has_shear_limit = in.number({.name = rigid.name + "_shear_limit",
                                     .meaning = "largest shear stress of the interface; 0 is smooth",
                                     .unit = "Pa",
                                     .range = {.lowest = 0, .highest = 1e15},
                                     .change = k_by_choice},
                                    rigid.shear_limit);
  read_shear_fraction(in, config, rigid);
  in.number(
      {.name = rigid.name + "_friction",
       .meaning = "Coulomb coefficient of the interface; the shear limit or fraction, where given, bounds "
                  "the shear too",
       .unit = "-",
       .range = {.lowest = 0, .highest = 10},
       .change = k_by_choice},
      rigid.friction);
  read_restitution(in, rigid);
  read_contact_normal(in, rigid);
  read_contact_points(in, rigid);
  in.word({.name = rigid.name + "_separation",
           .meaning = "whether the soil may part from it; none: contact pulls as well (suction)",
           .change = k_by_choice},
          Words<bool>{{"free", true}, {"none", false}}, rigid.separates);
  read_gap_scaling(in, rigid);
  read_permeable(in, rigid);
}

void choose_contact(OptionReader& in, const Config* before, Config& config) {
  if (in.listing()) return;
  for (std::size_t r = 0; r < config.rigids.size(); ++r) {
    RigidConfig& rigid = config.rigids[r];
    if (in.given(rigid.name + "_contact")) continue;
    const bool first = before == nullptr || r >= before->rigids.size();
    rigid.contact_at_sites = first ? wants_sites(in, config, rigid) : before->rigids[r].contact_at_sites;
    if (!rigid.contact_at_sites) continue;
    rigid.contact_gap_scaling = false;
    in.settle(rigid.name + "_contact", "sites", "");
    for (const char* key : k_gap_keys) {
      in.not_taken(rigid.name + key, rigid.name + "_contact is sites, as in the stage before");
      in.unlist(rigid.name + key);
    }
  }
}

}  // namespace mpm
