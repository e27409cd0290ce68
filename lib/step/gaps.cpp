#include "step/gaps.hpp"

#include <algorithm>
#include <bit>
#include <unordered_map>

namespace mpm {
namespace {

constexpr int k_widest = 2;  // cells, of a run of empty ones that is a gap

enum class Holds { nothing, soil, rigid, outside };

template <int Dim>
class CellTable {
 public:
  CellTable(const std::vector<FilledPatch>& patches, const std::array<int, 3>& cells,
            const std::array<bool, 3>& periodic) {
    for (int d = 0; d < Dim; ++d) grid_.period[d] = periodic[d] ? cells[d] : 0;
    for (int d = 0; d < Dim; ++d) grid_.cells[d] = cells[d];
    for (int d = 0; d < Dim; ++d) grid_.patches[d] = (cells[d] + Patch<Dim>::edge - 1) / Patch<Dim>::edge + 2;
    for (const FilledPatch& patch : patches) {
      FilledPatch& of = table_.emplace(patch.number, FilledPatch{patch.number}).first->second;
      of.soil |= patch.soil, of.rigid |= patch.rigid;
    }
  }

  Gaps count() const {
    Gaps gaps;
    for (const auto& [number, patch] : table_) {
      gaps.filled += std::popcount(patch.soil);
      if (patch.soil == 0) continue;
      const Coord<Dim> origin = grid_.origin_of(number);
      for (std::uint64_t open = ~(patch.soil | patch.rigid); open != 0; open &= open - 1) {
        Coord<Dim> c = coord_of<Dim>(std::countr_zero(open));
        for (int d = 0; d < Dim; ++d) c[d] += origin[d];
        gaps.empty += grid_.holds(c) && is_gap(c);
      }
    }
    return gaps;
  }

 private:
  Holds at(Coord<Dim> c) const {
    for (int d = 0; d < Dim; ++d) c[d] = grid_.in_period(d, c[d]);
    if (!grid_.holds(c)) return Holds::outside;
    const auto found = table_.find(grid_.patch_of(c));
    if (found == table_.end()) return Holds::nothing;
    const std::uint64_t bit = std::uint64_t(1) << place_of<Dim>(c);
    return (found->second.soil & bit) != 0    ? Holds::soil
           : (found->second.rigid & bit) != 0 ? Holds::rigid
                                              : Holds::nothing;
  }
  /// Steps along an axis to the first cell that holds something; k_widest + 1 where that is further.
  int steps_to(Coord<Dim> c, int axis, int way, Holds* held) const {
    for (int n = 1; n <= k_widest; ++n) {
      c[axis] += way;
      *held = at(c);
      if (*held != Holds::nothing) return n;
    }
    return k_widest + 1;
  }
  bool is_inside(const Coord<Dim>& c, int but) const {
    for (int axis = 0; axis < Dim; ++axis)
      for (int way = -1; way <= 1 && axis != but; way += 2) {
        Holds held = Holds::nothing;
        if (steps_to(c, axis, way, &held) > k_widest) return false;
      }
    return true;
  }
  bool is_gap(const Coord<Dim>& c) const {
    for (int axis = 0; axis < Dim; ++axis) {
      Holds low = Holds::nothing, high = Holds::nothing;
      const int down = steps_to(c, axis, -1, &low), up = steps_to(c, axis, 1, &high);
      if (down + up - 1 > k_widest || low != Holds::soil || high != Holds::soil) continue;
      Coord<Dim> from = c, to = c;
      from[axis] -= down, to[axis] += up;
      if (is_inside(from, axis) && is_inside(to, axis)) return true;
    }
    return false;
  }

  Grid<double, Dim> grid_{};
  std::unordered_map<long, FilledPatch> table_;
};

}  // namespace

template <int Dim>
Gaps count_gaps(const std::vector<FilledPatch>& patches, const std::array<int, 3>& cells,
                const std::array<bool, 3>& periodic) {
  return CellTable<Dim>(patches, cells, periodic).count();
}

template Gaps count_gaps<2>(const std::vector<FilledPatch>&, const std::array<int, 3>&,
                            const std::array<bool, 3>&);
template Gaps count_gaps<3>(const std::vector<FilledPatch>&, const std::array<int, 3>&,
                            const std::array<bool, 3>&);

}  // namespace mpm
