#pragma once
// Checkpoints that an earlier version of the program has written.

#include "data/saved_state.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Rows that the sides of the mesh have in a saved table, as the words of the sides say.
struct SavedSideRows {
  std::size_t acting = 0, columns = 0;
};
SavedSideRows rows_of_sides(const SavedSides& sides, const Config& config);

/// Version 0.1 kept one number of each normal impulse, of what friction had not used: gives it the place that
/// it has in ImpulseTerms. The means of the impulses begin anew.
void complete_earlier(const Config& config, SavedState& state);

}  // namespace mpm
