#pragma once
// Which bodies and rigids are in the run in which stage.

#include "common/text.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Number of the stage that places a body or rigid; 0: the run begins with it.
inline int placed_at(const StageConfig& stage, const std::string& name) {
  const auto found = stage.placed_at.find(lower_case(name));
  return found == stage.placed_at.end() ? 0 : found->second;
}

/// Number of the stage that removes it; beyond all stages where none does.
inline int removed_at(const StageConfig& stage, const std::string& name) {
  constexpr int k_never = 1 << 30;
  const auto found = stage.removed_at.find(lower_case(name));
  return found == stage.removed_at.end() ? k_never : found->second;
}

/// Whether it is in the run in the stage of this number, from 1 on.
inline bool is_present(const StageConfig& stage, const std::string& name, int number) {
  return placed_at(stage, name) <= number && removed_at(stage, name) > number;
}

}  // namespace mpm
