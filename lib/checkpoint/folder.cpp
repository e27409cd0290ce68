#include "checkpoint/folder.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "output/files.hpp"
#include "output/own_files.hpp"

namespace mpm {
namespace fs = std::filesystem;

namespace {

using NumberOf = std::optional<long> (*)(const std::string& name);

/// Names in a folder that have a number of this kind above `last`.
std::vector<std::string> later_than(const fs::path& folder, NumberOf number_of, long last) {
  std::vector<std::string> later;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (const auto number = number_of(it->path().filename().string()); number && *number > last)
      later.push_back(it->path().string());
  return later;
}

}  // namespace

std::string checkpoint_path(const std::string& folder, long step) {
  return folder + "/checkpoint_" + std::to_string(step) + ".h5";
}

std::vector<long> checkpoint_steps(const std::string& folder) {
  std::vector<long> steps;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (const auto step = checkpoint_number(it->path().filename().string())) steps.push_back(*step);
  std::sort(steps.begin(), steps.end());
  return steps;
}

PetscErrorCode keep_last_checkpoints(const std::string& folder) {
  constexpr std::size_t k_kept = 2;
  PetscFunctionBeginUser;
  int removed = 0;
  const auto steps = checkpoint_steps(folder);
  for (std::size_t n = 0; n + k_kept < steps.size(); ++n)
    PetscCall(remove_own(checkpoint_path(folder, steps[n]), &removed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode remove_unfinished(const std::string& folder, int* removed) {
  PetscFunctionBeginUser;
  PetscCall(make_folder((fs::path(folder) / "frames").string()));
  for (const std::string& path : written_names(folder))
    if (path.ends_with(".tmp")) PetscCall(remove_own(path, removed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode remove_later_checkpoints(const std::string& folder, long step, int* removed) {
  PetscFunctionBeginUser;
  for (const std::string& path : later_than(folder, checkpoint_number, step))
    PetscCall(remove_own(path, removed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode remove_later_frames(const std::string& folder, long frames, int* removed) {
  PetscFunctionBeginUser;
  for (const std::string& path : later_than(fs::path(folder) / "frames", frame_number, frames - 1))
    PetscCall(remove_own(path, removed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
