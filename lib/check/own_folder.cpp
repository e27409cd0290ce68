#include "check/own_folder.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <utility>

#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/geometry/shapes.hpp"
#include "output/own_files.hpp"

namespace mpm {
namespace {

/// An option that names an input file, and that file.
using Input = std::pair<std::string, std::string>;

void add_files(const std::string& name, const Shape& shape, std::vector<Input>& inputs) {
  for (const auto& [option, file] : files_of(name, shape)) inputs.emplace_back(option, file);
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

void check_own_folder(const Config& config, InputReport& report) {
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

}  // namespace mpm
