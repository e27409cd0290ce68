#pragma once
// Tables in time from text.

#include <string>

#include "mpm/config.hpp"

namespace mpm {

/// Points of a table as text: in one line, as 0:0:0,1:2:3 (time and the components, with colons), or the name
/// of a CSV file of these columns, which may have a header and lines of #. A table has `dim` components, or
/// one factor for all of them (columns).
struct TableText {
  TimeTable table;
  int columns = 0;
};

/// Reads a table. Returns what it should be, as the end of "takes ...", empty where it is sound: its times
/// increase and go from 0 or earlier to `end` [s] or later, no number is missing, and there are at least two
/// points.
std::string read_table(const std::string& text, int dim, double end, TableText& read);

}  // namespace mpm
