#pragma once
// The fields of a frame: one table, which the files and their index follow.

#include <algorithm>
#include <string>
#include <vector>

#include "mpm/config.hpp"
#include "output/snapshot.hpp"

namespace mpm {

/// What of a snapshot is written, and how.
struct FrameStyle {
  std::vector<std::string> fields{};  // of bodies and rigids beside the position; empty for all
  int compression = 0;                // level of HDF5's deflate filter, 0 to 9
};

/// The groups that have a field.
enum class Of { all, bodies, nodes };

/// One field of a group. A new field is a line of k_fields.
struct Field {
  const char* name;
  const char* unit;
  int components;
  Of of;
  std::vector<double> ParticleSnapshot::*values;  // [components N]
};

inline constexpr Field k_fields[] = {
    {"position", "m", 3, Of::all, &ParticleSnapshot::position},  // first: the geometry, always float64
    {"velocity", "m/s", 3, Of::all, &ParticleSnapshot::velocity},
    {"grid_velocity", "m/s", 3, Of::bodies, &ParticleSnapshot::grid_velocity},
    {"stress", "Pa", 6, Of::bodies, &ParticleSnapshot::stress},
    {"volume", "m3", 1, Of::bodies, &ParticleSnapshot::volume},
    {"plastic_strain", "-", 1, Of::bodies, &ParticleSnapshot::plastic_strain},
    {"mass", "kg", 1, Of::nodes, &ParticleSnapshot::mass},
    {"number", "-", 1, Of::nodes, &ParticleSnapshot::number},
};

/// Whether a group of this kind has a field in this style. Nodes have all of theirs.
inline bool is_written(const Field& field, Of group, const FrameStyle& style) {
  if (field.of != Of::all && field.of != group) return false;
  return &field == k_fields || group == Of::nodes || style.fields.empty() ||
         std::find(style.fields.begin(), style.fields.end(), field.name) != style.fields.end();
}

/// The names that FrameStyle::fields may hold.
inline std::vector<std::string> frame_field_names() {
  std::vector<std::string> names;
  for (const Field& field : k_fields)
    if (&field != k_fields && field.of != Of::nodes) names.push_back(field.name);
  return names;
}

}  // namespace mpm
