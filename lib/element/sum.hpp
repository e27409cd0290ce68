#pragma once
// Weighted sums of components, which a path may govern in lieu of single components.

#include <optional>
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// The sum that a column of this name governs: increments of stress, or of strain, with + and - between them
/// and factors before them, as dsxx+dsyy+dszz or dsyy-0.5*dsxx. None where the name is no such sum.
std::optional<ElementSum> parse_sum(const std::string& name);

/// Fault of the sums that a row governs; empty where there is none. A row governs as many sums as it leaves
/// components free, and none of its stresses and sums follows from the others.
std::string fault_of_sums(const ElementRow& row, const std::vector<ElementSum>& sums);

}  // namespace mpm
