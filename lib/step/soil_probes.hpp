#pragma once
// Probes, sections and columns of soil (-probes, -raster), between state, history and checkpoints.

#include "step/step_context.hpp"
#include "transfer/section_sums.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class SoilProbes {
 public:
  explicit SoilProbes(StepContext<Space, T, Dim>& run)
      : run_(run), planes_(planes_of(run.config)), lost_beyond_(planes_.size()) {}

  /// Functions of Stepper. Collective.
  PetscErrorCode begin(ProbeState* state);
  PetscErrorCode sum_sections(std::vector<SectionSum>* sums) const;
  PetscErrorCode measure(const ProbeState& state, std::vector<double>* values) const;
  PetscErrorCode sum_columns(std::vector<long>* sums) const;

  /// Before locate(): marks the particles that are beyond sections.
  BeyondMask<Space> mark_beyond() const;
  /// After locate(): adds those of them that have left the run.
  void add_lost(const BeyondMask<Space>& beyond);
  /// Saves the soil that has left beyond the sections, of all ranks. Collective.
  PetscErrorCode save(SavedState* saved) const;
  /// Rank 0 goes on with the soil that has left on all ranks.
  void restore(const SavedState& saved);

 private:
  /// Particles of all ranks that probes take, on every rank, by probe and id.
  PetscErrorCode take_particles(const ProbeState& state, std::vector<ProbeParticle>* particles) const;

  StepContext<Space, T, Dim>& run_;
  std::vector<SectionPlane> planes_;
  std::vector<SectionSum> lost_beyond_;  // by plane: what has left beyond it, on this rank
};

}  // namespace mpm
