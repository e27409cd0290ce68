#include "element/path_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>

#include "common/regular_file.hpp"
#include "common/text.hpp"
#include "element/sum.hpp"

namespace mpm {
namespace {

constexpr double k_largest_stress = 1e15, k_largest_strain = 100, k_largest_part = 0.2,
                 k_largest_state = 1e12;

/// Short names of state variables, as tables of element tests have them.
constexpr const char* k_short_names[][2] = {
    {"xi", "plastic_strain"}, {"Pc", "preconsolidation"}, {"v", "specific_volume"}};

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
  return first == std::string_view::npos ? "" : std::string(text.substr(first, last - first + 1));
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells = split(line);
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

/// Places of the columns in a row; -1 where the file has none.
struct Columns {
  std::vector<std::string> names;
  int time = -1, dt = -1;
  std::array<int, 6> total{}, strain{}, stress_change{}, stress{};
  std::vector<int> state;
  std::vector<int> sums;  // in the order of ElementConfig::sums

  int find(const std::string& name) const {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  }
  bool drives(int c) const { return total[c] >= 0 || strain[c] >= 0 || stress_change[c] >= 0; }
};

int find_state(const Columns& columns, const std::string& name) {
  for (const auto& [brief, full] : k_short_names)
    if (name == full && columns.find(brief) >= 0) return columns.find(brief);
  return columns.find(name);
}

bool is_state(const std::string& name, const std::vector<StateVariable>& state) {
  const auto has = [&](const std::string& word) {
    return std::any_of(state.begin(), state.end(),
                       [&](const auto& variable) { return word == variable.name; });
  };
  return has(name) || std::any_of(std::begin(k_short_names), std::end(k_short_names),
                                  [&](const auto& pair) { return name == pair[0]; });
}

/// Whether a column is of an increment of one component.
bool component_name(const std::string& name) {
  const auto is = [&](const char* c) {
    return name == std::string("de") + c || name == std::string("ds") + c;
  };
  return std::any_of(std::begin(k_components), std::end(k_components), is);
}

/// Fault of the names of a header.
std::string fault_of_names(const std::vector<std::string>& names, const std::vector<StateVariable>& state) {
  std::vector<std::string> known = {"time", "dt"};
  for (const char* prefix : {"e", "de", "ds", "s"})
    for (const char* c : k_components) known.push_back(std::string(prefix) + c);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (std::find(names.begin(), names.begin() + static_cast<long>(k), names[k]) !=
        names.begin() + static_cast<long>(k))
      return "a header that names each column once; " + printable(names[k]) + " is there twice";
    if (std::find(known.begin(), known.end(), names[k]) != known.end() || is_state(names[k], state) ||
        parse_sum(names[k]))
      continue;
    return "a header of the columns time or dt, exx or dexx, dsxx, sxx (and yy, zz, xy, yz, zx), sums as "
           "dsxx+dsyy+dszz or dsyy-0.5*dsxx, and the state variables of the law; \"" +
           printable(names[k]) + "\" is none";
  }
  return "";
}

std::string read_header(const std::string& line, const std::vector<StateVariable>& state, Columns& columns,
                        std::vector<ElementSum>& sums) {
  columns.names = cells_of(line);
  if (std::string fault = fault_of_names(columns.names, state); !fault.empty()) return fault;
  columns.time = columns.find("time"), columns.dt = columns.find("dt");
  if (columns.time >= 0 && columns.dt >= 0) return "a header with time or dt, not both";
  bool drives = false;
  for (int c = 0; c < 6; ++c) {
    const std::string name = k_components[c];
    columns.total[c] = columns.find("e" + name), columns.strain[c] = columns.find("de" + name);
    columns.stress_change[c] = columns.find("ds" + name), columns.stress[c] = columns.find("s" + name);
    if (columns.total[c] >= 0 && columns.strain[c] >= 0)
      return "a header with e" + name + " or de" + name + ", not both";
    drives |= columns.drives(c);
  }
  for (std::size_t k = 0; k < columns.names.size(); ++k) {
    const auto sum = parse_sum(columns.names[k]);
    if (!sum || component_name(columns.names[k])) continue;
    columns.sums.push_back(static_cast<int>(k)), sums.push_back(*sum);
  }
  if (!drives && sums.empty())
    return "a header with at least one column of strain or of stress increments, as exx, dexx or dsxx";
  for (const StateVariable& variable : state) columns.state.push_back(find_state(columns, variable.name));
  return "";
}

/// The numbers of a row; none where a cell is empty.
struct Row {
  long line;  // of the file
  std::vector<std::optional<double>> values;

