#pragma once
// The list of materials. To add one: its own header, included here, and its name in the list.

#include "materials/cam_clay.hpp"
#include "materials/drucker_prager.hpp"
#include "materials/j2_hardening.hpp"
#include "materials/linear_elastic.hpp"
#include "materials/mohr_coulomb.hpp"
#include "materials/mu_i.hpp"
#include "materials/newtonian.hpp"
#include "materials/power_elastic.hpp"
#include "materials/softening_clay.hpp"
#include "materials/tresca.hpp"
#include "materials/von_mises.hpp"
#include "materials/yield_stress_fluid.hpp"

namespace mpm {

template <template <class> class... Models>
struct ModelList {
  static constexpr int k_size = sizeof...(Models);
};

using Materials = ModelList<LinearElastic, VonMises, Tresca, MohrCoulomb, DruckerPrager, MuI, Newtonian,
                            YieldStressFluid, PowerElastic, J2Hardening, CamClay, SofteningClay>;

}  // namespace mpm
