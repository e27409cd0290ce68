#include "check/alike.hpp"

#include <map>
#include <regex>
#include <set>

#include "common/text.hpp"

namespace mpm {
namespace {

/// A warning of a rigid body without names behind "rigid" and without numbers; another line as it is.
std::string kind_of(const std::string& line) {
  if (!line.starts_with("warning: rigid ")) return line;
  static const std::regex name("rigid \\S+"), number("[-+]?[0-9][0-9.]*(e[-+]?[0-9]+)?");
  return std::regex_replace(std::regex_replace(line, name, "rigid"), number, "#");
}

}  // namespace

std::vector<std::string> without_alike(const std::vector<std::string>& lines) {
  constexpr int k_few = 3;
  std::map<std::string, int> count;
  for (const std::string& line : lines) ++count[kind_of(line)];
  std::set<std::string> listed;
  std::vector<std::string> out;
  for (const std::string& line : lines) {
    const std::string kind = kind_of(line);
    const int alike = count.at(kind);
    if (alike <= k_few || kind == line)
      out.push_back(line);
    else if (listed.insert(kind).second)
      out.push_back(line + formatted("; and so for %d other rigid bodies", alike - 1));
  }
  return out;
}

}  // namespace mpm
