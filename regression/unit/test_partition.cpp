// Who owns which patch, and which nodes ranks share: tables alone, no messages.

#include <algorithm>
#include <catch2/catch_test_macros.hpp>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "mesh/background.hpp"
#include "parallel/halo_plan.hpp"
#include "parallel/partition.hpp"

using namespace mpm;

namespace {

constexpr int k_nodes = 64;  // of a patch

/// A grid of n patches along each direction, with the ring.
PatchGrid grid_of(int dim, int n) {
  PatchGrid grid{dim, {n + 2, n + 2, 1}};
  if (dim == 3) grid.patches[2] = n + 2;
  return grid;
}

/// Loads in a box of patches, from the ring's first inner patch.
Loads box_of_loads(const PatchGrid& grid, std::array<int, 3> size, double load) {
  Loads loads(grid.count());
  for (long n = 0; n < grid.count(); ++n) {
    const std::array<int, 3> at = grid.place(n);
    bool in = true;
    for (int d = 0; d < grid.dim; ++d) in = in && at[d] >= 1 && at[d] <= size[d];
    if (in) loads[n] = load;
  }
  return loads;
}

/// Nodes that the particles of a patch reach, as patch times nodes plus place.
std::set<long> window_of(const PatchGrid& grid, long patch) {
  const int edge = patch_edge(grid.dim);
  const std::array<int, 3> at = grid.place(patch);
  std::set<long> nodes;
  for (int z = grid.dim == 3 ? -1 : 0; z <= (grid.dim == 3 ? edge + 1 : 0); ++z)
    for (int y = -1; y <= edge + 1; ++y)
      for (int x = -1; x <= edge + 1; ++x) {
        const int c[3] = {x, y, z};
        std::array<int, 3> to = at;
        int place = 0, step = 1;
        for (int d = 0; d < grid.dim; ++d, step *= edge) {
          to[d] += c[d] < 0 ? -1 : c[d] / edge;
          place += step * ((c[d] + edge) % edge);
        }
        nodes.insert(grid.number(to) * k_nodes + place);
      }
  return nodes;
}

/// A random table of owners, and patches that hold particles.
struct Scene {
  PatchGrid grid;
  Owners owners;
  std::vector<std::uint8_t> occupied;
  std::vector<long> slots;  // every patch has one, on every rank
};

Scene random_scene(int dim, int ranks, unsigned seed) {
  std::mt19937 dice(seed);
  Scene scene{grid_of(dim, dim == 2 ? 6 : 3), {}, {}, {}};
  for (long n = 0; n < scene.grid.count(); ++n) {
    const std::array<int, 3> at = scene.grid.place(n);
    bool inside = true;
    for (int d = 0; d < dim; ++d) inside = inside && at[d] > 0 && at[d] < scene.grid.patches[d] - 1;
    scene.owners.push_back(static_cast<int>(dice() % ranks));
    scene.occupied.push_back(inside && dice() % 3 > 0);
    scene.slots.push_back(n);
  }
  return scene;
}

}  // namespace

TEST_CASE("two ranks list the nodes that they share alike, and these are all of them", "[partition]") {
  for (const int dim : {2, 3})
    for (const int ranks : {2, 3, 5}) {
      const Scene scene = random_scene(dim, ranks, 7 * dim + ranks);
      std::vector<std::set<long>> reached(ranks);
      for (long n = 0; n < scene.grid.count(); ++n)
        if (scene.occupied[n]) reached[scene.owners[n]].merge(window_of(scene.grid, n));
      std::map<std::pair<int, int>, std::vector<int>> lists;  // of the first rank, with the second
      for (int r = 0; r < ranks; ++r) {
        const HaloPlan plan = plan_halo(scene.grid, scene.owners, scene.occupied, scene.slots, r);
        for (std::size_t n = 0; n < plan.neighbours.size(); ++n)
          lists[{r, plan.neighbours[n]}] = {plan.node.begin() + plan.begin[n],
                                            plan.node.begin() + plan.begin[n + 1]};
      }
      for (int a = 0; a < ranks; ++a)
        for (int b = 0; b < ranks; ++b) {
          if (a == b) continue;
          CHECK(lists[{a, b}] == lists[{b, a}]);
          std::vector<int> both;
          std::set_intersection(reached[a].begin(), reached[a].end(), reached[b].begin(), reached[b].end(),
                                std::back_inserter(both));
          CHECK(lists[{a, b}] == both);
        }
    }
}

