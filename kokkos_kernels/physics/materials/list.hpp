#pragma once
// The list of materials. To add one: its own header, included here, and its name in the list.

#include "physics/materials/cam_clay.hpp"
#include "physics/materials/drucker_prager.hpp"
#include "physics/materials/j2_hardening.hpp"
#include "physics/materials/linear_elastic.hpp"
#include "physics/materials/mohr_coulomb.hpp"
#include "physics/materials/mu_i.hpp"
#include "physics/materials/newtonian.hpp"
#include "physics/materials/power_elastic.hpp"
#include "physics/materials/softening_clay.hpp"
#include "physics/materials/tresca.hpp"
#include "physics/materials/umat.hpp"
#include "physics/materials/von_mises.hpp"
#include "physics/materials/yield_stress_fluid.hpp"

namespace mpm {

template <template <class> class... Models>
struct ModelList {
  static constexpr int k_size = sizeof...(Models);
};

using Materials = ModelList<LinearElastic, VonMises, Tresca, MohrCoulomb, DruckerPrager, MuI, Newtonian,
                            YieldStressFluid, PowerElastic, J2Hardening, CamClay, SofteningClay, Umat>;

}  // namespace mpm
