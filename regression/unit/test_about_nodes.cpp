// Bins about nodes: the weights about the nearest node, the positions of particles, the sums of a patch, and
// steps.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "loops/gpu/node_tile.hpp"
#include "rebuild/about_nodes.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_spacing = 0.1;

/// Weights of nodes -1, 0 and 1 by the formulas for any place.
template <class T>
AxisWeights<T> three_nodes(T r, HalfLength<T> half) {
  const AxisWeights<T> a = axis_weights(r, half);
  AxisWeights<T> of{-1, {}, {}};
  for (int k = 0; k < 3; ++k)
    if (const int n = a.first + k + 1; n >= 0 && n < 3) of.w[n] = a.w[k], of.g[n] = a.g[k];
  return of;
}

/// A body that reaches all sides of the mesh, as clay, with clay at the middle of it that moves and is
/// stressed.
Cloud block(Wall wall, int per_cell) {
  Dice dice{std::mt19937_64(12)};
  Cloud cloud;
  cloud.grid = grid_of<3>({10, 9, 8}, k_spacing, wall);
  cloud.materials = clays();
  cloud.bodies = {body_of<3>(lattice<3>({0, 0, 0}, {10, 9, 8}, per_cell, k_spacing), per_cell, k_spacing, 1)};
  BodyInput& body = cloud.bodies[0];
  for (double& x : body.position) x += dice.uniform(-0.1, 0.1) * k_spacing / per_cell;
  for (std::size_t p = 0; p < strength_of(body).size(); ++p) {
    for (int d = 0; d < 3; ++d)  // m/s, a hundredth of a cell a step
      body.velocity.push_back(12 * std::sin(2 * std::numbers::pi * body.position[3 * p + (d + 1) % 3] + d));
    for (int k = 0; k < sym_size<3>; ++k) body.stress.push_back(dice.uniform(-1000, 1000));
  }
  return cloud;
}

template <class B>
std::vector<Table> fields_after(Cloud cloud, bool about_nodes, P2G how, int steps) {
  cloud.p2g.margin = 0.2, cloud.p2g.about_nodes = about_nodes;
  auto s = state_of<B>(cloud, how);
  const int rebuilds = run_steps(s, 1e-4, steps);
  CHECK(rebuilds > 0);
  CHECK(read_control(s).fault_count == 0);
  return soil_fields(s);
}

/// The sums of a tile in the order of a team, one lane after the other.
template <int values, class Sum>
void add_warps(double* sums, const Sum& sum) {
  using Tile = NodeTile<double>;
  for (int warp = 0; warp < Tile::warps; ++warp) {
    double* const of_warp = sums + warp * values * Tile::k_plane;
    std::fill(of_warp, of_warp + values * Tile::k_plane, 0.0);
    for (int lane = 0; lane < k_warp; ++lane) {
      double own[3][3][values] = {};
      sum(warp / Tile::warps_of_layer, warp % Tile::warps_of_layer * k_warp + lane, own);
      for (int n = 0; n < 9; ++n) Tile::template add_node<values>(lane, of_warp, own, n / 3, n % 3);
    }
  }
}

}  // namespace

TEST_CASE("weights about the nearest node are those of the shape functions", "[shape]") {
  for (double l : {0.05, 0.125, 0.25, 1.0 / 3}) {
    for (int n = 0; n <= 200; ++n) {
      const double r = (1 - l) * (n - 100) / 100.0;
      const auto expected = three_nodes<double>(r, l);
      const auto got = nearest_weights<double>(r, l);
      for (int k = 0; k < 3; ++k) {
        INFO("l " << l << " r " << r << " k " << k);
        CHECK(std::fabs(got.weight(k) - expected.w[k]) < 1e-14);
        CHECK(std::fabs(got.slope(k) - expected.g[k]) < 1e-13);
      }
    }
  }
}

