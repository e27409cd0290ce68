#pragma once
// The soil of a State from columns on the host.

#include <vector>

#include "transfer/upload.hpp"

namespace mpm {

/// Fills the vectors of the soil, and what bodies and materials have in common. scratch: bytes that sorting
/// anything else takes. fault: of the first particle outside the mesh.
template <class Space, class T, int Dim>
void upload_soil(Core<Space, T, Dim>& s, const std::vector<MaterialInput>& materials,
                 const std::vector<BodyInput>& bodies, std::size_t scratch, Fault& fault);

}  // namespace mpm
