// Periodic sides: the motion does not depend on where the mesh begins, and nothing is lost at its sides.

#include <catch2/catch_test_macros.hpp>
#include <map>
#include <set>

#include "compare.hpp"
#include "mesh/background.hpp"
#include "parallel/halo_plan.hpp"
#include "parallel/partition.hpp"
#include "rebuild/shift_particle.hpp"
#include "step/gaps.hpp"
#include "transfer/measure.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_edge = 0.125;  // m, a power of two: soil that is shifted by whole cells has the same bits
constexpr double k_dt = 5e-5;     // s
constexpr int k_steps = 60;

/// A mesh of so many patches along x and y, periodic along both or along x alone.
struct Periods {
  std::array<int, 2> patches;
  bool both;
};
constexpr Periods k_shapes[] = {
    {{1, 1}, true}, {{2, 1}, true}, {{3, 2}, true}, {{1, 2}, false}, {{4, 1}, false}};

/// Random soil with a mean velocity that takes it through periodic sides, shifted by whole cells.
template <int Dim>
Cloud random_soil(int seed, const Periods& shape, const std::array<int, 3>& shift) {
  Dice dice{std::mt19937_64(seed)};
  constexpr int edge = Patch<Dim>::edge;
  const std::array<int, 3> cells{edge * shape.patches[0], edge * shape.patches[1], 5};
  Cloud cloud;
  cloud.grid = grid_of<Dim>(cells, k_edge, Wall::roller);
  for (int d = 0; d < (shape.both ? 2 : 1); ++d) cloud.grid.walls[d] = {Wall::periodic, Wall::periodic};
  cloud.materials = clays();
  BodyInput body = random_body<Dim>(dice, {0, 0, 0}, cells, 0.6, 2, k_edge);
  constexpr double k_resolved = 1 << 16;  // parts of a cell, so that a shift rounds nothing
  const double mean[3] = {45, shape.both ? -38.0 : 0.0, 0};  // m/s
  for (std::size_t k = 0; k < body.position.size(); ++k) {
    const int d = static_cast<int>(k % Dim);
    const bool wraps = cloud.grid.walls[d][0] == Wall::periodic;
    double x = std::floor(body.position[k] / k_edge * k_resolved) / k_resolved;
    if (wraps) x = std::fmod(x + shift[d], cells[d]);
    body.position[k] = x * k_edge;
    body.velocity[k] += mean[d];
  }
  cloud.bodies = {body};
  return cloud;
}

/// Particles after some steps, by id, and where they would be had they passed no side [m].
struct Outcome {
  std::vector<double> velocity, stress, volume, position, way;
  int rebuilds = 0;
};

template <class State_>
Outcome outcome_of(const State_& s, const Cloud& cloud, int dim) {
  const SoilFields soil = download_soil(s);
  Outcome out{soil.velocity, soil.stress, soil.volume, soil.position, soil.position, 0};
  for (std::size_t k = 0; k < out.way.size(); ++k)
    out.way[k] += soil.periods[k] * cloud.grid.cells[k % dim] * k_edge;
  return out;
}
template <class B>
Outcome run_soil(const Cloud& cloud, P2G how, const typename B::Space& space = B::space()) {
  auto s = state_of<B>(cloud, how, space);
  const int rebuilds = run_steps(s, k_dt, k_steps);
  Outcome out = outcome_of(s, cloud, B::dim);
  out.rebuilds = rebuilds;
  return out;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double v : values) most = std::max(most, std::fabs(v));
  return most;
}
double difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::fabs(a[k] - b[k]));
  return most;
}

/// How far two outcomes are apart [of the largest value], the second with the soil shifted at the start.
double distance(const Outcome& one, const Outcome& other, const Cloud& at, const Cloud& shifted) {
  std::vector<double> moved = one.way, moved_too = other.way;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    moved[k] -= at.bodies[0].position[k];
    moved_too[k] -= shifted.bodies[0].position[k];
  }
  return std::max({difference(one.velocity, other.velocity) / largest(one.velocity),
                   difference(one.stress, other.stress) / largest(one.stress),
                   difference(one.volume, other.volume) / largest(one.volume),
                   difference(moved, moved_too) / largest(moved)});
}

