#include "parallel/partition.hpp"

#include <metis.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>

#include "common/collectives.hpp"
#include "mesh/background.hpp"

namespace mpm {
namespace {

/// The patches that have a load, as METIS takes them.
struct Graph {
  std::vector<long> patch;
  std::vector<idx_t> begin, neighbour, shared_nodes, weight;
};

/// Nodes that the particles of both of two patches reach.
int shared_nodes(const std::array<int, 3>& offset, int dim) {
  int nodes = 1;
  for (int d = 0; d < dim; ++d) nodes *= offset[d] == 0 ? patch_edge(dim) + 3 : 3;
  return nodes;
}

Graph graph_of(const PatchGrid& grid, const Loads& loads) {
  constexpr double k_heaviest = 1e6;  // METIS counts by whole numbers, and sums them in 32 bits
  Graph graph;
  std::vector<idx_t> vertex(loads.size(), -1);
  double sum = 0;
  for (std::size_t n = 0; n < loads.size(); ++n)
    if (loads[n] > 0) {
      vertex[n] = static_cast<idx_t>(graph.patch.size());
      graph.patch.push_back(static_cast<long>(n));
      sum += loads[n];
    }
  const double scale = std::min(k_heaviest, 1e9 / std::max<double>(graph.patch.size(), 1)) *
                       graph.patch.size() / std::max(sum, 1e-300) / 4;
  graph.begin = {0};
  for (const long n : graph.patch) {
    graph.weight.push_back(std::max<idx_t>(1, static_cast<idx_t>(std::lround(scale * loads[n]))));
    std::map<long, idx_t> shared;  // with each patch round n, which may be there several times
    grid.for_each_around(n, [&](long other, const std::array<int, 3>& offset) {
      if (other != n && vertex[other] >= 0) shared[other] += shared_nodes(offset, grid.dim);
    });
    for (const auto& [other, nodes] : shared) {
      graph.neighbour.push_back(vertex[other]);
      graph.shared_nodes.push_back(nodes);
    }
    graph.begin.push_back(static_cast<idx_t>(graph.neighbour.size()));
  }
  return graph;
}

/// Parts of the graph as intervals of the patches' numbers, of about the same load.
std::vector<idx_t> by_intervals(const Graph& graph, int ranks) {
  const double sum = std::accumulate(graph.weight.begin(), graph.weight.end(), 0.0);
  std::vector<idx_t> part;
  double before = 0;
  for (const idx_t weight : graph.weight) {
    part.push_back(std::min<idx_t>(ranks - 1, static_cast<idx_t>((before + weight / 2.0) / sum * ranks)));
    before += weight;
  }
  return part;
}

double imbalance_of_parts(const Graph& graph, const std::vector<idx_t>& part, int ranks) {
  std::vector<double> load(ranks);
  for (std::size_t n = 0; n < part.size(); ++n) load[part[n]] += graph.weight[n];
  return imbalance_of(load);
}

/// Calls METIS with one seed; false where it fails.
bool call_metis(Graph& graph, int ranks, int seed, std::vector<idx_t>& part) {
  idx_t vertices = static_cast<idx_t>(graph.patch.size()), constraints = 1, parts = ranks, cut = 0;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = seed;
  options[METIS_OPTION_UFACTOR] = 10;  // parts may be 1 % heavier than the mean
  part.assign(vertices, 0);
  return METIS_PartGraphKway(&vertices, &constraints, graph.begin.data(), graph.neighbour.data(),
                             graph.weight.data(), nullptr, graph.shared_nodes.data(), &parts, nullptr,
                             nullptr, options, &cut, part.data()) == METIS_OK;
}

/// The best balanced of some cuts by METIS. On few vertices a part METIS's balance is loose, and parts may be
/// empty: there the intervals are a candidate too.
std::vector<idx_t> parts_of(Graph& graph, int ranks) {
  constexpr int k_seeds = 4, k_few = 8;
  constexpr double k_good = 1.02, k_worse = 1.05;
  std::vector<idx_t> best = by_intervals(graph, ranks), part;
  const bool few = static_cast<long>(graph.patch.size()) < long(k_few) * ranks;
  double balance = imbalance_of_parts(graph, best, ranks) * (few ? 1.0 : k_worse);
  if (static_cast<long>(graph.patch.size()) < 2L * ranks) return best;  // METIS bisects empty graphs there
  for (int seed = 0; seed < k_seeds && (seed == 0 || balance > k_good); ++seed) {
    if (!call_metis(graph, ranks, seed, part)) continue;
    const double now = imbalance_of_parts(graph, part, ranks);
    if (now < balance) best = part, balance = now;
  }
  return best;
}

/// Renumbers the parts so that the heaviest common loads stay with their owners.
void keep_owners(const Graph& graph, const Owners& before, int ranks, std::vector<idx_t>& part) {
  std::vector<double> common(std::size_t(ranks) * ranks);
  for (std::size_t n = 0; n < part.size(); ++n)
    common[std::size_t(part[n]) * ranks + before[graph.patch[n]]] += graph.weight[n];
  std::vector<std::size_t> order(common.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return common[a] > common[b]; });
  std::vector<int> name(ranks, -1), taken(ranks, 0);
  for (const std::size_t pair : order) {
    const int from = static_cast<int>(pair / ranks), rank = static_cast<int>(pair % ranks);
    if (name[from] >= 0 || taken[rank]) continue;
    name[from] = rank;
    taken[rank] = 1;
  }
  for (idx_t& p : part) p = name[p];
}

/// Gives every patch without an owner that of the nearest one that has one.
void spread(const PatchGrid& grid, Owners& owners) {
  std::queue<long> front;
  for (std::size_t n = 0; n < owners.size(); ++n)
    if (owners[n] >= 0) front.push(static_cast<long>(n));
  for (; !front.empty(); front.pop()) {
    const int owner = owners[front.front()];
    grid.for_each_around(front.front(), [&](long other, const std::array<int, 3>&) {
      if (owners[other] >= 0) return;
      owners[other] = owner;
      front.push(other);
    });
  }
  for (std::size_t n = 0; n < owners.size(); ++n)  // beyond periodic sides
    if (owners[n] < 0) owners[n] = owners[grid.number(grid.in_period(grid.place(static_cast<long>(n))))];
}

}  // namespace

