#pragma once
// Dashpots and static reactions of absorbing sides, from the soil where it is when they begin to absorb.

#include <functional>
#include <vector>

#include "data/state.hpp"

namespace mpm {

/// Sums over the ranks of a run, and the largest of them; both leave the value of one rank as it is where
/// there is none other.
struct SideRanks {
  std::function<void(long long*, int)> sum = [](long long*, int) {};
  std::function<void(double*)> largest = [](double*) {};
};

/// Sets what the sides with dashpots of s.sides.unknown need. The nodal sums are those of the soil as it is
/// (sum_present_soil), of all ranks. shear_ratio [-]: speed of shear waves over that of pressure waves in the
/// drained soil of each material. Collective.
template <class Space, class T, int Dim>
void begin_absorbing(State<Space, T, Dim>& s, const std::vector<double>& shear_ratio, const SideRanks& ranks);

}  // namespace mpm
