#pragma once
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Motions and contacts that a user may expect of rigid bodies and that the program has not: a line for
/// each ("warning: ...").
std::vector<std::string> warnings_of_rigids(const Config& config);

}  // namespace mpm
