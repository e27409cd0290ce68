// -NAME_table of loads and motions.

#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/files/time_table.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

/// Multiplies a constant by the factors of a table of one column. False where the constant is missing.
bool scale(OptionReader& in, const Option& of, int dim, const Vec3& constant, TimeTable& table) {
  if (!in.given(of.name)) {
    in.reject(of.name + "_table",
              formatted("a time and %d components in each point where -%s is not given; a table of factors "
                        "multiplies -%s",
                        dim, of.name.c_str(), of.name.c_str()));
    return false;
  }
  for (Vec3& value : table.values)
    for (int d = 0; d < 3; ++d) value[d] *= constant[d];
  return true;
}

bool in_range(const Range& range, int dim, const TimeTable& table) {
  for (const Vec3& value : table.values)
    for (int d = 0; d < dim; ++d)
      if (!range.holds(value[d])) return false;
  return true;
}

}  // namespace

bool read_timed(OptionReader& in, const Option& of, bool has_constant, int dim, double end,
                const Vec3& constant, std::optional<TimeTable>& table) {
  const std::string name = of.name + "_table";
  const Option points{.name = name,
                      .meaning = of.meaning +
                                 (dim == 1 ? " in time: points as t:p,t:p, or a CSV file of these columns"
                                           : " in time: points as t:x:y,t:x:y (t:x:y:z in 3D), or a CSV file "
                                             "of these columns") +
                                 (!has_constant ? ""
                                  : dim == 1    ? "; where " + of.name + " is given too, its factors"
                                                : "; with one column, factors of " + of.name),
                      .unit = of.unit,
                      .standard = "none",
                      .change = of.change};
  std::string text;
  const bool given = in.text(points, text);
  bool smooth = false;
  if (const auto only = in.where(name); given || in.listing())
    in.word({.name = name + "_interpolation",
             .meaning = "between the points of the table: straight, or smooth by 3 x^2 - 2 x^3",
             .change = of.change},
            Words<bool>{{"linear", false}, {"smooth", true}}, smooth);
  else if (in.given(name))
    in.ignore(name + "_interpolation");
  else
    in.not_taken(name + "_interpolation", "there is no -" + name);
  if (!given) return in.given(name);
  TableText read;
  std::string fault = read_table(text, dim, end, read);
  if (fault.empty() && read.columns == 1 && dim > 1 && !has_constant)
    fault = formatted("a time and %d components in each point", dim);
  if (!fault.empty()) return in.reject(name, fault), true;
  read.table.smooth = smooth;
  const bool factors = read.columns == 1 && (dim > 1 || in.given(of.name));
  if (factors && !scale(in, of, dim, constant, read.table)) return true;
  if (read.columns != 1 && in.given(of.name))
    return in.reject(of.name, "nothing beside -" + name +
                                  " that has all components; a table of one column "
                                  "has factors of it"),
           true;
  if (!in_range(of.range, dim, read.table))
    return in.reject(name, "values" + of.range.text() + " " + of.unit), true;
  table = std::move(read.table);
  return true;
}

}  // namespace mpm
