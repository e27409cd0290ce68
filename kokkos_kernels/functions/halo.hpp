#pragma once
// Nodes that several ranks reach: each rank sends its own sums in one buffer, and adds the ghost sums that
// come in.

#include "base/spaces.hpp"
#include "data/core.hpp"

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
  Kokkos::View<int*, Memory> source;       // in the order of ranks: an entry that came in, -1 for the own sum
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

/// Replaces the own sum of each shared node by the sum over the ranks that reach it, in the order of ranks:
/// the same bits on each of them. Where nobody here reads the sum it becomes 0: no kernel does that there,
/// and the next step must not add to it.
template <class Space, class T>
void sum_ghosts(const Space& space, const HaloLists<Space>& lists, const HaloField<T>& field, int width,
                const T* in);

}  // namespace mpm
