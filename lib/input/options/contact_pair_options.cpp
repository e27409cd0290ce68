// -contact_pairs: deformable bodies that slide on each other and part.

#include <algorithm>

#include "base/most_fields.hpp"
#include "common/text.hpp"
#include "common/velocity_fields.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr const char* k_form = "pairs of names of -bodies, as soil:pile,pile:cap";

int body_of(const Config& config, const std::string& name) {
  const auto named = [&](const BodyConfig& body) { return body.name == name; };
  const auto found = std::find_if(config.bodies.begin(), config.bodies.end(), named);
  return found == config.bodies.end() ? -1 : static_cast<int>(found - config.bodies.begin());
}

/// Fault of the name of a pair, with which its options and columns begin; empty where nothing else has it.
std::string name_clash(const Config& config, const std::string& name) {
  const auto has = [&](const auto& things) {
    return std::any_of(things.begin(), things.end(),
                       [&](const auto& thing) { return lower_case(thing.name) == lower_case(name); });
  };
  if (!has(config.materials) && !has(config.bodies) && !has(config.rigids) && !has(config.contact_pairs))
    return "";
  return "pairs whose options begin as those of nothing else; " + name + " is taken";
}

/// Fault of a pair, as the end of "takes ..."; empty where it is sound.
std::string pair_fault(const Config& config, const std::vector<std::string>& words,
                       const ContactPairConfig& pair) {
  if (words.size() != 2) return k_form;
  for (int side = 0; side < 2; ++side)
    if (pair.bodies[side] < 0) {
      std::vector<std::string> names;
      for (const BodyConfig& body : config.bodies) names.push_back(body.name);
      return "pairs of names of -bodies: " + join(names, ", ") + "; " + words[side] + " is none of them";
    }
  if (pair.bodies[0] == pair.bodies[1]) return "pairs of two different bodies";
  for (const ContactPairConfig& other : config.contact_pairs)
    if (std::minmax(pair.bodies[0], pair.bodies[1]) == std::minmax(other.bodies[0], other.bodies[1]))
      return "each pair once; " + other.name + " is there already";
  return name_clash(config, pair.name);
}

/// The shear of the interface.
void read_shear(OptionReader& in, const Config& config, ContactPairConfig& pair) {
  const std::string fraction = pair.name + "_shear_fraction";
  const auto only = in.where(pair.name + "_contact", {"slide"});
  in.number({.name = pair.name + "_friction",
             .meaning = "slide: Coulomb coefficient of the interface; 0, the default, is smooth",
             .unit = "-",
             .range = {.lowest = 0, .highest = 10},
             .change = k_by_choice},
            pair.friction);
  in.number({.name = pair.name + "_adhesion",
             .meaning = "slide: shear stress of the interface where no normal stress acts, beside friction",
             .unit = "Pa",
             .range = {.lowest = 0, .highest = 1e15},
             .change = k_by_choice},
            pair.adhesion);
  in.number(
      {.name = pair.name + "_shear_limit",
       .meaning = "slide: largest shear stress of the interface; it bounds friction and adhesion, and alone "
                  "it is the shear stress of what slides in touch",
       .unit = "Pa",
       .range = {.lowest = 0, .highest = 1e15},
       .change = k_by_choice},
      pair.shear_limit);
  const bool found =
      in.number({.name = fraction,
                 .meaning = "slide: shear limit as a fraction of the strength of the weaker soil "
                            "there (su); elastic bodies have none",
                 .unit = "-",
                 .range = {.lowest = 0, .highest = 1},
                 .change = k_by_choice},
                pair.shear_fraction);
  for (int side = 0; side < 2; ++side)
    pair.strong[side] = has_strength(config, config.bodies[pair.bodies[side]]);
  if (found && !pair.strong[0] && !pair.strong[1])
    in.reject(fraction, "nothing here: one of the bodies needs a material with a strength");
}

void read_pair(OptionReader& in, const Config& config, ContactPairConfig& pair) {
  in.section("Each contact pair NAME, the names of its bodies with an underscore", {"contact_pairs"});
  in.word({.name = pair.name + "_contact",
           .meaning = "slide: the bodies part, and shear as the options below say; weld: they move as one"},
          Words<bool>{{"slide", false}, {"weld", true}}, pair.welded);
  if (!pair.welded || in.listing()) return read_shear(in, config, pair);
  for (const char* key : {"_friction", "_adhesion", "_shear_limit", "_shear_fraction"})
    in.not_taken(pair.name + key, pair.name + "_contact is weld");
}

}  // namespace

void read_contact_pairs(OptionReader& in, Config& config) {
  const Option option{
      .name = "contact_pairs",
      .meaning =
          "pairs of deformable bodies that touch, as soil:pile,pile:cap; bodies stick together "
          "where no pair has the two"};
  std::vector<std::string> given;
  if (in.listing()) {
    in.section("Contact of deformable bodies");
    in.list_of(option, k_form, given);
    ContactPairConfig pair;
    pair.name = "NAME";
    return read_pair(in, config, pair);
  }
  if (!in.none(option)) in.list_of(option, k_form, given);
  for (const std::string& text : given) {
    const std::vector<std::string> words = split(text, ':');
    ContactPairConfig pair;
    pair.name = join(words, "_");
    for (std::size_t side = 0; side < 2 && side < words.size(); ++side)
      pair.bodies[side] = body_of(config, words[side]);
    const std::string fault = pair_fault(config, words, pair);
    if (!fault.empty()) {
      for (const std::string& each : given) in.ignore(join(split(each, ':'), "_") + "_");
      return in.reject(option.name, fault);
    }
    read_pair(in, config, pair);
    config.contact_pairs.push_back(pair);
  }
  if (velocity_fields(config).count > k_most_fields)
    in.reject(option.name, "pairs of at most " + std::to_string(k_most_fields) + " bodies, or of " +
                               std::to_string(k_most_fields - 1) + " where there are others");
  for (const RigidConfig& rigid : config.rigids)
    if (!config.contact_pairs.empty() && rigid.contact_normal == ContactNormal::gradient)
      in.reject(rigid.name + "_contact_normal", "surface where there are -contact_pairs");
}

}  // namespace mpm
