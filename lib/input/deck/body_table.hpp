#pragma once
// Tables of rigid bodies (-rigid_bodies_file).

#include <string>
#include <utility>
#include <vector>

namespace mpm {

/// A row of a table: the name of a body, and its options with their values.
struct RowOptions {
  std::string name;
  std::vector<std::pair<std::string, std::string>> options;
};

/// The rows of a table in CSV: a line of keys, of which the first is `name`, and a line for each body. The
/// key KEY of a body NAME is the option -NAME_KEY; an empty cell gives none, and blanks stand between the
/// numbers of a list. `fault` is the end of a message "takes ..." where the text is no such table.
std::vector<RowOptions> rows_of_bodies(const std::string& text, std::string* fault);

}  // namespace mpm
