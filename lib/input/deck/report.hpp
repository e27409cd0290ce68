#pragma once
// Findings of the reading of the input: options and mistakes.

#include <petscsys.h>

#include <memory>
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// One option as it is in force.
struct EffectiveOption {
  std::string name;   // with its dash: -mesh_spacing
  std::string value;  // as given, or the default; "none" where there is none
  std::string unit;   // SI, "-" for a pure number, empty for words
  bool standard;      // the default holds
};

/// The input of a stage of a run.
struct StageInput {
  Config config;
  std::vector<EffectiveOption> options;  // in force in the stage
};

/// Findings of the reading of the input.
struct InputReport {
  std::vector<std::string> errors;    // each a whole line without its end: mpm: -NAME: given "...", takes ...
  std::vector<std::string> warnings;  // each a whole line without its end: warning: ..., mpm: note: ...
  std::vector<EffectiveOption> options;        // in the order of reading; for the log
  std::vector<EffectiveOption> stage_options;  // that stages give, as they are given: -push_gravity
  std::vector<StageInput> stages;              // of a run that has stages, in order
  std::string help_text;           // every option, its unit, default and meaning (only where help was asked)
  std::string options_file;        // the last -options_file, empty where there was none or it was a pipe
  std::vector<std::string> files;  // every -options_file that was read, with those in files, in turn
  bool help = false;               // -help was given
  bool file_unread = false;        // an options file was left out for its mistakes
  std::vector<std::string>
      replaced;  // in pairs: an option without its dash, a value that a later one replaced
  std::vector<std::string> renamed;  // in pairs: an option without its dash, the former name that was given
  std::vector<std::string> words;    // names with their dash and values, of all but PETSc's own options
  std::vector<std::string> petsc_words;  // PETSc's command line: its own options that a run passes on
  std::string log_view;                  // the value of -log_view, which may name files
  std::vector<char*> arguments;          // that as argv; not of use in a copy
  std::shared_ptr<bool> inserted =
      std::make_shared<bool>(false);  // words are in PETSc's database; of all copies
};

/// Reads the command line, the options files (a pipe too), PETSc's own files and PETSC_OPTIONS on the first
/// process of comm, and leaves of the arguments only PETSc's own options, those that a run passes on; they
/// live as long as the report. All others wait in report.words for read_options, so that PETSc does not act
/// on an option before it is known. The command line takes precedence over the files. Reports files that
/// cannot be read, lines of them that are not "-NAME VALUE", and words that belong to no option (PETSc would
/// pass over both). Call it on every process of comm after MPI_Init and before PetscInitialize.
void prepare_arguments(MPI_Comm comm, int* argc, char*** argv, InputReport& report);

/// Checks the files of -log_view, which PETSc opens at the end of the run, for this output folder.
void check_log_view(const std::string& folder, InputReport& report);

/// Takes report.words out of PETSc's database again, and -log_view: a refused run leaves PETSc nothing to do.
PetscErrorCode forget_options(const InputReport& report);

/// Gives PETSc the files of -log_view, in the output folder, where the value has some. Call it once the
/// folder is there.
PetscErrorCode place_log_view(const InputReport& report, const std::string& folder);

/// Prints report.help_text on stdout of the first process.
PetscErrorCode print_help(MPI_Comm comm, const InputReport& report);

/// Prints report.errors on stderr of the first process, one line each.
PetscErrorCode print_errors(MPI_Comm comm, const InputReport& report);

}  // namespace mpm
