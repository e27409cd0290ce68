#pragma once
// Every option as data, for programs: `mpm -schema`; and the help of one option: `mpm -help NAME`.

#include <optional>
#include <string>

#include "input/options/reader.hpp"

namespace mpm {

/// JSON of all options that a reader has listed: "version" of the program, "format" of this text, "petsc",
/// the options that a run passes on to PETSc, "former" names of options by pairs, and "options", a list of
/// objects:
///   name          without dash; NAME or STAGE in it stands for a name that one of "owners" lists
///   group, meaning, takes   as in the help
///   type          number, integer, numbers, text, flag, word, list
///   unit          SI, "-" for a pure number, empty for words
///   required      whether it must be given where its conditions hold
///   default       as a deck would hold it, or in words; null where there is none
///   range         lowest and highest, null where open; open_lowest, open_highest: whether the end is not
///   taken choices       words that it takes; of a number, beside numbers names_of      the option that lists
///   the names which are its values form          of numbers: as x,y; form_3d: that in 3D, where it differs
///   where         conditions that must all hold: option, is (words, of which its value or the last of its
///                 list is one; empty: any), given
///   changes       where it may have another value: restart, restart_change, stage
///   restrictions  in words
std::string schema_of(const OptionReader& listed, const std::string& version);

/// The help of an option by its name, with or without dash, of the table (NAME_young) or of a deck
/// (clay_young); none where there is no such option.
std::optional<std::string> help_of_name(const OptionReader& listed, const std::string& name);

/// The option that is most like a name which is none.
std::string nearest_option(const OptionReader& listed, const std::string& name);

}  // namespace mpm
