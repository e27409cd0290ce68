#pragma once
// The groups of options, each read at one place. All report their mistakes to the reader.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "input/files/field_file.hpp"
#include "input/files/particle_file.hpp"
#include "input/options/reader.hpp"
#include "physics/materials/tables.hpp"

namespace mpm {

/// -time_*. limit_courant, after the bodies, which determine the stable Courant numbers.
void read_time(OptionReader& in, TimeConfig& time);
void limit_courant(OptionReader& in, Config& config);
/// Gravity, water, damping, and how particles follow the soil. After the time.
void read_physics(OptionReader& in, Config& config);

/// -output_dir, whose default has the stem of the options file.
void read_directory(OptionReader& in, const std::string& options_file, OutputConfig& output);
/// Reads what a run writes and when, and from what it goes on. time_end [s]: of the run.
void read_output(OptionReader& in, const std::string& options_file, double time_end, OutputConfig& output);
/// -restart_change names only what loads and holds the bodies.
void check_restart_change(OptionReader& in, const Config& config);

/// -mesh_*. Whether the mesh is sound, so that shapes can be checked against it.
bool read_mesh(OptionReader& in, int dim, MeshConfig& mesh);

/// Reads properties of sides of the mesh beside their kind: friction, dashpots, velocities. After the time.
void read_sides(OptionReader& in, Config& config);
/// The side against gravity, where no option gives it: soil may leave it (smooth). Where a body reaches it at
/// the start it stays a roller, as the run says. before: the stage before, or null. After the bodies.
void choose_lid(OptionReader& in, const Config* before, Config& config);
/// Rejects sides with dashpots where a material does not give the speed of its shear waves, and columns of
/// the free field without a base.
void check_absorbing(OptionReader& in, const Config& config);
/// Reads -rayleigh_*. check_rayleigh, after the sides and the materials, rejects input that excludes such
/// damping.
void read_rayleigh(OptionReader& in, Config& config);
void check_rayleigh(OptionReader& in, const Config& config);
/// Chooses the strategy that goes in batches, where -device_memory_limit asks for them and -p2g is auto.
void choose_batches(Config& config);
/// Rejects the features that exclude batches (StepWay::in_batches), where -device_memory_limit asks for them.
void check_batches(OptionReader& in, const Config& config);
/// Checks what a periodic mesh takes: weight of water across it alone, and rigids that do not end beside its
/// periodic sides.
void check_periodic(OptionReader& in, const Config& config);
/// Checks that the sides that are periodic are those of another stage.
void check_periodic_kept(OptionReader& in, int dim, const MeshConfig& first, const MeshConfig& mesh);

/// The options of one material of a run: its density, its model and the model's own tables of parameters and
/// texts. A null mesh is unsound.
void read_material(OptionReader& in, const std::string& name, const MeshConfig* mesh, const Config& config,
                   MaterialConfig& material);

/// The object that the model of a material makes from its texts, for a mesh and a dimension, and the law's
/// check of its parameters together. For a single point, call it after the path has decided the dimension.
void make_law_object(OptionReader& in, const MeshConfig& mesh, int dim, MaterialConfig& material);

/// A parameter of a material by its key; NaN where its model has none of that name.
double parameter_of(const MaterialConfig& material, const std::string& key);

/// Warnings of the law of a material about its parameters, for the log.
std::vector<std::string> warnings_of_law(const MaterialConfig& material);

/// Sets the parameters of a sound material that depend on the mesh's spacing [m] and the largest initial mean
/// stress in compression of its soil [Pa]; 0 where it is unknown as yet.
void prepare_material(MaterialConfig& material, double spacing, double largest_pressure);

/// Calls prepare_material for all materials, each with the largest pressure of its bodies.
void prepare_for_pressure(double spacing, Config& config);

/// Whether a particle of a sound material may start at a height [m] with a stress [Pa], and with its own
/// values of the law's parameters where there are some; reports why it may not. `dim`: of the run.
bool check_start(OptionReader& in, const std::string& body, const MaterialConfig& material, double height,
                 const Sym6& stress, int dim, const OwnValues& own = {});

/// Whether the particles of a material must be given their own Young's moduli (-NAME_young field).
bool needs_own_young(const MaterialConfig& material);

/// Whether a particle of a sound material may start so; as check_start, without a report.
bool may_start(const MaterialConfig& material, double height, const Sym6& stress, int dim,
               const OwnValues& own);

/// Fault of particles whose own values of a parameter are from `least` to `largest`, as the end of "takes
/// ..."; empty where their material takes these values.
std::string own_parameter_fault(const MaterialConfig& material, const std::string& key, double least,
                                double largest);

/// Checks the bodies whose stress is that of level ground, when all of them have been read, and notes their
/// largest stress. The mesh, the shapes and the materials must be sound.
void check_level_ground(OptionReader& in, const MeshConfig& mesh, Config& config);

/// Checks the starts of the particles of a body of a sound material, by the lowest and highest point of its
/// shape or by the file that lists them, and notes their largest pressure and own strength. Particles whose
/// state a file gives go on as they are.
void check_starts(OptionReader& in, const MeshConfig& mesh, const Config& config, const ParticleTable& listed,
                  BodyConfig& body);

/// Whether soil of a material has a strength, somewhere.
bool has_strength(const MaterialConfig& material);
/// Whether the material of a body is sound and has a strength.
bool has_strength(const Config& config, const BodyConfig& body);

/// The geometry and lattice of a body or rigid, where `body` says which. Whether all of it was sound. A file
/// may list the particles of a body. The bodies before it have been read.
bool read_shape(OptionReader& in, const std::string& name, const Config& config, bool body, Shape& shape);

/// Checks that a sound shape lies in the mesh, or is cut by planes of symmetry, and holds a particle.
void check_shape(OptionReader& in, const std::string& name, const Shape& shape, const MeshConfig& mesh,
                 int dim);

/// Checks that the shapes cut out of a body leave a particle.
void check_cut_out(OptionReader& in, const MeshConfig& mesh, const Config& config, const BodyConfig& body);

/// NAME_table and NAME_table_interpolation, where NAME is the option `of`, a vector of `dim` components, or a
/// number (dim 1): its values in time till `end` [s]. has_constant: NAME itself is an option too, with the
/// value `constant`, of which a table of one column gives factors. Returns whether the table is given.
bool read_timed(OptionReader& in, const Option& of, bool has_constant, int dim, double end,
                const Vec3& constant, std::optional<TimeTable>& table);

/// Rotation of a rigid that moves. turning_keys: its options, without the name of the rigid.
const std::vector<std::string>& turning_keys();
void read_turning(OptionReader& in, int dim, double end, RigidConfig& rigid);
void check_turning(OptionReader& in, const Config& config, const MeshConfig& mesh, const RigidConfig& rigid);

/// Contact of one rigid with soil.
void read_contact(OptionReader& in, const Config& config, RigidConfig& rigid);
/// Where contact acts on the rigids for which no option gives it, as in the stage before, if there is one
/// (else null). After all names, without an error.
void choose_contact(OptionReader& in, const Config* before, Config& config);
/// -contact_pairs and the options of each pair; bodies and rigids have been read.
void read_contact_pairs(OptionReader& in, Config& config);
/// Contact between rigid bodies: the options of all of them, and that of each.
void read_rigid_contact(OptionReader& in, Config& config);
void read_restitution(OptionReader& in, RigidConfig& rigid);
/// Springs and dashpots that hold a rigid. support_keys: its options, without the name of the rigid.
const std::vector<std::string>& support_keys();
void read_support(OptionReader& in, int dim, RigidConfig& rigid);

/// The options of one joint; the rigids and the time have been read. mesh: null where it is unsound.
void read_joint(OptionReader& in, const MeshConfig* mesh, const Config& config, JointConfig& joint);

/// The motion of a rigid and what moves it; `end` [s]: of the run.
void read_motion(OptionReader& in, int dim, double end, RigidConfig& rigid);

/// Checks that a rigid does not move across a plane of symmetry that cuts it.
void check_cut_motion(OptionReader& in, const MeshConfig& mesh, int dim, const RigidConfig& rigid);

/// -water_*. Gravity must have been read.
void read_water(OptionReader& in, Config& config);

/// Reads -NAME_water of a material and what goes with it, before its density. -water_* must have been read.
void read_pores(OptionReader& in, const Config& config, MaterialConfig& material);
/// Reads the properties of water in pores; some: a material may have such water.
void read_water_in_pores(OptionReader& in, bool some, WaterConfig& water);
/// Reads the pore pressure of a body at the start. Its material must have been read.
void read_pore_pressure(OptionReader& in, const Config& config, BodyConfig& body);
/// Reads whether water in pores passes a rigid body.
void read_permeable(OptionReader& in, RigidConfig& rigid);
/// Reads whether water in pores passes a side of the mesh.
void read_side_water(OptionReader& in, const std::string& name, Wall kind, SideConfig& side);
/// Rejects input that excludes water which flows in pores. After all bodies and sides.
void check_pores(OptionReader& in, const Config& config);
/// Checks that the pores of bodies are those that they have in the first stage.
void check_pores_kept(OptionReader& in, const Config& first, const Config& now);

/// The options of one region with a level of its own.
void read_water_region(OptionReader& in, const Config& config, WaterRegionConfig& region);
/// Rejects more regions than a step can have, and regions where there is no water.
void check_water_regions(OptionReader& in, const Config& config);
/// Checks that there is water in a stage if there is in the first one.
void check_water_kept(OptionReader& in, const Config& first, const Config& now);

/// Lowest and highest height of a shape against gravity [m], where there is gravity. The mesh must be sound.
std::array<double, 2> heights_of(const Shape& shape, const Config& config);

/// Checks that a rigid that moves by forces is wholly below the water's level or above it: its buoyancy is
/// constant. The mesh must be sound.
void check_in_water(OptionReader& in, const Config& config, const RigidConfig& rigid);

/// -NAME_field of a body; `listed`: a file lists its particles, and it takes none.
void read_body_field(OptionReader& in, const std::string& name, bool listed, BodyConfig& body);
/// Checks the field against the body's sound shape and material, and notes its largest values.
void check_body_field(OptionReader& in, const MeshConfig& mesh, const Config& config, BodyConfig& body);
/// Whether the law of a body's material takes values of each particle.
bool takes_field(const BodyConfig& body, const Config& config);
/// Reads the grids of the parameters that a body's field gives its particles, by their keys; some must be
/// there. Returns what the file should have been, as the end of "takes ..."; empty where all is well.
std::string read_body_grids(const BodyConfig& body, const Config& config, std::vector<NamedGrid>& grids);

/// The initial velocity and stress of a body, which take the place of those of its file.
void read_start(OptionReader& in, int dim, BodyConfig& body);

/// Where a body's particles are, if a file lists them.
ParticleSource source_of(const BodyConfig& body);
/// The particle source with the state variables of the body's law.
ParticleSource source_of(const BodyConfig& body, const Config& config);

/// Reads the particles that a file lists, and checks them; the table is empty where they are wrong.
void check_particles(OptionReader& in, const BodyConfig& body, const Config& config, const MeshConfig& mesh,
                     ParticleTable& table);

/// Checks that the masses of a file are those of the body's material, to a quarter.
void check_density(OptionReader& in, const BodyConfig& body, const Config& config,
                   const ParticleTable& table);

/// The options of one load on a surface; the bodies and the time have been read.
void read_load(OptionReader& in, const Config& config, LoadConfig& load);

/// The options of one probe. A null mesh is unsound; the bodies have been read.
void read_probe(OptionReader& in, const MeshConfig* mesh, const Config& config, ProbeConfig& probe);
/// Rejects more sections than there may be.
void check_probes(OptionReader& in, const Config& config);
/// -output_rasters and -raster_*, before the names: no name may begin so. A null mesh is unsound.
void read_rasters(OptionReader& in, const MeshConfig* mesh, Config& config);
/// -raster_bodies, once the bodies have been read.
void read_raster_bodies(OptionReader& in, const Config& config, RasterConfig& rasters);

/// -stages: the good names. The names of all options are reserved.
std::vector<std::string> read_stage_names(OptionReader& in);
/// Which stages place and remove bodies, by the texts of their options; the names are not checked.
void note_stage_bodies(const OptionReader& in, const std::vector<std::string>& stages, StageConfig& stage);
/// Whether a body or rigid is in the run in a stage.
void note_presence(const StageConfig& stage, BodyConfig& body);
void note_presence(const StageConfig& stage, RigidConfig& rigid);
/// The bodies that the stage of a reader places and removes; bodies and rigids have been read.
void read_stage_bodies(OptionReader& in, const Config& config, StageConfig& stage);
/// Checks that a stage cuts out of bodies, as they are placed, what the first one does: their particles keep
/// their ids.
void check_cut_kept(OptionReader& in, const Config& first, const Config& now);
/// Copies from the stage before what bodies keep: their masses, and the data of their initial stress. Before
/// prepare_for_pressure, which takes the largest pressures.
void follow_stage(const Config& before, Config& now);
/// Reads the options that the stage of a reader owns, after rigids and gravity.
void read_stage(OptionReader& in, Config& config);
/// Checks that the options that the stage of a reader gives may change at a stage.
void check_stage_changes(OptionReader& in, const Config& config);

/// Fault of a name that is to begin options beside those that `known` has read or listed; empty where there
/// is none.
std::string name_fault(const OptionReader& known, const std::string& name);

/// -element_path and what goes with it. Whether it is given.
bool read_element_file(OptionReader& in, ElementConfig& element);

/// Reads the input of a single material point: the one material and the file of its path. Checks that the law
/// can start there. Options of a run of a mesh are passed over.
void read_element(OptionReader& in, Config& config);

/// -materials with one name, and that material.
void read_only_material(OptionReader& in, Config& config);

/// Whether a point of a sound material may start a path at a height [m] with a stress [Pa]; reports why it
/// may not.
bool check_element_start(OptionReader& in, const MaterialConfig& material, double height, const Sym6& stress);

/// Lists every option with the reader, which lists.
void list_all(OptionReader& in);

/// -materials, -bodies, -rigid_bodies, -probes and the options of each that they name. The fixed options must
/// have been read before, since no name may begin as they do. A null mesh (unsound) leaves the shapes
/// unchecked against it. `before`: the stage before, if there is one.
void read_named(OptionReader& in, const MeshConfig* mesh, Config& config, const Config* before = nullptr);

}  // namespace mpm
