// Options of PETSc that it looks at only once the run has ended.

#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "common/text.hpp"
#include "input/groups.hpp"

namespace mpm {
namespace {

/// Whether a file can be made at this path, or written anew.
bool can_be_written(const std::string& path) {
  std::error_code error;
  const std::filesystem::path file(path), folder = file.parent_path();
  if (std::filesystem::is_directory(file, error)) return false;
  if (std::filesystem::exists(file, error)) return access(path.c_str(), W_OK) == 0;
  const std::string where = folder.empty() ? "." : folder.string();
  return std::filesystem::is_directory(where, error) && access(where.c_str(), W_OK) == 0;
}

/// Reports an option, which PETSc then must not see at its end.
void refuse(OptionReader& in, const std::string& name, const std::string& takes) {
  in.reject(name, takes);
  (void)PetscOptionsClearValue(nullptr, ("-" + name).c_str());
}

/// [ascii][:FILE[:FORMAT]], as many as wanted.
void check_log_view(OptionReader& in) {
  for (const auto& viewer : split(in.given_text("log_view"))) {
    const auto parts = split(viewer, ':');
    if (!parts[0].empty() && parts[0] != "ascii")
      return refuse(in, "log_view", "nothing, or [ascii]:FILE[:FORMAT]");
    if (parts.size() > 1 && !parts[1].empty() && !can_be_written(parts[1]))
      return refuse(in, "log_view", "a file that can be written, in a folder that exists");
  }
}

}  // namespace

void check_petsc_options(OptionReader& in) {
  if (in.given("log_view")) check_log_view(in);
  for (const char* name :
       {"citations", "history", "log", "log_all", "log_mpe", "log_trace", "malloc_view", "objects_dump"}) {
    const std::string file = in.given_text(name);
    if (!file.empty() && !can_be_written(file))
      refuse(in, name, "a file that can be written, in a folder that exists");
  }
  static const std::vector<std::string> words = {"", "true", "false", "yes", "no", "on", "off", "1", "0"};
  for (const char* name : {"get_total_flops", "memory_view", "mpidump", "options_left", "options_view"})
    if (std::find(words.begin(), words.end(), lower_case(in.given_text(name))) == words.end())
      refuse(in, name, "true or false");
}

}  // namespace mpm
