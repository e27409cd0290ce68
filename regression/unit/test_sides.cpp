// Sides of the mesh that act on the soil: friction, dashpots, a motion of their own.

#include <catch2/catch_test_macros.hpp>
#include <set>

#include "compare.hpp"
#include "functions/absorbing_sides.hpp"
#include "physics/sides.hpp"
#include "transfer/upload_sides.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_edge = 0.1;  // m

/// Random particles at a corner of a mesh whose lower sides act.
template <int Dim>
Cloud corner(int seed) {
  Dice dice{std::mt19937_64(seed)};
  Cloud cloud;
  cloud.grid = grid_of<Dim>({11, 9, 7}, k_edge, Wall::free);
  cloud.grid.walls[0][0] = Wall::friction;
  cloud.grid.walls[1][0] = Wall::driven;
  cloud.grid.walls[2][0] = Wall::absorbing;
  cloud.materials = clays();
  cloud.gravity = {-2, -5, -3};
  cloud.bodies = {random_body<Dim>(dice, {0, 0, 0}, {6, 5, 4}, 0.9, 2, k_edge)};
  return cloud;
}

std::vector<SideInput> sides_of_corner(int dim) {
  std::vector<SideInput> sides = {
      {.direction = 0, .velocity = {0, 0.3, 0}, .numbers = {.friction = 0.4, .shear_limit = 1e9}},
      {.direction = 1, .holds_all = true, .velocity = {0.2, -0.1, 0.1}}};
  if (dim == 3) sides.push_back({.direction = 2});
  return sides;
}

template <class B>
StateOf<B> state_with_sides(const Cloud& cloud, P2G how) {
  auto s = state_of<B>(cloud, how);
  upload_sides(s, cloud.grid, sides_of_corner(B::dim), k_density);
  interpolate(s);
  finish_sums(s);
  begin_absorbing(s, {0.3, 0.3}, {});
  return s;
}

/// A friction side below a node.
Side<3> rough_side(double friction) {
  Side<3> side;
  side.kind = Wall::friction;
  side.velocity = {0.1, 0, -0.2};
  side.numbers.friction = friction;
  side.unit_mass = 1, side.face = 1;
  return side;
}

}  // namespace

namespace {

/// Sides of a mesh, with rows of kept values for one node, and what they make of its velocity.
template <int Dim>
struct NodeOnSides {
  std::array<Side<Dim>, 2 * Dim> all{};
  std::array<double, 2 * Dim * SideTerms<Dim>::size> kept{};
  unsigned sides = 0, ends = 0;

  void add(int n, const Side<Dim>& side) {
    all[n] = side, sides |= 1u << n;
    all[n].first = n;
    for (int k = 0; k < Dim; ++k) all[n].step[k] = 0;
  }
  double* of(int n) { return kept.data() + n * SideTerms<Dim>::size; }
  Vector<double, Dim> meet(double mass, double dt, const Vector<double, Dim>& v) {
    const SideNode<Dim> node{{}, sides, ends, mass, dt, 0.1, true, true};
    return by_sides<double, Dim>({sides, all.data(), kept.data(), nullptr}, node, v, v, true);
  }
};

}  // namespace

TEST_CASE("friction of a side takes no more than its share of the normal impulse, and turns no slip round",
          "[sides]") {
  Dice dice{std::mt19937_64(5)};
  for (int n = 0; n < 200; ++n) {
    const Side<3> side = rough_side(dice.uniform(0, 1));
    NodeOnSides<3> node;
    node.add(2, side);
    double normal = 0, along = 0;
    for (int step = 0; step < 50; ++step) {
      const double mass = dice.uniform(0.1, 2);
      const Vector<double, 3> old{dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(-1, 1)};
      const auto v = node.meet(mass, 1e-3, old);
      CHECK(v[1] == std::max(old[1], side.velocity[1]));  // it does not pull
      normal += mass * std::max(0.0, -old[1]);
      const double slip[2] = {old[0] - side.velocity[0], old[2] - side.velocity[2]},
                   left[2] = {v[0] - side.velocity[0], v[2] - side.velocity[2]};
      CHECK(slip[0] * left[0] + slip[1] * left[1] >= -1e-15);
      along += mass * std::hypot(v[0] - old[0], v[2] - old[2]);
      CHECK(along <= side.numbers.friction * normal * (1 + 1e-12) + 1e-15);
    }
  }
}

