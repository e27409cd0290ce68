#pragma once
// The fields of a frame: one table, which the files and their index follow.

#include <algorithm>
#include <string>
#include <vector>

#include "common/snapshot.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Fields of a snapshot that are written, and their form.
struct FrameStyle {
  std::vector<std::string> fields{};  // of bodies and rigids beside the position; empty for all
  int compression = 0;                // level of HDF5's deflate filter, 0 to 9
};

/// One field of a group. Fields come from the tables of particles' columns and of laws' state variables; what
/// else frames have is a line of frame_fields().
struct Field {
  const char* name;
  const char* unit;
  int components;
  Framed of;
  std::vector<double> ParticleSnapshot::*values;  // [components N]; null: a state variable, by its name
  bool of_flow = false;                           // runs in which water flows in pores alone have it
};

/// All fields that a group of any run may have; the position, which is the geometry, is the first.
const std::vector<Field>& frame_fields();

/// The numbers of a field in a group; null where the group has none.
const std::vector<double>* values_of(const ParticleSnapshot& particles, const Field& field);

inline bool is_position(const Field& field) { return field.values == &ParticleSnapshot::position; }

/// Whether a group holds nodes of the mesh: it has all of its fields, whatever -output_fields names.
constexpr bool is_of_mesh(Framed group) { return group == Framed::nodes || group == Framed::contacts; }

/// Whether the groups of a kind (all: rigids) have a field.
inline bool belongs_to(const Field& field, Framed group) {
  if (group == Framed::contacts) return is_position(field) || field.of == group;
  return field.of == Framed::all || field.of == group ||
         (field.of == Framed::bodies_and_nodes && (group == Framed::bodies || group == Framed::nodes));
}

/// Whether a field is float64 in any precision: where particles are and were.
inline bool is_exact(const Field& field) {
  return is_position(field) || field.values == &ParticleSnapshot::reference_height;
}

/// Whether a group of this kind is written with a field in this style.
inline bool is_written(const ParticleSnapshot& particles, const Field& field, Framed group,
                       const FrameStyle& style) {
  if (!belongs_to(field, group) || values_of(particles, field) == nullptr) return false;
  return is_position(field) || is_of_mesh(group) || style.fields.empty() ||
         std::find(style.fields.begin(), style.fields.end(), field.name) != style.fields.end();
}

/// The names of the fields that a group of this kind is written with.
inline std::vector<std::string> written_fields(const ParticleSnapshot& particles, Framed group,
                                               const FrameStyle& style) {
  std::vector<std::string> names;
  for (const Field& field : frame_fields())
    if (is_written(particles, field, group, style)) names.push_back(field.name);
  return names;
}

/// The names that FrameStyle::fields may hold.
inline std::vector<std::string> frame_field_names() {
  std::vector<std::string> names;
  for (const Field& field : frame_fields())
    if (!is_position(field) && !is_of_mesh(field.of)) names.push_back(field.name);
  return names;
}
/// The list for a message, which names only the first and the last of numbered names: "state_1 to state_9".
std::string frame_field_list();

}  // namespace mpm
