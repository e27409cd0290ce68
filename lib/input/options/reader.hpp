#pragma once
// The one reader of options: one call per option gives its help, default, parsing, checks and errors.

#include <petscsys.h>

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "input/deck/report.hpp"
#include "input/options/option.hpp"

namespace mpm {

/// Reads options from a copy of PETSc's database. Each reading function leaves the value as it was and
/// returns false where the option was not given, or was wrong (which it reports).
class OptionReader {
 public:
  /// Takes the options with this prefix (null for none) out of PETSc's database and marks them as used.
  PetscErrorCode load(const char* prefix, InputReport& report);
  /// A reader of the same options for one of the stages of a run: what is given as -STAGE_NAME stands for
  /// -NAME, and options of the other stages are left out. It reports to `report`.
  OptionReader for_stage(const std::string& stage, const std::vector<std::string>& stages,
                         InputReport& report) const;
  /// The names, without those of the stage, that the stage gives.
  const std::set<std::string>& of_stage() const { return of_stage_; }
  /// Reads nothing and writes the help text instead: every option is listed once.
  void list(InputReport& report);
  bool listing() const { return listing_; }
  /// The rules of all options that were listed.
  const ChangeRules& change_rules() const { return rules_; }

  bool number(const Option& option, double& value);
  bool number(const Option& option, std::optional<double>& value);
  bool integer(const Option& option, int& value);
  bool integer(const Option& option, std::optional<int>& value);
  bool integer(const Option& option, std::optional<long>& value);
  /// As many numbers as `value` holds, written as `form`; in the help `form_3d` is that in 3D.
  bool numbers(const Option& option, const std::string& form, const std::string& form_3d,
               std::span<double> value);
  /// `dim` numbers; the others stay.
  bool vector(const Option& option, int dim, Vec3& value);
  /// 4 numbers in 2D (plane strain), 6 in 3D; the others stay.
  bool tensor(const Option& option, int dim, Sym6& value);
  bool text(const Option& option, std::string& value);
  /// An option that needs no value: on where it stands alone, on or off.
  bool flag(const Option& option, bool& value);
  /// A list of any length; `takes` says of what, since only the caller can check it. Where a piece is empty,
  /// which is reported, the value still holds all pieces.
  bool list_of(const Option& option, const std::string& takes, std::vector<std::string>& value);
  /// Whether a list is given without a value: it is then empty.
  bool none(const Option& option);
  /// An index into the words.
  bool word(const Option& option, const std::vector<std::string>& words, int& index);
  template <class Enum>
  bool word(const Option& option, const Words<Enum>& words, Enum& value);

  bool given(const std::string& name) const;
  /// Whether something has asked for an option, by its lower-case name.
  bool is_read(const std::string& name) const { return read_.count(name) > 0; }
  /// The text given, in lieu of a value.
  std::string given_text(const std::string& name) const;
  /// Reports the option, if given, as one that has no place here. Where it is given for all stages, a reader
  /// of one of them sets it aside, as if it were not given.
  void not_taken(const std::string& name, const std::string& why);
  /// The same by what it takes.
  void refuse(const std::string& name, const std::string& takes);
  /// Reports by lower-case names of what this reader of a stage has set aside.
  const std::map<std::string, std::string>& set_aside() const { return set_aside_; }
  /// Reports an option that parsed but does not fit the others.
  void reject(const std::string& name, const std::string& takes);
  /// Warns of an option that is given: "warning: -NAME: given "...", WHAT".
  void warn(const std::string& name, const std::string& what);
  /// The default that an option takes which is not given, once others are read, and a warning, unless empty.
  void settle(const std::string& name, const std::string& value, const std::string& warning);
  /// Takes an option that is not given from the list of options: once others are read, it has no place.
  void unlist(const std::string& name);
  /// Notes for the log what became of an option that is given: "mpm: note: -NAME: WHAT".
  void note(const std::string& name, const std::string& what);
  /// No unknown option that begins so is reported: what it belongs to was wrong itself.
  void ignore(const std::string& beginning);
  /// The values of an option that later ones replaced.
  std::vector<std::string> replaced(const std::string& name) const;
  /// NAME is in a list of names that another list replaced: what is given for it is a warning, no mistake.
  void leave_out(const std::string& list, const std::string& name);
  bool is_left_out(const std::string& name) const;
  /// Every NAME for which -NAME_key is given, in lower case.
  std::vector<std::string> owners_of(const std::string& key) const;
  /// Options that this run does not use, by their names and by what they begin with: they are no mistakes.
  /// How many of them are given and have not been read.
  int pass_over(const std::vector<std::string>& names, const std::vector<std::string>& beginnings);
  /// How many options that begin so are given and have not been read.
  int count_of(const std::string& beginning) const;
  /// Reports every option that nobody asked for and that is not PETSc's.
  void report_unknown();
  /// A heading of the help. owners: options that list the names for which NAME stands in the options of the
  /// section.
  void section(const std::string& title, const std::vector<std::string>& owners = {});
  /// A condition of the options that are listed while the result lives.
  class [[nodiscard]] Scope {
   public:
    explicit Scope(std::vector<Condition>* conditions) : conditions_(conditions) {}
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() {
      if (conditions_ != nullptr) conditions_->pop_back();
    }

