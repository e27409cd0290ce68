#pragma once
// Water that does not flow. The pore pressure is u = u_h + u_e: hydrostatic by the depth below a level, and
// in excess of that what undrained loading adds, du_e = -K d(volume strain) with the stiffness K of the water
// in the pores (Naylor 1974). Compression is positive for u.
//
// The stress of a particle is s = sigma + u_h I = sigma' - u_e I, total stress in excess of hydrostatic. The
// gradient of u_h balances the weight of the water that the soil displaces, so that rho a = div s +
// (rho - rho_w) g below the level, and s n = 0 on a surface that only water touches.

#include "base/lanes.hpp"
#include "data/water.hpp"

namespace mpm {

/// Adds a pressure [Pa] times the unit tensor to a stress.
template <class R, int Dim>
KOKKOS_INLINE_FUNCTION void add_isotropic(SymTensor<R, Dim>& s, const R& pressure) {
  for (int d = 0; d < 3; ++d) s[d] += pressure;
}

/// Excess pore pressure [Pa] behind a step without flow, from that before it and the step's strain; the
/// stiffness is that of the pore water [Pa].
template <class R, class T, int Dim>
KOKKOS_INLINE_FUNCTION R undrained_pressure(const R& excess, T stiffness, const SymTensor<R, Dim>& strain) {
  return excess - stiffness * (strain[0] + strain[1] + strain[2]);
}

}  // namespace mpm
