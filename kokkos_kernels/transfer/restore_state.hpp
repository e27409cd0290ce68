#pragma once
// The rebuild amid the parts of a restart, and all of them on one rank.

#include <string>
#include <utility>

#include "rebuild/rebuild_state.hpp"
#include "transfer/save_state.hpp"

namespace mpm {

/// Order and lists of the points that take_saved has put on the device. A rebuild brings the pressures of a
/// cell together (F-bar); this keeps them.
template <class Space, class T, int Dim>
void list_saved(State<Space, T, Dim>& s) {
  const bool keeps = std::exchange(s.f_bar.keeps_stress, true);
  sort_and_list(s);
  s.f_bar.keeps_stress = keeps;
}

/// take_saved, list_saved and finish_saved, on one rank. Empty, or what does not fit.
template <class Space, class T, int Dim>
std::string restore_state(State<Space, T, Dim>& s, const SavedState& saved) {
  const std::string unfit = take_saved(s, saved);
  if (!unfit.empty()) return unfit;
  list_saved(s);
  finish_saved(s, saved);
  return {};
}

}  // namespace mpm
