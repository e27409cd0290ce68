#pragma once
// Which nodes a rank shares with which others. Every rank finds the same lists from the same tables, without
// a word to the others.

#include "mesh/patch_grid.hpp"

namespace mpm {

/// The shared nodes of one rank. Entries of a neighbour's list are ordered by the number of the patch and the
/// place of the node in it, on both sides.
struct HaloPlan {
  std::vector<int> neighbours;  // ranks, rising
  std::vector<int> begin;       // first entry of each neighbour [neighbours + 1]
  std::vector<int> node;        // number of the node of each entry: slot * nodes of a patch + place
  std::vector<int> shared;      // each shared node once
  std::vector<int> first;       // first source of a shared node [shared + 1]
  std::vector<int> source;      // in the order of ranks: the entry that came in, -1 for the own sum
  std::vector<std::uint64_t> owned_nodes;  // by slot, a bit a node: reached by this rank and by none below it
  std::vector<char> border;  // by slot: whether particles of other ranks are in the patches round it
};

/// Makes the plan of rank `own`.
///   occupied  by patch: whether it holds particles, of its owner then
///   slots     patches that have a slot on this rank, in the order of slots, which is that of their numbers
HaloPlan plan_halo(const PatchGrid& grid, const Owners& owners, const std::vector<std::uint8_t>& occupied,
                   const std::vector<long>& slots, int own);

}  // namespace mpm
