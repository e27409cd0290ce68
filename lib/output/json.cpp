#include "output/json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace mpm {
namespace {

/// Bytes of the UTF-8 character that a text begins with; 0 where it begins with none (RFC 3629).
size_t utf8_length(std::string_view text) {
  const auto byte = [&](size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned first = byte(0), second = byte(1);
  const size_t length = first < 0x80   ? 1
                        : first < 0xc2 ? 0
                        : first < 0xe0 ? 2
                        : first < 0xf0 ? 3
                        : first < 0xf5 ? 4
                                       : 0;
  for (size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  const bool overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool no_character = (first == 0xed && second >= 0xa0) || (first == 0xf4 && second >= 0x90);
  return overlong || no_character ? 0 : length;
}

}  // namespace

std::string json_text(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const size_t length = utf8_length(text);
    const std::string_view one = text.substr(0, std::max<size_t>(length, 1));
    text.remove_prefix(one.size());
    if (length == 0)
      out += "\\ufffd";
    else if (one == "\"" || one == "\\")
      out.append("\\").append(one);
    else
      out += static_cast<unsigned char>(one[0]) < ' ' ? " " : one;
  }
  return out + "\"";
}

std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  char digits[32];  // a double has at most 24
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

}  // namespace mpm