  std::optional<double> at(int column) const { return column < 0 ? std::nullopt : values[column]; }
  std::string where() const { return " in line " + std::to_string(line); }
};

std::string read_row(const std::string& line, const Columns& columns, Row& row) {
  const std::vector<std::string> cells = cells_of(line);
  if (cells.size() != columns.names.size())
    return "rows of " + std::to_string(columns.names.size()) + " numbers, as the header has columns;" +
           row.where() + " there are " + std::to_string(cells.size());
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto number = cells[k].empty() ? std::nullopt : parse_number(cells[k]);
    if (!cells[k].empty() && !number)
      return "finite numbers;" + row.where() + " " + columns.names[k] + " is \"" + printable(cells[k]) + "\"";
    row.values.push_back(number);
  }
  return "";
}

/// Row 0: where the path starts. `strain` gets the strain from which those of later rows count.
std::string read_start(const Row& row, const Columns& columns, Sym6& strain, ElementConfig& path) {
  if (columns.time >= 0 && !row.at(columns.time))
    return "a time in each row;" + row.where() + " there is none";
  path.time = row.at(columns.time).value_or(0);
  for (int c = 0; c < 6; ++c) {
    const std::string name = k_components[c];
    strain[c] = row.at(columns.total[c]).value_or(0);
    path.stress[c] = row.at(columns.stress[c]).value_or(0);
    if (row.at(columns.strain[c]).value_or(0) != 0 || row.at(columns.stress_change[c]).value_or(0) != 0)
      return "row 0 without increments, since it is the start;" + row.where() + " there is one of " + name;
    if (!(std::fabs(path.stress[c]) <= k_largest_stress))
      return "stresses of at most 1e15 Pa;" + row.where() + " s" + name + " is larger";
  }
  for (const int column : columns.sums)
    if (row.at(column).value_or(0) != 0)
      return "row 0 without increments, since it is the start;" + row.where() + " there is one of " +
             columns.names[column];
  for (std::size_t k = 0; k < columns.state.size(); ++k) {
    const auto value = row.at(columns.state[k]);
    if (!value) continue;
    if (!(std::fabs(*value) <= k_largest_state))
      return "state variables of at most 1e12;" + row.where() + " " + columns.names[columns.state[k]] +
             " is larger";
    path.state.emplace_back(static_cast<int>(k), *value);
  }
  return "";
}

/// The sums that a row governs.
std::string read_sums(const Row& row, const Columns& columns, int parts, const std::vector<ElementSum>& sums,
                      ElementRow& to) {
  for (std::size_t k = 0; k < sums.size(); ++k) {
    to.sums.push_back(row.at(columns.sums[k]));
    double weights = 0;
    for (const double weight : sums[k].weight) weights += std::fabs(weight);
    const double most = weights * (sums[k].of_strain ? k_largest_part * parts : k_largest_stress);
    if (std::fabs(to.sums[k].value_or(0)) <= most) continue;
    return "increments of sums of at most " + text_of(most) + ";" + row.where() + " that of " + sums[k].name +
           " is larger";
  }
  return "";
}

/// Whether sums that a row governs hold component c.
bool in_sums(const ElementRow& row, const std::vector<ElementSum>& sums, int c) {
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (row.sums[k] && sums[k].weight[c] != 0) return true;
  return false;
}

