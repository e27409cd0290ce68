#pragma once
// Checksums of what must read back as it was written.

#include <cstdint>
#include <string_view>

namespace mpm {

/// CRC-32 of `text` behind a text that has `crc`; 0 for none.
std::uint32_t checksum(std::uint32_t crc, std::string_view text);

}  // namespace mpm
