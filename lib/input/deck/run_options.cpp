#include "input/deck/run_options.hpp"

#include <algorithm>

#include "output/files.hpp"
#include "output/json.hpp"

namespace mpm {
namespace {

/// Text filled up with blanks to `width`.
std::string padded(std::string text, size_t width) {
  if (text.size() < width) text.resize(width, ' ');
  return text;
}

}  // namespace

std::string format_options(const std::vector<EffectiveOption>& options) {
  constexpr size_t k_widest = 24;  // a longer value, such as a polygon's, pushes its own line only
  size_t name_width = 0, value_width = 0;
  for (const EffectiveOption& option : options) {
    name_width = std::max(name_width, option.name.size());
    value_width = std::max(value_width, std::min(option.value.size(), k_widest));
  }
  std::string text;
  for (const EffectiveOption& option : options)
    text += "  " + padded(option.name, name_width) + "  " + padded(option.value, value_width) + " " +
            padded(option.unit, 6) + " " + (option.standard ? "default" : "given") + "\n";
  return text;
}

PetscErrorCode write_options_json(const std::string& folder, const std::string& version,
                                  const std::vector<EffectiveOption>& options) {
  PetscFunctionBeginUser;
  std::string text = "{\n  \"version\": " + json_text(version) + ",\n  \"options\": {";
  const char* separator = "\n";
  for (const EffectiveOption& option : options) {
    const std::string name = option.name.starts_with('-') ? option.name.substr(1) : option.name;
    text += separator + ("    " + json_text(name) + ": " + json_text(option.value));
    separator = ",\n";
  }
  PetscCall(replace_file(folder + "/options.json", text + "\n  }\n}\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
