#pragma once
// A material in a table of a device, for code that runs no law. Code that does includes any.hpp.

#include <cstddef>
#include <vector>

#include "base/spaces.hpp"
#include "physics/materials/material.hpp"

namespace mpm {

/// State variables that a particle has room for. A law may have as many; one that runs on processors alone
/// (k_host_double) as many as k_most_state_on_host.
inline constexpr int k_most_state_on_device = 5, k_most_state_on_host = 74;
template <class Space>
inline constexpr int k_most_state = is_device<Space> ? k_most_state_on_device : k_most_state_on_host;

/// Room for an AnyMaterial of any law; material_in() of any.hpp gives the material.
template <class T>
struct StoredMaterial {
  static constexpr std::size_t k_room = 16 + 64 * sizeof(T);  // bytes
  alignas(16) unsigned char bytes[k_room];
  T f_bar_share = 1;  // of the run's fraction of F-bar, FBar::fraction
};

/// make_material() of any.hpp, for a table of a device. pore_stiffness [Pa]: of water in its pores that does
/// not flow; saturated: water flows there.
template <class T>
StoredMaterial<T> store_material(int which, const std::vector<double>& parameters, const void* object,
                                 double pore_stiffness, bool saturated = false);

}  // namespace mpm
