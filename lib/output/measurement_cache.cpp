#include "output/measurement_cache.hpp"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#include "common/numbers.hpp"

namespace mpm {
namespace {

namespace fs = std::filesystem;

/// Empty where there is no home.
fs::path cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && *cache != '\0') return fs::path(cache) / "mpm";
  const char* home = std::getenv("HOME");
  return home != nullptr && *home != '\0' ? fs::path(home) / ".cache" / "mpm" : fs::path();
}

/// Lines of "number key".
std::map<std::string, double> read(const fs::path& path) {
  std::map<std::string, double> kept;
  std::ifstream file(path);
  std::string key;
  for (double value; file >> value && std::getline(file >> std::ws, key);) kept[key] = value;
  return kept;
}

/// Under another name first: programs that start together each leave a whole file. Nobody waits for the disk.
void write(const fs::path& path, const std::map<std::string, double>& kept) {
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  const fs::path temporary = path.string() + "." + std::to_string(::getpid());
  std::ofstream file(temporary);
  for (const auto& [key, value] : kept) file << text_of(value) << ' ' << key << '\n';
  file.close();
  if (file)
    fs::rename(temporary, path, error);
  else
    fs::remove(temporary, error);
}

}  // namespace

double cached_measurement(const std::string& name, const std::string& key,
                          const std::function<double()>& measure) {
  const fs::path folder = cache_folder();
  if (folder.empty()) return measure();
  std::map<std::string, double> kept = read(folder / name);
  if (const auto found = kept.find(key); found != kept.end()) return found->second;
  const double value = measure();
  if (value > 0) {
    kept[key] = value;
    write(folder / name, kept);
  }
  return value;
}

}  // namespace mpm
