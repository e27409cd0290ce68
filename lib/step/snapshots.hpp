#pragma once
// Frames of the run, and fields of checkpoints for starts of other runs; with the reference heights, which no
// step needs.

#include "parallel/kept_by_id.hpp"
#include "step/body_ids.hpp"
#include "step/step_context.hpp"
#include "transfer/download.hpp"

namespace mpm {

template <class Space, class T, int Dim>
class Snapshots {
 public:
  Snapshots(StepContext<Space, T, Dim>& run, const BodyIds& ids) : run_(run), ids_(ids) {}

  /// Keeps the reference heights of all particles. Those of particles that are created now are their heights;
  /// the last direction is the vertical one. Collective.
  PetscErrorCode keep_heights(std::vector<BodyParticles>* bodies);
  /// Makes the frame at out->time. Collective.
  PetscErrorCode take(Snapshot* out) const;
  /// Saves the fields that a start from a checkpoint needs beside those of a restart, and the names of the
  /// state variables and of their fields. Collective.
  PetscErrorCode save_for_starts(SavedState* saved) const;

 private:
  /// Body b of a frame but for reference heights; grid_velocity: m/s [Dim N], of all soil.
  ParticleSnapshot body_of(std::size_t b, const SoilFields& soil,
                           const std::vector<double>& grid_velocity) const;
  /// Rigid bodies of a frame at a time of the tables [s].
  std::vector<ParticleSnapshot> rigids_at(double time) const;

  StepContext<Space, T, Dim>& run_;
  const BodyIds& ids_;
  KeptById heights_;  // m, absolute, where each particle was created
};

}  // namespace mpm
