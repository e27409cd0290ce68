#include "input/deck/renamed.hpp"

#include <array>
#include <utility>

#include "common/text.hpp"

namespace mpm {
namespace {

/// Former and present name of an option, or of what follows the name of its owner.
constexpr std::array<std::pair<const char*, const char*>, 8> k_renamed = {{
    {"p2g_margin", "rebuild_margin"},
    {"flip_share", "flip_fraction"},
    {"f_bar_share", "f_bar_fraction"},
    {"rigids", "rigid_bodies"},
    {"shear_share", "shear_fraction"},
    {"contact_penalty", "contact_gap_scaling"},
    {"penalty_reach", "contact_gap_reach"},
    {"penalty_exponent", "contact_gap_exponent"},
}};

}  // namespace

std::vector<std::pair<std::string, std::string>> renamed_options() {
  return {k_renamed.begin(), k_renamed.end()};
}

std::string present_name(const std::string& name) {
  const std::string key = lower_case(name);
  for (const auto& [former, present] : k_renamed) {
    const std::string ending = former;
    if (!key.ends_with("-" + ending) && !key.ends_with("_" + ending)) continue;
    return name.substr(0, name.size() - ending.size()) + present;
  }
  return name;
}

}  // namespace mpm
