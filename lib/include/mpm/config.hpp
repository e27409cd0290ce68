#pragma once
// Every input of a run as plain structs, validated, in SI units. In 2D (plane strain) every force and mass is
// per metre of width, or of the whole revolution where the geometry is axisymmetric, and the third component
// of a vector is zero and unused.

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "choices.hpp"
#include "side_kinds.hpp"

namespace mpm {

using Vec3 = std::array<double, 3>;
using Sym6 = std::array<double, 6>;  // symmetric tensor: xx yy zz xy yz zx (in 2D the last two are 0)

/// Arithmetic of the fields (-precision).
enum class Precision { double_, single };

/// A quantity that changes in time: its values at points, straight between them, or smooth by 3 x^2 - 2 x^3.
struct TimeTable {
  std::vector<double> times;  // s, each after the one before
  std::vector<Vec3> values;   // at these
  bool smooth = false;
  std::string file;  // CSV; empty where the option itself lists the points
};

/// Properties of a side of the mesh beside its kind.
struct SideConfig {
  SideNumbers numbers;
  Vec3 velocity{};                          // m/s; where a table gives it, its components of largest size
  std::optional<TimeTable> velocity_table;  // m/s
  bool of_accelerations = false;            // that table is the integral of a record of accelerations
  bool moves = false;
  bool open_to_water = false;  // the water in the pores leaves through it, and has no pressure there
};

/// The background mesh of square (cubic) cells.
struct MeshConfig {
  Vec3 lower{}, upper{};                       // m, corners
  double spacing = 0;                          // m, edge of a cell
  std::array<int, 3> cells{};                  // whole cells in each direction (third is 1 in 2D)
  std::array<std::array<Wall, 2>, 3> walls{};  // [direction][0 lower, 1 upper side]; default roller
  std::array<std::array<SideConfig, 2>, 3> sides{};
};

/// Whether the mesh repeats itself along a direction.
inline bool is_periodic(const MeshConfig& mesh, int d) { return mesh.walls[d][0] == Wall::periodic; }
/// Whether it does along some direction.
inline bool is_periodic(const MeshConfig& mesh) {
  return is_periodic(mesh, 0) || is_periodic(mesh, 1) || is_periodic(mesh, 2);
}

enum class ShapeKind { box, polygon, disc, cylinder, cone, half_plane, stl, layer, particles, parts };
enum class Fill { centre, cell, cut };

class TriangleSurface;
class HeightSurface;

/// A region of space and the lattice of particles that fills it. The vertical axis is y in 2D and z in 3D. A
/// box that is not turned, a disc, a cylinder and a cone may reach beyond sides of the mesh that are planes
/// of symmetry (roller); only what is inside is filled.
struct Shape {
  ShapeKind kind = ShapeKind::box;
  Vec3 lower{}, upper{};                       // m, box, before it is turned
  double fillet = 0;                           // m, box: radius of its corners
  double angle = 0;                            // rad, box: turned about `lower`, from x to the vertical axis
  std::vector<std::array<double, 2>> polygon;  // m, vertices in order: x and the vertical coordinate
  std::array<double, 2> width{};               // m, polygon in 3D: the prism's lower and upper y
  Vec3 centre{};           // m, disc (ball in 3D); cylinder: lower end of its vertical axis; cone: its tip
  double radius = 0;       // m, disc, cylinder; cone: of its base
  double height = 0;       // m, cylinder (with its tip), cone
  double tip_height = 0;   // m, cylinder: of the cone that its lower end is; 0 where that is flat
  bool tip_up = false;     // cone: its tip is its highest point, not its lowest
  Vec3 point{}, normal{};  // m, -, half_plane: on its face; outward, of length 1
  std::shared_ptr<const TriangleSurface> triangles;  // stl: closed
  std::vector<std::string> part_names;               // parts: of which it is the union
  std::vector<Shape> parts;
  std::shared_ptr<const HeightSurface> top, base;  // layer: what it is between
  std::string top_file, base_file;                 // layer: of its surfaces that are rasters
  std::string file, file_body;                     // stl: its file; particles (of a body): the HDF5 file that
                                                   // lists them, and the body's name there
  int particles_per_cell = 2;                      // in each direction
  Fill fill = Fill::centre;
};

/// Water in the pores of a material: it drains at once, does not flow, or flows.
enum class PoreWater { drained, undrained, saturated };

/// Pores of a material and the water that flows in them.
struct PoreConfig {
  PoreWater water = PoreWater::drained;
  double porosity = 0;       // -, at the start
  double grain_density = 0;  // kg/m3
  double permeability = 0;   // m/s, at the porosity of the start and under WaterConfig::gravity
  bool kozeny = false;       // it changes with the porosity n as n^3 / (1 - n)^2; else it is constant
};

/// A material: its model's name, density, and the model's parameters in the order of the model's own table.
struct MaterialConfig {
  std::string name, model;
  double density = 0;                    // kg/m3
  std::vector<double> parameters;        // as Model::parameters() lists them
  std::vector<std::string> texts{};      // values of the model's options that are texts, as it lists them
  std::shared_ptr<const void> object{};  // what the model made of its texts; most need none
  double pore_stiffness = 0;   // Pa, of the water in its pores, which does not flow; 0: there is none
  PoreConfig pores{};          // where its water is told by them
  std::optional<double> k0{};  // -, horizontal over vertical effective stress of level ground
  std::optional<double> f_bar_fraction{};  // -, as Config::f_bar_fraction, which holds where there is none

