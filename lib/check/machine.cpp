#include "check/machine.hpp"

#include "check/gpu.hpp"
#include "common/text.hpp"
#include "mesh/background.hpp"
#include "step/stepper.hpp"

namespace mpm {
namespace {

/// A run with -backend cuda needs a GPU on every rank.
PetscErrorCode check_device(MPI_Comm comm, Config& config, InputReport& report) {
  PetscFunctionBeginUser;
  int gpus = gpu_count();
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &gpus, 1, MPI_INT, MPI_MIN, comm));
  if (config.backend != Backend::cuda || gpus > 0) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<std::string> words;
  Backend host = Backend::serial;  // the fastest
  for (const Backend backend : available_backends())
    if (backend != Backend::cuda) words.push_back(word_of(host = backend));
  if (config.dry_run) {
    config.backend = host;
    report.warnings.push_back(
        formatted("warning: -backend cuda: there is no GPU here, or no driver for it; this dry run is one of "
                  "-backend %s, whose memory and wall time are not those of a GPU",
                  word_of(host)));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  bool given = false;
  for (const EffectiveOption& option : report.options)
    given = given || (option.name == "-backend" && !option.standard);
  const std::string why = why_no_gpu();
  report.errors.push_back(
      formatted("mpm: -backend: %s, takes %s where there is no GPU or no driver for it%s%s",
                given ? "given \"cuda\"" : "not given, which stands for \"cuda\"",
                join(words, " or ").c_str(), why.empty() ? "" : "; CUDA says: ", why.c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A program may be built for one dimension or precision only.
void check_build(MPI_Comm comm, const Config& config, InputReport& report) {
  if (make_stepper(config, comm)) return;
  report.errors.push_back(
      formatted("mpm: -precision: given \"%s\" with -dim %d, takes what this program was built for "
                "(MPM_REALS, MPM_DIMS)",
                word_of(config.precision), config.dim));
}

/// The patch table is counted by int.
void check_mesh(const Config& config, InputReport& report) {
  constexpr double k_most_patches = 2147483647;
  const double patches = patch_count(config.mesh, config.dim);
  if (patches <= k_most_patches) return;
  report.errors.push_back(
      formatted("mpm: -mesh_spacing: given \"%g\", takes an edge that gives at most %.0f patches of %d cells "
                "a side; this is %.4g",
                config.mesh.spacing, k_most_patches, patch_edge(config.dim), patches));
}

}  // namespace

PetscErrorCode check_machine(MPI_Comm comm, Config& config, InputReport& report) {
  PetscFunctionBeginUser;
  PetscCall(check_device(comm, config, report));
  if (report.errors.empty()) check_build(comm, config, report);
  if (report.errors.empty()) check_mesh(config, report);
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
