#pragma once
// Files that can be read twice and have an end: a pipe or a device may let the program wait for ever.

#include <string>

namespace mpm {

/// Fault of a path, as the end of "takes ..."; empty where it is a regular file or nothing.
std::string irregular_fault(const std::string& path);

}  // namespace mpm
