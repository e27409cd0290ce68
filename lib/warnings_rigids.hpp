#pragma once
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// What a user may expect of rigid bodies and they do not do: a line for each ("warning: ...").
std::vector<std::string> warnings_of_rigids(const Config& config);

}  // namespace mpm
