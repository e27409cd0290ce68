#pragma once
#include <string>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Whether two bodies have nodes in common at the start: less than a cell is between their bounds. The places
/// of a file's particles are unknown here.
bool touch(const Config& config, const BodyConfig& a, const BodyConfig& b);

/// Excavations of a stage that fill with water: a line for each ("warning: ...").
std::vector<std::string> warnings_of_excavations(const Config& config);

/// Warnings of bodies of -contact_pairs that are too thin for their cells.
std::vector<std::string> warnings_of_pairs(const Config& config);

/// Warnings of water that flows in pores: a stiffness that costs answers or time, flow beyond Darcy's law,
/// soil from which grains and water may part.
std::vector<std::string> warnings_of_pores(const Config& config);

/// Line of the log for deformable bodies that touch or may meet; empty where none do.
std::string note_of_touching(const Config& config);

}  // namespace mpm
