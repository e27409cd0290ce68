#pragma once

#include <string>

namespace mpm {

/// What keeps the loader from a file: it is no ELF file of this processor, or it has been cut short, which
/// the loader meets with a signal. Empty where nothing does.
std::string fault_of_shared_object(const std::string& path);

}  // namespace mpm
