#include "mpm/about.hpp"

#include <hdf5.h>
#include <mpi.h>
#include <petscsys.h>

#include <cstdlib>

#include "common/text.hpp"
#include "git_commit.hpp"
#include "input/options/options.hpp"
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

std::string help_text() {
  InputReport report;
  report.help = true;
  Config config;
  return read_options(nullptr, available_backends(), config, report) == PETSC_SUCCESS ? report.help_text : "";
}

AboutAnswer answer_without_run(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = lower_case(argv[k]);
    const bool version = word == "--version" || word == "-version";
    if (!version && word != "--help" && word != "-help" && word != "-h") continue;
    if (is_later_process()) return {true, ""};
    return {true, version ? version_text() : help_text()};
  }
  return {};
}

}  // namespace mpm
