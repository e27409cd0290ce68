#include "common/energy_meter.hpp"

#include <filesystem>
#include <fstream>
#include <optional>

namespace mpm {
namespace {

template <class T>
std::optional<T> content_of(const std::string& file) {
  T value{};
  std::ifstream in(file);
  if (!(in >> value)) return std::nullopt;
  return value;
}

/// Whether a zone counts what no other one counts: a package holds its cores, but not its memory. That of the
/// whole board holds both, where there is one, and is left out.
bool counts_alone(const std::string& name) { return name.starts_with("package") || name == "dram"; }

}  // namespace

EnergyMeter::EnergyMeter(const std::string& folder) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    const std::string zone = entry.path().string();
    if (!counts_alone(content_of<std::string>(zone + "/name").value_or(""))) continue;
    const auto now = content_of<double>(zone + "/energy_uj"),
               range = content_of<double>(zone + "/max_energy_range_uj");
    if (now && range) counters_.push_back({zone + "/energy_uj", *now, *range});
  }
}

void EnergyMeter::read() {
  for (Counter& counter : counters_) {
    const auto now = content_of<double>(counter.file);
    if (!now) continue;
    joules_ += 1e-6 * (*now - counter.last + (*now < counter.last ? counter.range : 0));
    counter.last = *now;
  }
}

}  // namespace mpm
