#pragma once
// One material of any model, for device tables: which model, and its parameters.

#include <cstddef>
#include <vector>

#include "materials/list.hpp"

namespace mpm {

template <class T, class List>
struct OneOf;

/// Holds one of the models of the list; `visit` calls f with it.
template <class T, template <class> class... Models>
struct OneOf<T, ModelList<Models...>> {
  static constexpr std::size_t k_bytes = Kokkos::max({sizeof(Models<T>)...});
  int which = -1;
  alignas(8) unsigned char bytes[k_bytes];

  template <class F>
  KOKKOS_INLINE_FUNCTION void visit(F&& f) const {
    int k = 0;
    (void)((which == k++ ? (f(*reinterpret_cast<const Models<T>*>(bytes)), true) : false) || ...);
  }
};

template <class T>
using AnyMaterial = OneOf<T, Materials>;

/// A material by its model's index in Materials and its parameters in the order of the model's table.
template <class T>
AnyMaterial<T> make_material(int which, const std::vector<double>& parameters);

/// Name of each model in the list, in its order.
std::vector<const char*> material_models();

/// lambda + 2 G [Pa] of a material.
double wave_modulus(const AnyMaterial<double>& material);

/// Undrained shear strength [Pa] of a material at a height [m].
double strength_at(const AnyMaterial<double>& material, double height);

}  // namespace mpm
