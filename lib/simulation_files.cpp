// Files of a run: checks that the run destroys no input and no file of others, and is alone in its output
// folder.

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <utility>

#include "common/collectives.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/shapes.hpp"
#include "output/own_files.hpp"
#include "simulation_body.hpp"

namespace mpm {
namespace {

/// An option that names an input file, and that file.
using Input = std::pair<std::string, std::string>;

void add_files(const std::string& name, const Shape& shape, std::vector<Input>& inputs) {
  for (const auto& [key, file] : files_of(shape)) inputs.emplace_back("-" + name + key, file);
}

std::vector<Input> inputs_of(const Config& config, const InputReport& report) {
  std::vector<Input> inputs;
  for (const std::string& file : report.files) inputs.emplace_back("-options_file", file);
  for (const BodyConfig& body : config.bodies) {
    add_files(body.name, body.shape, inputs);
    if (!body.field.empty()) inputs.emplace_back("-" + body.name + "_field", body.field);
  }
  for (const RigidConfig& rigid : config.rigids) add_files(rigid.name, rigid.shape, inputs);
  for (const auto& [option, file] : table_files(config)) inputs.emplace_back(option, file);
  if (!config.element.file.empty()) inputs.emplace_back("-element_path", config.element.file);
  return inputs;
}

bool same_file(const std::string& one, const std::string& other) {
  struct stat a {
  }, b{};
  return ::stat(one.c_str(), &a) == 0 && ::stat(other.c_str(), &b) == 0 && a.st_dev == b.st_dev &&
         a.st_ino == b.st_ino;
}

}  // namespace

/// A line for each input file that the run would remove or write over, and for a file of others under a name
/// that the run needs. Touches nothing; on one rank.
void Simulation::Body::check_files() {
  const std::string& folder = config.output.directory;
  if (has_control(folder))  // of the options file's name
    report.errors.push_back("mpm: -output_dir: default \"" + visible(folder) +
                            "\", takes a folder without line ends, tabulators and the like in its name");
  if (std::error_code error; !std::filesystem::is_directory(folder, error)) return;
  const auto inputs = inputs_of(config, report);
  std::string foreign;
  for (const std::string& path : written_names(folder)) {
    bool input = false;
    for (const auto& [option, file] : inputs) {
      if (!same_file(path, file)) continue;
      input = true;
      report.errors.push_back(
          "mpm: " + option + ": given \"" + file +
          "\", takes a file that this run does not remove; give another -output_dir than " + folder);
    }
    if (foreign.empty() && !input && !is_own_file(path)) foreign = path;
  }
  if (!foreign.empty() && report.errors.empty())
    report.errors.push_back("mpm: -output_dir: given \"" + folder +
                            "\", takes a folder without files of others under the names of the results; " +
                            foreign + " is not the program's");
}

/// Takes the lock of the output folder on the first rank, if the folder can be written into; that another run
/// has it becomes a line for the user on every rank. Collective.
PetscErrorCode Simulation::Body::lock_folder() {
  PetscFunctionBeginUser;
  std::string other;
  const std::string& folder = config.output.directory;
  std::error_code error;
  const bool due = rank_of(comm) == 0 && std::filesystem::is_directory(folder, error) &&
                   ::access(folder.c_str(), W_OK | X_OK) == 0;
  PetscCall(agree(comm, due ? lock.take(folder, &other) : PETSC_SUCCESS));
  PetscCall(share_text(comm, &other));
  if (!other.empty())
    report.errors = {"mpm: -output_dir: given \"" + folder +
                     "\", takes a folder that no other run has; this one has " + other};
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
