// The reader as it lists options, for help and schema, in lieu of reading them.

#include <algorithm>

#include "common/text.hpp"
#include "input/options/reader.hpp"

namespace mpm {
namespace {

/// An option's name in the help without that of its owner.
std::string key_of(const std::string& name) {
  for (const std::string owner : {"NAME_", "STAGE_"})
    if (name.starts_with(owner)) return name.substr(owner.size());
  return name;
}

/// A condition in words.
std::string text_of_condition(const Condition& condition) {
  const std::string dashed = "-" + condition.option;
  if (!condition.words.empty()) return dashed + " is " + one_of(condition.words);
  return dashed + (condition.given ? " is given" : " is not given");
}

}  // namespace

void OptionReader::list(InputReport& report) {
  report_ = &report;
  listing_ = true;
}

OptionReader::Scope OptionReader::where(const std::string& option, const std::vector<std::string>& words) {
  if (!listing_) return Scope(nullptr);
  conditions_.push_back({option, words});
  return Scope(&conditions_);
}

OptionReader::Scope OptionReader::unless(const std::string& option) {
  if (!listing_) return Scope(nullptr);
  conditions_.push_back({option, {}, false});
  return Scope(&conditions_);
}

void OptionReader::restricts(const std::string& name, const std::string& takes) {
  const std::pair restriction(name, takes);
  const auto known = std::find(restrictions_.begin(), restrictions_.end(), restriction);
  if (listing_ && known == restrictions_.end()) restrictions_.push_back(restriction);
}

void OptionReader::section(const std::string& title, const std::vector<std::string>& owners) {
  group_ = title, owners_ = owners;
  owner_ = title.starts_with("Material") || title.starts_with("Each material") ? Owner::material
           : title.starts_with("Each rigid")                                   ? Owner::rigid
           : title.starts_with("Each body")                                    ? Owner::body
           : title.starts_with("Each joint")                                   ? Owner::joint
           : title.starts_with("Each contact pair")                            ? Owner::contact_pair
           : title.starts_with("Each load")                                    ? Owner::load
           : title.starts_with("Each water region")                            ? Owner::water_region
                                                                               : Owner::run;
  if (listing_) report_->help_text += "\n" + title + "\n";
}

void OptionReader::list_option(const Option& option, const std::string& takes, const std::string& standard,
                               const ValueForm& form) {
  const std::string otherwise = !option.standard.empty() ? option.standard
                                : standard.empty()       ? "none"
                                                         : standard;
  const bool owned = key_of(option.name) != option.name;
  listed_.push_back({group_, owned ? owners_ : std::vector<std::string>(), option, form, takes,
                     option.required ? "" : otherwise, conditions_});
  rules_[{owner_, lower_case(key_of(option.name))}] = option.change;
  report_->help_text += help_of(listed_.back());
}

std::string help_of(const ListedOption& listed) {
  const Option& option = listed.option;
  std::string text = "  -" + option.name + "\n      " + option.meaning + "\n      takes " + listed.takes +
                     "; " + (option.required ? "required" : "default " + listed.standard) + "\n";
  std::vector<std::string> conditions;
  for (const Condition& condition : listed.where) conditions.push_back(text_of_condition(condition));
  if (!conditions.empty()) text += "      only where " + join(conditions, " and ") + "\n";
  const std::string changes = option.change.text();
  if (!changes.empty()) text += "      may change " + changes + "\n";
  return text;
}

}  // namespace mpm