TEST_CASE("where sides with friction meet, their order does not matter, and their impulses are the node's",
          "[sides]") {
  Dice dice{std::mt19937_64(6)};
  for (int n = 0; n < 200; ++n) {
    Side<3> a = rough_side(dice.uniform(0, 1)), b = rough_side(dice.uniform(0, 1));
    a.velocity = b.velocity = {};
    NodeOnSides<3> node, turned;  // turned: x and y exchanged
    node.add(0, a), node.add(2, b), turned.add(2, a), turned.add(0, b);
    for (int step = 0; step < 20; ++step) {
      const Vector<double, 3> old{dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(-1, 1)};
      const auto v = node.meet(1.5, 1e-3, old), w = turned.meet(1.5, 1e-3, {old[1], old[0], old[2]});
      CHECK(std::fabs(v[0] - w[1]) + std::fabs(v[1] - w[0]) + std::fabs(v[2] - w[2]) < 1e-14);
      CHECK(old[2] * v[2] >= -1e-15);
    }
    using S = SideTerms<3>;
    for (int k = 0; k < 3; ++k) {
      const int image = k < 2 ? 1 - k : 2;
      CHECK(std::fabs(node.of(0)[S::impulse + k] - turned.of(2)[S::impulse + image]) < 1e-13);
      CHECK(std::fabs(node.of(2)[S::impulse + k] - turned.of(0)[S::impulse + image]) < 1e-13);
    }
  }
}

TEST_CASE("the shear limit of a side bounds the shear impulse of a step by its area", "[sides]") {
  Side<3> side = rough_side(100);
  side.numbers.shear_limit = 30, side.face = 0.5, side.unit_mass = 4;
  NodeOnSides<3> node;
  node.add(2, side);
  const auto v = node.meet(2, 1e-2, {5, -10, -0.2});  // half of a full node
  CHECK(std::fabs(2 * (5 - v[0]) - 30 * 0.25 * 1e-2) < 1e-14);
  node.ends = 0b010101;  // in a corner of the mesh its area is a quarter at most, however dense the soil is
  const auto w = node.meet(1.2, 1e-2, {5, -10, -0.2});
  CHECK(std::fabs(1.2 * (5 - w[0]) - 30 * 0.5 / 4 * 1e-2) < 1e-14);
}

TEST_CASE("dashpots of a side are implicit, and of two sides that meet add up", "[sides]") {
  Side<2> side;
  side.kind = Wall::absorbing, side.velocity = {0.3, -0.2};
  using S = SideTerms<2>;
  NodeOnSides<2> node;
  node.add(0, side);
  node.of(0)[S::dashpot] = 500, node.of(0)[S::dashpot + 1] = 200;
  auto v = node.meet(1.5, 1e-2, {2, -1});
  CHECK(std::fabs(1.5 * (v[0] - 2) + 500 * 1e-2 * (v[0] - 0.3)) < 1e-14);
  CHECK(std::fabs(1.5 * (v[1] + 1) + 200 * 1e-2 * (v[1] + 0.2)) < 1e-14);
  side.velocity = {-0.1, 0.4};
  node.add(2, side);
  node.of(2)[S::dashpot] = 300, node.of(2)[S::dashpot + 1] = 100;
  v = node.meet(1.5, 1e-2, {2, -1});
  CHECK(std::fabs(1.5 * (v[0] - 2) + 500 * 1e-2 * (v[0] - 0.3) + 100 * 1e-2 * (v[0] + 0.1)) < 1e-14);
  CHECK(std::fabs(1.5 * (v[1] + 1) + 200 * 1e-2 * (v[1] + 0.2) + 300 * 1e-2 * (v[1] - 0.4)) < 1e-14);
}

TEST_CASE("each node of the sides has a row of its own", "[sides]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    StateOf<B> s;
    s.space = B::space();
    GridInput grid = grid_of<Dim>({5, 4, 3}, k_edge, Wall::driven);
    std::vector<SideInput> sides;
    for (int n = 0; n < 2 * Dim; ++n) sides.push_back({.direction = n / 2, .side = n % 2});
    upload_sides(s, grid, sides, 1000);
    std::set<int> rows;
    int nodes = 0;
    for (int n = 0; n < 2 * Dim; ++n)
      for (int a = -1; a <= grid.cells[(n / 2 + 1) % Dim] + 1; ++a)
        for (int b = -1; b <= (Dim == 3 ? grid.cells[(n / 2 + 2) % Dim] + 1 : -1); ++b, ++nodes) {
          Coord<Dim> at;
          at[n / 2] = n % 2 == 0 ? 0 : grid.cells[n / 2];
          at[(n / 2 + 1) % Dim] = a;
          if (Dim == 3) at[(n / 2 + 2) % Dim] = b;
          rows.insert(s.sides.host[n].row(at));
        }
    CHECK(static_cast<int>(rows.size()) == nodes);
    CHECK((*rows.begin() == 0 && *rows.rbegin() == nodes - 1));
    CHECK(static_cast<int>(s.sides.nodes.extent(0)) == nodes);
  });
}

