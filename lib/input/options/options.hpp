#pragma once
// From the command line and the options files to a validated Config. Every mistake is collected, so that a
// user sees all of them at once; nothing here prints but print_help and print_errors, and nothing here ends
// the program.
//
// The order in a program:
//   flush_subnormals, MPI_Init, Kokkos::initialize
//   prepare_arguments(...)     before PetscInitialize, which ends the program over a file that it cannot read
//   PetscInitialize(&argc, &argv, nullptr, nullptr)
//   read_options(...)
//   report.help: print_help, exit status 0;  report.errors not empty: print_errors, exit status 2

#include "input/deck/report.hpp"

namespace mpm {

/// Puts report.words into PETSc's database, reads every option with this prefix (null for none) from it,
/// the same on all processes, and checks them, also against each other. `backends` are those compiled in, the
/// slowest first; the last is the default. Appends to report.errors; config is valid only where that is empty
/// at the end. Where report.help holds, fills report.help_text instead; where report.file_unread holds, reads
/// nothing, since all that is in the file would seem to be missing. Where the run has stages, config and
/// report.options are those of the first one, and report.stages has all. With a null prefix every option that
/// is neither ours nor PETSc's is an error, so simulations that have a prefix must be read before the one
/// that has none.
PetscErrorCode read_options(const char* prefix, const std::vector<Backend>& backends, Config& config,
                            InputReport& report);

}  // namespace mpm
