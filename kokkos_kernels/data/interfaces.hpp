#pragma once
// Interfaces between deformable bodies that have velocity fields of their own.

#include <limits>

#include "base/most_fields.hpp"
#include "base/spaces.hpp"
#include "base/types.hpp"

namespace mpm {

/// Law of contact between the soil of two velocity fields.
struct InterfaceLaw {
  bool welded = true;   // the fields move as one where they share nodes
  double friction = 0;  // -, Coulomb coefficient; negative: neither friction nor adhesion is given
  double adhesion = 0;  // Pa, shear stress at no normal stress, beside friction
  double shear_limit = std::numeric_limits<double>::infinity();  // Pa
  double shear_fraction = -1;  // -, shear limit over the strength of the weaker soil; negative: none is given
  bool strong[2] = {true, true};  // whether each field, the lower one first, has a strength
  int row = -1;                   // of the pair of bodies that has this law; -1: no pair has it
  int sign = 1;  // of forces on the lower field in the row: -1 where the pair lists it second
};

/// Sums over the nodes of an interface: impulse on the first body [N s], area in touch times time [m2 s] and
/// work of friction [J].
template <int Dim>
struct InterfaceTerms {
  static constexpr int impulse = 0, area = Dim, work = Dim + 1, size = Dim + 2;
};

/// At one node: force on the first body [N], normal out of it, and area [m2].
template <int Dim>
struct InterfaceTraction {
  static constexpr int force = 0, normal = Dim, area = 2 * Dim, size = 2 * Dim + 1;
};

/// Nodes that several velocity fields share, with the laws and the forces there. A place is a patch of the
/// mesh in which two fields or more are active.
template <class Space, int Dim>
struct Interfaces {
  using Memory = typename Space::memory_space;
  int fields = 1;                            // velocity fields
  int rows = 0;                              // pairs of bodies, whose sums are kept
  int count = 0;                             // places, until the next rebuild
  Kokkos::View<InterfaceLaw*, Memory> laws;  // of fields a and b: a * fields + b
  Kokkos::View<int*, Memory> slots;          // [place][field]; -1: the field is not active there
  /// Patches of a field that this rank takes as holding soil, though they hold none: they hold soil of
  /// another field, and soil of other ranks may reach their nodes.
  Kokkos::View<int*, Memory> borrowed;
  Kokkos::View<int*, Memory> entry;      // by slot: its place * fields + field, from 1 on; 0: none
  Kokkos::View<double*, Memory> force;   // N, of other fields on a node: [place][field][component][cell]
  Kokkos::View<double*, Memory> sums;    // InterfaceTerms of a step: [place][row]
  Kokkos::View<double*, Memory> totals;  // InterfaceTerms of each row; impulse and area since the host last
                                         // took them, work since the start

  bool in_use() const { return fields > 1 && laws.extent(0) > 0; }
};

}  // namespace mpm