TEST_CASE("the sources of a shared node are its ranks in their order, its own share among them",
          "[partition]") {
  const Scene scene = random_scene(2, 4, 3);
  for (int r = 0; r < 4; ++r) {
    const HaloPlan plan = plan_halo(scene.grid, scene.owners, scene.occupied, scene.slots, r);
    for (std::size_t n = 0; n < plan.shared.size(); ++n) {
      int before = -1, own = 0;
      for (int e = plan.first[n]; e < plan.first[n + 1]; ++e) {
        const int entry = plan.source[e];
        int rank = r;
        if (entry < 0) {
          ++own;
        } else {
          CHECK(plan.node[entry] == plan.shared[n]);
          const auto end = std::upper_bound(plan.begin.begin(), plan.begin.end(), entry);
          rank = plan.neighbours[end - plan.begin.begin() - 1];
        }
        CHECK(rank > before);
        before = rank;
      }
      CHECK(own == 1);
    }
  }
}

TEST_CASE("exactly one rank answers for a node that any reaches", "[partition]") {
  for (const int dim : {2, 3}) {
    const int ranks = 4;
    const Scene scene = random_scene(dim, ranks, 11);
    std::set<long> reached;
    for (long n = 0; n < scene.grid.count(); ++n)
      if (scene.occupied[n]) reached.merge(window_of(scene.grid, n));
    std::map<long, int> answers;
    for (int r = 0; r < ranks; ++r) {
      const HaloPlan plan = plan_halo(scene.grid, scene.owners, scene.occupied, scene.slots, r);
      REQUIRE(plan.owned_nodes.size() == scene.slots.size());
      for (std::size_t slot = 0; slot < plan.owned_nodes.size(); ++slot)
        for (int k = 0; k < k_nodes; ++k)
          if (plan.owned_nodes[slot] >> k & 1) ++answers[scene.slots[slot] * k_nodes + k];
    }
    CHECK(answers.size() == reached.size());
    for (const auto& [node, count] : answers) CHECK((count == 1 && reached.count(node) == 1));
  }
}

TEST_CASE("METIS balances patches of the same load, and every patch has an owner", "[partition]") {
  for (const int dim : {2, 3})
    for (const int ranks : {2, 3, 4, 8}) {
      const PatchGrid grid = grid_of(dim, dim == 2 ? 20 : 8);
      const Loads loads = box_of_loads(grid, {16, 16, 8}, 100);
      const Owners owners = cut_graph(grid, loads, ranks, {});
      CHECK(imbalance_of(loads_of(owners, loads, ranks)) < 1.1);
      REQUIRE(static_cast<long>(owners.size()) == grid.count());
      for (const int r : owners) CHECK((r >= 0 && r < ranks));
    }
}

TEST_CASE("more ranks than patches, a layer of one patch, and no particle at all can be cut", "[partition]") {
  const PatchGrid grid = grid_of(2, 12);
  const Loads few = box_of_loads(grid, {3, 1, 1}, 5), layer = box_of_loads(grid, {12, 1, 1}, 5);
  const Owners spread = cut_graph(grid, few, 8, {});
  for (const double load : loads_of(spread, few, 8)) CHECK(load <= 5);
  CHECK(imbalance_of(loads_of(cut_graph(grid, layer, 4, {}), layer, 4)) == 1.0);
  CHECK(cut_graph(grid, Loads(grid.count()), 4, {}) == Owners(grid.count(), 0));
}

TEST_CASE("a new cut of the same loads leaves patches with their owners", "[partition]") {
  const PatchGrid grid = grid_of(2, 16);
  const Loads loads = box_of_loads(grid, {16, 16, 1}, 64);
  const Owners before = cut_graph(grid, loads, 4, {});
  Owners renamed = before;
  for (int& r : renamed) r = (r + 1) % 4;
  const Owners again = cut_graph(grid, loads, 4, renamed);
  long same = 0;
  for (long n = 0; n < grid.count(); ++n) same += loads[n] > 0 && again[n] == renamed[n];
  CHECK(same == 256);
}

TEST_CASE("boxes of ranks have a patch each, and as small a cut as there is", "[partition]") {
  CHECK(ranks_along(4, {50, 4, 1}) == std::array<int, 3>{4, 1, 1});
  CHECK(ranks_along(4, {10, 10, 1}) == std::array<int, 3>{2, 2, 1});
  CHECK(ranks_along(8, {8, 8, 8}) == std::array<int, 3>{2, 2, 2});
  CHECK(ranks_along(7, {3, 3, 1}) == std::array<int, 3>{2, 3, 1});  // six of seven
  CHECK(ranks_along(5, {1, 1, 1}) == std::array<int, 3>{1, 1, 1});
}