   private:
    std::vector<Condition>* conditions_;
  };
  /// The options that follow have a place where another one is given, or is one of the words.
  Scope where(const std::string& option, const std::vector<std::string>& words = {});
  /// The options that follow have a place where another one is not given.
  Scope unless(const std::string& option);
  /// No condition.
  Scope always() { return Scope(nullptr); }
  /// Lists what an option takes beside its range, because of another option; nothing in reading.
  void restricts(const std::string& name, const std::string& takes);
  /// Pairs of an option and what it takes.
  const std::vector<std::pair<std::string, std::string>>& restrictions() const { return restrictions_; }
  /// All that was listed.
  const std::vector<ListedOption>& listed() const { return listed_; }

  std::size_t errors() const { return report_->errors.size(); }
  /// The names asked for so far.
  const std::vector<std::string>& known() const { return known_; }

 private:
  struct Given {
    std::string name, value;  // as the user wrote them
    bool unused;              // nobody (PETSc itself) had read it before
  };
  /// The text given, if any. Reports a required option that is missing, and writes the help.
  const std::string* find(const Option& option, const std::string& takes, const std::string& standard,
                          const ValueForm& form);
  void list_option(const Option& option, const std::string& takes, const std::string& standard,
                   const ValueForm& form);
  bool fail(const Option& option, const std::string& takes);
  /// "-NAME", by the name that the user gave.
  std::string dashed(const std::string& name) const;
  void keep(const Option& option, const std::string& value, bool standard);
  void warn_of_left_out();
  template <class Value>
  bool whole(const Option& option, const std::string& standard, Value& value);

  std::string prefix_;
  bool listing_ = false;
  Owner owner_ = Owner::run;  // of the options of this section of the help
  std::string group_;         // title of this section
  std::vector<std::string> owners_;
  std::vector<Condition> conditions_;
  std::vector<ListedOption> listed_;
  std::vector<std::pair<std::string, std::string>> restrictions_;
  ChangeRules rules_;
  InputReport* report_ = nullptr;
  std::map<std::string, Given> given_;  // by lower-case name without prefix
  std::set<std::string> read_;
  std::vector<std::string> known_, ignored_;
  std::multimap<std::string, std::string> replaced_;  // by lower-case name without prefix
  std::map<std::string, std::string> former_;         // names as given, by lower-case name
  std::string stage_;               // of what this reader reads, with its underscore; empty: of the run
  std::set<std::string> of_stage_;  // lower-case names that it gives
  std::map<std::string, std::string> set_aside_;
  std::map<std::string, std::vector<std::string>> left_out_;  // names by their list
};

/// Lines of the help for an option.
std::string help_of(const ListedOption& listed);

template <class Enum>
bool OptionReader::word(const Option& option, const Words<Enum>& words, Enum& value) {
  std::vector<std::string> names;
  int index = 0;
  for (const auto& [name, enumerator] : words) {
    if (enumerator == value) index = static_cast<int>(names.size());
    names.push_back(name);
  }
  const bool found = word(option, names, index);
  value = words[index].second;
  return found;
}

}  // namespace mpm
