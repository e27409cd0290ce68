#pragma once
// Whether the run destroys no input and no file of others.

#include "input/deck/report.hpp"

namespace mpm {

/// Adds a line to the report for each input file that the run would remove or write over, and for a file of
/// others under a name that the run needs. Touches nothing; on one rank.
void check_own_folder(const Config& config, InputReport& report);

}  // namespace mpm
