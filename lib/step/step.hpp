#pragma once
// One time step; step.cpp has it in the paper's words.

#include "functions/rayleigh.hpp"
#include "parallel/decomposition.hpp"
#include "step/overlap_stream.hpp"
#include "step/timers.hpp"
#include "step/to_nodes.hpp"

namespace mpm {

/// Advances one explicit step of dt [s], or up to `left` steps where one launch does them. Reduces `left` by
/// the number of steps done. Does nothing while s.control is paused. rayleigh: null without such damping.
template <class Space, class T, int Dim>
PetscErrorCode step(State<Space, T, Dim>& s, Timers& timers, double dt,
                    Decomposition<Space, T, Dim>* ranks = nullptr, OverlapStream<Space>* overlap = nullptr,
                    long* left = nullptr, Rayleigh<Space, T, Dim>* rayleigh = nullptr);

}  // namespace mpm