TEST_CASE("beyond sides that act nodes hold nothing, and the nodes on them all that particles give",
          "[sides]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (const P2G how : k_strategies) {
      INFO(build.name() << " " << word_of(how));
      auto s = state_of<B>(corner<Dim>(2), how);
      interpolate(s);
      finish_sums(s);
      const auto soil = on_host(s.nodes.soil);
      const auto origin = on_host(s.patches.origin);
      double sum[1 + Dim] = {}, exact[1 + Dim] = {}, size = 0;
      int wrong = 0;
      for (int i = 0; i < s.patches.node_count(); ++i) {
        const Coord<Dim> in = coord_of<Dim>(i), from = origin(i / Patch<Dim>::cells);
        bool beyond = false;
        for (int d = 0; d < Dim; ++d) beyond = beyond || from[d] + in[d] < 0;
        for (int k = 0; k <= Dim; ++k) sum[k] += soil(i, k);
        wrong += beyond && soil(i, 0) != 0;
      }
      const SoilFields fields = download_soil(s);
      for (std::size_t p = 0; p < fields.mass.size(); ++p) {
        exact[0] += fields.mass[p];
        for (int d = 0; d < Dim; ++d) exact[1 + d] += fields.mass[p] * fields.velocity[p * Dim + d];
        size += fields.mass[p];
      }
      CHECK(wrong == 0);
      for (int k = 0; k <= Dim; ++k) CHECK(std::fabs(sum[k] - exact[k]) < B::of(1e-12, 1e-5) * size);
    }
  });
}

TEST_CASE("every build and strategy moves soil at sides that act as the reference does", "[sides]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = corner<B::dim>(7);
    auto reference = state_with_sides<Reference<B::dim>>(cloud, P2G::sequential);
    run_steps(reference, 5e-5, 60);
    const SoilFields exact = download_soil(reference);
    for (const P2G how : k_strategies) {
      INFO(build.name() << " " << word_of(how));
      auto s = state_with_sides<B>(cloud, how);
      run_steps(s, 5e-5, 60);
      const SoilFields soil = download_soil(s);
      double worst = 0;
      for (std::size_t k = 0; k < soil.position.size(); ++k)
        worst = std::max(worst, std::fabs(soil.position[k] - exact.position[k]));
      CHECK(worst < B::of(1e-12, 2e-5));
    }
  });
}

TEST_CASE("impulses of sides and gravity are what the momentum of the soil changes by", "[sides]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    const Cloud cloud = corner<Dim>(11);
    auto s = state_with_sides<B>(cloud, P2G::tile);
    const auto momentum = [&] {
      const SoilFields soil = download_soil(s);
      std::array<double, 4> sum{};
      for (std::size_t p = 0; p < soil.mass.size(); ++p) {
        sum[3] += soil.mass[p];
        for (int d = 0; d < Dim; ++d) sum[d] += soil.mass[p] * soil.velocity[p * Dim + d];
      }
      return sum;
    };
    const auto before = momentum();
    constexpr double dt = 2e-5;
    one_step(s, dt);  // no particle is put back in one step
    const auto after = momentum();
    const SideWork done = take_side_work(s);
    for (int d = 0; d < Dim; ++d) {
      double impulse = before[3] * cloud.gravity[d] * dt;
      for (int n = 0; n < 2 * Dim; ++n) impulse -= done.impulse[n / 2][n % 2][d];
      CHECK(std::fabs(after[d] - before[d] - impulse) < B::of(1e-11, 1e-4) * before[3]);
    }
  });
}

