#pragma once
// Which rigid bodies have contact with each other.

#include <algorithm>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Whether the surface of a rigid body is one that others may touch.
inline bool is_touchable(const RigidConfig& rigid) { return rigid.shape.kind != ShapeKind::particles; }

/// Whether two rigid bodies touch each other where they meet.
inline bool have_contact(const Config& config, const RigidConfig& one, const RigidConfig& other) {
  return config.rigid_contact && is_touchable(one) && is_touchable(other) &&
         (one.motion == Motion::dynamic || other.motion == Motion::dynamic);
}

/// Whether the history has the forces of other rigid bodies on each one: where one of two that may meet
/// is dynamic, or -rigid_contact asks for contact. `config` is that of the history (history_config).
inline std::vector<char> contact_columns(const Config& config) {
  const auto moves = [](const RigidConfig& rigid) { return rigid.motion == Motion::dynamic; };
  const auto dynamic = std::count_if(config.rigids.begin(), config.rigids.end(), moves);
  std::vector<char> out;
  for (const RigidConfig& rigid : config.rigids) {
    const bool meets = moves(rigid) ? config.rigids.size() > 1 || config.rigid_contact_given : dynamic > 0;
    out.push_back(config.rigid_contact && meets && is_touchable(rigid));
  }
  return out;
}

}  // namespace mpm
