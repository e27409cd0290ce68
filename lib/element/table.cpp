#include "element/table.hpp"

#include "common/numbers.hpp"
#include "element/path_file.hpp"

namespace mpm {

std::string element_header(const std::vector<StateVariable>& state) {
  std::string line = "time";
  for (const char* c : k_components) line += std::string(",s") + c;
  for (const StateVariable& variable : state)
    if (variable.output) line += std::string(",") + variable.name;
  for (const char* c : k_components) line += std::string(",e") + c;
  return line + "\n";
}

std::string element_line(const std::vector<StateVariable>& state, const DrivenPoint& point) {
  std::string line = text_of(point.time);
  for (const double stress : point.now.stress) line += "," + text_of(stress);
  for (std::size_t k = 0; k < state.size(); ++k)
    if (state[k].output) line += "," + text_of(point.now.state[k]);
  for (const double strain : point.strain) line += "," + text_of(strain);
  return line + "\n";
}

}  // namespace mpm
