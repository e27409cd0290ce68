#pragma once
// The friction's impulses at nodes, when ranks come to reach other nodes than before: the rank that was
// responsible for a node before a rebuild sends its impulses to the ranks that reach it afterwards.

#include <vector>

#include "base/spaces.hpp"
#include "data/contact_core.hpp"

namespace mpm {

/// Impulses of a set of nodes.
template <class T>
struct NodeImpulses {
  std::vector<long> node;  // Patch::cells times the number of the patch in the whole grid, plus the place
  std::vector<T> value;    // N s [rigids][of each node: node after node]
};

/// Impulses that are not zero, of the nodes that this rank is responsible for (State::owned_nodes).
template <class Space, class T, int Dim>
NodeImpulses<T> list_impulses(const ContactCore<Space, T, Dim>& s);

/// Sets the impulse of these nodes, where they have a slot, and that of all others to zero.
template <class Space, class T, int Dim>
void put_impulses(ContactCore<Space, T, Dim>& s, const NodeImpulses<T>& impulses);

}  // namespace mpm
