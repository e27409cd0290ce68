#pragma once
// Columns of the free field beside sides of the mesh (Wall::free_field, docs/boundaries.md).

#include "functions/absorbing_sides.hpp"

namespace mpm {

/// Sets up the columns of the sides of s.sides.unknown, at rest, from the soil as it is. `nodes`: the table
/// of the sides' nodes, with the dashpots of absorbing sides in it. Collective.
template <class Space, class T, int Dim>
void begin_columns(State<Space, T, Dim>& s, const std::vector<double>& shear_ratio, const SideRanks& ranks,
                   const std::vector<double>& nodes);

/// Advances all columns by a step of dt [s]; before the nodes of the sides are updated.
template <class Space, class T, int Dim>
void advance_columns(State<Space, T, Dim>& s, double dt);

}  // namespace mpm