  /// Whether water flows in its pores.
  bool saturated() const { return pores.water == PoreWater::saturated; }
  /// Whether its water has a pressure in excess of the hydrostatic one.
  bool has_pore_pressure() const { return saturated() || pore_stiffness > 0; }
};

/// A deformable body.
struct BodyConfig {
  std::string name;
  Shape shape;
  int material = 0;             // index into Config::materials
  Vec3 velocity{};              // m/s, initial
  Sym6 stress{};                // Pa, initial, tension positive
  bool velocity_given = false;  // by the options: a file's do not count then
  bool stress_given = false;
  bool k0 = false;  // its stress is that of level ground; `stress` is then that of its lowest particles
  /// Pa, largest mean stress in compression of its particles at the start.
  double largest_pressure = 0;
  /// HDF5 file with grids of the law's strength and Young's modulus, from which its particles take theirs.
  std::string field;
  /// Largest values of the parameters that its file or field gives each particle, in the order of the law's
  /// table and in their units; none where neither gives it.
  std::array<std::optional<double>, 2> largest_own{};
  std::vector<int> cut_out;         // indices into Config::rigids: particles in their shapes are left out
  std::vector<int> cut_out_bodies;  // the same of Config::bodies
  bool absent = false;              // a later stage places it
  bool from_before = false;         // it has been in the run before this stage
  bool removed = false;             // this stage or an earlier one removes it
  /// Its strengths, which follow from the vertical stress by a ratio, stay as they were in the stage before.
  bool keeps_strength = true;
  /// kg/m3, with which its soil was created, where that is not the density of its present material.
  std::optional<double> density;
  /// Pa, of the water in its pores at the start; none: hydrostatic, or 0 without -water_level.
  std::optional<double> pore_pressure;
};

/// Where the normals of a contact come from: the body's own surface, or its nodal mass gradient (Eq. 3).
enum class ContactNormal { surface, gradient };

enum class Motion { fixed, prescribed, dynamic };

/// A rigid body.
struct RigidConfig {
  std::string name;
  Shape shape;
  Motion motion = Motion::fixed;
  /// m/s: the velocity (prescribed) or the initial velocity (dynamic). Where a table gives it, its component
  /// of largest size in the table.
  Vec3 velocity{};
  std::optional<TimeTable> velocity_table;       // m/s (prescribed)
  std::optional<TimeTable> displacement_table;   // m, instead of a velocity: its changes count (prescribed)
  double density = 0;                            // kg/m3 (dynamic)
  std::optional<double> mass;                    // kg, instead of that by the density (dynamic)
  std::optional<Vec3> centre_of_mass;            // m, where the body turns; else that of the shape
  std::optional<std::array<double, 6>> inertia;  // kg m2, about it: xx, yy, zz, xy, yz, zx; in 2D the first
  /// Along x, y, z and about them: whether forces and moments move it (dynamic). In 2D it turns about z.
  std::array<bool, 6> free{true, true, true, false, false, false};
  Vec3 angular_velocity{};  // rad/s, initial (dynamic) or prescribed; in 2D the first, counter-clockwise
  std::optional<TimeTable> angular_velocity_table;  // rad/s (prescribed)
  std::optional<TimeTable> angle_table;             // rad, instead of it: its changes count (prescribed)
  Vec3 moment{};                                    // N m, external, likewise (dynamic)
  std::optional<TimeTable> moment_table;            // N m, instead of it
  bool part_forces = false;                         // the history has the forces on its parts
  std::optional<Vec3> moment_point;  // m, about which the history has the moment; else the centre
  /// N/m and N m/rad, N s/m and N m s/rad, of springs and dashpots to the ground along x, y, z and about them
  /// (dynamic).
  std::array<double, 6> stiffness{}, viscosity{};
  Vec3 force{};                          // N, external (dynamic), beside gravity
  std::optional<TimeTable> force_table;  // N, instead of it
  double shear_limit = 0;                // Pa, largest shear stress of the interface; 0 is smooth
  std::optional<double> shear_fraction;  // -, the limit as a fraction of the soil's strength, instead of it
  std::optional<double> friction;        // -, Coulomb coefficient
  std::optional<double> restitution;     // -, of impacts on other rigid bodies
  bool contact_at_sites = false;         // else at nodes
  ContactNormal contact_normal = ContactNormal::surface;
  bool separates = true;            // the soil may part from it
  bool contact_gap_scaling = true;  // the normal correction decreases with the gap (Geo-contact)
  double contact_gap_reach = 0.15;  // cells, gap at which it ends
  double contact_gap_exponent = 6;  // -
  bool has_shear_limit = false;     // -NAME_shear_limit was given (it then bounds the friction too)
  bool absent = false;              // not in the run in this stage: a later one places it, or it was removed
  bool turns_in_run = false;        // it may turn in some stage of the run
  bool permeable = false;           // water that flows in the pores of the soil passes it

