#pragma once
#include <string>
#include <vector>

namespace mpm {

/// Options of PETSc itself that a run may be given and that PETSc may read later than we look (without their
/// dash).
const std::vector<std::string>& petsc_names();

/// Whether an option (lower case, without its dash) is PETSc's, whether a run takes it or not.
bool is_petsc_name(const std::string& name);

/// Whether a run passes an option (lower case, without its dash) on to PETSc. Those are few, because PETSc's
/// others load libraries, write files anywhere, or wait for a debugger.
bool is_passed_on(const std::string& name);

/// The message of what an option of PETSc takes, where its value is refused; empty where the value is good.
/// The file of -log_view is checked later, after the output folder has been read.
std::string petsc_fault(const std::string& name, const std::string& value);

/// The names of the options that are passed on.
std::vector<std::string> passed_on_names();

}  // namespace mpm
