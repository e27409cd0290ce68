#pragma once
// Light rigid bodies in a step: contact takes them with the velocity that its impulses leave them.

#include "data/floors.hpp"

namespace mpm {

/// Rounds of the solution at most. It ends when the velocity of no body changes; mostly after two to four.
inline constexpr int k_light_rounds = 12;

/// Part of 4, before update_nodes, where s.light_rigids is in use: begins the solution of a step of dt [s]
/// with the bodies' motion without contact. damps: the soil has local damping, whose forces are those of the
/// solution without it, which is there.
template <class Space, class T, int Dim>
void begin_light_rigids(State<Space, T, Dim>& s, double dt, bool damps, const Space& stream);

/// Rehearses contact with the velocities as they are, and leaves the system of each light body in
/// s.light_rigids.sums, of this rank's nodes.
template <class Space, class T, int Dim>
void sum_light_rigids(State<Space, T, Dim>& s, double dt, bool damps, const Space& stream);

/// Whether the solution goes on for some body, by the sums of one rank. A device does not wait to tell.
template <class Space, class T, int Dim>
bool light_rigids_open(const State<Space, T, Dim>& s);

/// Improves the velocities by the sums of all ranks.
template <class Space, class T, int Dim>
void solve_light_rigids(State<Space, T, Dim>& s, double dt, bool damps, const Space& stream);

}  // namespace mpm
