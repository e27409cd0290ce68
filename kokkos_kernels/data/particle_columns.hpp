#pragma once
// Columns of numbers that a set of particles has on the host: one table, which files, starts from
// checkpoints, cuts, ranks and the start of a run walk. A new vector of every particle is one row of it.

#include <string>
#include <string_view>
#include <vector>

#include "data/face_terms.hpp"

namespace mpm {

/// A state variable of the law of a body, of each of its particles.
struct StateField {
  std::string name;
  std::vector<double> values;  // [N], in the unit of the law's table
};

/// The particles of a body. A column is empty where its values are not given, or are the same for all.
struct ParticleColumns {
  std::vector<double> position{};  // m [dim N]
  std::vector<double> velocity{};  // m/s [dim N]
  std::vector<double> stress{};    // Pa, effective, tension positive, xx yy zz xy yz zx [4 N; 6 N in 3D]
  std::vector<double> volume{};    // m3, present (m2 in 2D) [N]
  std::vector<double> mass{};      // kg [N]
  std::vector<double> reference_height{};   // m, absolute, of a particle's creation [N]
  std::vector<double> velocity_gradient{};  // m/s a cell of the mesh, C_p of APIC [dim^2 N]
  std::vector<double> domain{};  // cells2 of the mesh, moments of domains that stretch [dim (dim + 1) / 2 N]
  std::vector<double> darcy_flux{};    // m/s, of water that flows in the pores [dim N]
  std::vector<double> solid_volume{};  // m3, of the grains of such soil [N]
  std::vector<double> faces{};         // surfaces of loads [FaceTerms::size for each face of a particle, N]
  std::vector<StateField> state{};     // state variables of the law
  std::vector<StateField> own_parameters{};  // parameters of which each particle has its own value
};

/// Numbers of a particle in a column, by kind.
enum class Width { scalar, vector, stress, matrix, moments, faces };
/// Count of these numbers; faces: loads that a particle is on at most.
constexpr int width_of(Width width, int dim, int faces) {
  switch (width) {
    case Width::scalar: return 1;
    case Width::vector: return dim;
    case Width::stress: return dim == 2 ? 4 : 6;
    case Width::matrix: return dim * dim;
    case Width::moments: return dim * (dim + 1) / 2;
    case Width::faces: return faces * face_places(dim).size;
  }
  return 0;
}

/// Files that hold a column when particles of another run or of the user start this one.
enum class Carried {
  always,       // frames, checkpoints and the user's files have it
  where_kept,   // frames and checkpoints of a run have it, the user's files may
  if_needed,    // frames and checkpoints of a run that needed it have it, the user's files may
  checkpoints,  // checkpoints of a run that needed it alone
  never         // the run makes it anew
};

/// Numbers of a particle of a column in a frame: vectors have three components in 2D too, stresses six.
constexpr int framed_width(Width width) { return width_of(width, 3, 0); }
/// Place in a frame of component k of a column of a run.
constexpr int framed_place(Width width, int dim, int k) {
  return width == Width::matrix ? k / dim * 3 + k % dim : k;
}

/// Options of a body by which it gives a column to all of its particles, in the place of a file.
enum class GivenBy { none, velocity, stress };

/// Values of the particles of a body that has no column: those that all have in common (BodyInput), or zero.
enum class Common { zero, velocity, volume, mass };

/// Groups of a frame that have a column.
enum class Framed { no, bodies, nodes, bodies_and_nodes, contacts, all };

/// Bounds of magnitude that the arithmetic has room for.
enum class Bound { none, speed, stress, volume, mass, coordinate, domain };

/// A row of the table. A column of a vector of the soil on the device (for_each_field_of) has its name in
/// `saved`: by it the start of a run fills the vector, and frames and checkpoints read it.
struct ParticleColumn {
  const char* name;   // of the data set in a frame or a file of the user's
  const char* saved;  // of the vector on the device and of the field in a checkpoint
  const char* unit;   // in frames
  std::vector<double> ParticleColumns::*values;
  Width width;
  Carried carried;
  GivenBy given_by;
  Common common;
  Framed framed;
  int per_cell;  // power of the cell's edge by which a value goes from one mesh to another
  Bound bound;
};

inline constexpr ParticleColumn k_particle_columns[] = {
    {"position", "coordinate", "m", &ParticleColumns::position, Width::vector, Carried::always, GivenBy::none,
     Common::zero, Framed::all, 0, Bound::none},
    {"velocity", "velocity", "m/s", &ParticleColumns::velocity, Width::vector, Carried::where_kept,
     GivenBy::velocity, Common::velocity, Framed::all, 0, Bound::speed},
    {"stress", "stress", "Pa", &ParticleColumns::stress, Width::stress, Carried::where_kept, GivenBy::stress,
     Common::zero, Framed::bodies, 0, Bound::stress},
    {"volume", "volume", "m3", &ParticleColumns::volume, Width::scalar, Carried::always, GivenBy::none,
     Common::volume, Framed::bodies, 0, Bound::volume},
    {"mass", "mass", "kg", &ParticleColumns::mass, Width::scalar, Carried::where_kept, GivenBy::none,
     Common::mass, Framed::bodies_and_nodes, 0, Bound::mass},
    {"reference_height", "reference_height", "m", &ParticleColumns::reference_height, Width::scalar,
     Carried::where_kept, GivenBy::none, Common::zero, Framed::bodies, 0, Bound::coordinate},
    {"velocity_gradient", "affine", "m/s", &ParticleColumns::velocity_gradient, Width::matrix,
     Carried::checkpoints, GivenBy::velocity, Common::zero, Framed::no, 1, Bound::speed},
    {"domain", "domain", "-", &ParticleColumns::domain, Width::moments, Carried::checkpoints, GivenBy::none,
     Common::zero, Framed::no, -2, Bound::domain},
    {"darcy_flux", "darcy_flux", "m/s", &ParticleColumns::darcy_flux, Width::vector, Carried::if_needed,
     GivenBy::none, Common::zero, Framed::bodies, 0, Bound::speed},
    {"solid_volume", "solid_volume", "m3", &ParticleColumns::solid_volume, Width::scalar, Carried::if_needed,
     GivenBy::none, Common::zero, Framed::bodies, 0, Bound::volume},
    {"faces", "", "", &ParticleColumns::faces, Width::faces, Carried::never, GivenBy::none, Common::zero,
     Framed::no, 0, Bound::none},
};

/// The row of a vector of the soil on the device; null where only the device has it.
constexpr const ParticleColumn* column_of(std::string_view saved) {
  for (const ParticleColumn& column : k_particle_columns)
    if (column.saved == saved) return &column;
  return nullptr;
}

/// Calls f(values, width) for every column, state variables and own parameters included.
template <class F>
void for_each_column(ParticleColumns& particles, F&& f) {
  for (const ParticleColumn& column : k_particle_columns) f(particles.*column.values, column.width);
  for (auto* list : {&particles.state, &particles.own_parameters})
    for (StateField& field : *list) f(field.values, Width::scalar);
}

/// Removes the marked rows of a column, whose rows have equally many numbers; there may be none.
template <class Number>
void remove_rows(const std::vector<char>& marked, std::vector<Number>& column) {
  if (column.empty()) return;
  const std::size_t width = column.size() / marked.size();
  std::size_t kept = 0;
  for (std::size_t row = 0; row < marked.size(); ++row)
    for (std::size_t c = 0; c < width && marked[row] == 0; ++c) column[kept++] = column[row * width + c];
  column.resize(kept);
}

/// Removes the marked particles.
inline void remove_rows(const std::vector<char>& marked, ParticleColumns& particles) {
  for_each_column(particles, [&](std::vector<double>& column, Width) { remove_rows(marked, column); });
}

}  // namespace mpm
