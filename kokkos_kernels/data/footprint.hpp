#pragma once
// Device memory of particles and nodes, from their types alone.

#include "data/nodes.hpp"
#include "data/particles.hpp"

namespace mpm {

/// Bytes that a State holds for each particle of the soil, with what sorts it, for each node, and, of the
/// windows that threads of a processor sum to (`tile`), for each cell. Lists of the strategies come on top.
template <class T, int Dim>
struct Footprint {
  static constexpr double grown = 17.0 / 16;  // ensure() leaves room
  /// More where domains stretch.
  static constexpr double domain(bool on_device) {
    return sizeof(DomainMoments<T, Dim>) + sizeof(Vector<T, Dim>) + sizeof(T) +
           (on_device ? sizeof(Vector<float, Dim>) : sizeof(Vector<T, Dim>));  // StoredLength
  }
  /// Bytes of a node for domains that stretch.
  static constexpr double domain_node = grown * sizeof(T) * (CentreTerms<Dim>::size + Dim);
  /// More where the mesh is periodic.
  static constexpr double periods = sizeof(Vector<T, Dim>);
  /// More with loads on surfaces: of a particle (one load), and of a node.
  static constexpr double face = sizeof(Face<Dim>) + grown * 3 * sizeof(Vector<T, Dim>);
  static constexpr double load = grown * sizeof(T) * Dim;
  /// More for an energy balance.
  static constexpr double energy = grown * (2 * sizeof(SymTensor<T, Dim>) + sizeof(T));
  /// More for the position correction: of a particle, which sorts in half of it, and of a node.
  static constexpr double correction = grown * sizeof(Vector<T, Dim>);
  static constexpr double shares = grown * sizeof(T) * Dim;
  /// columns: of the history of the laws.
  static constexpr double particle(int columns) {
    return 2 * sizeof(Vector<T, Dim>) + sizeof(SymTensor<T, Dim>) + (1 + columns) * sizeof(T) +
           sizeof(std::uint16_t) + 2 * sizeof(int) + sizeof(long) +
           grown * (sizeof(int) + sizeof(Vector<T, Dim>));
  }
  static constexpr double node =
      grown * (sizeof(T) * (SoilTerms<Dim>::size + NodeKinematics<Dim>::size + BoundaryTerms<Dim>::size) +
               sizeof(int));
  /// Bytes of a point of a rigid, with the memory that sorts it.
  static constexpr double rigid_point =
      2 * sizeof(Vector<T, Dim>) + sizeof(Vector<double, Dim>) + 3 * sizeof(int) + sizeof(long);
  /// Bytes of the patch table, for every patch of the mesh and of the ring round it.
  static constexpr double patch = 2 * sizeof(int);
  static constexpr double window =
      grown * double(sizeof(T) * SoilTerms<Dim>::size * Patch<Dim>::window) / Patch<Dim>::cells;
};

}  // namespace mpm