  /// Whether it may turn, or may have turned in a stage before.
  bool turns() const {
    const bool free_to = motion == Motion::dynamic && (free[3] || free[4] || free[5]);
    const bool driven = angular_velocity != Vec3{} || angular_velocity_table || angle_table;
    return turns_in_run || free_to || (motion != Motion::fixed && driven);
  }
  /// Whether contact decreases with the gap by default: the gap is known, and may open.
  bool scales_by_gap() const {
    return separates && contact_normal == ContactNormal::surface && !contact_at_sites;
  }
  /// Whether springs or dashpots hold it.
  bool is_sprung() const {
    return stiffness != std::array<double, 6>{} || viscosity != std::array<double, 6>{};
  }
};

enum class JointKind { ball, hinge, slider, weld, rod, cable };

/// A joint of two rigid bodies, or of a rigid body and the ground. In 2D a ball is a hinge.
struct JointConfig {
  static constexpr int k_ground = -1;
  std::string name;
  JointKind kind = JointKind::ball;
  std::array<int, 2> bodies{k_ground, k_ground};  // indices into Config::rigids, or k_ground
  Vec3 point{}, other_point{};  // m, at the start: of the first body, and of the second (rod, cable)
  Vec3 axis{};                  // -, at the start (slider; hinge in 3D)
  double length = 0;            // m (rod, cable)
  std::optional<std::array<double, 2>> stop;  // rad, of the first body against the second (hinge)
  Vec3 velocity{};                            // m/s, of the end on the ground
  std::optional<TimeTable> velocity_table, displacement_table;  // m/s, m, instead of it
};

/// A pair of deformable bodies that touch.
struct ContactPairConfig {
  std::string name;                                             // those of the bodies, with an underscore
  std::array<int, 2> bodies{};                                  // indices into Config::bodies
  std::array<bool, 2> strong{true, true};                       // whether each has a strength
  bool welded = false;                                          // they move as one
  double adhesion = 0;                                          // Pa
  std::optional<double> friction, shear_limit, shear_fraction;  // -, Pa, - of the weaker soil's strength
};

/// Courant numbers above this are unstable (the energy of an elastic bar grows at 0.7).
inline constexpr double k_largest_courant = 0.6;

struct TimeConfig {
  double start = 0;            // s, at which the stage and with it the tables begin
  double end = 0;              // s, of the run or the stage
  double courant = 0.5;        // -, Eq. 14
  std::optional<double> step;  // s, instead of the Courant number
  std::optional<long> max_steps;
};

/// Event that ends a stage of a run, at its time_end at the latest.
enum class StageEnd { time, equilibrium, displacement };

/// A stage of a run.
struct StageConfig {
  std::string name;  // empty: the run has no stages
  int number = 0;    // from 1 on
  StageEnd end = StageEnd::time;
  double unbalanced_ratio = 1e-4;  // -, equilibrium: mean unbalanced force over mean weight of the nodes
  int end_rigid = 0;               // displacement: index into Config::rigids
  double end_displacement = 0;     // m, size of its displacement since the stage began
  std::vector<int> remove;         // indices into Config::bodies: removed when it begins
  std::vector<int> remove_rigids;  // the same of Config::rigids
  std::vector<int> place, place_rigids;  // likewise: placed when it begins
  bool reset = false;  // at its end velocities, displacements and plastic strains become zero
  /// Numbers of the stages that place and remove bodies and rigids, by their names in lower case: of all
  /// stages of the run.
  std::map<std::string, int> placed_at, removed_at;
};

/// Order of the soil's particles: by their cells, or by their nearest nodes where kernels for such bins do
/// all that the run asks for (-p2g_bins).
enum class BinsOf { cells, nodes };

struct P2GConfig {
  P2G strategy = P2G::automatic;
  BinsOf bins = BinsOf::nodes;
  double margin = 0.5;                  // cells, 0 < margin <= 0.5
  int mosaic_cells = 3;                 // >= 3
  std::optional<int> rebuild_interval;  // steps
};

/// How patches are given to ranks (-partition): boxes of the mesh, or parts of the graph of patches that
/// METIS cuts.
enum class PartitionKind { box, metis };

/// How the ghost sums of nodes travel from rank to rank (-halo_path): through the host's memory, by MPI from
/// where kernels run, or straight into the other rank's memory.
enum class HaloPath { automatic, host, device, peer };

struct PartitionConfig {
  PartitionKind kind = PartitionKind::box;
  double rebalance_threshold = 1.1;  // -, largest over mean work of the ranks above which METIS cuts anew
  HaloPath halo_path = HaloPath::automatic;
  bool halo_overlap = true;  // ghost sums travel while other patches are computed
};

enum class Progress { automatic, on, off };

struct OutputConfig {
  std::string directory;
  bool partition = false;                 // partition.csv: which rank owns what, at each frame
  bool frames = true;                     // of the particles; without them a run writes its history only
  std::vector<std::string> fields;        // of the frames, beside the position; empty for all
  int compression = 0;                    // of the frames, level of HDF5's deflate filter
  bool nodes = false;                     // frames hold the nodes' mass and velocity too
  bool energy = false;                    // the history has an energy balance
  double interval = 0;                    // s between frames
  double history_interval = 0;            // s between rows of the history
  std::optional<double> raster_interval;  // s between updates of the rasters; none: there are no rasters
  Progress progress = Progress::automatic;
  std::optional<double>
      checkpoint_interval;  // s between checkpoints; none: only when a signal or the time limit stops the run
  std::optional<double> wall_time_limit;  // s of wall time after which the run stops
  std::string restart;                    // the checkpoint to go on from, or "latest"; empty: from the start
  std::vector<std::string> restart_change;  // names of options, without dash, that may differ from its own
};

/// A load on a part of a body's surface, which moves with it.
struct LoadConfig {
  std::string name;
  int body = 0;                // index into Config::bodies
  int stage = 1;               // number of the stage that its surface is found at
  Vec3 lower{}, upper{};       // m, box in which the surface is then
  std::optional<Vec3> facing;  // direction that its normals have, to 60 degrees
  double pressure = 0;         // Pa, along the normal, into the soil
  bool on_pores = false;       // the pressure acts on the water in the pores too
  Vec3 traction{};             // Pa, of the area at the start
  std::optional<TimeTable> pressure_table, traction_table;  // Pa, instead of them
};

enum class ProbeKind { point, particle, gauge, section };

/// A place at which the history reports the soil.
struct ProbeConfig {
  std::string name;
  ProbeKind kind = ProbeKind::point;
  Vec3 at{};         // m; of a gauge without the vertical axis; of a section the component `axis` alone
  int axis = 0;      // section: that it is normal to
  double width = 0;  // m, gauge: of the strip (square in 3D) around its place
  std::vector<int> bodies;  // indices into Config::bodies that count; empty: all
};

/// Rasters of what has passed over the ground, by columns of soil.
struct RasterConfig {
  bool on = false;
  double spacing = 0;                     // m, edge of a cell
  double threshold_depth = 0;             // m, above which soil has arrived
  std::optional<double> threshold_speed;  // m/s, which it must have then too
  std::vector<int> bodies;                // indices into Config::bodies that count; empty: all
  Vec3 origin{};                          // m, added to the coordinates in files
};

/// A box in which the water has a level of its own.
struct WaterRegionConfig {
  std::string name;
  Vec3 lower{}, upper{};        // m
  std::optional<double> level;  // m; none: that of the water around it
  bool dry = false;             // in lieu of a level

