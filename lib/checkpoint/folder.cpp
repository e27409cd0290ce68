#include "checkpoint/folder.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "input/text.hpp"
#include "output/files.hpp"

namespace mpm {
namespace fs = std::filesystem;

namespace {

/// The number in PREFIX NUMBER .h5, if the name is of that kind.
std::optional<long> number_in(const std::string& name, const std::string& prefix) {
  const std::string suffix = ".h5";
  if (!name.starts_with(prefix) || !name.ends_with(suffix) || name.size() <= prefix.size() + suffix.size())
    return std::nullopt;
  const std::string digits = name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
  if (digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return parse_integer(digits);
}

PetscErrorCode remove_file(const fs::path& path) {
  PetscFunctionBeginUser;
  std::error_code failed;
  fs::remove(path, failed);
  PetscCheck(!failed, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot remove %s: %s", path.c_str(),
             failed.message().c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Removes the files PREFIX NUMBER .h5 of numbers above `last`, and all that begin so and were not finished.
PetscErrorCode remove_later(const fs::path& folder, const std::string& prefix, long last, int* removed) {
  PetscFunctionBeginUser;
  std::vector<fs::path> later;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const auto number = number_in(name, prefix);
    if ((number && *number > last) || (name.starts_with(prefix) && name.ends_with(".tmp")))
      later.push_back(it->path());
  }
  PetscCheck(!error, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot read the folder %s: %s", folder.c_str(),
             error.message().c_str());
  for (const fs::path& path : later) PetscCall(remove_file(path));
  *removed += static_cast<int>(later.size());
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

std::string checkpoint_path(const std::string& folder, long step) {
  return folder + "/checkpoint_" + std::to_string(step) + ".h5";
}

std::vector<long> checkpoint_steps(const std::string& folder) {
  std::vector<long> steps;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (const auto step = number_in(it->path().filename().string(), "checkpoint_")) steps.push_back(*step);
  std::sort(steps.begin(), steps.end());
  return steps;
}

PetscErrorCode keep_last_checkpoints(const std::string& folder) {
  constexpr std::size_t k_kept = 2;
  PetscFunctionBeginUser;
  const auto steps = checkpoint_steps(folder);
  for (std::size_t n = 0; n + k_kept < steps.size(); ++n)
    PetscCall(remove_file(checkpoint_path(folder, steps[n])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode go_back_to(const std::string& folder, long step, long frames, int* removed) {
  PetscFunctionBeginUser;
  const fs::path in_frames = fs::path(folder) / "frames";
  int count = 0;
  PetscCall(make_folder(in_frames.string()));
  PetscCall(remove_later(folder, "checkpoint_", step, &count));
  PetscCall(remove_later(in_frames, "frame_", frames - 1, &count));
  for (const char* file : {"history.csv.tmp", "options.json.tmp", "particles.xdmf.tmp"}) {
    std::error_code none;
    count += fs::remove(fs::path(folder) / file, none) ? 1 : 0;
  }
  *removed = count;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
