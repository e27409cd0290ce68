#pragma once
// The list of materials. To add one: its own header, included here, and its name in the list.

#include <type_traits>

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

/// Laws whose update takes few registers and instructions. A GPU has kernels for them alone, so that the
/// others cost them nothing (docs/development/gpu_laws.md).
using LightMaterials = ModelList<LinearElastic, VonMises>;

/// Laws whose update takes many registers and instructions.
using HeavyMaterials = ModelList<Tresca, MohrCoulomb, CamClay, SofteningClay>;

/// Laws for which a GPU has a kernel of their own, for common patches of soil that has no other law. Kernels
/// that do not sum ahead are for HeavyMaterials alone.
using SingleMaterials = ModelList<Tresca, MohrCoulomb, DruckerPrager, MuI, Newtonian, YieldStressFluid,
                                  PowerElastic, J2Hardening, CamClay, SofteningClay>;

/// Index in Materials of a model.
template <template <class> class Model, template <class> class... Models>
constexpr int model_index_in(ModelList<Models...>) {
  constexpr bool same[] = {std::is_same_v<Model<double>, Models<double>>...};
  int k = 0;
  while (!same[k]) ++k;
  return k;
}

/// Whether the model of this index in Materials is in a list.
template <template <class> class... Models>
constexpr bool has_model(ModelList<Models...>, int which) {
  return ((model_index_in<Models>(Materials{}) == which) || ...);
}

/// Whether a law is one of LightMaterials.
template <class Law>
constexpr bool is_light() {
  return []<template <class> class... Models>(ModelList<Models...>) {
    return (std::is_same_v<Law, Models<typename Law::real>> || ...);
  }(LightMaterials{});
}

}  // namespace mpm
