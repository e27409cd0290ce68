#pragma once
// The stepper has the rigid bodies that are in the run; the history, frames and checkpoints have all.

#include <vector>

#include "common/snapshot.hpp"
#include "data/saved_state.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Which rigid bodies of a configuration are in the run.
class PresentRigids {
 public:
  explicit PresentRigids(const Config& config);

  /// The configuration with these rigids alone. A joint without one of its bodies joins the ground to itself.
  Config narrowed(const Config& config) const;
  /// Index among all rigids of the k-th that is there.
  std::size_t place_of(std::size_t k) const { return place_[k]; }
  /// A state of all rigids becomes one of these; the others stay as they are then.
  void narrow(SavedState& state);
  /// A state of these rigids becomes one of all.
  void widen(SavedState& state) const;
  /// Widens rows of the history, and the groups of a frame, where rigids that are not in the run have no
  /// particles.
  void widen(std::vector<RigidRow>& rows) const;
  void widen(std::vector<ParticleSnapshot>& groups) const;

 private:
  bool all() const { return place_.size() == others_.size(); }

  std::vector<std::size_t> place_;  // of each that is there, among all
  std::vector<SavedRigid> others_;  // of all, where those that are not there stand
  std::vector<std::string> names_;  // of all
};

}  // namespace mpm