TEST_CASE("an absorbing side takes rho c A and the static force from the soil at it", "[sides]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    Cloud cloud;
    cloud.grid = grid_of<Dim>({6, 4, 3}, k_edge, Wall::roller);
    cloud.grid.walls[0][0] = Wall::absorbing;
    cloud.materials = {{0, {1e7, 0.25}}};
    const std::array<double, 3> high{6, 4, 3};
    BodyInput body = body_of<Dim>(lattice<Dim>({0, 0, 0}, high, 2, k_edge), 2, k_edge, 0);
    body.state.clear();
    const std::size_t count = body.position.size() / Dim;
    for (std::size_t p = 0; p < count; ++p)
      for (int k = 0; k < sym_size<Dim>; ++k) body.stress.push_back(k == 0 ? -4000.0 : 0.0);
    cloud.bodies = {body};
    auto s = state_of<B>(cloud);
    upload_sides(s, cloud.grid, {{.direction = 0, .numbers = {.dashpot_factor = 0.5}}}, k_density);
    interpolate(s);
    finish_sums(s);
    begin_absorbing(s, {1 / std::sqrt(3.0)}, {});
    const double c = std::sqrt(1.2e7 / k_density), face = std::pow(k_edge, Dim - 1);
    const auto table = side_table(s);
    const auto of = [&](Coord<Dim> at, int k) {
      return table[s.sides.host[0].row(at) * SideTerms<Dim>::size + k];
    };
    Coord<Dim> middle, edge;
    for (int d = 0; d < Dim; ++d) middle[d] = edge[d] = d == 0 ? 0 : 2;
    edge[1] = 0;
    for (const auto& [at, area] : {std::pair{middle, face}, std::pair{edge, face / 2}}) {
      CHECK(std::fabs(of(at, SideTerms<Dim>::dashpot) / (0.5 * k_density * c * area) - 1) <
            B::of(1e-10, 1e-5));
      CHECK(std::fabs(of(at, SideTerms<Dim>::dashpot + 1) * std::sqrt(3.0) / (0.5 * k_density * c * area) -
                      1) < B::of(1e-10, 1e-5));
      CHECK(std::fabs(of(at, SideTerms<Dim>::reaction) / (4000 * area) - 1) < B::of(1e-10, 1e-5));
    }
    CHECK(s.sides.unknown == 0);
  });
}

TEST_CASE(
    "absorbing sides of a body of revolution have the areas of its surface, and carry the soil's pressure",
    "[sides]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    if constexpr (B::dim == 2) {
      INFO(build.name());
      constexpr int radius = 6, height = 4;  // cells
      constexpr double pressure = 4000;      // Pa
      Cloud cloud;
      cloud.grid = grid_of<2>({radius, height, 1}, k_edge, Wall::absorbing);
      cloud.materials = {{0, {1e7, 0.25}}};
      BodyInput body = body_of<2>(lattice<2>({0, 0, 0}, {radius, height, 0}, 2, k_edge), 2, k_edge, 0);
      body.state.clear();
      for (std::size_t p = 0; p < body.position.size() / 2; ++p)
        for (int k = 0; k < sym_size<2>; ++k) body.stress.push_back(k < 3 ? -pressure : 0.0);
      cloud.bodies = {body};
      revolve(cloud);
      auto s = state_of<B>(cloud);
      upload_sides(s, cloud.grid,
                   {{.direction = 0, .side = 1}, {.direction = 1}, {.direction = 1, .side = 1}}, k_density);
      interpolate(s);
      finish_sums(s);
      begin_absorbing(s, {1 / std::sqrt(3.0)}, {});
      const double impedance = std::sqrt(1.2e7 * k_density), turn = 2 * std::numbers::pi * k_edge * k_edge;
      const auto table = side_table(s);
      const auto agrees = [&](int side, Coord<2> at, double area) {
        const double* const kept = &table[s.sides.host[side].row(at) * SideTerms<2>::size];
        const int along = side < 2 ? 0 : 1;
        const double out = side % 2 == 0 ? -1 : 1;
        CHECK(std::fabs(kept[SideTerms<2>::dashpot] / (impedance * area) - 1) < B::of(1e-10, 1e-5));
        CHECK(std::fabs(kept[SideTerms<2>::dashpot + 1] * std::sqrt(3.0) / (impedance * area) - 1) <
              B::of(1e-10, 1e-5));
        CHECK(std::fabs(-out * kept[SideTerms<2>::reaction + along] / (pressure * area) - 1) <
              B::of(1e-10, 1e-5));
      };
      for (int j = 0; j <= height; ++j)
        agrees(1, {radius, j}, turn * radius * (j == 0 || j == height ? 0.5 : 1));
      // The integral of N r over the radius.
      for (const int side : {2, 3})
        for (int i = 0; i < radius; ++i)
          agrees(side, {i, side == 2 ? 0 : height}, turn * (i == 0 ? 1.0 / 6 : double(i)));
    }
  });
}