TEST_CASE("a window about nodes gives the motion and the gradient of the shape functions", "[shape]") {
  using Window = NodeWindow<double>;
  Dice dice{std::mt19937_64(3)};
  std::vector<std::max_align_t> memory(Window::bytes() / sizeof(std::max_align_t) + 1);
  const Window window(reinterpret_cast<unsigned char*>(memory.data()));
  std::vector<Window::Motion> motion(Window::nodes);
  for (int n = 0; n < Window::nodes; ++n) {
    for (double& value : motion[n].c) value = dice.uniform(-1, 1);
    Window::store(window.motion, n, motion[n]);
  }
  for (int n = 0; n + 1 < Window::nodes; ++n) window.subtract(n);
  for (int bin = 0; bin < Patch<3>::cells; ++bin) {
    const HalfLength<double> half(0.25);
    NearestWeights<double> a[3];
    AxisWeights<double> b[3];
    for (int d = 0; d < 3; ++d) {
      const double r = dice.uniform(-0.75, 0.75);
      a[d] = nearest_weights<double>(r, half), b[d] = three_nodes<double>(r, half);
    }
    double value[6], gradient[3][3], expected[6] = {}, expected_gradient[3][3] = {};
    const int lowest = Window::lowest_of(bin);
    window.sample(lowest, a, value, gradient);
    interpolate_by_lines(
        b,
        [&](const Vector<int, 3>& k) {
          return motion[lowest + k[0] + k[1] * Window::step[1] + k[2] * Window::step[2]];
        },
        expected, expected_gradient);
    for (int v = 0; v < 6; ++v) CHECK(std::fabs(value[v] - expected[v]) < 1e-14);
    for (int d = 0; d < 9; ++d)
      CHECK(std::fabs(gradient[d / 3][d % 3] - expected_gradient[d / 3][d % 3]) < 1e-13);
    const double trace = expected_gradient[0][0] + expected_gradient[1][1] + expected_gradient[2][2];
    CHECK(std::fabs(window.dilatation(lowest, a) - trace) < 1e-13);
  }
}

TEST_CASE("a tile about nodes sums what the source gives", "[shape]") {
  using Tile = NodeTile<double>;
  using Source = SoilSource<Processor, double, 3>;
  using S = SoilTerms<3>;
  Dice dice{std::mt19937_64(8)};
  std::vector<std::max_align_t> memory(Tile::bytes() / sizeof(std::max_align_t) + 1);
  const Tile tile(reinterpret_cast<unsigned char*>(memory.data()));
  std::vector<double> expected(Tile::nodes * S::size);
  int count = 0;
  for (int bin = 0; bin < Tile::bins; ++bin) {
    tile.begin[bin] = count;
    for (int n = dice.below(14); n > 0; --n, ++count) {
      Source::Point q{0.25, dice.uniform(1, 2), {}, {}};
      for (double& p : q.momentum) p = dice.uniform(-1, 1);
      for (double& s : q.stress_volume) s = dice.uniform(-1, 1);
      NearestWeights<double> a[3];
      AxisWeights<double> b[3];
      for (int d = 0; d < 3; ++d) {
        const double r = dice.uniform(-0.75, 0.75);
        a[d] = nearest_weights<double>(r, 0.25), b[d] = three_nodes<double>(r, 0.25);
      }
      tile.put(count, a, q);
      for_each_weight(b, [&](const Vector<int, 3>& k, double w, const auto& grad) {
        const int node = NodeWindow<double>::lowest_of(bin) + k[0] + k[1] * NodeWindow<double>::step[1] +
                         k[2] * NodeWindow<double>::step[2];
        give<Source>(
            q, w, grad, [] { return 0; }, [&](int v, double term) { expected[node * S::size + v] += term; });
      });
    }
  }
  tile.begin[Tile::bins] = count;
  REQUIRE(count <= Tile::room);
  const auto range = [&](int bin) { return Tile::Range{tile.begin[bin], tile.begin[bin + 1]}; };
  add_warps<Tile::k_motion>(reinterpret_cast<double*>(tile.window), [&](int layer, int bin, auto& own) {
    layer == 0   ? tile.sum_motion<0>(range(bin), own)
    : layer == 1 ? tile.sum_motion<1>(range(bin), own)
                 : tile.sum_motion<2>(range(bin), own);
  });
  std::vector<double> force(Tile::sums_bytes(Tile::k_force) / sizeof(double));
  add_warps<Tile::k_force>(force.data(), [&](int layer, int bin, auto& own) {
    layer == 0   ? tile.sum_force<0>(range(bin), own)
    : layer == 1 ? tile.sum_force<1>(range(bin), own)
                 : tile.sum_force<2>(range(bin), own);
  });
  std::copy(force.begin(), force.end(), reinterpret_cast<double*>(tile.stage));
  for (int n = 0; n < Tile::nodes; ++n) {
    double sum[S::size];
    tile.gather(n, sum);
    for (int v = 0; v < S::size; ++v) CHECK(std::fabs(sum[v] - expected[n * S::size + v]) < 1e-12);
  }
}