/// The velocity updates, F-bar, and domains that stretch.
void for_each_kind(const std::function<void(const char*, const std::function<void(Cloud&)>&)>& f) {
  f("flip", [](Cloud&) {});
  f("F-bar", [](Cloud& c) { c.f_bar_fraction = 0.98; });
  f("apic", [](Cloud& c) { c.flip_fraction = 0, c.affine = true; });
  f("xpic", [](Cloud& c) { c.flip_fraction = 0, c.xpic_order = 3; });
  f("stretch", [](Cloud& c) { c.stretch = true; });
}

}  // namespace

TEST_CASE("soil in a periodic mesh moves alike wherever the mesh begins, by every strategy", "[periodic]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    int seed = 0;
    for (const Periods& shape : k_shapes) {
      const Cloud at = random_soil<B::dim>(++seed, shape, {});
      const Outcome expected = run_soil<B>(at, P2G::sequential);
      CHECK(expected.rebuilds > 0);
      Dice dice{std::mt19937_64(seed)};
      for (const P2G how : k_strategies) {
        const std::array<int, 3> shift{1 + dice.below(at.grid.cells[0] - 1),
                                       shape.both ? 1 + dice.below(at.grid.cells[1] - 1) : 0, 0};
        const Cloud shifted = random_soil<B::dim>(seed, shape, shift);
        INFO(B::name() << " " << word_of(how) << ", mesh " << seed << ", shifted by " << shift[0] << " "
                       << shift[1]);
        CHECK(distance(expected, run_soil<B>(shifted, how), at, shifted) < B::of(1e-11, 2e-3));
      }
    }
  });
}

TEST_CASE("so it does with every velocity update, F-bar and domains that stretch", "[periodic]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for_each_kind([&](const char* kind, const std::function<void(Cloud&)>& change) {
      const Periods shape{{2, 1}, true};
      Cloud at = random_soil<B::dim>(11, shape, {}), shifted = random_soil<B::dim>(11, shape, {3, 2, 0});
      change(at), change(shifted);
      INFO(B::name() << " " << kind);
      for (const P2G how : {P2G::tile, P2G::gather}) {
        const Outcome expected = run_soil<B>(at, how);
        CHECK(distance(expected, run_soil<B>(shifted, how), at, shifted) < B::of(1e-11, 2e-3));
      }
    });
  });
}

TEST_CASE("many steps in one launch cross periodic sides as single steps do", "[periodic]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    if (!is_device<typename B::Space> && B::dim == 3 && B::is_double) return;  // no room for it there
    for (const Periods& shape : k_shapes) {
      const Cloud cloud = random_soil<B::dim>(5, shape, {});
      const Outcome expected = run_soil<B>(cloud, P2G::sequential);
      auto s = state_of<B>(cloud, P2G::tile);
      for (int n = k_steps; n > 0;) {
        if (!s.summed.soil) interpolate(s), s.summed = {true, false, true};
        if (!s.strays.known) mark_strays(s, s.space);
        REQUIRE(can_persist(s));
        restart_count(s);
        run_persistent_steps(s, k_dt, std::min(n, 7));
        const Control control = read_control(s);
        REQUIRE((control.fault_count == 0 && control.steps > 0));
        if ((control.paused & Pause::not_co_resident) != 0) resume_single_steps(s);
        if ((control.paused & Pause::due) != 0) rebuild(s);
        n -= control.steps;
      }
      CHECK(distance(expected, outcome_of(s, cloud, B::dim), cloud, cloud) < B::of(1e-11, 2e-3));
    }
  });
}

