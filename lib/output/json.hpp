#pragma once
// Text and numbers as JSON (RFC 8259).

#include <string>
#include <string_view>

namespace mpm {

/// Text as a JSON string. A path may hold any bytes; those that are no UTF-8 become the replacement
/// character.
std::string json_text(std::string_view text);

/// The shortest number that is read back to the same bits; null where it is not finite, for which JSON has no
/// word.
std::string json_number(double value);

}  // namespace mpm
