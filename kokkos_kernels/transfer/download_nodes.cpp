#include "transfer/download_nodes.hpp"

#include "base/copy.hpp"

#include <algorithm>

namespace mpm {
namespace {

/// Number of a node in the whole mesh; -1 outside it.
template <class T, int Dim>
long node_number(const Grid<T, Dim>& grid, const Coord<Dim>& at) {
  long number = 0;
  for (int d = Dim - 1; d >= 0; --d) {
    if (at[d] < 0 || at[d] > grid.cells[d]) return -1;
    number = number * (grid.cells[d] + 1) + at[d];
  }
  return number;
}

}  // namespace

template <class Space, class T, int Dim>
NodeFields download_nodes(const Core<Space, T, Dim>& s) {
  using S = SoilTerms<Dim>;
  const auto soil = mirror_of(s.nodes.soil);
  const auto origin = mirror_of(s.patches.origin);
  const auto place = [&](int i) {
    Coord<Dim> at = coord_of<Dim>(i);
    for (int d = 0; d < Dim; ++d) at[d] += origin(i / Patch<Dim>::cells)[d];
    return at;
  };
  std::vector<std::pair<long, int>> order;
  for (int i = 0; i < s.patches.node_count(); ++i)
    if (const long number = node_number(s.grid, place(i)); number >= 0 && soil(i, S::mass) > 0)
      order.emplace_back(number, i);
  std::sort(order.begin(), order.end());
  NodeFields fields;
  for (const auto& [number, i] : order) {
    const double mass = soil(i, S::mass);
    fields.number.push_back(static_cast<double>(number));
    fields.mass.push_back(mass);
    for (int d = 0; d < Dim; ++d) {
      fields.position.push_back(place(i)[d] * s.spacing);
      fields.velocity.push_back(soil(i, S::momentum + d) / mass);
    }
  }
  return fields;
}

#define MPM_INSTANTIATE(Space, T, Dim) template NodeFields download_nodes(const Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
