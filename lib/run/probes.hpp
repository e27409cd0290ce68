#pragma once
// Probes of the history, and rasters of what passed.

#include "output/probes.hpp"
#include "output/rasters.hpp"
#include "run/clock.hpp"
#include "step/stepper.hpp"

namespace mpm {

class Probes {
 public:
  /// At the start of a run: what probes follow, and the first look for the rasters.
  PetscErrorCode begin(Job& job, const Clock& clock, Stepper& stepper);
  /// Goes on with those of a checkpoint.
  void go_on(Checkpoint& c) { state_ = std::move(c.probes), rasters_ = std::move(c.rasters); }
  void save(Checkpoint& c) const { c.probes = state_, c.rasters = rasters_; }

  /// The columns of all probes in a row of the history.
  PetscErrorCode measure(const Config& config, Stepper& stepper, std::vector<double>* values) const;
  PetscErrorCode update_rasters(const Config& config, double time, Stepper& stepper);
  /// Writes the rasters so far, with the depth as it is now; in a run that failed, with the depth of the last
  /// update.
  PetscErrorCode write_rasters(const Job& job, Stepper& stepper);

  /// Displacements of particles that are followed begin anew.
  PetscErrorCode reset(const Config& config, Stepper& stepper);
  /// Particles for the probes that follow one of a body that was not there before.
  PetscErrorCode follow_placed(const Config& config, Stepper& stepper);
  /// A stage that removes or places bodies takes nothing through a section: what is beyond counts from the
  /// new start.
  PetscErrorCode keep_sections(const Config& config, const std::vector<SectionSum>& before, Stepper& stepper);

 private:
  ProbeState state_;
  Rasters rasters_;
};

/// Fault of the probes and rasters in the checkpoint of a restart, as the end of "takes ..."; empty if there
/// is none.
std::string probes_fault(const Checkpoint& checkpoint, const Config& config);

}  // namespace mpm