TEST_CASE("tile has the same bits with one thread and with several in a periodic mesh", "[periodic]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    if constexpr (is_device<typename B::Space>) {
      return;
    } else {
      using One = OneThread<typename B::real, B::dim>;
      for (const Periods& shape : k_shapes) {
        const Cloud cloud = random_soil<B::dim>(6, shape, {});
        const Outcome one = run_soil<One>(cloud, P2G::tile), many = run_soil<B>(cloud, P2G::tile),
                      other = run_soil<B>(cloud, P2G::tile, with_other_threads<B>());
        CHECK(one.velocity == many.velocity);
        CHECK(one.stress == many.stress);
        CHECK(one.position == other.position);
      }
    }
  });
}

TEST_CASE("soil keeps its momentum through periodic sides, and its centre moves with it", "[periodic]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = random_soil<B::dim>(3, {{2, 1}, true}, {});
    auto s = state_of<B>(cloud, P2G::tile);
    const BodyMeasure before = measure(s, 0);
    run_steps(s, k_dt, k_steps);
    const BodyMeasure after = measure(s, 0);
    CHECK(after.mass == before.mass);
    for (int d = 0; d < 2; ++d) {  // rollers across
      const double speed = before.momentum[d] / before.mass, length = cloud.grid.cells[d] * k_edge;
      CHECK(std::fabs(after.momentum[d] / before.momentum[d] - 1) < B::of(1e-13, 1e-5));
      const double moved = after.centre[d] - before.centre[d], exact = speed * k_dt * k_steps;
      CHECK(std::fabs(moved - exact) < B::of(1e-11, 2e-4) * std::fabs(exact));
      CHECK(after.lower[d] >= 0);
      CHECK(after.upper[d] < length);
    }
    const std::vector<double> position = download_soil(s).position;
    for (std::size_t k = 0; k < position.size(); ++k) {
      const int d = static_cast<int>(k % B::dim);
      if (d < 2) CHECK((position[k] >= 0 && position[k] < cloud.grid.cells[d] * k_edge));
    }
  });
}

TEST_CASE("a particle is split and merged across a periodic side", "[periodic]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    const Cloud cloud = random_soil<B::dim>(4, {{1, 1}, true}, {});
    const auto s = state_of<B>(cloud, P2G::tile);
    Coord<B::dim> cell{};
    Placed<double, B::dim> place{s.grid.address_of(cell), filled<double, B::dim>(0.1)};
    Vector<double, B::dim> offset{};
    offset[0] = -0.3;
    REQUIRE(shift(s.grid, offset, place));
    CHECK(cell_of(s.grid, place.address)[0] == s.grid.cells[0] - 1);
    CHECK(std::fabs(place.x[0] - 0.8) < 1e-12);
    CHECK(place.passed[0] == -1);
    offset[0] = 0.3;
    REQUIRE(shift(s.grid, offset, place));
    CHECK(cell_of(s.grid, place.address)[0] == 0);
    CHECK(place.passed[0] == 1);
    CHECK(s.grid.shortest(0, s.grid.cells[0] - 0.5) == -0.5);
    CHECK(s.grid.shortest(0, 0.5 - s.grid.cells[0]) == 0.5);
    CHECK(s.grid.shortest(0, 1.5) == 1.5);
  });
}

TEST_CASE("a gap lies across a periodic side", "[periodic]") {
  constexpr int width = 8, height = 8;
  const GridInput in = grid_of<2>({width, height, 1}, 1, Wall::roller);
  Grid<double, 2> grid{};
  for (int d = 0; d < 2; ++d) grid.cells[d] = in.cells[d], grid.patches[d] = in.patches[d];
  FilledPatch patch{grid.patch_of({{0, 0}})};
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < width - 1; ++x) patch.soil |= std::uint64_t(1) << place_of<2>(Coord<2>{{x, y}});
  const std::array<int, 3> cells{width, height, 1};
  CHECK(count_gaps<2>({patch}, cells).empty == 0);  // the side of the mesh is beyond the last column
  CHECK(count_gaps<2>({patch}, cells, {true, false, false}).empty > 0);
}

