#pragma once
// Nodes that several ranks reach: their shares go out in one buffer, and what comes in is summed.

#include "base/spaces.hpp"
#include "data/state.hpp"

namespace mpm {

/// Which nodes are shared. The lists are made on the host at every rebuild, alike on all ranks that share a
/// node.
template <class Space>
struct HaloLists {
  using Memory = typename Space::memory_space;
  int sent = 0, shared = 0;
  Kokkos::View<int*, Memory> node;         // of each entry that goes out, neighbour by neighbour [sent]
  Kokkos::View<int*, Memory> shared_node;  // each shared node once [shared]
  Kokkos::View<int*, Memory> begin;        // first source of a shared node [shared + 1]
  Kokkos::View<int*, Memory> source;  // in the order of ranks: an entry that came in, -1 for the own share
};

/// A nodal field as rows of `size` values, and where a row begins in an entry of the buffer.
template <class T>
struct HaloField {
  T* values;
  int size, offset;
  const int* read = nullptr;  // by slot: 0 where nobody here reads the field; null: it is read everywhere
};

/// Writes the nodes' values to the entries of `out`, of `width` values each.
template <class Space, class T>
void pack_nodes(const Space& space, const HaloLists<Space>& lists, const HaloField<T>& field, int width,
                T* out);

/// Replaces each shared node's own share by the sum over the ranks that reach it, in the order of ranks: the
/// same bits on each of them. Where nobody here reads it the share becomes 0: no kernel does that there, and
/// the next share must not add to it.
template <class Space, class T>
void sum_shares(const Space& space, const HaloLists<Space>& lists, const HaloField<T>& field, int width,
                const T* in);

}  // namespace mpm
