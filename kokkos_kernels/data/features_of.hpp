#pragma once
// Features of a run that limit how its steps may be done.

#include <iterator>
#include <utility>

#include "base/step_features.hpp"
#include "data/state.hpp"

namespace mpm {

/// The features of a run as they are until the next rebuild.
template <class Space, class T, int Dim>
Features features_of(const State<Space, T, Dim>& s) {
  using F = Feature;
  const std::pair<F, bool> all[] = {{F::other_strategy, chosen(s.p2g.strategy) != P2G::tile},
                                    {F::xpic, s.scheme.xpic_order > 0},
                                    {F::apic, s.soil.points.has_affine},
                                    {F::splits, s.soil.points.splits},
                                    {F::correction, s.correction.on},
                                    {F::saturated, s.flow.in_use()},
                                    {F::submerged, s.water.is_there()},
                                    {F::energy, s.energy.on},
                                    {F::loads, s.loads.in_use()},
                                    {F::rayleigh, s.scheme.rayleigh},
                                    {F::damping, s.scheme.damping > 0},
                                    {F::shear_fraction, s.shear_fraction},
                                    {F::friction, s.has_friction},
                                    {F::acting_sides, s.sides.in_use()},
                                    {F::columns, s.sides.has_columns()},
                                    {F::gravity_table, s.timed.moves_gravity},
                                    {F::side_table, s.timed.moves_sides},
                                    {F::contact_sites, s.at_sites.in_use},
                                    {F::interfaces, s.interfaces.in_use()},
                                    {F::pushed_mass_normals, s.rigid_dynamic && s.mass_normals},
                                    {F::turning_rigids, s.rigid_turns},
                                    {F::many_rigids, s.contact.near.listed},
                                    {F::rigid_pairs, s.pairs.in_use()},
                                    {F::linked_rigids, s.links.in_use()},
                                    {F::light_rigids, s.light_rigids.in_use},
                                    {F::united_rigids, s.vertices.has_parts()},
                                    {F::revolved, s.soil.points.rings},
                                    {F::ranks, s.owned_nodes.extent(0) > 0},
                                    {F::batches, s.batches.in_use()}};
  static_assert(std::size(all) == static_cast<std::size_t>(F::count));
  Features features;
  for (const auto& [feature, on] : all) features.put(feature, on);
  return features;
}

}  // namespace mpm
