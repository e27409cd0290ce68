#pragma once

#include <string>

namespace mpm {

/// Fault of a file as a shared object: it is no ELF file of this processor, or it has been cut short, which
/// would end the loader with a signal. Empty where the file has no such fault.
std::string fault_of_shared_object(const std::string& path);

}  // namespace mpm
