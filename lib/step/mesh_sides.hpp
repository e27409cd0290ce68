#pragma once
// Sides of the mesh, between configuration, state, history and checkpoints.

#include "step/step_context.hpp"
#include "transfer/upload.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class MeshSides {
 public:
  explicit MeshSides(StepContext<Space, T, Dim>& run) : run_(run) {}

  /// Puts the sides that act on the soil on the device. A roller or fixed side that moves becomes a driven
  /// one in `grid`.
  void set_up(GridInput* grid);
  /// Finds dashpots, reactions and columns of sides with dashpots, from the soil before the first step.
  /// Collective.
  PetscErrorCode begin();
  /// Measures the forces on the sides for a row, and the work of those that act. Their forces are means since
  /// the last row, an interval [s] ago. Collective.
  PetscErrorCode measure(double interval, HistoryRow* row) const;
  /// Table of the nodes on sides that act, of all ranks. Collective.
  PetscErrorCode gather(std::vector<double>* table) const;
  /// Puts such a table back after lists were made. Collective.
  PetscErrorCode put(const std::vector<double>& table);
  PetscErrorCode save(SavedSides* saved) const;
  /// Restores the tables of sides of the same kind. A side that begins to absorb goes on to carry the forces
  /// that it held till now. So does a side with columns whose ends are held in another way; its columns begin
  /// anew. Collective.
  PetscErrorCode restore(const SavedSides& saved);

 private:
  /// Finds the rows of the sides' nodes that this rank answers for.
  PetscErrorCode find_own(std::vector<int>* own) const;

  StepContext<Space, T, Dim>& run_;
};

}  // namespace mpm
