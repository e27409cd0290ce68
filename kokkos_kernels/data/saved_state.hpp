#pragma once
// All that a run needs to go on to the same bits, on the host, as plain data whatever the execution space,
// real type and dimension. Points stay in their bins: a point is saved by the cell of its bin and its
// coordinate from there, so that going on does not need the rebuild that the run would not have made here.

#include <array>
#include <string>
#include <vector>

#include "data/impulse_terms.hpp"
#include "data/motion_terms.hpp"

namespace mpm {

/// One field of points. Every type that a field has goes into a double and back without a change of its bits.
struct SavedField {
  std::string name;            // the label of its view, without mpm::
  int components = 1;          // a point
  int bytes = 8;               // of a number on the device: 8 and 4 are real, 2 is a whole number
  std::vector<double> values;  // [components N]
};

/// Points in any order: sorting by address and id gives that of the device back.
struct SavedPoints {
  std::vector<long> id;            // order of creation, over all ranks
  std::vector<long> address;       // Grid::address_of the cell of the bin
  std::vector<SavedField> fields;  // the coordinate in that cell is the first
};

/// Motion of a rigid body, as MotionTerms.
using SavedRigid = std::array<double, MotionTerms::size>;

/// A vector of such a row, and the row with another one in its place.
inline std::array<double, 3> vector_of(const SavedRigid& rigid, int term) {
  return {rigid[term], rigid[term + 1], rigid[term + 2]};
}
inline void set_vector(SavedRigid& rigid, int term, const std::array<double, 3>& value) {
  for (int d = 0; d < 3; ++d) rigid[term + d] = value[d];
}

/// Impulses that contact keeps at the nodes and their sites; nodes that hold none are left out.
struct SavedImpulse {
  std::vector<long> address;   // Grid::address_of the cell whose lower corner is the node
  std::vector<double> values;  // ImpulseTerms of each rigid [ImpulseTerms::size rigids M]; where some rigid
                               // has contact at sites, SiteTerms of each site, rigid by rigid
};
/// Impulses of contact between rigid bodies: of its contacts in the last step, and on each rigid body since
/// the last row of the history.
struct SavedPairs {
  static constexpr int width = 6, totals = 6;  // numbers of a contact and of a rigid
  std::vector<double> contacts;  // [width]: numbers of the two bodies (sides of the mesh are negative: -1 -
                                 // side) and of the point, impulse [N s]
  std::vector<double> impulses;  // [totals], force and moment [N s, N m s]; empty: no two bodies may meet
};

/// Numbers of each of so many rigid bodies at a node of saved impulses.
inline int numbers_of_rigid(const SavedImpulse& saved, std::size_t rigids) {
  const std::size_t rows = saved.address.size() * rigids;
  return rows == 0 ? ImpulseTerms::size : static_cast<int>(saved.values.size() / rows);
}

/// The table of the nodes on sides of the mesh that act (data/sides.hpp), of all ranks.
struct SavedSides {
  std::vector<long> kinds;  // Wall, [2 direction + 1 for the upper side]: 0 to 2 are the words of -mesh_xmin
  std::vector<double> values;   // [rows][SideTerms::size], the sides in this order
  std::vector<double> columns;  // [rows][ColumnTerms::size], of those that are free_field
};

/// Numbers that SavedState::lost has of a body, and places of the numbers of particles among them: those that
/// have left, and those that others took up.
inline constexpr int k_lost = 11, k_lost_left = 0, k_lost_merged = 6;

/// Numbers of a rank in SavedState::bounds, beside MotionTerms::impulse_size a rigid that follow them.
inline constexpr int k_saved_bounds = 8;

/// Numbers of SavedState::energy.
inline constexpr int k_saved_energy = 8;

struct SavedState {
  double bound = 0, increment = 0;  // cells, of Control; the largest of all ranks
  double margin = 0;                // cells, that the bound was held against
  int due_in = 0;                   // steps to a rebuild that is due, the same of all ranks; 0: none is
  std::vector<double>
      bounds;  // of each of several ranks: what Decomposition::save puts there; empty on one rank
  std::vector<long> owners;  // rank of each patch of the grid; empty on one rank
  SavedPoints soil;
  long particles = 0;        // ids given, of all ranks: rows of particles that are gone have no address (-1)
  std::vector<double> lost;  // k_lost numbers a body: those of Lost, and Strays::put_back
  /// Ids of each body that no particle has had: those of a body that is not placed yet, and of particles that
  /// were cut out when it was placed.
  std::vector<long> unused;
  /// The fields of `soil` that hold state variables, in order, and for each body the names of the variables
  /// of its law, with commas: variable k is in field k. The excess pore pressure is a field of its own name.
  std::vector<std::string> columns, variables;
  std::vector<long> alone;  // Grid::address_of the cells whose particles are alone
  int alone_known = 0;      // 1: `alone` holds; 0: the next step finds it
  std::vector<SavedRigid> rigids;
  std::vector<double> joints, supports;  // JointTerms of each joint, SupportTerms of each rigid; or empty
  SavedImpulse impulse;
  SavedPairs pairs;
  std::vector<double> part_impulses;  // PartTerms of each part of a rigid, where forces on parts are measured
  std::vector<double> interfaces;     // InterfaceTerms of each pair of bodies in -contact_pairs
  std::vector<double> energy;  // k_saved_energy numbers where the run has an energy balance: the works, and
                               // kinetic and elastic energy at the start [J], of all ranks; behind them,
                               // where there are loads on surfaces, their work since the start [J]
  SavedSides sides;
  std::vector<double>
      sections;  // 2 a section: kg and m3 (initial volume) that have left beyond it, of all ranks
};

}  // namespace mpm
