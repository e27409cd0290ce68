#pragma once
#include <string>
#include <vector>

namespace mpm {

/// Options of PETSc itself that a run may be given and that PETSc may read later than we look (without their
/// dash).
const std::vector<std::string>& petsc_names();

/// Whether an option (lower case, without its dash) is PETSc's.
bool is_petsc_name(const std::string& name);

}  // namespace mpm
