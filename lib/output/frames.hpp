#pragma once
// frames/frame_NNNNN.h5, one file a frame, and particles.xdmf, their index for ParaView and VTK.

#include <petscsys.h>

#include <string>
#include <vector>

#include "output/frame_fields.hpp"
#include "output/frame_index.hpp"

namespace mpm {

/// Writes one frame whose bodies are spread over the ranks of comm, each with a range of their particles, by
/// MPI-IO. The same datasets as write_frame makes of all of them; whole or absent. Collective.
PetscErrorCode write_frame_together(MPI_Comm comm, const std::string& path, const Snapshot& snapshot,
                                    Precision precision, const FrameStyle& style);

/// Writes one frame as HDF5 to `path`: attributes time [s] and step; a group each body and rigid.
/// Positions are float64; the other fields are float64, or float32 for a run in single precision.
PetscErrorCode write_frame(const std::string& path, const Snapshot& snapshot, Precision precision,
                           const FrameStyle& style = {});

/// The frames of a run, numbered from 0.
class Frames {
 public:
  /// Says where they go; nothing is written yet. The folder was made by prepare_output_folder.
  void open(const std::string& folder, Precision precision, const FrameStyle& style = {},
            MPI_Comm comm = PETSC_COMM_SELF);
  /// Goes on after the first `count` frames of an earlier part of the run; those that are still there stay in
  /// the index.
  PetscErrorCode resume(const Config& config, long count, MPI_Comm comm = PETSC_COMM_SELF);
  /// Brings what was written to the disk, with its name.
  PetscErrorCode settle() const;
  /// Writes the next frame, then the index anew; both are complete or as they were. Collective.
  PetscErrorCode write(const Snapshot& snapshot);
  int count() const { return count_; }

 private:
  PetscErrorCode write_index() const;

  MPI_Comm comm_ = PETSC_COMM_SELF;
  std::string folder_;
  Precision precision_ = Precision::double_;
  FrameStyle style_;
  std::vector<FrameEntry> entries_;
  int count_ = 0;
};

}  // namespace mpm
