#include "checkpoint/earlier.hpp"

#include "base/side_kinds.hpp"
#include "data/side_terms.hpp"

namespace mpm {
namespace {

/// Rows of `width` numbers, of which the first is the store, with all of ImpulseTerms in its place.
std::vector<double> with_all_terms(const std::vector<double>& rows, std::size_t width) {
  std::vector<double> out;
  for (std::size_t at = 0; at < rows.size(); at += width) {
    out.insert(out.end(), ImpulseTerms::size, 0.0);
    out[out.size() - ImpulseTerms::size + ImpulseTerms::store] = rows[at];
    out.insert(out.end(), rows.begin() + at + 1, rows.begin() + at + width);
  }
  return out;
}

}  // namespace

SavedSideRows rows_of_sides(const SavedSides& sides, const Config& config) {
  SavedSideRows rows;
  for (std::size_t n = 0; n < sides.kinds.size(); ++n) {
    const Wall kind = static_cast<Wall>(sides.kinds[n]);
    const int of_side = side_rows(config.mesh.cells, config.dim, static_cast<int>(n / 2));
    if (is_acting(kind)) rows.acting += of_side;
    if (kind == Wall::free_field) rows.columns += of_side;
  }
  return rows;
}

void complete_earlier(const Config& config, SavedState& state) {
  constexpr std::size_t k_fewer = ImpulseTerms::size - 1;
  if (state.impulse.values.size() == state.impulse.address.size() * state.rigids.size())
    state.impulse.values = with_all_terms(state.impulse.values, 1);
  if (state.sides.kinds.size() != 2 * static_cast<std::size_t>(config.dim)) return;
  const std::size_t terms = config.dim == 2 ? SideTerms<2>::size : SideTerms<3>::size;
  const std::size_t rows = rows_of_sides(state.sides, config).acting;
  if (rows > 0 && state.sides.values.size() == rows * (terms - k_fewer))
    state.sides.values = with_all_terms(state.sides.values, terms - k_fewer);
}

}  // namespace mpm
