// Cells without soil inside the soil.

#include <catch2/catch_test_macros.hpp>
#include <map>
#include <set>

#include "compare.hpp"
#include "step/gaps.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// The cells of a picture, whose last line is the lowest row: # holds soil, R a rigid.
Gaps gaps_of(const std::vector<std::string>& rows) {
  const int width = static_cast<int>(rows[0].size()), height = static_cast<int>(rows.size());
  const GridInput in = grid_of<2>({width, height, 1}, 1, Wall::roller);
  Grid<double, 2> grid{};
  for (int d = 0; d < 2; ++d) grid.cells[d] = in.cells[d], grid.patches[d] = in.patches[d];
  std::vector<FilledPatch> patches;  // one for each cell: parts of a patch are put together
  for (int row = 0; row < height; ++row)
    for (int x = 0; x < width; ++x) {
      const Coord<2> c{{x, height - 1 - row}};
      const std::uint64_t bit = std::uint64_t(1) << place_of<2>(c);
      const char what = rows[row][x];
      if (what == '#' || what == 'R')
        patches.push_back({grid.patch_of(c), what == '#' ? bit : 0, what == 'R' ? bit : 0});
    }
  return count_gaps<2>(patches, {width, height, 1});
}

}  // namespace

TEST_CASE("gaps are cracks and holes, not the surface, nor where a rigid is", "[gaps]") {
  CHECK(gaps_of({"............", "############", "############"}).empty == 0);
  const Gaps hole = gaps_of({"....", "####", "#.##", "####"});
  CHECK(hole.empty == 1);
  CHECK(hole.filled == 11);
  CHECK(gaps_of({".....", ".....", "#.###", "#####"}).empty == 0);                    // a notch
  CHECK(gaps_of({".....", ".....", "##.##", "##.##", "##.##", "#####"}).empty == 2);  // a crack from above
  CHECK(gaps_of({"##########", "######.###", "#####.####", "####.#####", "##########"}).empty == 3);
  CHECK(gaps_of({"##########", "###..#####", "###..#####", "##########"}).empty == 4);
  CHECK(gaps_of({"##########", "###...####", "###...####", "###...####", "##########"}).empty == 0);
  CHECK(gaps_of({"##########", "####R#####", "##########"}).empty == 0);
  CHECK(gaps_of({"......", ".####.", "......", "......", "......", "######"}).empty == 0);  // apart by three
  // Across the border of two patches of 8 cells.
  CHECK(gaps_of({"################", "#######..#######", "################"}).empty == 2);
}

TEST_CASE("a lattice has no gap, one without the particles of a cell has one, whatever the back end",
          "[gaps]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud;
    cloud.grid = grid_of<Dim>({12, 11, 9}, 0.1, Wall::roller);
    cloud.materials = clays();
    std::vector<double> all = lattice<Dim>({0, 0, 0}, {12, 6, 7}, 2, 0.1), holed;
    for (std::size_t p = 0; p < all.size() / Dim; ++p) {
      bool in_hole = true;
      for (int d = 0; d < Dim; ++d) in_hole = in_hole && std::floor(all[p * Dim + d] / 0.1) == 3 + d;
      for (int d = 0; d < Dim && !in_hole; ++d) holed.push_back(all[p * Dim + d]);
    }
    const std::array<int, 3> cells{12, 11, Dim == 3 ? 9 : 1};
    const long full = Dim == 2 ? 72 : 504;
    INFO(B::name());
    cloud.bodies = {body_of<Dim>(all, 2, 0.1, 0)};
    Gaps gaps = count_gaps<Dim>(filled_cells(state_of<B>(cloud, P2G::tile)), cells);
    CHECK(gaps.filled == full);
    CHECK(gaps.empty == 0);
    cloud.bodies = {body_of<Dim>(holed, 2, 0.1, 0)};
    gaps = count_gaps<Dim>(filled_cells(state_of<B>(cloud, P2G::tile)), cells);
    CHECK(gaps.filled == full - 1);
    CHECK(gaps.empty == 1);
  });
}
