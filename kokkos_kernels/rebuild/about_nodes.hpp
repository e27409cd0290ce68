#pragma once
// Bins about nodes (P2GPlan::about_nodes). A cell has the number of the node at its lower corner, so the bin
// of the nearest node is a cell as any other, from whose lower corner the particle's coordinate is -1/2 to
// 1/2: what takes a position as a cell and a coordinate needs no other formula. Eight particles of a lattice
// of two an edge then reach the same 27 nodes, where those of a cell reach 64.

#include "data/contact_core.hpp"
#include "data/node_bins.hpp"

namespace mpm {

/// The longest half length [cells] of particles that such bins are for.
inline constexpr double k_longest_about_nodes = 1.0 / 3;

/// The margin [cells] of bins about nodes, where no particle is longer than half_length [cells]: as long as a
/// particle has moved no further, it reaches only its node and the nodes next to it.
constexpr double margin_about_nodes(double half_length) { return 0.5 - half_length; }

/// Whether the steps of this run gain from bins about nodes, and kernels for them do all that it asks for.
/// The strategy, the features and the soil must be known. half_length: [cells] the longest of all particles.
template <class Space, class T, int Dim>
bool wants_bins_about_nodes(const State<Space, T, Dim>& s, double half_length);

/// Brings each particle that has an address (ParticleSet::address) from its cell to the bin of the nearest
/// node, before the sort.
template <class Space, class T, int Dim>
void bring_to_nodes(Core<Space, T, Dim>& s);

/// Makes room for the sums of F-bar over cells, and notes the cell of each particle (CellMeans::corner),
/// after the sort.
template <class Space, class T, int Dim>
void note_cells(Core<Space, T, Dim>& s);
/// As average_pressure(), where bins are about nodes and materials have no means of their own; after
/// note_cells().
template <class Space, class T, int Dim>
void average_pressure_of_cells(Core<Space, T, Dim>& s);

}  // namespace mpm