TEST_CASE("in bins about nodes a particle is where it was, by its nearest node", "[bins]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    if constexpr (B::dim == 3) {
      for (Wall wall : {Wall::free, Wall::roller}) {
        Cloud cloud = random_cloud<3>(4, wall);
        const auto by_cell = soil_fields(state_of<B>(cloud, P2G::tile));
        cloud.p2g.about_nodes = true;
        const auto s = state_of<B>(cloud, P2G::tile);
        CHECK(largest_difference(soil_fields(s), by_cell) < B::of(1e-14, 1e-6));
        const auto x = on_host(s.soil.points.coordinate);
        const auto cell = on_host(s.soil.points.cell);
        const auto origin = on_host(s.patches.origin);
        const Coord<3> last = last_bins(s.grid);
        bool nearest = true;
        for (int p = 0; p < s.soil.points.count; ++p)
          for (int d = 0; d < 3; ++d) {
            const int at = origin(cell(p) / Patch<3>::cells)[d] + coord_of<3>(cell(p))[d];
            nearest = nearest && at <= last[d] && x(p)[d] >= -0.5 && x(p)[d] < (at < last[d] ? 0.5 : 1);
          }
        CHECK(nearest);
      }
    }
  });
}

TEST_CASE("the particles of a patch have places in the order of their cells", "[bins]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    if constexpr (B::dim == 3) {
      Cloud cloud = block(Wall::roller, 3);
      cloud.f_bar_fraction = 0.9, cloud.p2g.about_nodes = true;
      const auto s = state_of<B>(cloud, P2G::tile);
      const auto x = on_host(s.soil.points.coordinate);
      const auto bin = on_host(s.soil.points.cell), begin = on_host(s.soil.bins.begin);
      const auto place = on_host(s.cell_means.place);
      const auto first = on_host(s.cell_means.first);
      std::vector<int> taken(s.soil.points.count);
      bool in_cell = true;
      for (int p = 0; p < s.soil.points.count; ++p) {
        const int slot = bin(p) / Patch<3>::cells, at = slot * (CellWindow::cells + 1),
                  c = CellWindow::cell_of(place(p).bin(), place(p).corner()), n = place(p).number();
        in_cell = in_cell && place(p).bin() == bin(p) % Patch<3>::cells && first(at + c) <= n &&
                  n < first(at + c + 1);
        for (int d = 0; d < 3; ++d) in_cell = in_cell && (place(p).corner() >> d & 1) == (x(p)[d] < 0);
        ++taken[begin(slot * Patch<3>::cells) + n];
      }
      INFO(build.name());
      CHECK(in_cell);
      CHECK(std::count(taken.begin(), taken.end(), 1) == s.soil.points.count);
    }
  });
}

TEST_CASE("steps with bins about nodes are those with bins of cells", "[step]") {
  for (Wall wall : {Wall::roller, Wall::fixed, Wall::free})
    for (int per_cell : {2, 3}) {
      const Cloud cloud = block(wall, per_cell);
      const auto expected = fields_after<Reference<3>>(cloud, false, P2G::sequential, 40);
      for_each_build([&](auto build) {
        using B = decltype(build);
        if constexpr (B::dim == 3)
          for (P2G how : {P2G::gather, P2G::tile}) {
            INFO(build.name() << ' ' << word_of(how) << ' ' << per_cell << " a cell");
            CHECK(largest_difference(fields_after<B>(cloud, true, how, 40), expected) < B::of(1e-10, 1e-3));
          }
      });
    }
}

#ifdef KOKKOS_ENABLE_CUDA
TEST_CASE("F-bar has the means of cells where bins are about nodes", "[step]") {
  for (Wall wall : {Wall::roller, Wall::fixed, Wall::free}) {
    Cloud cloud = block(wall, 2);
    cloud.f_bar_fraction = 0.9;
    const auto expected = fields_after<Reference<3>>(cloud, false, P2G::sequential, 40);
    for_each_build([&](auto build) {
      using B = decltype(build);
      if constexpr (B::dim == 3 && is_device<typename B::Space>) {
        INFO(build.name());
        CHECK(largest_difference(fields_after<B>(cloud, true, P2G::tile, 40), expected) < B::of(1e-10, 1e-3));
      }
    });
  }
}
#endif