double imbalance_of(const std::vector<double>& by_rank) {
  const double sum = std::accumulate(by_rank.begin(), by_rank.end(), 0.0);
  return sum > 0 ? *std::max_element(by_rank.begin(), by_rank.end()) * by_rank.size() / sum : 1;
}

std::vector<double> loads_of(const Owners& owners, const Loads& loads, int ranks) {
  std::vector<double> by_rank(ranks);
  for (std::size_t n = 0; n < loads.size(); ++n) by_rank[owners[n]] += loads[n];
  return by_rank;
}

Owners cut_graph(const PatchGrid& grid, const Loads& loads, int ranks, const Owners& before) {
  Graph graph = graph_of(grid, loads);
  if (graph.patch.empty()) return Owners(grid.count(), 0);
  std::vector<idx_t> part = parts_of(graph, ranks);
  if (!before.empty()) keep_owners(graph, before, ranks, part);
  Owners owners(grid.count(), -1);
  for (std::size_t n = 0; n < part.size(); ++n) owners[graph.patch[n]] = static_cast<int>(part[n]);
  spread(grid, owners);
  return owners;
}

PetscErrorCode cut_graph(MPI_Comm comm, const PatchGrid& grid, const Loads& loads, const Owners& before,
                         Owners* owners) {
  PetscFunctionBeginUser;
  owners->resize(grid.count());
  if (rank_of(comm) == 0) *owners = cut_graph(grid, loads, size_of(comm), before);
  PetscCallMPI(MPI_Bcast(owners->data(), static_cast<int>(owners->size()), MPI_INT, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
