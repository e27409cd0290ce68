#pragma once
// Loads that follow tables in time, from the host to a State.

#include <vector>

#include "data/state.hpp"

namespace mpm {

/// A number that is constant, or the mean of a curve over each step.
struct NumberInput {
  double constant = 0;
  std::vector<CurvePoint> points;  // empty: constant
  CurveUse use = CurveUse::value;
  bool smooth = false;
};

/// A component of what follows a table in time, as TimedLoad has it.
struct LoadInput {
  LoadTarget target = LoadTarget::gravity;
  int rigid = 0, component = 0;  // of a side, 2 direction + 1 for the upper one stands for the rigid; or the
                                 // number of a surface's load or a joint
  NumberInput own, gravity;
  double factor = 0;
};

/// Puts loads on surfaces on the device, with the values that they have where they follow no table. Before
/// upload_loads and upload.
template <class Space, class T, int Dim>
void upload_surface_loads(State<Space, T, Dim>& s, const std::vector<SurfaceLoad<Dim>>& loads);

/// Puts the loads on the device, behind the sides, the loads on surfaces and the joints that they set;
/// begin_loads sets their first values. s.gravity is that of the start.
template <class Space, class T, int Dim>
void upload_loads(State<Space, T, Dim>& s, const std::vector<LoadInput>& loads);

}  // namespace mpm
