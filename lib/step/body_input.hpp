#pragma once
// Materials, bodies and rigid bodies for the kernels, from the configuration and the particles of the run.

#include <vector>

#include "common/model.hpp"
#include "transfer/upload.hpp"

namespace mpm {

std::vector<MaterialInput> material_input(const Config& config);

/// Speed of shear waves over that of pressure waves in the drained soil of each material [-]; 0 where it has
/// none.
std::vector<double> shear_ratios(const Config& config);

/// All bodies, whose particles have reference heights, and all rigid bodies. Empty `particles`.
template <int Dim>
std::vector<BodyInput> body_input(const Config& config, std::vector<BodyParticles>& particles);
std::vector<RigidInput> rigid_input(const Config& config, std::vector<BodyParticles>& particles);

/// Mass of each rigid body less that of the water it displaces [kg].
std::vector<double> carried_masses(const Config& config, const std::vector<RigidInput>& rigids);

}  // namespace mpm
