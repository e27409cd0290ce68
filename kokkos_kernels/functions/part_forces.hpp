#pragma once
// Forces of the soil on the parts of rigid bodies.

#include <vector>

#include "data/contact_core.hpp"

namespace mpm {

/// Adds the forces on parts in a step of dt [s] to their impulses, before the rigid bodies move.
template <class Space, class T, int Dim>
void add_part_impulses(ContactCore<Space, T, Dim>& s, double dt, const Space& stream);

/// Impulses of the soil on parts since they were last taken [N s, N m s]; they begin anew.
template <class Space, class T, int Dim>
std::vector<Wrench<Dim>> take_part_impulses(ContactCore<Space, T, Dim>& s);

/// These impulses as SavedState::part_impulses, and back from there. A part that is not there begins at 0.
template <class Space, class T, int Dim>
std::vector<double> save_part_impulses(const ContactCore<Space, T, Dim>& s);
template <class Space, class T, int Dim>
void restore_part_impulses(ContactCore<Space, T, Dim>& s, const std::vector<double>& saved);

}  // namespace mpm
