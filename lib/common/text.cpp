#include "common/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace mpm {
namespace {

template <class Value>
std::optional<Value> parse_whole(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Value value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<long> parse_integer(std::string_view text) { return parse_whole<long>(text); }

std::string formatted(const char* format, ...) {
  char buffer[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

std::string text_of(std::span<const double> x) {
  std::vector<std::string> pieces;
  for (const double number : x) pieces.push_back(text_of(number));
  return join(pieces);
}

std::string text_of(const std::array<double, 3>& x, int dim) { return text_of(std::span(x).first(dim)); }

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> pieces;
  for (;;) {
    const auto end = text.find(separator);
    pieces.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return pieces;
    text.remove_prefix(end + 1);
  }
}

std::string join(const std::vector<std::string>& pieces, std::string_view separator) {
  std::string all;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (k > 0) all += separator;
    all += pieces[k];
  }
  return all;
}

std::string printable(std::string_view text) {
  constexpr std::size_t k_most = 100;
  std::string shown(text.substr(0, k_most));
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return shown + (text.size() > k_most ? "..." : "");
}

std::string one_of(const std::vector<std::string>& words) {
  if (words.size() < 2) return join(words);
  return join({words.begin(), words.end() - 1}, ", ") + " or " + words.back();
}

std::string side_option(int d, int side) {
  return std::string("mesh_") + "xyz"[d] + (side == 0 ? "min" : "max");
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 0x7f; });
}

std::string visible(std::string_view text) {
  constexpr const char* k_digits = "0123456789abcdef";
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (!has_control({&c, 1}))
      out += c;
    else if (c == '\n' || c == '\t' || c == '\r')
      out += c == '\n' ? "\\n" : c == '\t' ? "\\t" : "\\r";
    else
      out.append("\\x").append(1, k_digits[byte >> 4]).append(1, k_digits[byte & 15]);
  }
  return out;
}

int edit_distance(std::string_view a, std::string_view b) {
  const int rows = static_cast<int>(a.size()), columns = static_cast<int>(b.size());
  std::vector<std::vector<int>> d(rows + 1, std::vector<int>(columns + 1));  // of the first i and j letters
  for (int i = 0; i <= rows; ++i) d[i][0] = i;
  for (int j = 0; j <= columns; ++j) d[0][j] = j;
  for (int i = 1; i <= rows; ++i)
    for (int j = 1; j <= columns; ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[rows][columns];
}

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& words) {
  const int furthest = std::max(2, static_cast<int>(word.size()) / 3);
  std::optional<std::string> best;
  int best_distance = furthest + 1;
  for (const auto& candidate : words) {
    const int distance = edit_distance(lower_case(word), lower_case(candidate));
    if (distance < best_distance) best = candidate, best_distance = distance;
  }
  return best;
}

}  // namespace mpm
