#pragma once
// A node's part in the system of a light rigid body that it touches.

#include "data/light_rigids.hpp"

namespace mpm {

/// Contact of a node with a light body.
template <class T, int Dim>
struct Touch {
  Vector<T, Dim> normal;  // -, of length 1
  Vector<T, Dim> change;  // m/s, of the node's velocity
  T mass;                 // kg, of the node
  T stopped, held;        // -, fractions of the approach and of the slip that contact takes away
};

/// Adds a touch to the system of a body: its impulse, and the loss of this by the body's velocity. place(d):
/// component d of the node's place [m]; system: LightTerms, `stride` apart.
template <class T, int Dim, class Component>
KOKKOS_INLINE_FUNCTION void add_touch(const Touch<T, Dim>& touch, const RigidPose<Dim>& pose,
                                      const Component& place, int stride, double* system) {
  using Terms = LightTerms<Dim>;
  const Vector<double, Dim> arm = pose.arm_to(place);
  Vector<double, Dim> along[Terms::unknowns] = {};  // m/s at the node, of a velocity or a spin of 1
  for (int u = 0; u < Terms::unknowns; ++u) {
    if (u < Dim) {
      along[u][u] = 1;
    } else if (pose.turns) {
      AngularVector<Dim> spin{};
      spin[u - Dim] = 1;
      along[u] = cross(spin, arm);
    }
  }
  const double mass = touch.mass, held = touch.held, more = touch.stopped - touch.held;
  for (int u = 0; u < Terms::unknowns; ++u) {
    double impulse = 0, across = 0;
    for (int d = 0; d < Dim; ++d) across += along[u][d] * touch.normal[d];
    for (int d = 0; d < Dim; ++d) impulse -= along[u][d] * mass * touch.change[d];
    system[(Terms::impulse + u) * stride] += impulse;
    for (int w = 0; w <= u; ++w) {
      double other = 0, product = 0;
      for (int d = 0; d < Dim; ++d) {
        other += along[w][d] * touch.normal[d];
        product += along[u][d] * along[w][d];
      }
      system[Terms::loss_at(u, w) * stride] += mass * (held * product + more * across * other);
    }
  }
}

}  // namespace mpm