  bool operator==(const WaterRegionConfig& other) const {
    return name == other.name && lower == other.lower && upper == other.upper && level == other.level &&
           dry == other.dry;
  }
};

/// Water at rest, in which the soil is submerged, and properties of water in pores.
struct WaterConfig {
  std::optional<double> level;    // m, of its surface: height against gravity; none: there is no water
  double density = 1000;          // kg/m3
  double bulk_modulus = 2.2e9;    // Pa, of water in pores
  double gravity = 9.81;          // m/s2, for which permeabilities are given
  double tension = 100e3;         // Pa, largest tension that water in pores takes
  double permeability_scale = 1;  // -, by which all permeabilities are multiplied
  std::vector<WaterRegionConfig> regions;  // where they overlap, the last one that has a level counts

  bool operator==(const WaterConfig& other) const {
    return level == other.level && density == other.density && bulk_modulus == other.bulk_modulus &&
           gravity == other.gravity && tension == other.tension &&
           permeability_scale == other.permeability_scale && regions == other.regions;
  }
};

/// Drive of a component over a row of a path: an increment of strain, the strain since the start that it ends
/// with, an increment of stress, or nothing of its own, so that sums of components decide its strain.
enum class Drive { strain, total_strain, stress, free };

/// A weighted sum of increments of stress, or of strain, that rows of a path may govern.
struct ElementSum {
  std::string name;        // as the header has it, dsxx+dsyy+dszz
  bool of_strain = false;  // else of stress
  Sym6 weight{};           // -
};

/// A row of the path of a single material point.
struct ElementRow {
  long line = 0;  // of the file
  double dt = 1;  // s
  std::array<Drive, 6> drive{};
  Sym6 value{};                               // -, tensor shear strains; Pa
  std::vector<std::optional<double>> sums{};  // Pa or -, change of each sum; none where it is not governed
};

/// A single material point that is driven along a path, in lieu of a mesh.
struct ElementConfig {
  std::string file;                           // CSV; empty: an ordinary run
  int parts = 40;                             // equal parts in which each row is done
  double height = 0;                          // m, of the point, for parameters that grow with depth
  double time = 0;                            // s, at the start
  bool timed = false;                         // the file has times; otherwise each row takes 1 s
  Sym6 stress{};                              // Pa, at the start
  std::vector<std::pair<int, double>> state;  // state variables of the law that the file gives for the start
  std::vector<ElementSum> sums;               // that rows may govern
  std::vector<ElementRow> rows;
};

inline constexpr double k_gib = 1024.0 * 1024 * 1024;  // bytes

/// The whole input of a run.
struct Config {
  int dim = 2;
  Geometry geometry = Geometry::plane_strain;  // in 2D
  Backend backend = Backend::serial;
  Precision precision = Precision::double_;
  std::optional<double> device_memory_limit;  // GiB, of the run on its device: more soil goes in batches
  P2GConfig p2g;
  PartitionConfig partition;
  MeshConfig mesh;
  Vec3 gravity{};  // m/s2; where it follows a table, the largest of it
  std::optional<TimeTable> gravity_table;
  WaterConfig water;
  TimeConfig time;
  double strength_factor = 1;     // -, by which strengths are divided, of materials without their own
  double damping = 0;             // -, local (non-viscous) damping factor, 0 <= damping < 1
  double rayleigh_mass = 0;       // 1/s, alpha of Rayleigh damping
  double rayleigh_stiffness = 0;  // s, beta of Rayleigh damping
  VelocityUpdate velocity_update = VelocityUpdate::flip;
  int xpic_order = 2;        // -, m of XPIC(m), with xpic
  double flip_fraction = 1;  // -, fraction of FLIP in the velocity update, the rest PIC, or XPIC with xpic
  ParticleDomain particle_domain = ParticleDomain::fixed;
  bool position_correction = false;      // particles of soil that flows are brought to an even density
  double position_correction_rate = 20;  // -, diffusion number of the density a unit of shear strain
  StrayRule stray_particles = StrayRule::keep;
  double f_bar_fraction = 0.98;  // -, fraction of the cell's mean in a particle's dilatation (F-bar)
  std::vector<MaterialConfig> materials;
  std::vector<BodyConfig> bodies;
  std::vector<RigidConfig> rigids;
  bool rigid_contact = true;             // rigid bodies touch each other, where one of two is dynamic
  bool rigid_contact_given = false;      // by the options
  std::optional<double> rigid_friction;  // -, of all pairs of rigid bodies
  std::vector<JointConfig> joints;
  std::vector<ContactPairConfig> contact_pairs;
  OutputConfig output;
  std::vector<LoadConfig> loads;
  std::vector<ProbeConfig> probes;
  RasterConfig rasters;
  ElementConfig element;
  StageConfig stage;                // which stage these options are of
  bool balance = false;             // the history has the unbalanced ratio
  std::vector<std::string> stages;  // names of all stages, in order; empty: the run has none
  bool dry_run = false;             // print what the run would take, and do not run
};

/// Density with which the soil of a body was created [kg/m3]: its particles keep their masses where a stage
/// changes its material.
inline double density_of(const Config& config, const BodyConfig& body) {
  return body.density.value_or(config.materials[body.material].density);
}

/// Whether water flows in the pores of some body.
inline bool water_flows(const Config& config) {
  for (const BodyConfig& body : config.bodies)
    if (body.material < static_cast<int>(config.materials.size()) &&
        config.materials[body.material].saturated())
      return true;
  return false;
}

}  // namespace mpm
