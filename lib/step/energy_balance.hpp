#pragma once
// Energy balance of the soil (-output_energy on), between state, history and checkpoints.

#include "step/step_context.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class EnergyBalance {
 public:
  explicit EnergyBalance(StepContext<Space, T, Dim>& run) : run_(run) {}

  /// Begins with the energies of the soil as it is, and with works of zero. Collective.
  PetscErrorCode begin();
  /// Measures the balance for a row that has its bodies and loads. Collective.
  PetscErrorCode measure(HistoryRow* row) const;
  /// After the soil was changed between two steps: goes on with the dissipated energy and the energy that the
  /// update takes of `before`. now: a row with bodies. Collective.
  PetscErrorCode keep(const EnergyRow& before, HistoryRow* now);
  /// Saves the works of all ranks, and the energies at the start. Collective.
  PetscErrorCode save(SavedState* saved) const;
  /// Rank 0 goes on with the works of all ranks.
  void restore(const SavedState& saved);

 private:
  PetscErrorCode sum_works(std::vector<double>* works) const;

  StepContext<Space, T, Dim>& run_;
  double kinetic_at_start_ = 0, elastic_at_start_ = 0;  // J, of all ranks
};

}  // namespace mpm
