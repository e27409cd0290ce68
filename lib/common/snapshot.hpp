#pragma once
// Frames and rows of a run, on the host, whatever the backend, precision and dimension.

#include <array>
#include <string>
#include <vector>

#include "data/particle_columns.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// The particles of one body or rigid at one time, in the order of their creation: the columns of
/// k_particle_columns that frames have, as wide as framed_width() says, and the state variables that frames
/// have. Positions are from the origin. All but position and velocity are empty for rigids.
struct ParticleSnapshot : ParticleColumns {
  std::string name;
  std::vector<int> id;  // of the particles of this rank, in the body; empty where they follow one another
  long first = 0;       // on several ranks: number in the body of the first particle here,
  long total = -1;      // and of all of them; negative where all are here
  std::vector<double> grid_velocity{};   // m/s [3 N], of the nodes, interpolated to the particles
  std::vector<std::string> own_names{};  // of those of `state` that are each particle's own parameters
  std::vector<double> number{};          // - [N], of nodes: in the whole mesh, x fastest
  std::vector<double> vertices{};  // m [3 V], of a rigid with a surface of triangles: where they are now
  std::vector<int> triangles{};    // [3 M], numbers of their vertices
  bool has_flow = false;           // of a body in a run in which water flows in pores
};

/// The attribute of a body's group in a frame that names the parameters of which each particle has its own,
/// with commas between them.
inline constexpr const char* k_own_parameter = "own_parameter";

/// The name of the group of nodes.
inline constexpr const char* k_nodes = "nodes";

/// One frame: bodies first, then rigids, in the order of the options, then nodes that hold soil, if they are
/// asked for (position, velocity, mass and number), then the nodes at which bodies act on each other, for
/// each of Config::contact_pairs (position, and fields in `state`).
struct Snapshot {
  double time = 0;  // s
  long step = 0;
  std::vector<ParticleSnapshot> bodies, rigids, nodes{};
  int dim = 0;          // 0: the file has none
  std::string stage{};  // its name; empty: the run has none
  std::vector<ParticleSnapshot> contacts{};
};

/// One row of the history for one body.
struct BodyRow {
  Vec3 lower{}, upper{};              // m, extent of its particles
  double kinetic_energy = 0;          // J
  Vec3 momentum{};                    // kg m/s
  Vec3 quantile{};                    // m, 99.9th percentile of the coordinates of its particles
  Vec3 centre{};                      // m, of mass
  double grid_velocity = 0;           // m/s, the largest at which the nodes move a particle of it
  double stored_energy = 0;           // J, elastic
  double mass = 0;                    // kg, in the mesh
  double water_energy = 0;            // J, of the water that it displaces
  double lost_mass = 0;               // kg, left through free sides or removed
  double lost_energy = 0;             // J, kinetic, that it had
  Vec3 lost_momentum{};               // kg m/s
  long strays = 0, limited = 0;       // particles that are alone; whose volume is at a bound
  long particles = 0;                 // in the mesh
  long stretched = 0;                 // whose domain is at its upper bound along some axis
  long merged = 0;                    // that others took up, since the start
  double merged_energy = 0;           // J, kinetic, that merging has taken since the start
  double corrected = 0, raised = 0;   // J, kinetic and of height, that the position correction has added
  long put_back = 0, lost_count = 0;  // particles put back at walls, and lost, since the start
  double pore_water = 0,
         outflow = 0;  // m3, water without pressure: in its pores, and out of them since the start
};

/// One row of the history for one part of a rigid.
struct PartRow {
  Vec3 force{};   // N, of the soil on it, mean over the interval since the last row
  Vec3 moment{};  // N m, likewise, where the body may turn; about the same point as the body's
};

/// One row of the history for one rigid.
struct RigidRow {
  Vec3 displacement{};  // m, since the start
  Vec3 velocity{};      // m/s
  Vec3 force{};         // N, of the soil on it, mean over the interval since the last row
  // Where it may turn; in 2D the first of each, counter-clockwise. About its centre of mass.
  Vec3 angle{};             // rad, since the start: the rotation vector
  Vec3 angular_velocity{};  // rad/s
  Vec3 moment{};            // N m, as the force; about the moment's point, where the options give one
  // The action of other rigid bodies and of sides of the mesh on it, likewise.
  Vec3 contact_force{};                  // N
  Vec3 contact_moment{};                 // N m
  double kinetic_energy = 0;             // J, where forces move it
  Vec3 spring_force{}, spring_moment{};  // N, N m, of springs and dashpots on it, mean as the force
  std::vector<PartRow> parts;            // where their forces are wanted, and the body is there
};

/// One row of the history for one joint.
struct JointReaction {
  Vec3 force{};     // N, on its first body, mean over the interval since the last row
  Vec3 moment{};    // N m, about the joint's point, likewise; in 2D the first
  double peak = 0;  // N, largest force in a step of the interval
  double work = 0;  // J, of its end on the ground since the start
};

/// One row of the history for a pair of deformable bodies that touch.
struct InterfaceRow {
  Vec3 force{};     // N, on the first body, mean over the interval since the last row
  double area = 0;  // m2, in touch, likewise
  double work = 0;  // J, of friction since the start
};

/// One row of the history for one load on a surface.
struct LoadRow {
  Vec3 force{};     // N, of the load on the soil
  double area = 0;  // m2, of the surface now
};

/// The energy balance of the soil: kinetic + internal + lost - start = gravity + loads + rigids + contact +
/// damping + update + error [J]. Works are those since the start.
struct EnergyRow {
  double kinetic = 0;     // of the particles
  double internal = 0;    // work of the stress: elastic and dissipated
  double elastic = 0;     // what the stress can give back
  double dissipated = 0;  // internal less what the elastic energy has grown
  double lost = 0;        // kinetic, of particles that left, and of merging
  double gravity = 0;     // work of gravity, and of the water that carries soil
  double loads = 0;       // of loads on surfaces
  double rigids = 0;      // of the rigids on the soil
  double contact = 0;     // of walls and contact beyond that: what friction and impact take
  double damping = 0;     // of -damping
  double update = 0;      // of the velocity update: the kinetic energy that it takes
  double error = 0;       // what is missing
};

/// One row of history.csv.
struct HistoryRow {
  long step = 0;
  double time = 0, dt = 0, wall_time = 0;  // s
  std::vector<BodyRow> bodies;
  std::vector<RigidRow> rigids;
  std::vector<JointReaction> joints{};
  std::vector<InterfaceRow> interfaces{};      // of the pairs of bodies in -contact_pairs
  std::array<std::array<Vec3, 2>, 3> walls{};  // N, of the soil on each side of the mesh
  std::vector<LoadRow> loads{};
  double load_work = 0;                    // J, of loads on surfaces, since the start
  double side_work = 0;                    // J, of sides that act on the soil, since the last row
  int stage = 0;                           // number of the stage, from 1 on; 0: the run has none
  double unbalanced_ratio = 0;             // -, where some stage ends by equilibrium
  long filled_cells = 0, empty_cells = 0;  // cells that hold soil; gaps between them
  EnergyRow energy{};                      // where the run asks for it
  std::vector<double> probes{};            // the columns of all probes (output/probes.hpp)
};

}  // namespace mpm
