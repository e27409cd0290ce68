#pragma once
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// What in a sound input is likely to be a mistake, or to give poor answers: a line for each, with advice
/// ("warning: ..."). The run goes on.
std::vector<std::string> warnings_of(const Config& config, int ranks = 1);

}  // namespace mpm
