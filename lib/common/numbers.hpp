#pragma once
// Numbers as text that reads back to the same bits.

#include <charconv>
#include <string>

namespace mpm {

/// The shortest text that reads back to the same number.
inline std::string text_of(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

}  // namespace mpm
