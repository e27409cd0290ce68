#pragma once
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Warnings about a sound input that is likely to be a mistake, or to give poor answers: a line each, with
/// advice ("warning: ..."). The run goes on.
std::vector<std::string> warnings_of(const Config& config, int ranks = 1);

}  // namespace mpm
