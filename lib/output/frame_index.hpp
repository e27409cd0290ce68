#pragma once
// particles.xdmf, the index of the frames for ParaView and VTK.

#include <optional>
#include <string>
#include <vector>

#include "output/frame_surface.hpp"

namespace mpm {

/// Entry of the index for one frame.
struct FrameEntry {
  struct Group {
    std::string name;
    long count = 0;                     // particles
    std::vector<std::string> fields{};  // that it has
    SurfaceSize surface{};
  };
  std::string file;  // relative to the output folder
  double time = 0;   // s
  std::vector<Group> groups;
};

/// The text of particles.xdmf: a temporal collection of spatial collections with one grid a body or rigid,
/// and another one of each surface of triangles.
/// The index shows stress as six scalars, stress_xx to stress_zx. `real_bytes` is 8 or 4, the size of every
/// field but position, which is always 8.
std::string format_xdmf(const std::vector<FrameEntry>& frames, int real_bytes);

/// Entry of the index for a frame of an earlier part of the run; nothing where the frame is no longer there.
/// `groups`: those to look for, of which the first `always` must be there.
std::optional<FrameEntry> read_entry(const std::string& folder, const std::string& name,
                                     const std::vector<std::string>& groups, std::size_t always);

}  // namespace mpm
