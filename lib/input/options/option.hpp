#pragma once
// Description of an option of the input: what the reader reads it by, and what help and schema print.

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "input/options/change_rules.hpp"

namespace mpm {

/// Accepted values; an open end is itself not accepted.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool open_lowest = false, open_highest = false;

  bool holds(double value) const;
  std::string text() const;  // " greater than 0"; empty where everything is accepted
};
inline constexpr Range k_positive{.lowest = 0, .open_lowest = true};
inline constexpr Range k_not_negative{.lowest = 0};
// Ranges that leave room for arithmetic: products of such numbers are finite.
inline constexpr Range k_coordinate{.lowest = -1e9, .highest = 1e9};                  // m
inline constexpr Range k_speed{.lowest = -1e6, .highest = 1e6};                       // m/s, m/s2
inline constexpr Range k_stress{.lowest = -1e15, .highest = 1e15};                    // Pa, N
inline constexpr Range k_density{.lowest = 0, .highest = 1e10, .open_lowest = true};  // kg/m3

/// The words of an option, each with what it stands for.
template <class Enum>
using Words = std::vector<std::pair<std::string, Enum>>;

/// Description of an option without its value. The default is what the variable holds before it is read.
struct Option {
  std::string name;     // without its dash
  std::string meaning;  // for -help
  std::string unit{};   // SI, "-" for a pure number, empty for words
  Range range{};
  bool required = false;
  std::string standard{};            // the default in words, where it is not a fixed value
  std::string aside{};               // the end of "takes ...", beside what the type and the range say
  ChangeRule change{};               // none: it stays for the whole run
  std::vector<std::string> words{};  // that it takes beside numbers
  std::string names_of{};            // the option that lists the names which are its values
};

/// A condition under which an option has a place: another option, by its name without dash, whose value, or
/// the last of its list, is one of the words; without words, that is given, or is not given.
struct Condition {
  std::string option;
  std::vector<std::string> words;
  bool given = true;
};

/// Form of the values of an option, beside its range.
struct ValueForm {
  const char* type;  // number, integer, numbers, text, flag, word, list
  std::vector<std::string> words{};
  std::string form{}, form_3d{};  // of numbers, in 2D and 3D
};

/// Option as the reader lists it.
struct ListedOption {
  std::string group;                // title of its section
  std::vector<std::string> owners;  // options that list the names for which NAME in its name stands
  Option option;
  ValueForm form;
  std::string takes, standard;  // in words
  std::vector<Condition> where;
};

}  // namespace mpm
