#pragma once
// The list of materials. To add one: its own header, included here, and its name in the list.

#include "materials/drucker_prager.hpp"
#include "materials/linear_elastic.hpp"
#include "materials/mohr_coulomb.hpp"
#include "materials/tresca.hpp"
#include "materials/von_mises.hpp"

namespace mpm {

template <template <class> class... Models>
struct ModelList {
  static constexpr int k_size = sizeof...(Models);
};

using Materials = ModelList<LinearElastic, VonMises, Tresca, MohrCoulomb, DruckerPrager>;

}  // namespace mpm
