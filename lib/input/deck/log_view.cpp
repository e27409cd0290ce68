// -log_view, the one option of PETSc that may name files: they go to the output folder.

#include <algorithm>
#include <filesystem>

#include "common/text.hpp"
#include "input/deck/deck.hpp"
#include "input/deck/report.hpp"
#include "output/own_files.hpp"

namespace mpm {
namespace {

/// One of the viewers of -log_view: [ascii][:FILE[:FORMAT]].
struct Viewer {
  std::string kind, file, rest;  // rest: the format with its colon
};

std::vector<Viewer> viewers_of(const std::string& value) {
  std::vector<Viewer> viewers;
  for (const auto& text : split(value)) {
    const auto first = text.find(':');
    const auto second = first == std::string::npos ? first : text.find(':', first + 1);
    Viewer& viewer = viewers.emplace_back();
    viewer.kind = text.substr(0, first);
    if (first != std::string::npos) viewer.file = text.substr(first + 1, second - first - 1);
    if (second != std::string::npos) viewer.rest = text.substr(second);
  }
  return viewers;
}

/// Fault of the name of a file of the output folder; empty where there is none.
std::string fault_of(const std::string& name, const std::string& folder, const InputReport& report) {
  namespace fs = std::filesystem;
  if (name == "." || name == ".." || name.find('/') != std::string::npos || has_control(name))
    return "the name of a file without a folder: it goes to the output folder";
  if (folder.find_first_of(",:") != std::string::npos)
    return "no file where the name of the output folder has a comma or a colon";
  if (is_written_name(name, false) || name == "frames" || name == "mpm.lock")
    return "a name that no other file of the run has";
  std::error_code error;
  const fs::path path = fs::path(folder) / name;
  const auto kind = fs::symlink_status(path, error).type();
  if (kind != fs::file_type::not_found && kind != fs::file_type::regular && fs::is_directory(folder, error))
    return "a regular file of the output folder, or none yet";
  const bool input = std::any_of(report.files.begin(), report.files.end(),
                                 [&](const std::string& file) { return fs::equivalent(file, path, error); });
  return input ? "a file that the run does not read" : "";
}

}  // namespace

void check_log_view(const std::string& folder, InputReport& report) {
  if (report.log_view.empty()) return;
  const auto refuse = [&report](const std::string& takes) {
    report.errors.push_back("mpm: -log_view: given \"" + printable(report.log_view) + "\", takes " + takes);
  };
  for (const Viewer& viewer : viewers_of(report.log_view)) {
    if (!viewer.kind.empty() && viewer.kind != "ascii") return refuse("nothing, or [ascii]:FILE[:FORMAT]");
    if (viewer.file.empty()) continue;
    if (const std::string fault = fault_of(viewer.file, folder, report); !fault.empty()) return refuse(fault);
  }
}

PetscErrorCode place_log_view(const InputReport& report, const std::string& folder) {
  PetscFunctionBeginUser;
  if (report.log_view.find(':') == std::string::npos) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<std::string> viewers;
  for (const Viewer& viewer : viewers_of(report.log_view)) {
    const std::string place = viewer.file.empty() ? "" : folder + "/" + viewer.file;
    viewers.push_back(viewer.kind + ":" + place + viewer.rest);
  }
  PetscCall(PetscOptionsSetValue(nullptr, "-log_view", join(viewers).c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode forget_options(const InputReport& report) {
  PetscFunctionBeginUser;
  for (const std::string& word : report.words)
    if (is_option_name(word)) PetscCall(PetscOptionsClearValue(nullptr, word.c_str()));
  PetscCall(PetscOptionsClearValue(nullptr, "-log_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
