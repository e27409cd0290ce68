#pragma once
// Stiffness of the soil at sides with dashpots, in its present state.

#include <vector>

#include "base/copy.hpp"
#include "data/particles.hpp"
#include "physics/materials/any.hpp"
#include "physics/pore_water.hpp"

namespace mpm {

/// Wave modulus and shear modulus of drained soil, and the stiffness of pore water that does not flow [Pa].
struct SideModuli {
  double wave, shear, pore;
};

/// Moduli of particle p. shear_ratio [-]: speed of shear waves over that of pressure waves in its material.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION SideModuli side_moduli(const Soil<Space, T, Dim>& soil, double shear_ratio, int p) {
  const AnyMaterial<T>& material = material_in(soil.materials(soil.properties(p).material));
  SymTensor<T, Dim> stress = soil.stress(p);
  add_isotropic(stress, soil.excess_pore_pressure(material, p));
  double wave = 0;
  material.visit([&](const auto& law) { wave = law.wave_modulus(stress, soil.state_of(law, p)); });
  return {wave, shear_ratio * shear_ratio * wave, double(material.pore_stiffness)};
}

/// shear_ratio by material, for kernels.
template <class Space>
Kokkos::View<double*, typename Space::memory_space> shear_ratios(const std::vector<double>& ratio) {
  Kokkos::View<double*, typename Space::memory_space> view("mpm::shear_ratio", ratio.size());
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t m = 0; m < ratio.size(); ++m) host(m) = ratio[m];
  copy(view, host);
  return view;
}

}  // namespace mpm
