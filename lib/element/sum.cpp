#include "element/sum.hpp"

#include <algorithm>
#include <cmath>

#include "common/text.hpp"
#include "element/path_file.hpp"

namespace mpm {
namespace {

/// Index of the component of an increment's name, dsxx or dexx; -1 where it is none.
int component_of(const std::string& name) {
  for (int c = 0; c < 6; ++c)
    if (name.size() == 4 && name.substr(2) == k_components[c]) return c;
  return -1;
}

/// Takes one term, as +0.5*dsxx, from the front of a text and adds it to a sum. `first`: it needs no sign.
bool take_term(std::string& text, bool first, ElementSum& sum) {
  double weight = text[0] == '-' ? -1 : 1;
  if (text[0] == '-' || text[0] == '+')
    text.erase(0, 1);
  else if (!first)
    return false;
  const auto factor = text.find('*');
  if (!text.empty() && text[0] != 'd' && factor != std::string::npos) {
    const auto number = parse_number(text.substr(0, factor));
    if (!number || !(std::fabs(*number) >= 1e-6) || !(std::fabs(*number) <= 1e6)) return false;
    weight *= *number, text.erase(0, factor + 1);
  }
  const std::string name = text.substr(0, 4);
  const int c = component_of(name);
  const bool strain = name.starts_with("de");
  if (c < 0 || (!strain && !name.starts_with("ds")) || (!first && strain != sum.of_strain)) return false;
  sum.of_strain = strain, sum.weight[c] += weight;
  text.erase(0, 4);
  return true;
}

/// Whether one of these weights is a sum of multiples of the others.
bool dependent(std::vector<Sym6> weights) {
  const auto product = [](const Sym6& a, const Sym6& b) {
    double sum = 0;
    for (int c = 0; c < 6; ++c) sum += a[c] * b[c];
    return sum;
  };
  for (std::size_t k = 0; k < weights.size(); ++k) {  // Gram and Schmidt, modified
    const double length = std::sqrt(product(weights[k], weights[k]));
    if (!(length > 1e-9)) return true;
    for (double& w : weights[k]) w /= length;
    for (std::size_t j = k + 1; j < weights.size(); ++j) {
      const double before = std::sqrt(product(weights[j], weights[j])),
                   along = product(weights[k], weights[j]);
      for (int c = 0; c < 6; ++c) weights[j][c] -= along * weights[k][c];
      if (!(std::sqrt(product(weights[j], weights[j])) > 1e-9 * before)) return true;
    }
  }
  return false;
}

}  // namespace

std::optional<ElementSum> parse_sum(const std::string& name) {
  std::string text = name;
  std::erase(text, ' ');
  ElementSum sum{.name = text};
  for (bool first = true; !text.empty(); first = false)
    if (!take_term(text, first, sum)) return std::nullopt;
  const bool some = std::any_of(sum.weight.begin(), sum.weight.end(), [](double w) { return w != 0; });
  return some ? std::optional(sum) : std::nullopt;
}

std::string fault_of_sums(const ElementRow& row, const std::vector<ElementSum>& sums) {
  std::vector<std::string> free;
  std::vector<Sym6> stresses, strains;
  const auto is_free = [&](int c) { return row.drive[c] == Drive::free; };
  for (int c = 0; c < 6; ++c) {
    if (is_free(c)) free.push_back(k_components[c]);
    if (row.drive[c] == Drive::stress) stresses.emplace_back()[c] = 1;
  }
  std::size_t governed = 0;
  for (std::size_t k = 0; k < row.sums.size(); ++k) {
    if (!row.sums[k]) continue;
    ++governed;
    Sym6 weight = sums[k].weight;
    for (int c = 0; c < 6; ++c)  // strains that are given are no unknowns
      if (sums[k].of_strain && !is_free(c) && row.drive[c] != Drive::stress) weight[c] = 0;
    (sums[k].of_strain ? strains : stresses).push_back(weight);
  }
  if (governed != free.size())
    return "as many numbers of sums as components without a number of their own that occur in these sums; in "
           "line " +
           std::to_string(row.line) + " there are " + std::to_string(governed) + " and " +
           std::to_string(free.size()) + (free.empty() ? "" : " (" + join(free) + ")");
  if (dependent(stresses) || dependent(strains))
    return "stresses and sums of which none follows from the others; in line " + std::to_string(row.line) +
           " one does";
  return "";
}

}  // namespace mpm
