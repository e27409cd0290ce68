#pragma once
// frames/frame_NNNNN.h5, one file a frame, and particles.xdmf, their index for ParaView and VTK.

#include <petscsys.h>

#include <string>
#include <vector>

#include "mpm/config.hpp"
#include "output/snapshot.hpp"

namespace mpm {

/// What the index says of one frame.
struct FrameEntry {
  struct Group {
    std::string name;
    long count = 0;                     // particles
    bool body = false;                  // has stress, volume and plastic_strain
    std::vector<std::string> fields{};  // that it has; empty for all
  };
  std::string file;  // relative to the output folder
  double time = 0;   // s
  std::vector<Group> groups;
};

/// What of a snapshot is written, and how.
struct FrameStyle {
  std::vector<std::string> fields{};  // of bodies and rigids beside the position; empty for all
  int compression = 0;                // level of HDF5's deflate filter, 0 to 9
};

/// The names that FrameStyle::fields may hold.
std::vector<std::string> frame_field_names();

/// The text of particles.xdmf: a temporal collection of spatial collections with one grid a body or rigid.
/// The index shows stress as six scalars, stress_xx to stress_zx. `real_bytes` is 8 or 4, the size of every
/// field but position, which is always 8.
std::string format_xdmf(const std::vector<FrameEntry>& frames, int real_bytes);

/// Where a field's numbers stand in a frame's file.
struct FrameSlab {
  std::size_t body = 0;  // of Snapshot::bodies
  std::vector<double> ParticleSnapshot::*values = nullptr;
  int components = 0, bytes = 0;  // of a particle; of a number
  long long offset = 0;           // bytes, of the first particle of the body
};

/// A frame's file without the bodies' numbers, made in memory (/dev/shm): its bytes as a descriptor to read
/// from, which the caller closes, and where the numbers belong.
PetscErrorCode lay_out_frame(const std::string& path, const Snapshot& snapshot, Precision precision,
                             const FrameStyle& style, int* descriptor, std::vector<FrameSlab>* slabs);

/// Writes one frame whose bodies are spread over the ranks of comm, each with a range of their particles, by
/// MPI-IO. The same file as write_frame makes of all of them, not compressed; whole or absent. Collective.
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
