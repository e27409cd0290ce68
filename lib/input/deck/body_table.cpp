#include "input/deck/body_table.hpp"

#include <cctype>

#include "common/text.hpp"
#include "input/deck/deck.hpp"

namespace mpm {
namespace {

/// A cell without the blanks around it, and with commas for those between words.
std::string list_of(const std::string& cell) {
  std::string out;
  bool gap = false;
  for (const char c : cell) {
    if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      gap = !out.empty();
      continue;
    }
    if (gap) out += ',';
    gap = false;
    out += c;
  }
  return out;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (const std::string& cell : split(line, ',')) cells.push_back(list_of(cell));
  return cells;
}

}  // namespace

std::vector<RowOptions> rows_of_bodies(const std::string& text, std::string* fault) {
  std::vector<RowOptions> rows;
  std::vector<std::string> keys;
  int number = 0;
  if (!fault->empty()) return rows;
  for (const std::string& line : split(text, '\n')) {
    ++number;
    if (list_of(line).empty() || list_of(line)[0] == '#') continue;
    const std::vector<std::string> cells = cells_of(line);
    if (keys.empty()) {
      keys = cells;
      if (keys[0] != "name") *fault = "a CSV file whose first column is name";
      continue;
    }
    RowOptions row{cells[0], {}};
    if (cells.size() != keys.size())
      *fault = "a CSV file with " + std::to_string(keys.size()) + " cells in line " + std::to_string(number);
    for (std::size_t k = 1; k < cells.size() && fault->empty(); ++k) {
      const std::string option = "-" + row.name + "_" + keys[k];
      if (!is_option_name(option))
        *fault = "a CSV file with names of bodies and keys of options in line " + std::to_string(number);
      else if (!cells[k].empty())
        row.options.emplace_back(option, cells[k]);
    }
    rows.push_back(row);
  }
  if (fault->empty() && rows.empty()) *fault = "a CSV file with a row for each rigid body";
  return rows;
}

}  // namespace mpm
