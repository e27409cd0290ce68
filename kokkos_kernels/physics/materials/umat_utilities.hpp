#pragma once

namespace mpm {

/// Links the utility routines that UMATs call (SINV, SPRINC, SPRIND, ROTSIG, XIT and others) into the
/// program, whose symbols umat_symbols.txt exports.
void keep_umat_utilities();

}  // namespace mpm
