#pragma once
// A material in a table of a device, for code that runs no law. Code that does includes any.hpp.

#include <cstddef>
#include <vector>

#include "physics/materials/material.hpp"

namespace mpm {

/// State variables that a particle has room for. A law may have as many.
inline constexpr int k_most_state = 4;

/// Room for an AnyMaterial of any law; material_in() of any.hpp gives the material.
template <class T>
struct StoredMaterial {
  static constexpr std::size_t k_room = 16 + 64 * sizeof(T);  // bytes
  alignas(16) unsigned char bytes[k_room];
};

/// make_material() of any.hpp, for a table of a device.
template <class T>
StoredMaterial<T> store_material(int which, const std::vector<double>& parameters);

}  // namespace mpm
