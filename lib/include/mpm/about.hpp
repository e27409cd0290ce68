#pragma once
// Version, build and help of the program. Printing them needs neither MPI nor PETSc nor Kokkos to have
// started.

#include <string>

namespace mpm {

/// Version, commit, libraries, and what the program was built for, as lines.
std::string version_text();

/// How to begin, where the manual is, and every option by group.
std::string help_text();

/// Every option as JSON: name, type, unit, default, range, conditions and meaning.
std::string schema_text();

/// The text that the command line asks for in place of a run: that of --version, --schema or --help, where
/// one of them (or -version, -schema, -help, -h) is among the words; else empty. A name after -help asks for
/// the help of this option alone. Only the first process of a job has a text to print.
struct AboutAnswer {
  bool asked = false;  // the program then ends with the status
  std::string text;
  int status = 0;  // 2 where -help names no option; the text is then that of the error
};
AboutAnswer answer_without_run(int argc, char** argv);

}  // namespace mpm
