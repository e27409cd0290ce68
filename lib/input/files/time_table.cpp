#include "input/files/time_table.hpp"

#include <algorithm>

#include "common/text.hpp"
#include "common/text_file.hpp"

namespace mpm {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? "" : std::string(text.substr(first, last - first + 1));
}

/// Where a point stands, for messages.
struct Place {
  const char* what;  // point, or line
  long number;
  std::string text() const { return formatted("%s %ld", what, number); }
};

/// Adds a point from its cells; returns what the table should be where they are none.
std::string add_point(const std::vector<std::string>& cells, const Place& place, int dim, TableText& read) {
  const int columns = static_cast<int>(cells.size()) - 1;
  if (columns != 1 && columns != dim)
    return formatted("%s in each point; %s has %zu number%s",
                     dim == 1 ? "a time and a number"
                              : formatted("a time and %d components, or a time and a factor,", dim).c_str(),
                     place.text().c_str(), cells.size(), cells.size() == 1 ? "" : "s");
  if (read.columns != 0 && columns != read.columns)
    return formatted("as many numbers in each point; %s has %d, those before it %d", place.text().c_str(),
                     columns + 1, read.columns + 1);
  read.columns = columns;
  std::vector<double> numbers;
  for (const std::string& cell : cells) {
    const auto number = parse_number(cell);
    if (!number)
      return formatted("a number in each place; number %zu of %s is %s", numbers.size() + 1,
                       place.text().c_str(),
                       cell.empty() ? "missing" : ("\"" + printable(cell) + "\"").c_str());
    numbers.push_back(*number);
  }
  auto& [times, values, smooth, file] = read.table;
  if (!times.empty() && numbers[0] <= times.back())
    return formatted("times that increase; %s is at %.9g s, after %.9g s", place.text().c_str(), numbers[0],
                     times.back());
  times.push_back(numbers[0]);
  Vec3 value{};
  for (int d = 0; d < dim; ++d) value[d] = numbers[columns == 1 ? 1 : 1 + d];
  values.push_back(value);
  return "";
}

std::string read_inline(const std::string& text, int dim, TableText& read) {
  long number = 0;
  for (const std::string& point : split(text))
    if (std::string fault = add_point(split(point, ':'), {"point", ++number}, dim, read); !fault.empty())
      return fault;
  return "";
}

/// Whether a row is a header: it has a cell, and none of its cells is a number.
bool is_header(const std::vector<std::string>& cells) {
  return std::none_of(cells.begin(), cells.end(),
                      [](const std::string& cell) { return cell.empty() || parse_number(cell); });
}

std::string read_csv(const std::string& path, int dim, TableText& read) {
  std::string text;
  constexpr double k_copies = 4;  // of a number's text
  if (std::string fault = read_whole(path, k_copies, text); !fault.empty()) return fault;
  read.table.file = path;
  long number = 0;
  bool begun = false;
  for (const std::string& line : split(text, '\n')) {
    ++number;
    const std::string row = trimmed(line);
    if (row.empty() || row[0] == '#') continue;
    std::vector<std::string> cells = split(row);
    for (std::string& cell : cells) cell = trimmed(cell);
    const bool header = !begun && is_header(cells);
    begun = true;
    if (header) continue;
    if (std::string fault = add_point(cells, {"line", number}, dim, read); !fault.empty()) return fault;
  }
  return "";
}

/// Whether a text lists points itself: a number and a colon come first.
bool is_inline(const std::string& text) {
  const std::string first = split(text)[0];
  const auto colon = first.find(':');
  return colon != std::string::npos && parse_number(first.substr(0, colon));
}

}  // namespace

std::string read_table(const std::string& text, int dim, double end, TableText& read) {
  std::string fault = is_inline(text) ? read_inline(text, dim, read) : read_csv(text, dim, read);
  if (!fault.empty()) return fault;
  const auto& times = read.table.times;
  constexpr double k_round_off = 1e-12;
  if (times.size() < 2)
    return formatted("two points or more; there %s", times.empty() ? "is none" : "is one");
  if (times.front() > 0) return formatted("a first point at 0 s or earlier; it is at %.9g s", times.front());
  if (times.back() < end * (1 - k_round_off))
    return formatted("a last point at the end of the run, %.9g s, or later; it is at %.9g s", end,
                     times.back());
  return "";
}

}  // namespace mpm
