#include "parallel/halo_plan.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <utility>

#include "mesh/background.hpp"

namespace mpm {
namespace {

constexpr int k_nodes = 64;  // of a patch, in 2D and in 3D

/// Nodes of a patch, a bit each, that the particles of the patch at `offset` from it reach: the window of a
/// patch goes from node -1 to node edge + 1 (patches.hpp).
std::uint64_t reached_from(const std::array<int, 3>& offset, int dim) {
  const int edge = patch_edge(dim);
  std::uint64_t mask = 0;
  for (int n = 0; n < k_nodes; ++n) {
    bool reached = true;
    for (int d = 0, rest = n; d < dim; ++d, rest /= edge) {
      const int c = rest % edge;
      reached = reached && (offset[d] == 0 || (offset[d] < 0 ? c <= 1 : c == edge - 1));
    }
    if (reached) mask |= std::uint64_t(1) << n;
  }
  return mask;
}

/// Nodes of a patch that each rank reaches.
using Reach = std::vector<std::pair<int, std::uint64_t>>;  // by rank, rising

class Planner {
 public:
  Planner(const PatchGrid& grid, const Owners& owners, const std::vector<std::uint8_t>& occupied, int own)
      : grid_(grid), owners_(owners), occupied_(occupied), own_(own) {
    for (int k = 0; k < 27; ++k) masks_[k] = reached_from({k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1}, grid.dim);
    const int deep = grid.dim == 3;
    for (int z = -deep; z <= deep; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) around_.push_back({grid.number({x, y, z}), mask_of({x, y, z})});
  }

  /// Adds a slot of patch n.
  void add(int slot, long n) {
    std::uint64_t mine = 0;
    if (inside(n) && reach_alone(n, &mine)) {
      plan_.owned_nodes.push_back(mine);
      plan_.border.push_back(0);
    } else {
      add(slot, reach_of(n));
    }
  }

  HaloPlan finish() {
    lists_.erase(own_);
    plan_.begin = {0};
    std::map<int, int> begin;
    for (const auto& [rank, list] : lists_) {
      begin[rank] = plan_.begin.back();
      plan_.neighbours.push_back(rank);
      plan_.node.insert(plan_.node.end(), list.begin(), list.end());
      plan_.begin.push_back(static_cast<int>(plan_.node.size()));
    }
    plan_.first = {0};
    plan_.first.insert(plan_.first.end(), ends_.begin(), ends_.end());
    for (const auto& [rank, place] : sources_)
      plan_.source.push_back(rank == own_ ? -1 : begin[rank] + place);
    return std::move(plan_);
  }

 private:
  std::uint64_t mask_of(const std::array<int, 3>& offset) const {
    return masks_[(offset[2] + 1) * 9 + (offset[1] + 1) * 3 + offset[0] + 1];
  }

  /// Whether all patches round n are in the grid, so that their numbers are n plus an offset.
  bool inside(long n) const {
    const std::array<int, 3> at = grid_.place(grid_.in_first_field(n));
    bool in = true;
    for (int d = 0; d < grid_.dim; ++d) {
      const int ring = grid_.periodic[d] ? 1 : 0;  // at a periodic side, patches round n are far away
      in = in && at[d] > ring && at[d] < grid_.patches[d] - 1 - ring;
    }
    return in;
  }

  /// Whether no other rank reaches patch n, and what this one does; so it is for nearly all.
  bool reach_alone(long n, std::uint64_t* mine) const {
    for (const auto& [offset, mask] : around_) {
      if (!occupied_[n + offset]) continue;
      if (owners_[grid_.in_first_field(n + offset)] != own_) return false;
      *mine |= mask;
    }
    return true;
  }

  /// Nodes of patch n that the ranks reach.
  const Reach& reach_of(long n) {
    reach_.clear();
    grid_.for_each_around(n, [&](long other, const std::array<int, 3>& offset) {
      if (!occupied_[other]) return;
      const int rank = owners_[grid_.in_first_field(other)];
      auto at = std::find_if(reach_.begin(), reach_.end(), [&](const auto& r) { return r.first >= rank; });
      if (at == reach_.end() || at->first != rank) at = reach_.insert(at, {rank, 0});
      at->second |= mask_of(offset);
    });
    return reach_;
  }

  /// Adds the shared nodes of one slot.
  void add(int slot, const Reach& reach) {
    std::uint64_t mine = 0, others = 0, below = 0;
    for (const auto& [rank, mask] : reach) {
      (rank == own_ ? mine : others) |= mask;
      if (rank < own_) below |= mask;
    }
    plan_.owned_nodes.push_back(mine & ~below);
    plan_.border.push_back(others != 0);
    for (std::uint64_t left = mine & others; left != 0; left &= left - 1) {
      const int place = std::countr_zero(left);
      plan_.shared.push_back(slot * k_nodes + place);
      for (const auto& [rank, mask] : reach) {
        if ((mask >> place & 1) == 0) continue;
        std::vector<int>& list = lists_[rank];
        sources_.push_back({rank, static_cast<int>(list.size())});
        if (rank != own_) list.push_back(slot * k_nodes + place);
      }
      ends_.push_back(static_cast<int>(sources_.size()));
    }
  }

  const PatchGrid& grid_;
  const Owners& owners_;
  const std::vector<std::uint8_t>& occupied_;
  int own_;
  std::uint64_t masks_[27];
  std::vector<std::pair<long, std::uint64_t>> around_;  // patches round one inside: what to add to its number
  Reach reach_;
  HaloPlan plan_;
  std::map<int, std::vector<int>> lists_;     // nodes by rank
  std::vector<std::pair<int, int>> sources_;  // rank, entry of its list
  std::vector<int> ends_;                     // of the sources of a shared node
};

}  // namespace

HaloPlan plan_halo(const PatchGrid& grid, const Owners& owners, const std::vector<std::uint8_t>& occupied,
                   const std::vector<long>& slots, int own) {
  Planner planner(grid, owners, occupied, own);
  for (std::size_t slot = 0; slot < slots.size(); ++slot) planner.add(static_cast<int>(slot), slots[slot]);
  return planner.finish();
}

}  // namespace mpm
