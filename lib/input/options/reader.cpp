#include "input/options/reader.hpp"

#include <algorithm>

#include "common/text.hpp"
#include "input/deck/petsc_names.hpp"
#include "input/deck/suggest.hpp"

namespace mpm {
namespace {

/// "a length in m greater than 0".
std::string takes_number(const Option& option) {
  const std::string noun = option.unit == "m" ? "a length" : option.unit == "s" ? "a time" : "a number";
  const std::string unit = option.unit == "-" || option.unit.empty() ? "" : " in " + option.unit;
  return noun + unit + option.range.text() + option.aside;
}

std::string quoted(const std::string& text) { return "\"" + visible(text) + "\""; }

}  // namespace

bool Range::holds(double value) const {
  return (open_lowest ? value > lowest : value >= lowest) &&
         (open_highest ? value < highest : value <= highest);
}

std::string Range::text() const {
  constexpr double k_all = std::numeric_limits<double>::infinity();
  if (lowest == -k_all && highest == k_all) return "";
  if (lowest > -k_all && highest < k_all && !open_lowest && !open_highest)
    return " from " + text_of(lowest) + " to " + text_of(highest);
  std::string low, high;
  if (lowest > -k_all)
    low = open_lowest ? " greater than " + text_of(lowest) : " of " + text_of(lowest) + " or more";
  if (highest < k_all) high = (open_highest ? " less than " : " at most ") + text_of(highest);
  return low + (low.empty() || high.empty() ? "" : " and") + high;
}

PetscErrorCode OptionReader::load(const char* prefix, InputReport& report) {
  PetscFunctionBeginUser;
  report_ = &report;
  prefix_ = prefix ? prefix : "";
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr, *all = nullptr;
  PetscCall(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::set<std::string> unused;
  for (PetscInt k = 0; k < count; ++k) unused.insert(lower_case(names[k]));
  PetscCall(PetscOptionsLeftRestore(nullptr, &count, &names, &values));

  // Exact names: PetscOptionsFindPair alone would also find -pile_shape in lieu of -pile_1_shape.
  PetscCall(PetscOptionsGetAll(nullptr, &all));
  for (const auto& piece : split(all, ' ')) {
    PetscBool is_key = PETSC_FALSE, set = PETSC_FALSE;
    const char* value = nullptr;
    PetscCall(PetscOptionsValidKey(piece.c_str(), &is_key));
    const std::string name = is_key ? piece.substr(1) : "";
    if (name.empty() || lower_case(name).rfind(lower_case(prefix_), 0) != 0) continue;
    PetscCall(PetscOptionsFindPair(nullptr, nullptr, piece.c_str(), &value, &set));
    if (set)
      given_[lower_case(name.substr(prefix_.size()))] = {name, value ? value : "",
                                                         unused.count(lower_case(name)) > 0};
  }
  PetscCall(PetscFree(all));
  for (std::size_t k = 0; k + 1 < report.replaced.size(); k += 2)
    if (report.replaced[k].starts_with(lower_case(prefix_)))
      replaced_.insert({report.replaced[k].substr(prefix_.size()), report.replaced[k + 1]});
  for (std::size_t k = 0; k + 1 < report.renamed.size(); k += 2)
    former_[report.renamed[k]] = report.renamed[k + 1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

OptionReader OptionReader::for_stage(const std::string& stage, const std::vector<std::string>& stages,
                                     InputReport& report) const {
  OptionReader in = *this;
  in.report_ = &report;
  in.stage_ = stage + "_";
  for (const std::string& other : stages) {
    const std::string beginning = lower_case(other) + "_";
    for (auto given = in.given_.lower_bound(beginning);
         given != in.given_.end() && given->first.starts_with(beginning);)
      given = in.given_.erase(given);
  }
  const std::string beginning = lower_case(in.stage_);
  for (auto given = given_.lower_bound(beginning);
       given != given_.end() && given->first.starts_with(beginning); ++given) {
    in.given_.erase(given->first);
    const std::string key = given->first.substr(beginning.size());
    in.given_[key] = given->second;
    in.of_stage_.insert(key);
  }
  return in;
}

std::string OptionReader::dashed(const std::string& name) const {
  if (of_stage_.count(lower_case(name)) > 0) return "-" + prefix_ + stage_ + name;
  const auto former = former_.find(lower_case(prefix_ + name));
  return "-" + (former == former_.end() ? prefix_ + name : former->second);
}

bool OptionReader::given(const std::string& name) const { return given_.count(lower_case(name)) > 0; }

void OptionReader::ignore(const std::string& beginning) { ignored_.push_back(lower_case(beginning)); }

std::vector<std::string> OptionReader::replaced(const std::string& name) const {
  std::vector<std::string> values;
  const auto [first, last] = replaced_.equal_range(lower_case(name));
  for (auto found = first; found != last; ++found) values.push_back(found->second);
  return values;
}

void OptionReader::leave_out(const std::string& list, const std::string& name) {
  left_out_[list].push_back(name);
}

bool OptionReader::is_left_out(const std::string& name) const {
  return std::any_of(left_out_.begin(), left_out_.end(), [&name](const auto& list) {
    return std::find(list.second.begin(), list.second.end(), name) != list.second.end();
  });
}

std::vector<std::string> OptionReader::owners_of(const std::string& key) const {
  std::vector<std::string> owners;
  for (const auto& [name, option] : given_)
    if (name.ends_with("_" + key)) owners.push_back(name.substr(0, name.size() - key.size() - 1));
  return owners;
}

int OptionReader::count_of(const std::string& beginning) const {
  return static_cast<int>(std::count_if(given_.begin(), given_.end(), [&](const auto& option) {
    return option.second.unused && !read_.count(option.first) &&
           option.first.starts_with(lower_case(beginning));
  }));
}

int OptionReader::pass_over(const std::vector<std::string>& names,
                            const std::vector<std::string>& beginnings) {
  int count = 0;
  for (const std::string& name : names) {
    const std::string key = lower_case(name);
    const auto found = given_.find(key);
    if (found == given_.end() || read_.count(key)) continue;
    read_.insert(key);
    ++count;
  }
  for (const std::string& beginning : beginnings) {
    count += count_of(beginning);
    ignore(beginning);
  }
  return count;
}

/// One line for each list that another one replaced.
void OptionReader::warn_of_left_out() {
  for (const auto& [list, names] : left_out_) {
    int count = 0;
    for (const auto& name : names) count += count_of(name + "_"), ignore(name + "_");
    if (count > 0)
      warn(list, "so " + std::to_string(count) + " options of " + join(names, ", ") + " are not used");
  }
}

const std::string* OptionReader::find(const Option& option, const std::string& takes,
                                      const std::string& standard, const ValueForm& form) {
  known_.push_back(option.name);
  if (listing_) {
    list_option(option, takes, standard, form);
    return nullptr;
  }
  read_.insert(lower_case(option.name));
  const auto found = given_.find(lower_case(option.name));
  if (found != given_.end()) return &found->second.value;
  if (option.required)
    report_->errors.push_back("mpm: -" + prefix_ + option.name + ": not given, takes " + takes);
  else
    keep(option, standard.empty() ? (option.standard.empty() ? "none" : option.standard) : standard, true);
  return nullptr;
}

void OptionReader::keep(const Option& option, const std::string& value, bool standard) {
  report_->options.push_back({"-" + prefix_ + option.name, value, option.unit, standard});
}

void OptionReader::settle(const std::string& name, const std::string& value, const std::string& warning) {
  for (EffectiveOption& option : report_->options)
    if (option.name == "-" + prefix_ + name) option.value = value;
  if (!warning.empty()) report_->warnings.push_back("warning: -" + prefix_ + name + ": " + warning);
}

void OptionReader::unlist(const std::string& name) {
  std::erase_if(report_->options,
                [&](const EffectiveOption& option) { return option.name == "-" + prefix_ + name; });
}

bool OptionReader::fail(const Option& option, const std::string& takes) {
  reject(option.name, takes);
  return false;
}

std::string OptionReader::given_text(const std::string& name) const {
  const auto found = given_.find(lower_case(name));
  return found == given_.end() ? "" : found->second.value;
}

void OptionReader::reject(const std::string& name, const std::string& takes) {
  const std::string what = given(name) ? "given " + quoted(given_text(name)) : "not given";
  const std::string line = "mpm: " + dashed(name) + ": " + what + ", takes " + takes;
  auto& errors = report_->errors;  // several bodies may find the same mistake of their material
  if (std::find(errors.begin(), errors.end(), line) == errors.end()) errors.push_back(line);
}

void OptionReader::warn(const std::string& name, const std::string& what) {
  report_->warnings.push_back("warning: " + dashed(name) + ": given " + quoted(given_text(name)) + ", " +
                              what);
}

void OptionReader::note(const std::string& name, const std::string& what) {
  report_->warnings.push_back("mpm: note: " + dashed(name) + ": " + what);
}

void OptionReader::not_taken(const std::string& name, const std::string& why) {
  refuse(name, "nothing here: " + why);
}

void OptionReader::refuse(const std::string& name, const std::string& takes) {
  if (listing_) return;
  const std::string low = lower_case(name);
  read_.insert(low);
  if (!given(name)) return;
  reject(name, takes);
  if (stage_.empty() || of_stage_.count(low) > 0) return;
  // Given for all stages: another one may take it.
  set_aside_[low] = report_->errors.back();
  report_->errors.pop_back();
  given_.erase(low);
}

bool OptionReader::number(const Option& option, double& value) {
  std::optional<double> read = value;
  const bool found = number(option, read);
  value = *read;
  return found;
}

bool OptionReader::number(const Option& option, std::optional<double>& value) {
  const std::string takes = takes_number(option);
  const bool fixed = value && option.standard.empty();
  const std::string* given = find(option, takes, fixed ? text_of(*value) : "", {"number", option.words});
  if (!given) return false;
  const auto read = parse_number(*given);
  if (!read || !option.range.holds(*read)) return fail(option, takes);
  keep(option, *given, false);
  value = read;
  return true;
}

template <class Value>
bool OptionReader::whole(const Option& option, const std::string& standard, Value& value) {
  Range range = option.range;
  if (range.highest > std::numeric_limits<int>::max()) range.highest = std::numeric_limits<int>::max();
  const bool bounded = option.range.highest < std::numeric_limits<int>::max();
  const std::string takes = "a whole number" + (bounded ? range : option.range).text();
  const std::string* given = find(option, takes, standard, {"integer"});
  if (!given) return false;
  const auto read = parse_integer(*given);
  if (!read || !range.holds(static_cast<double>(*read))) return fail(option, takes);
  keep(option, *given, false);
  value = static_cast<int>(*read);
  return true;
}

bool OptionReader::integer(const Option& option, int& value) {
  return whole(option, std::to_string(value), value);
}
bool OptionReader::integer(const Option& option, std::optional<int>& value) {
  return whole(option, "", value);
}
bool OptionReader::integer(const Option& option, std::optional<long>& value) {
  return whole(option, "", value);
}

bool OptionReader::numbers(const Option& option, const std::string& form, const std::string& form_3d,
                           std::span<double> value) {
  const auto count = [](const std::string& list) { return std::to_string(split(list).size()); };
  const std::string noun = split(form).size() == 1 ? " number" : " numbers",
                    unit = option.unit.empty() || option.unit == "-" ? "" : " in " + option.unit;
  std::string in_3d;
  if (listing_ && !form_3d.empty() && form_3d != form)
    in_3d.append(" (").append(count(form_3d)).append(" in 3D, as ").append(form_3d + ")");
  const std::string bounds = option.range.text().empty() ? "" : ", each" + option.range.text();
  const std::string takes = count(form) + noun + unit + ", as " + form + in_3d + bounds + option.aside;
  const std::string* given = find(option, takes, text_of(value), {"numbers", option.words, form, form_3d});
  if (!given) return false;
  const auto pieces = split(*given);
  if (pieces.size() != value.size()) return fail(option, takes);
  std::vector<double> read;
  for (const auto& piece : pieces) {
    const auto number = parse_number(piece);
    if (!number || !option.range.holds(*number)) return fail(option, takes);
    read.push_back(*number);
  }
  keep(option, *given, false);
  std::copy(read.begin(), read.end(), value.begin());
  return true;
}

bool OptionReader::vector(const Option& option, int dim, Vec3& value) {
  return numbers(option, dim == 2 ? "x,y" : "x,y,z", "x,y,z", std::span(value).first(dim));
}

bool OptionReader::tensor(const Option& option, int dim, Sym6& value) {
  const std::string in_2d = "xx,yy,zz,xy", in_3d = in_2d + ",yz,zx";
  return numbers(option, dim == 2 ? in_2d : in_3d, in_3d, std::span(value).first(dim == 2 ? 4 : 6));
}

bool OptionReader::text(const Option& option, std::string& value) {
  const std::string takes = "a text that is not empty";
  const std::string* given = find(option, takes, option.standard.empty() || !listing_ ? value : "", {"text"});
  if (!given) return false;
  if (given->empty()) return fail(option, takes);
  if (has_control(*given)) return fail(option, "a text without line ends, tabulators and the like");
  keep(option, *given, false);
  value = *given;
  return true;
}

bool OptionReader::flag(const Option& option, bool& value) {
  const std::string takes = "on, off or no value";
  const std::string* given = find(option, takes, value ? "on" : "off", {"flag"});
  if (!given) return false;
  if (!given->empty() && *given != "on" && *given != "off") return fail(option, takes);
  value = *given != "off";
  keep(option, value ? "on" : "off", false);
  return true;
}

bool OptionReader::list_of(const Option& option, const std::string& takes, std::vector<std::string>& value) {
  const std::string* given = find(option, takes, "", {"list"});
  if (!given) return false;
  value = split(*given);
  if (std::any_of(value.begin(), value.end(), [](const std::string& piece) { return piece.empty(); }))
    return fail(option, takes);
  keep(option, *given, false);
  return true;
}

bool OptionReader::none(const Option& option) {
  if (listing_ || !given(option.name) || !given_text(option.name).empty()) return false;
  read_.insert(lower_case(option.name));
  known_.push_back(option.name);
  keep(option, "none", false);
  return true;
}

bool OptionReader::word(const Option& option, const std::vector<std::string>& words, int& index) {
  const std::string takes = one_of(words) + option.aside;
  const std::string* given = find(option, takes, option.required ? "" : words.at(index), {"word", words});
  if (!given) return false;
  const auto found = std::find(words.begin(), words.end(), *given);
  if (found == words.end()) {
    const auto meant = nearest(*given, words);
    return fail(option, takes + (meant ? "; the nearest is " + *meant : ""));
  }
  index = static_cast<int>(found - words.begin());
  keep(option, *given, false);
  return true;
}

void OptionReader::report_unknown() {
  std::vector<std::string> known = known_;
  if (prefix_.empty())
    for (std::string& name : passed_on_names()) known.push_back(std::move(name));
  std::vector<std::string> owners;
  for (const char* list : {"materials", "bodies", "rigid_bodies", "loads", "probes"})
    for (std::string& owner : split(lower_case(given_text(list)))) owners.push_back(std::move(owner));
  warn_of_left_out();
  for (const auto& [name, option] : given_) {
    const auto begins_name = [&name = name](const std::string& beginning) {
      return name.rfind(beginning, 0) == 0;
    };
    if (!option.unused || read_.count(name) || is_passed_on(name)) continue;
    if (std::any_of(ignored_.begin(), ignored_.end(), begins_name)) continue;
    const auto listed = [this](const char* list) { return split(lower_case(given_text(list))); };
    const std::string why = why_none(name, listed("bodies"), listed("rigid_bodies"));
    const bool staged = of_stage_.count(name) > 0;
    const std::string as_given = staged ? "-" + option.name : dashed(option.name.substr(prefix_.size()));
    report_->errors.push_back(
        "mpm: " + as_given + ": given " + quoted(option.value) + ", takes nothing: no such option" +
        (why.empty()
             ? ", the nearest is -" + prefix_ + (staged ? stage_ : "") + most_like(name, known, owners)
             : "; " + why));
  }
}

}  // namespace mpm
