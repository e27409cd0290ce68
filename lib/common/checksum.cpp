#include "common/checksum.hpp"

#include <zlib.h>

namespace mpm {

std::uint32_t checksum(std::uint32_t crc, std::string_view text) {
  if (text.empty()) return crc;
  return static_cast<std::uint32_t>(::crc32_z(crc, reinterpret_cast<const Bytef*>(text.data()), text.size()));
}

}  // namespace mpm
