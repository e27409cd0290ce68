#include "input/deck/suggest.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "common/text.hpp"

namespace mpm {
namespace {

bool has_one_of(const std::string& text, const std::vector<std::string>& pieces) {
  return std::any_of(pieces.begin(), pieces.end(),
                     [&text](const std::string& piece) { return text.find(piece) != std::string::npos; });
}

/// The longest NAME_ of the owners that a name begins with; empty where it begins with none.
std::string beginning_of(const std::string& name, const std::vector<std::string>& owners) {
  std::string longest;
  for (const std::string& owner : owners)
    if (const std::string beginning = owner + "_";
        name.starts_with(beginning) && beginning.size() > longest.size())
      longest = beginning;
  return longest;
}

/// Letters of the words that two names share, over those of the shorter name.
double shared_words(const std::string& a, const std::string& b) {
  const auto words = split(a, '_'), others = split(b, '_');
  const std::set<std::string> known(others.begin(), others.end());
  double shared = 0;
  for (const std::string& word : words)
    if (known.count(word)) shared += double(word.size());
  return shared / double(std::max<std::size_t>(std::min(a.size(), b.size()), 1));
}

/// How little two names have in common: 0 where they are equal, else up to 1.
double unlikeness(const std::string& a, const std::string& b) {
  const double letters = double(edit_distance(a, b)) / double(std::max<std::size_t>({a.size(), b.size(), 1}));
  return letters * (1 - std::min(shared_words(a, b), 1.0) / 2);
}

}  // namespace

std::string most_like(const std::string& name, const std::vector<std::string>& known,
                      const std::vector<std::string>& owners) {
  if (const auto near = nearest(name, known)) return *near;
  const std::string beginning = beginning_of(name, owners);
  std::string best = known.front();
  double least = std::numeric_limits<double>::infinity();
  for (const bool of_owner : {true, false}) {
    for (const std::string& candidate : known) {
      const std::string key = lower_case(candidate);
      if (of_owner != (beginning_of(key, owners) == beginning)) continue;
      const std::size_t from = of_owner ? beginning.size() : 0;
      const double now = unlikeness(name.substr(from), key.substr(from));
      if (now < least) best = candidate, least = now;
    }
    if (least < std::numeric_limits<double>::infinity()) break;
  }
  return best;
}

std::string why_none(const std::string& name, const std::vector<std::string>& bodies,
                     const std::vector<std::string>& rigids) {
  static const std::vector<std::string> flow = {"permeab",  "conductivity",  "porosity",     "drain",
                                                "consolid", "darcy",         "seepage",      "water_bulk",
                                                "phreatic", "pore_pressure", "grain_density"};
  static const std::vector<std::string> contact = {"friction",    "adhesion",       "contact",
                                                   "shear_limit", "shear_fraction", "restitution"};
  static const std::vector<std::string> rotation = {"rotat",  "angular",        "inertia", "moment",
                                                    "torque", "centre_of_mass", "hinge"};
  if (has_one_of(name, flow) || name.ends_with("_water"))
    return "docs/water.md has the options of water in soil";
  if (!beginning_of(name, bodies).empty() && has_one_of(name, contact))
    return "contact of deformable bodies is that of pairs: -contact_pairs, see docs/contact.md";
  if (!beginning_of(name, rigids).empty() && has_one_of(name, rotation))
    return "docs/bodies.md has the options of rigid bodies that turn";
  return "";
}

}  // namespace mpm
