#include "mpm/about.hpp"

#include <hdf5.h>
#include <mpi.h>
#include <petscsys.h>

#include <cstdlib>

#include "common/text.hpp"
#include "git_commit.hpp"
#include "input/options/groups.hpp"
#include "input/options/options.hpp"
#include "input/options/schema.hpp"
#include "mpm/simulation.hpp"
#include "step/stepper.hpp"

namespace mpm {
namespace {

std::string backends_text() {
  std::vector<std::string> words;
  for (const Backend backend : available_backends()) words.emplace_back(word_of(backend));
  return join(words, ", ");
}

/// Whether a launcher of MPI says that this is not the first process.
bool is_later_process() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"})
    if (const char* rank = std::getenv(name)) return std::string(rank) != "0";
  return false;
}

}  // namespace

std::string version_text() {
#ifdef MPM_ONLY_DOUBLE
  const char* precisions = "double";
#else
  const char* precisions = "double, single";
#endif
#ifdef MPM_ONLY_2D
  const char* dimensions = "2";
#else
  const char* dimensions = "2, 3";
#endif
  char mpi[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int length = 0;
  MPI_Get_library_version(mpi, &length);
  const std::string mpi_name = std::string(mpi, static_cast<std::size_t>(length));
  return formatted("mpm %s\n", k_version) + "  commit      " + k_git_commit + "\n" +
         formatted("  PETSc       %d.%d.%d\n", PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR,
                   PETSC_VERSION_SUBMINOR) +
         "  Kokkos      " + kokkos_version() + "\n" + "  MPI         " +
         mpi_name.substr(0, mpi_name.find_first_of(",\n")) + "\n" +
         formatted("  HDF5        %d.%d.%d\n", H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE) +
         "  back ends   " + backends_text() + "\n" + "  precisions  " + precisions + "\n" + "  dimensions  " +
         dimensions + "\n";
}

namespace {

/// A reader that has listed every option.
OptionReader listed_options() {
  InputReport unused;
  OptionReader in;
  in.list(unused);
  list_all(in);
  return in;
}

/// The help of one option, or the nearest where there is none of that name.
AboutAnswer help_answer(const std::string& name) {
  const OptionReader listed = listed_options();
  if (const auto help = help_of_name(listed, name)) return {true, *help};
  return {true,
          "mpm: -help: given \"" + printable(name) + "\", takes the name of an option; the nearest is -" +
              nearest_option(listed, name) + "\n",
          static_cast<int>(Outcome::bad_input)};
}

}  // namespace

std::string schema_text() { return schema_of(listed_options(), k_version); }

std::string help_text() {
  InputReport report;
  report.help = true;
  Config config;
  return read_options(nullptr, available_backends(), config, report) == PETSC_SUCCESS ? report.help_text : "";
}

AboutAnswer answer_without_run(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = lower_case(argv[k]);
    const bool version = word == "--version" || word == "-version",
               schema = word == "--schema" || word == "-schema";
    if (!version && !schema && word != "--help" && word != "-help" && word != "-h") continue;
    if (is_later_process()) return {true, ""};
    if (version) return {true, version_text()};
    if (schema) return {true, schema_text()};
    // A dash may belong to an option of a run that also has -help; as the last word it is asked for.
    const bool named = k + 1 < argc && (argv[k + 1][0] != '-' || k + 2 == argc);
    return named ? help_answer(argv[k + 1]) : AboutAnswer{true, help_text()};
  }
  return {};
}

}  // namespace mpm
