#pragma once
// The file of -element_path: the path of a single material point.

#include <string>
#include <vector>

#include "mpm/config.hpp"
#include "physics/materials/tables.hpp"

namespace mpm {

/// The components of stress and strain, in their order.
inline constexpr const char* k_components[6] = {"xx", "yy", "zz", "xy", "yz", "zx"};

/// Reads a path: lines of #, a header, row 0 (the start: stress and, where given, state variables), and rows
/// of increments. Columns: `time` [s] or `dt` [s] of the row; for each component C `eC`, the strain since the
/// start, or `deC`, that of the row, and `dsC` [Pa], the increment of stress of the row, of which a row fills
/// one; sums of such increments, as dsxx+dsyy+dszz (parse_sum); `sC` [Pa] and the state variables of the law,
/// of which row 0 alone counts. A component without columns is not strained. Returns what is wrong, as the
/// end of "takes ..."; empty where nothing is.
std::string read_path(const std::string& file, const std::vector<StateVariable>& state, ElementConfig& path);

}  // namespace mpm
