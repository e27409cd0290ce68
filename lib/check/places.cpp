#include "check/places.hpp"

#include <algorithm>

#include "check/overlap.hpp"

namespace mpm {
namespace {

/// Checks bodies that later stages place for overlaps that can be found at the start.
PetscErrorCode check_placed(MPI_Comm comm, InputReport& report) {
  PetscFunctionBeginUser;
  std::vector<char> fixed;  // rigids that have not moved so far
  for (const StageInput& input : report.stages) {
    const StageConfig& stage = input.config.stage;
    const auto& placed = stage.place_rigids;
    fixed.resize(input.config.rigids.size(), 1);
    for (std::size_t r = 0; r < fixed.size(); ++r)
      if (!input.config.rigids[r].absent && input.config.rigids[r].motion != Motion::fixed &&
          std::find(placed.begin(), placed.end(), static_cast<int>(r)) == placed.end())
        fixed[r] = 0;
    if (stage.place.empty() && placed.empty()) continue;
    std::vector<Overlap> overlaps;
    PetscCall(find_overlaps_of_placed(comm, input.config, fixed, &overlaps));
    for (const std::string& line : describe(overlaps, input.config)) report.errors.push_back(line);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode check_places(MPI_Comm comm, const Config& config, InputReport& report) {
  PetscFunctionBeginUser;
  int wrong = report.errors.empty() ? 0 : 1;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &wrong, 1, MPI_INT, MPI_MAX, comm));
  if (wrong) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<Overlap> overlaps;
  PetscCall(find_overlaps(comm, config, &overlaps));
  report.errors = describe(overlaps, config);
  PetscCall(check_placed(comm, report));
  PetscCall(check_load_faces(comm, config, &report.errors, &report.warnings));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
