#pragma once
// A frame as an HDF5 file. HDF5 makes it in memory, for it does not survive a disk that fills while it
// writes: its close fails, and its clean-up at the end of the program then crashes.

#include <petscsys.h>

#include <string>
#include <vector>

#include "output/frame_fields.hpp"

namespace mpm {

/// The bytes of the file. `path` is for messages, here and below.
PetscErrorCode frame_image(const std::string& path, const Snapshot& snapshot, Precision precision,
                           const FrameStyle& style, std::string* image);

/// A stretch of a frame's file with numbers that several ranks give: all of a field as it is, or one piece of
/// it, compressed.
struct FrameSlab {
  const ParticleSnapshot* body = nullptr;
  const Field* field = nullptr;
  int bytes = 0;                    // of a number
  long first = 0, rows = 0;         // particles of the body that are in it
  bool packed = false;              // compressed, by HDF5's filters
  long long size = 0, offset = -1;  // bytes, in the file; -1 where there are no particles
  unsigned skipped = 0;             // filters that were of no use to it, a bit each
};

/// The slabs of the bodies, in the order of the file, on every rank the same; where they are compressed, in
/// pieces that `ranks` ranks can share, with sizes to be found yet.
std::vector<FrameSlab> frame_slabs(const Snapshot& snapshot, Precision precision, const FrameStyle& style,
                                   int ranks);

/// The numbers of a slab of pieces, compressed; sets its size.
PetscErrorCode pack_slab(const std::string& path, const std::vector<double>& values, int compression,
                         FrameSlab* slab, std::string* bytes);

/// The file without the numbers of the slabs, as a descriptor to read from, which the caller closes; and
/// where the slabs belong. The slabs have their sizes.
PetscErrorCode lay_out_frame(const std::string& path, const Snapshot& snapshot, Precision precision,
                             const FrameStyle& style, int* descriptor, std::vector<FrameSlab>* slabs);

}  // namespace mpm