namespace {

constexpr int k_nodes = 64;  // of a patch

/// Nodes that the particles of a patch reach in a periodic grid, as patch times nodes plus place.
std::set<long> window_of(const PatchGrid& grid, long patch) {
  const int edge = patch_edge(grid.dim);
  const std::array<int, 3> at = grid.place(patch);
  std::set<long> nodes;
  for (int z = grid.dim == 3 ? -1 : 0; z <= (grid.dim == 3 ? edge + 1 : 0); ++z)
    for (int y = -1; y <= edge + 1; ++y)
      for (int x = -1; x <= edge + 1; ++x) {
        const int c[3] = {x, y, z};
        std::array<int, 3> to = at;
        int place = 0;
        for (int d = 0, step = 1; d < grid.dim; ++d, step *= edge) {
          to[d] += c[d] < 0 ? -1 : c[d] / edge;
          place += step * ((c[d] + edge) % edge);
        }
        nodes.insert(grid.number(grid.in_period(to)) * k_nodes + place);
      }
  return nodes;
}

}  // namespace

TEST_CASE("ranks list the nodes that they share across periodic sides alike", "[periodic]") {
  for (const int dim : {2, 3})
    for (const int along : {1, 2, 3, 5})
      for (const int ranks : {2, 3}) {
        PatchGrid grid{dim, {along + 2, 4, dim == 3 ? 3 : 1}};
        grid.periodic = {true, along % 2 == 1, false};
        std::mt19937 dice(7 * dim + ranks + along);
        Owners owners;
        std::vector<std::uint8_t> occupied;
        std::vector<long> slots;
        for (long n = 0; n < grid.count(); ++n) {
          const std::array<int, 3> place = grid.place(n);
          bool inside = true;
          for (int d = 0; d < dim; ++d) inside = inside && place[d] > 0 && place[d] < grid.patches[d] - 1;
          owners.push_back(static_cast<int>(dice() % ranks));
          occupied.push_back(inside && dice() % 4 > 0);
          if (grid.in_period(place) == place) slots.push_back(n);
        }
        std::vector<std::set<long>> reached(ranks);
        for (long n = 0; n < grid.count(); ++n)
          if (occupied[n]) reached[owners[n]].merge(window_of(grid, n));
        std::map<std::pair<int, int>, std::vector<long>> lists;  // of the first rank, with the second
        for (int r = 0; r < ranks; ++r) {
          const HaloPlan plan = plan_halo(grid, owners, occupied, slots, r);
          for (std::size_t n = 0; n < plan.neighbours.size(); ++n)
            for (int k = plan.begin[n]; k < plan.begin[n + 1]; ++k)
              lists[{r, plan.neighbours[n]}].push_back(slots[plan.node[k] / k_nodes] * k_nodes +
                                                       plan.node[k] % k_nodes);
        }
        for (int a = 0; a < ranks; ++a)
          for (int b = 0; b < ranks; ++b) {
            if (a == b) continue;
            std::vector<long> both;
            std::set_intersection(reached[a].begin(), reached[a].end(), reached[b].begin(), reached[b].end(),
                                  std::back_inserter(both));
            INFO(dim << "D, " << along << " patches, ranks " << a << " and " << b << " of " << ranks);
            CHECK(lists[{a, b}] == both);
          }
      }
}

TEST_CASE("METIS cuts a periodic grid, of one patch or two too, and every patch has an owner", "[periodic]") {
  for (const int along : {1, 2, 7})
    for (const int ranks : {2, 3}) {
      PatchGrid grid{2, {along + 2, 9, 1}};
      grid.periodic = {true, false, false};
      Loads loads(grid.count());
      for (long n = 0; n < grid.count(); ++n) {
        const std::array<int, 3> at = grid.place(n);
        if (at[0] > 0 && at[0] <= along && at[1] > 0 && at[1] < 8) loads[n] = 10;
      }
      const Owners owners = cut_graph(grid, loads, ranks, {});
      REQUIRE(owners.size() == loads.size());
      for (const int owner : owners) CHECK((owner >= 0 && owner < ranks));
      if (along == 7) CHECK(imbalance_of(loads_of(owners, loads, ranks)) < 1.2);
    }
}
