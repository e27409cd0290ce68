#include "common/regular_file.hpp"

#include <filesystem>
#include <system_error>

namespace mpm {

std::string irregular_fault(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  switch (fs::status(path, error).type()) {
    case fs::file_type::none:
    case fs::file_type::not_found:
    case fs::file_type::unknown:
    case fs::file_type::regular: return "";
    case fs::file_type::directory: return "a regular file; this is a folder";
    case fs::file_type::fifo: return "a regular file; this is a pipe";
    case fs::file_type::socket: return "a regular file; this is a socket";
    default: return "a regular file; this is a device";
  }
}

}  // namespace mpm
