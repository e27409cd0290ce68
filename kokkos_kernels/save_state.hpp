#pragma once
// From a State to a SavedState and back. Between two steps only, with no rebuild due.

#include "saved_state.hpp"
#include "spaces.hpp"
#include "state.hpp"

namespace mpm {

template <class Space, class T, int Dim>
SavedState save_state(const State<Space, T, Dim>& s);

/// Puts a saved state in the place of what `upload` made from the same input: the next step gives the bits
/// that it would have given then, where space and real type are the same, too. Empty, or what does not fit.
template <class Space, class T, int Dim>
std::string restore_state(State<Space, T, Dim>& s, const SavedState& saved);

}  // namespace mpm
