#pragma once
// Device memory of particles and nodes, by the tables of their fields.

#include <algorithm>

#include "data/nodes.hpp"
#include "data/particles.hpp"

namespace mpm {

/// Room that a view which grew has beyond what it holds (ensure).
inline constexpr double k_grown = 17.0 / 16;

/// Bytes a point of the fields that are sorted. No view of `points` need have memory.
template <class Points_>
double bytes_of_point(Points_ points) {
  double bytes = sizeof(*points.cell.data()) + sizeof(*points.id.data());
  for_each_field(points, [&](const auto& field) { bytes += sizeof(*field.data()); });
  return bytes;
}

/// Bytes that sort a point: its address, its former place, and the widest of its fields in the new order.
template <class Points_>
double bytes_to_sort(Points_ points) {
  std::size_t widest = 0;
  for_each_field(points, [&](const auto& field) { widest = std::max(widest, sizeof(*field.data())); });
  return sizeof(long) + k_grown * double(sizeof(int) + widest);
}

/// Bytes of a node in fields of one entry a node.
template <class Nodes_>
double bytes_of_node(Nodes_ nodes, const NodeUses& uses) {
  double bytes = sizeof(int);  // Bins::begin
  const auto add = [&](const char*, bool in_use, const auto& field) {
    if (in_use) bytes += double(sizeof(*field.data()) * field.static_extent(1));
  };
  for_each_nodal_field(add, nodes, uses);
  return k_grown * bytes;
}

/// Bytes of the patch table, for every patch of the mesh and of the ring round it.
inline constexpr double k_patch_bytes = 2 * sizeof(int);

/// Bytes for a cell of the windows that threads of a processor sum to (`tile`).
template <class T, int Dim>
inline constexpr double k_window_bytes =
    k_grown* double(sizeof(T) * SoilTerms<Dim>::size * Patch<Dim>::window) / Patch<Dim>::cells;

}  // namespace mpm
