#pragma once
// From the state of a run to a SavedState and back. Between two steps only, with no rebuild due.

#include <string>

#include "base/spaces.hpp"
#include "data/contact_core.hpp"
#include "data/saved_state.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {

template <class Space, class T, int Dim>
SavedState save_state(const ContactCore<Space, T, Dim>& s);

// A saved state takes the place of what `upload` made from the same input in three parts, between which
// several ranks bring its points to their owners: the points, their order and lists, and all that hangs on
// these (transfer/restore_state.hpp). The next step then gives the bits that it would have given, where space
// and real type are the same.

/// Empty, or what does not fit.
template <class Space, class T, int Dim>
std::string take_saved(ContactCore<Space, T, Dim>& s, const SavedState& saved);
template <class Space, class T, int Dim>
void finish_saved(ContactCore<Space, T, Dim>& s, const SavedState& saved);

}  // namespace mpm
