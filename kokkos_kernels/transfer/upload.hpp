#pragma once
// From a description on the host to soil and rigid bodies on the device.

#include <array>
#include <memory>
#include <vector>

#include "data/particle_columns.hpp"
#include "data/surface_samples.hpp"
#include "rebuild/rebuild.hpp"

namespace mpm {

/// The background mesh for kernels.
struct GridInput {
  double spacing = 1;  // m
  std::array<int, 3> cells{};
  std::array<int, 3> patches{};  // with the ring outside
  std::array<std::array<Wall, 2>, 3> walls{};
};

struct MaterialInput {
  int model = 0;                         // index into Materials
  std::vector<double> parameters;        // in the order of the model's table
  std::shared_ptr<const void> object{};  // of make_object, where the model has one
  double pore_stiffness = 0;             // Pa, of water in its pores that does not flow; 0: there is none
  double f_bar_share = 1;                // -, of FBar::fraction
  bool saturated = false;                // water flows in its pores

  bool has_pore_pressure() const { return saturated || pore_stiffness > 0; }
};

/// Particles of one deformable body: columns, and where a column is empty the values that all particles have
/// in common. Positions are from the mesh's lower corner; the stress is total where the state has an excess
/// pore pressure. The state has the variables of the law, in the order of its table, or none of them, where
/// they are zero; behind them the excess pore pressure, where it is not zero.
struct BodyInput : ParticleColumns {
  std::vector<int> id;                      // [N], or empty where they are counted from 0
  std::array<double, 3> common_velocity{};  // m/s
  double particle_volume = 0;               // m3
  double least_volume = 0;                  // m3, of all ranks, as they were created; 0: that above
  double most_volume = 0;                   // m3, likewise
  double particle_mass = 0;                 // kg; 0: density times particle_volume
  double least_mass = 0;                    // kg, where they differ in mass, of all ranks; else 0
  double half_length = 0.25;                // cells
  double density = 0;                       // kg/m3
  bool weighed = false;  // each particle's mass is the density times its volume at its creation
  int material = 0;
  int velocity_field = 0;  // bodies of one field stick to one another, those of two do not feel each other
};

/// Mass of each particle of a body whose particles have none of their own [kg].
inline double common_mass(const BodyInput& body) {
  return body.particle_mass > 0 ? body.particle_mass : body.density * body.particle_volume;
}

/// The surface of a rigid body, as Surface has it.
struct SurfaceInput {
  SurfaceKind kind = SurfaceKind::box;
  std::array<double, 3> centre{}, half{}, normal{};
  double radius = 0, angle = 0;  // m, rad
  std::vector<Vertex> vertices;
  int columns = 0;          // of heights, in a row
  SampleGrid grid{};        // sampled: numbers in its tables count from 0
  std::vector<int> blocks;  // as in SurfaceTables
  std::vector<SurfaceSample> samples;
  std::vector<unsigned char> edges;
  std::vector<SurfaceInput> parts;
};

/// spacing [m]: edge of the cells, of which round-off is a share.
template <int Dim>
Surface<Dim> surface_of(const SurfaceInput& in, double spacing);

/// Rotation of a rigid body: nothing is set where it may not turn.
struct RigidTurning {
  bool turns = false;
  std::array<double, 3> centre{};          // m, of mass
  std::array<double, 3> spin{};            // rad/s, in 2D the first; initial, or prescribed
  std::array<double, 3> moment{};          // N m, external, likewise
  std::array<double, 3> principal{};       // kg m2, principal moments of inertia, in 2D the first
  std::array<double, 4> axes{1, 0, 0, 0};  // quaternion, from the principal axes to the body's (3D)
  int axis = -1;                           // the only one about which moments turn it; 3: any; -1: none
  double reach = 0;                        // m, from the centre to the farthest point
};

/// Particles of one rigid body, its motion and its contact.
struct RigidInput {
  std::vector<double> position;      // m [Dim N]
  double particle_volume = 0;        // m3
  double revolved_volume = 0;        // m3, of the rigid where it is revolved about the axis; else 0
  double half_length = 0.125;        // cells
  double density = 1;                // kg/m3
  std::array<double, 3> velocity{};  // m/s
  std::array<double, 3> force{};     // N, external and weight
  bool dynamic = false;
  bool light = false;          // against the soil, so that contact at nodes solves for its velocity
  bool timed = false;          // its velocity follows a table
  std::array<bool, 3> held{};  // no force moves it along these axes
  RigidTurning turning;        // where it may turn
  double shear_limit = 0;      // Pa, infinite where only the friction limits
  double shear_fraction = -1;  // -, of the soil's strength instead of the limit; negative: none
  double friction = -1;        // -, negative: none
  SurfaceInput surface;
  std::vector<SurfaceInput> parts;  // of several, as they were given; sampled ones without samples
  bool part_forces = false;         // the forces on them are wanted
  bool surface_normal = false;      // contact normals from the surface, not from the mass gradient
  bool at_sites = false;            // contact at sites, not at nodes
  bool separates = true;            // the soil may part from it
  bool permeable = false;           // water in the pores of the soil passes it
  double reach = 0;                 // m, gap at which the contact ends; 0: it does not depend on the gap
  double exponent = 6;              // -, of its decrease with the gap
};

/// Puts the particles on the device; sort_and_list and begin_domains then make patches, bins, lists and
/// domains. s.p2g and the scalars of s are set by the caller, before. Returns the first fault (a particle
/// outside the mesh), if any.
template <class Space, class T, int Dim>
Fault upload(ContactCore<Space, T, Dim>& s, const GridInput& grid,
             const std::vector<MaterialInput>& materials, const std::vector<BodyInput>& bodies,
             const std::vector<RigidInput>& rigids);

}  // namespace mpm
