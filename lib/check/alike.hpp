#pragma once
#include <string>
#include <vector>

namespace mpm {

/// Warnings without those of rigid bodies that differ from an earlier one in the name and in numbers alone:
/// the first says for how many others it holds. A hundred boulders have one line of a kind, not a hundred.
/// Up to three lines that are alike stay.
std::vector<std::string> without_alike(const std::vector<std::string>& lines);

}  // namespace mpm