/// Reads what drives component c over a row; returns a fault. `known` is the strain of c as long as strains
/// alone have driven it.
std::string read_component(const Row& row, const Columns& columns, int c, int parts,
                           std::optional<double>& known, const std::vector<ElementSum>& sums,
                           ElementRow& to) {
  const std::string name = k_components[c];
  const auto total = row.at(columns.total[c]), increment = row.at(columns.strain[c]),
             stress = row.at(columns.stress_change[c]);
  const bool by_strain = total || increment;
  if (by_strain && stress)
    return "a strain or a stress increment for each component, not both;" + row.where() + " " + name +
           " has both";
  if (!by_strain && !stress && in_sums(to, sums, c)) {
    known.reset(), to.drive[c] = Drive::free;
    return "";
  }
  if (!by_strain && !stress && columns.drives(c))
    return "a strain or a stress increment for each component that has columns;" + row.where() + " " + name +
           " has none";
  to.drive[c] = stress ? Drive::stress : total ? Drive::total_strain : Drive::strain;
  to.value[c] = stress ? *stress : total ? *total : increment.value_or(0);
  if (stress) {
    known.reset();
    if (std::fabs(*stress) <= k_largest_stress) return "";
    return "stress increments of at most 1e15 Pa;" + row.where() + " ds" + name + " is larger";
  }
  if (!(std::fabs(to.value[c]) <= k_largest_strain))
    return "strains of at most 100;" + row.where() + " that of " + name + " is larger";
  const double change = total ? *total - known.value_or(*total) : to.value[c];
  if (std::fabs(change) > k_largest_part * parts)
    return "rows of which each part, 1/" + std::to_string(parts) +
           " by -element_parts, strains by at most 0.2;" + row.where() + " " + name + " changes by " +
           text_of(change);
  if (total)
    known = total;
  else if (known)
    *known += change;
  return "";
}

/// How long a row takes. `time` is that of the row before.
std::string read_time(const Row& row, const Columns& columns, double& time, ElementRow& to) {
  if (columns.time < 0 && columns.dt < 0) return "";
  const auto given = row.at(columns.time >= 0 ? columns.time : columns.dt);
  if (!given) return "a time in each row;" + row.where() + " there is none";
  to.dt = columns.time >= 0 ? *given - time : *given;
  if (!(to.dt > 0) || !(to.dt <= 1e15))
    return std::string(columns.time >= 0 ? "times that grow from row to row;"
                                         : "durations dt greater than 0;") +
           row.where() + " it is " + text_of(*given);
  time = *given;
  return "";
}

/// The lines of a file that are not empty and no comments, with their numbers.
std::string read_lines(const std::string& file, std::vector<std::pair<long, std::string>>& lines) {
  if (std::string fault = irregular_fault(file); !fault.empty()) return fault;
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::string("a file that can be read; this cannot: ") + std::strerror(errno);
  long number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);  // as spreadsheets begin files
    line = trimmed(line);
    if (!line.empty() && line[0] != '#') lines.emplace_back(number, line);
  }
  if (in.bad()) return "a file that can be read to its end";
  if (lines.size() < 3) return "a file with a header, row 0 (the start) and a row of increments at least";
  return "";
}

}  // namespace

std::string read_path(const std::string& file, const std::vector<StateVariable>& state, ElementConfig& path) {
  std::vector<std::pair<long, std::string>> lines;
  Columns columns;
  std::string fault = read_lines(file, lines);
  if (fault.empty()) fault = read_header(lines[0].second, state, columns, path.sums);
  Sym6 start{};
  std::array<std::optional<double>, 6> known;
  double time = 0;
  for (std::size_t n = 1; n < lines.size() && fault.empty(); ++n) {
    Row row{lines[n].first, {}};
    fault = read_row(lines[n].second, columns, row);
    if (!fault.empty()) break;
    if (n == 1) {
      fault = read_start(row, columns, start, path);
      for (int c = 0; c < 6; ++c) known[c] = start[c];
      time = path.time;
      continue;
    }
    ElementRow& to = path.rows.emplace_back();
    to.line = row.line;
    fault = read_time(row, columns, time, to);
    if (fault.empty()) fault = read_sums(row, columns, path.parts, path.sums, to);
    for (int c = 0; c < 6 && fault.empty(); ++c) {
      fault = read_component(row, columns, c, path.parts, known[c], path.sums, to);
      if (to.drive[c] == Drive::total_strain) to.value[c] -= start[c];
    }
    if (fault.empty()) fault = fault_of_sums(to, path.sums);
  }
  path.timed = columns.time >= 0 || columns.dt >= 0;
  return fault;
}

}  // namespace mpm
