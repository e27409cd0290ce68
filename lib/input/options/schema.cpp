#include "input/options/schema.hpp"

#include <cmath>

#include "common/text.hpp"
#include "input/deck/petsc_names.hpp"
#include "input/deck/renamed.hpp"
#include "input/deck/suggest.hpp"
#include "output/json.hpp"

namespace mpm {
namespace {

constexpr int k_format = 1;  // of the text; a change that readers must know of raises it

std::string json_bool(bool value) { return value ? "true" : "false"; }

std::string json_list(const std::vector<std::string>& texts) {
  std::vector<std::string> pieces;
  for (const std::string& text : texts) pieces.push_back(json_text(text));
  return "[" + join(pieces, ", ") + "]";
}

/// An object of members whose values are JSON; those with an empty value are left out.
std::string json_object(const std::vector<std::pair<std::string, std::string>>& members) {
  std::vector<std::string> pieces;
  for (const auto& [name, value] : members)
    if (!value.empty()) pieces.push_back(json_text(name) + ": " + value);
  return "{" + join(pieces, ", ") + "}";
}

std::string json_range(const Range& range) {
  if (!std::isfinite(range.lowest) && !std::isfinite(range.highest)) return "";
  return json_object({{"lowest", json_number(range.lowest)},
                      {"highest", json_number(range.highest)},
                      {"open_lowest", json_bool(range.open_lowest)},
                      {"open_highest", json_bool(range.open_highest)}});
}

std::string json_conditions(const std::vector<Condition>& conditions) {
  std::vector<std::string> pieces;
  for (const Condition& condition : conditions)
    pieces.push_back(json_object({{"option", json_text(condition.option)},
                                  {"is", json_list(condition.words)},
                                  {"given", json_bool(condition.given)}}));
  return pieces.empty() ? "" : "[" + join(pieces, ", ") + "]";
}

std::vector<std::string> words_of(const ChangeRule& change) {
  std::vector<std::string> words;
  if (change.restart) words.emplace_back("restart");
  if (change.listed) words.emplace_back("restart_change");
  if (change.stage) words.emplace_back("stage");
  return words;
}

std::string json_option(const ListedOption& listed, const std::vector<std::string>& restrictions) {
  const Option& option = listed.option;
  const auto& words = listed.form.words;
  const auto text = [](const std::string& value) { return value.empty() ? "" : json_text(value); };
  const auto list = [](const std::vector<std::string>& values) {
    return values.empty() ? "" : json_list(values);
  };
  const bool none = option.required || (listed.standard == "none" && words.empty());
  return json_object({{"name", json_text(option.name)},
                      {"group", json_text(listed.group)},
                      {"owners", list(listed.owners)},
                      {"type", json_text(listed.form.type)},
                      {"unit", text(option.unit)},
                      {"required", json_bool(option.required)},
                      {"default", none ? "null" : json_text(listed.standard)},
                      {"range", json_range(option.range)},
                      {"choices", option.names_of.empty() ? list(words) : ""},
                      {"names_of", text(option.names_of)},
                      {"form", text(listed.form.form)},
                      {"form_3d", text(listed.form.form_3d)},
                      {"where", json_conditions(listed.where)},
                      {"changes", list(words_of(option.change))},
                      {"restrictions", list(restrictions)},
                      {"meaning", json_text(option.meaning)},
                      {"takes", json_text(listed.takes)}});
}

/// Name of an option of the help without that of its owner, with the underscore before it; empty where no
/// owner begins it.
std::string ending_of(const std::string& name) {
  for (const std::string owner : {"NAME", "STAGE"})
    if (name.starts_with(owner + "_")) return lower_case(name.substr(owner.size()));
  return "";
}

/// A name without dashes, and by its present name.
std::string plain_name(const std::string& name) {
  const auto from = std::min(name.find_first_not_of('-'), name.size());
  return lower_case(present_name("-" + name.substr(from)).substr(1));
}

}  // namespace

std::string schema_of(const OptionReader& listed, const std::string& version) {
  std::vector<std::string> former, options;
  for (const auto& [old_name, name] : renamed_options())
    former.push_back("    " + json_list({old_name, name}));
  for (const ListedOption& option : listed.listed()) {
    std::vector<std::string> restrictions;
    for (const auto& [name, text] : listed.restrictions())
      if (name == option.option.name) restrictions.push_back(text);
    options.push_back("    " + json_option(option, restrictions));
  }
  return "{\n  \"version\": " + json_text(version) + ",\n  \"format\": " + std::to_string(k_format) +
         ",\n  \"petsc\": " + json_list(passed_on_names()) + ",\n  \"former\": [\n" + join(former, ",\n") +
         "\n  ],\n  \"options\": [\n" + join(options, ",\n") + "\n  ]\n}\n";
}

std::optional<std::string> help_of_name(const OptionReader& listed, const std::string& name) {
  const std::string key = plain_name(name);
  std::size_t longest = 0;  // of the endings that fit: clay_young_gradient is no NAME_gradient
  const auto fit_of = [&key](const ListedOption& option) -> std::size_t {
    if (lower_case(option.option.name) == key) return key.size() + 1;
    const std::string ending = ending_of(option.option.name);
    return !ending.empty() && key.size() > ending.size() && key.ends_with(ending) ? ending.size() : 0;
  };
  for (const ListedOption& option : listed.listed()) longest = std::max(longest, fit_of(option));
  if (longest == 0) return {};
  std::string text, group;
  for (const ListedOption& option : listed.listed()) {
    if (fit_of(option) != longest) continue;
    if (option.group != group) text += (text.empty() ? "" : "\n") + option.group + "\n";
    group = option.group;
    text += help_of(option);
    for (const auto& [restricted, words] : listed.restrictions())
      if (restricted == option.option.name) text += "      takes " + words + "\n";
  }
  return text;
}

std::string nearest_option(const OptionReader& listed, const std::string& name) {
  return most_like(plain_name(name), listed.known(), {"name", "stage"});
}

}  // namespace mpm
