#include "common/text_file.hpp"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/host_memory.hpp"
#include "common/regular_file.hpp"
#include "common/text.hpp"

namespace mpm {

std::string read_whole(const std::string& path, double copies, std::string& text) {
  if (const std::string fault = irregular_fault(path); !fault.empty()) return fault;
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::string("a file that can be read: ") + std::strerror(errno);
  std::error_code error;
  const double bytes = static_cast<double>(std::filesystem::file_size(path, error)),
               free = free_host_memory();
  if (error) return "a file that can be read: " + error.message();
  if (const double needed = (1 + copies) * bytes; free > 0 && needed > free)
    return formatted("a file that fits into memory: it needs about %.4g GB, and %.4g GB are free",
                     needed / 1e9, free / 1e9);
  text.resize(static_cast<std::size_t>(bytes));
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return "";
}

std::string_view Words::next() {
  const auto blank = [](char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
  };
  std::size_t first = 0;
  for (; first < rest_.size() && blank(rest_[first]); ++first) line_ += rest_[first] == '\n';
  std::size_t last = first;
  while (last < rest_.size() && !blank(rest_[last])) ++last;
  const std::string_view word = rest_.substr(first, last - first);
  rest_.remove_prefix(last);
  return word;
}

void Words::skip_line() {
  const std::size_t end = rest_.find('\n');
  rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end);
}

std::optional<double> Words::number() {
  std::string_view word = next();
  if (!word.empty() && word[0] == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace mpm
