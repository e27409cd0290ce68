#pragma once
// The options in force, for the log and for scripts.

#include <petscsys.h>

#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// One option: `-name value [unit]`, given by the user or the default.
struct OptionLine {
  std::string name, value, unit;  // the name without its dash
  bool given = false;
};

/// Every option of `config` as it is in force, in the order of the manual; `material_parameters` are the lines of
/// the materials' own parameters (clay_su ...), which only the materials know. What else the user gave (also to
/// PETSc) follows. `given` is what PETSc's options database holds.
PetscErrorCode options_in_force(const Config& config, const std::vector<OptionLine>& material_parameters,
                                std::vector<OptionLine>* lines);

/// A table of name, value, unit and origin (given or default), a line each.
std::string format_options(const std::vector<OptionLine>& lines);

/// Writes OUTPUT/options.json: {"version": ..., "options": {name: value, ...}}; values are text, as on the command line.
PetscErrorCode write_options_json(const std::string& folder, const std::string& version,
                                  const std::vector<OptionLine>& lines);

}  // namespace mpm
