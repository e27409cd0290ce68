#pragma once
#include "data/particles.hpp"
#include "physics/materials/any.hpp"

namespace mpm {

/// Whether a law, or some law of a list, can part.
template <template <class> class Model>
inline constexpr bool parts = requires(const Model<double>& law,
                                       const LawState<double, state_size<Model<double>>>& state) {
  law.free_gap(state);
};
template <template <class> class... Models>
constexpr bool can_part(ModelList<Models...>) {
  return (parts<Models> || ...);
}

/// By how much the most volume of particle p grows because its soil has parted in all directions: exp of the
/// gap (free_gap of its law, one of the list Laws). Such soil takes no pressure before the gap has closed.
/// Its volume must remember the gap, or compression would bring the volume below that which the soil then
/// has.
template <class Laws = Materials, class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION T gap_room(const Soil<Space, T, Dim>& soil, int p) {
  constexpr T k_most = 4;  // of the gap: soil is alone, and its volume stays, long before
  T gap = 0;
  const AnyMaterial<T>& of = material_in(soil.materials(soil.bodies(soil.body(p)).material));
  of.visit_as(Laws{}, of.which, [&](const auto& law) {
    if constexpr (requires { law.free_gap(soil.state_of(law, p)); })
      gap = law.free_gap(soil.state_of(law, p));
  });
  return Kokkos::exp(Kokkos::fmin(gap, k_most));
}

}  // namespace mpm
