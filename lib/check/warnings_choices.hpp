#pragma once
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Mistakes of new users that give poor answers or huge files: cells, particles, precision, output,
/// soil that locks, sinks or falls out. A line for each, with the cure ("warning: ...").
std::vector<std::string> warnings_of_choices(const Config& config);

}  // namespace mpm
