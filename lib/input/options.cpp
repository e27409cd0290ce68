#include "input/options.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "checkpoint/change_rules.hpp"
#include "common/text.hpp"
#include "common/time_table.hpp"
#include "input/analysis_options.hpp"
#include "input/courant.hpp"
#include "input/groups.hpp"
#include "input/reader.hpp"
#include "input/revolution_options.hpp"
#include "output/frame_fields.hpp"

namespace mpm {
namespace {

template <class Enum>
using Words = std::vector<std::pair<std::string, Enum>>;

void read_run(OptionReader& in, const std::vector<Backend>& backends, Config& config) {
  static const Words<Backend> all = {
      {"serial", Backend::serial}, {"openmp", Backend::openmp}, {"cuda", Backend::cuda}};
  Words<Backend> compiled;
  for (const Backend backend : backends) compiled.push_back(all[static_cast<int>(backend)]);
  config.backend = backends.back();
  in.word({.name = "backend",
           .meaning = "where the time step runs",
           .standard = "the fastest compiled in",
           .aside = in.listing() ? "" : ", which are compiled in"},
          in.listing() ? all : compiled, config.backend);
  in.word({.name = "precision", .meaning = "arithmetic of the fields"},
          Words<Precision>{{"double", Precision::double_}, {"single", Precision::single}}, config.precision);
  in.number({.name = "device_memory_limit",
             .meaning = "what the run may take of its device's memory; more soil goes through it in batches, "
                        "from the host's memory",
             .unit = "GiB",
             .range = k_positive},
            config.device_memory_limit);
  in.flag({.name = "dry_run",
           .meaning =
               "tells particles, memory, steps, output and about how long the run takes, and writes nothing"},
          config.dry_run);
}

void read_p2g(OptionReader& in, P2GConfig& p2g) {
  static const Words<P2G> words(std::begin(k_p2g_words), std::end(k_p2g_words));
  in.section("Particle-to-node interpolation");
  in.word({.name = "p2g", .meaning = "strategy; auto is the fastest for the backend"}, words, p2g.strategy);
  in.number({.name = "rebuild_margin",
             .meaning = "how far a particle may move before lists and bins are rebuilt",
             .unit = "cells",
             .range = {.lowest = 0, .highest = 0.5, .open_lowest = true}},
            p2g.margin);
  if (p2g.strategy == P2G::mosaic || p2g.strategy == P2G::automatic || in.listing())
    in.integer({.name = "p2g_mosaic_cells",
                .meaning = "edge of the blocks of the mosaic",
                .unit = "cells",
                .range = {.lowest = 3}},
               p2g.mosaic_cells);
  else
    in.not_taken("p2g_mosaic_cells", "-p2g is " + in.given_text("p2g"));
  in.integer({.name = "p2g_rebuild_interval",
              .meaning = "forces the interval of rebuilding instead of the bound on the movement",
              .unit = "steps",
              .range = {.lowest = 1}},
             p2g.rebuild_interval);
}

void read_partition(OptionReader& in, PartitionConfig& partition) {
  in.section("Several ranks");
  in.word({.name = "partition",
           .meaning =
               "how patches are given to ranks: boxes of the mesh, or parts that METIS cuts by their load"},
          Words<PartitionKind>{{"box", PartitionKind::box}, {"metis", PartitionKind::metis}}, partition.kind);
  if (partition.kind == PartitionKind::metis || in.listing())
    in.number({.name = "rebalance_threshold",
               .meaning = "largest over mean work of the ranks above which patches change hands, with metis",
               .unit = "-",
               .range = {.lowest = 1, .open_lowest = true}},
              partition.rebalance_threshold);
  else
    in.not_taken("rebalance_threshold", "-partition is not metis");
  in.word(
      {.name = "halo_path",
       .meaning = "how sums of nodes travel between ranks: host: through the host's memory, on a GPU pinned; "
                  "device: by an MPI that takes GPU memory; peer: straight into the other's memory, between "
                  "GPUs by CUDA IPC, on one node; auto: on GPUs the first of device, peer and host that "
                  "works, else host"},
      Words<HaloPath>{{"auto", HaloPath::automatic},
                      {"host", HaloPath::host},
                      {"device", HaloPath::device},
                      {"peer", HaloPath::peer}},
      partition.halo_path);
  in.word({.name = "halo_overlap",
           .meaning =
               "on: with -p2g tile, where kernels run on a GPU or on one thread, sums of nodes travel while "
               "patches that no other rank waits for are computed"},
          Words<bool>{{"on", true}, {"off", false}}, partition.halo_overlap);
}

void read_time(OptionReader& in, TimeConfig& time) {
  in.section("Time");
  in.number(
      {.name = "time_end", .meaning = "time to simulate", .unit = "s", .range = k_positive, .required = true},
      time.end);
  in.number({.name = "time_step",
             .meaning = "the time step itself, instead of the Courant number",
             .unit = "s",
             .range = k_positive},
            time.step);
  in.number(
      {.name = "time_courant",
       .meaning =
           "Courant number that gives the time step, at most 0.6, sqrt(2 / (dim n)) for "
           "bodies of n particles along a cell's edge, and less with damping; by default 0.5, or 95 % of "
           "that if it is less",
       .unit = "-",
       .range = {.lowest = 0, .highest = k_largest_courant, .open_lowest = true},
       .standard = time.step ? "none" : ""},
      time.courant);
  if (!in.listing() && in.given("time_step") && in.given("time_courant"))
    in.reject("time_step", "the place of -time_courant, which is given too; give one of them");
  in.integer({.name = "time_max_steps",
              .meaning = "stop after so many steps",
              .unit = "steps",
              .range = {.lowest = 1}},
             time.max_steps);
}

/// The bodies tell which Courant numbers are stable.
void limit_courant(OptionReader& in, Config& config) {
  if (in.listing() || config.time.step || config.bodies.empty()) return;
  const double largest = largest_courant(config);
  if (!in.given("time_courant"))
    config.time.courant = standard_courant(config);
  else if (config.time.courant > largest)
    in.reject("time_courant", formatted("at most %.4g, by the particles along a cell's edge and the damping: "
                                        "above it the rim of a body is "
                                        "not stable",
                                        largest));
}

void read_velocity_update(OptionReader& in, Config& config) {
  VelocityUpdate& update = config.velocity_update;
  in.word({.name = "velocity_update",
           .meaning = "how particles take their velocity from the nodes",
           .standard = in.listing() ? "flip, or apic with -analysis flow" : ""},
          Words<VelocityUpdate>{{"flip", VelocityUpdate::flip},
                                {"pic", VelocityUpdate::pic},
                                {"xpic", VelocityUpdate::xpic},
                                {"apic", VelocityUpdate::apic}},
          update);
  const std::string chosen = "-velocity_update is " + (set_by_flow(in, config, "velocity_update")
                                                           ? "apic by -analysis flow"
                                                           : in.given_text("velocity_update"));
  const bool xpic = update == VelocityUpdate::xpic;
  if (update != VelocityUpdate::flip) config.flip_fraction = 0;
  if (update == VelocityUpdate::flip || xpic)
    in.number({.name = "flip_fraction",
               .meaning = "fraction of FLIP in the velocity update, the rest PIC, or XPIC with xpic",
               .unit = "-",
               .range = {.lowest = 0, .highest = 1},
               .standard = in.listing() ? "1 with flip, 0 with xpic" : ""},
              config.flip_fraction);
  else
    in.not_taken("flip_fraction", chosen);
  if (xpic || in.listing())
    in.integer({.name = "xpic_order",
                .meaning = "order m of XPIC(m): the higher, the less it damps",
                .unit = "-",
                .range = {.lowest = 2, .highest = 20}},
               config.xpic_order);
  else
    in.not_taken("xpic_order", "-velocity_update is not xpic");
}

void read_position_correction(OptionReader& in, Config& config) {
  in.word({.name = "position_correction",
           .meaning = "delta: particles of soil that flows move a little, by less than 0.05 cells at each "
                      "rebuild, from where they crowd to where they leave gaps",
           .standard = in.listing() ? "none, or delta with -analysis flow" : ""},
          Words<bool>{{"none", false}, {"delta", true}}, config.position_correction);
  if (config.position_correction || in.listing())
    in.number(
        {.name = "position_correction_rate",
         .meaning = "how fast the density of particles diffuses: diffusion number, in cells, for a unit "
                    "of shear strain",
         .unit = "-",
         .range = {.lowest = 0, .highest = 100, .open_lowest = true}},
        config.position_correction_rate);
  else
    in.not_taken("position_correction_rate", "-position_correction is none");
}

void read_physics(OptionReader& in, Config& config) {
  in.section("Physics");
  const Option gravity{
      .name = "gravity", .meaning = "acceleration of gravity", .unit = "m/s2", .range = k_speed};
  in.vector(gravity, config.dim, config.gravity);
  read_timed(in, gravity, true, config.dim, config.time.end, config.gravity, config.gravity_table);
  if (config.gravity_table) config.gravity = largest_of(*config.gravity_table);
  read_water(in, config);
  in.number({.name = "damping",
             .meaning = "local (non-viscous) damping factor",
             .unit = "-",
             .range = {.lowest = 0, .highest = 1, .open_highest = true}},
            config.damping);
  read_rayleigh(in, config);
  in.number(
      {.name = "strength_factor",
       .meaning = "what the strength of all materials without a strength_factor of their own is divided "
                  "by, as in a search for a factor of safety",
       .unit = "-",
       .range = {.lowest = 0.01, .highest = 100}},
      config.strength_factor);
  read_analysis(in, config);
  read_velocity_update(in, config);
  in.word({.name = "particle_domain",
           .meaning = "how the domains of particles follow the soil: fixed: not at all; stretch: each "
                      "particle has half lengths along the axes that follow its deformation, from 0.1 to 0.5 "
                      "cells; split: that, and particles whose domains become too long are split, and those "
                      "that crowd are merged again",
           .standard = in.listing() ? "fixed, or split with -analysis flow" : ""},
          Words<ParticleDomain>{{"fixed", ParticleDomain::fixed},
                                {"stretch", ParticleDomain::stretch},
                                {"split", ParticleDomain::split}},
          config.particle_domain);
  read_position_correction(in, config);
  in.word(
      {.name = "stray_particles",
       .meaning =
           "what becomes of particles that are alone, or whose volume leaves 0.2 to 2 times that at the "
           "start: keep: alone they carry no stress, and the volume stays at the bound; remove: they "
           "leave the run; stop: the run ends with exit status 3"},
      Words<StrayRule>{{"keep", StrayRule::keep}, {"remove", StrayRule::remove}, {"stop", StrayRule::stop}},
      config.stray_particles);
  in.number(
      {.name = "f_bar_fraction",
       .meaning = "fraction of the cell's mean in a particle's dilatation (F-bar), against locking, of all "
                  "materials without an f_bar_fraction of their own; by default a material with a "
                  "dilation_deg above 0 has 0",
       .unit = "-",
       .range = {.lowest = 0, .highest = 1}},
      config.f_bar_fraction);
  note_analysis(in, config);
}

/// Reads the options of frames.
void read_frames(OptionReader& in, OutputConfig& output) {
  const auto known = frame_field_names();
  const Option fields{
      .name = "output_fields",
      .meaning = "fields of the frames beside the position; those of bodies are left out of rigids",
      .standard = "all"};
  const std::string takes = "names of fields: " + frame_field_list();
  std::vector<std::string> names;
  if (in.list_of(fields, takes, names)) {
    output.fields = names;
    for (const auto& name : names)
      if (std::find(known.begin(), known.end(), name) == known.end()) return in.reject(fields.name, takes);
  }
  in.integer({.name = "output_compression",
              .meaning = "level of the compression of frames, 0 for none",
              .unit = "-",
              .range = {.lowest = 0, .highest = 9}},
             output.compression);
  in.word({.name = "output_nodes",
           .meaning = "on: frames also hold mass and velocity of the nodes, as group nodes"},
          Words<bool>{{"on", true}, {"off", false}}, output.nodes);
  if (output.frames) return;
  for (const char* name : {"output_fields", "output_compression", "output_nodes"})
    if (in.given(name)) in.warn(name, "is not used, for -output_frames is off");
}

/// -output_dir, whose default has the stem of the options file.
void read_directory(OptionReader& in, const std::string& options_file, OutputConfig& output) {
  const std::string stem = std::filesystem::path(options_file).stem().string();
  output.directory = "out/" + (stem.empty() ? "mpm" : stem);
  in.text({.name = "output_dir",
           .meaning = "folder of the results",
           .standard = in.listing() ? "out/ and the stem of the options file" : ""},
          output.directory);
}

void read_output(OptionReader& in, const std::string& options_file, double time_end, OutputConfig& output) {
  in.section("Output");
  output.interval = time_end / 50;
  output.history_interval = time_end / 500;
  const bool listing = in.listing();
  read_directory(in, options_file, output);
  in.word(
      {.name = "output_frames",
       .meaning = "off: no frames of the particles, as for measuring speed or where the disk is too small"},
      Words<bool>{{"on", true}, {"off", false}}, output.frames);
  read_frames(in, output);
  in.number({.name = "output_interval",
             .meaning = "time between frames",
             .unit = "s",
             .range = k_positive,
             .standard = listing ? "a fiftieth of time_end" : ""},
            output.interval);
  in.word({.name = "output_energy",
           .meaning = "on: the history has an energy balance, which takes time in each step"},
          Words<bool>{{"on", true}, {"off", false}}, output.energy);
  in.number({.name = "history_interval",
             .meaning = "time between rows of the history",
             .unit = "s",
             .range = k_positive,
             .standard = listing ? "a five-hundredth of time_end" : ""},
            output.history_interval);
  in.number({.name = "checkpoint_interval",
             .meaning = "simulated time between checkpoints, of which the last two are kept",
             .unit = "s",
             .range = k_positive},
            output.checkpoint_interval);
  in.text({.name = "restart",
           .meaning = "checkpoint to go on from, or latest: the last sound one of the output folder"},
          output.restart);
  in.list_of({.name = "restart_change",
              .meaning = "what may differ from the checkpoint's run, of the options that may change by it"},
             "names of options, as gravity,damping", output.restart_change);
  in.number(
      {.name = "wall_time_limit",
       .meaning = "time on the clock after which the run writes a checkpoint and stops with exit status 75",
       .unit = "s",
       .range = k_positive},
      output.wall_time_limit);
  in.word(
      {.name = "output_partition", .meaning = "on: partition.csv tells at each frame which rank owns what"},
      Words<bool>{{"on", true}, {"off", false}}, output.partition);
  in.word({.name = "progress", .meaning = "auto: a live line on a terminal, else a line each 10 %"},
          Words<Progress>{{"auto", Progress::automatic}, {"on", Progress::on}, {"off", Progress::off}},
          output.progress);
}

/// -restart_change names only what loads and holds the bodies.
void check_restart_change(OptionReader& in, const Config& config) {
  const std::string option = "restart_change";
  if (!in.listing() && config.output.restart.empty()) return in.not_taken(option, "there is no -restart");
  for (const std::string& name : config.output.restart_change)
    if (!name.empty() && !change_rule(name, config).listed)
      return in.reject(option,
                       "names of options among gravity, damping, those of the mesh's sides, of loads their "
                       "pressure and traction, of rigids their motion, loads and contact, of materials their "
                       "parameters, and the material of a body; " +
                           name + " is none");
}

/// All that a single material point needs. Its law is computed on the processor whatever the backend.
void read_element_run(OptionReader& in, const std::vector<Backend>& backends, const std::string& options_file,
                      Config& config) {
  config.backend = backends.front();
  read_directory(in, options_file, config.output);
  read_element(in, config);
}

void read_all(OptionReader& in, const std::vector<Backend>& backends, const std::string& options_file,
              Config& config, const Config* before = nullptr) {
  const auto errors = in.errors();
  in.section("Run");
  in.integer({.name = "dim",
              .meaning = "2 (plane strain, or axisymmetric by -geometry) or 3",
              .unit = "-",
              .range = {.lowest = 2, .highest = 3}},
             config.dim);
  read_geometry_of(in, config);
  if (in.errors() != errors) return;  // they decide what all others take
  if (in.listing()) read_stage_names(in);
  read_run(in, backends, config);
  if (read_element_file(in, config.element)) {
    read_element_run(in, backends, options_file, config);
    in.report_unknown();
    return;
  }
  read_p2g(in, config.p2g);
  read_partition(in, config.partition);
  const bool sound = read_mesh(in, config.dim, config.mesh);
  read_time(in, config.time);
  read_physics(in, config);
  read_sides(in, config);
  choose_batches(config);
  read_output(in, options_file, config.time.end, config.output);
  read_rasters(in, sound ? &config.mesh : nullptr, config);
  read_named(in, sound ? &config.mesh : nullptr, config, before);
  read_raster_bodies(in, config, config.rasters);
  if (sound && in.errors() == errors) choose_lid(in, before, config);
  if (sound) check_absorbing(in, config);
  check_rayleigh(in, config);
  check_batches(in, config);
  if (sound && in.errors() == errors) check_periodic(in, config);
  check_revolution(in, config);
  limit_courant(in, config);
  const auto named_nodes = [](const auto& thing) { return thing.name == k_nodes; };
  if (config.output.nodes && (std::any_of(config.bodies.begin(), config.bodies.end(), named_nodes) ||
                              std::any_of(config.rigids.begin(), config.rigids.end(), named_nodes)))
    in.reject("output_nodes", "off where a body or rigid has the name nodes");
  check_restart_change(in, config);
  if (!config.stages.empty() || in.listing()) {
    read_stage(in, config);
    check_stage_changes(in, config);
  }
  in.report_unknown();
}

/// Every stage as a run of its own, by the options of the run with those of the stage in their place.
void read_stages(OptionReader& in, const std::vector<Backend>& backends,
                 const std::vector<std::string>& names, InputReport& report) {
  for (const std::string& name : names) {
    InputReport of_stage;
    StageInput& input = report.stages.emplace_back();
    input.config.stages = names;
    input.config.stage = {.name = name, .number = static_cast<int>(report.stages.size())};
    note_stage_bodies(in, names, input.config.stage);
    OptionReader reader = in.for_stage(name, names, of_stage);
    const bool first = report.stages.size() == 1;
    read_all(reader, backends, report.options_file, input.config,
             first ? nullptr : &report.stages.end()[-2].config);
    check_cut_kept(reader, report.stages.front().config, input.config);
    check_water_kept(reader, report.stages.front().config, input.config);
    check_periodic_kept(reader, input.config.dim, report.stages.front().config.mesh, input.config.mesh);
    input.options = std::move(of_stage.options);
    for (const std::string& key : reader.of_stage())
      report.stage_options.push_back({"-" + name + "_" + key, reader.given_text(key), "", false});
    for (auto [from, to] :
         {std::pair{&of_stage.errors, &report.errors}, {&of_stage.warnings, &report.warnings}})
      for (const std::string& line : *from)
        if (std::find(to->begin(), to->end(), line) == to->end()) to->push_back(line);
  }
}

/// Puts the options that are ours into PETSc's database, once for all simulations of a program. The files of
/// -log_view wait for the output folder.
PetscErrorCode insert_words(InputReport& report) {
  PetscFunctionBeginUser;
  if (*report.inserted) PetscFunctionReturn(PETSC_SUCCESS);
  *report.inserted = true;
  std::vector<char*> words;
  for (std::string& word : report.words) words.push_back(word.data());
  PetscCall(PetscOptionsInsertArgs(nullptr, static_cast<int>(words.size()), words.data()));
  if (report.log_view.find(':') != std::string::npos) PetscCall(PetscOptionsClearValue(nullptr, "-log_view"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Usage for a newcomer, before the options.
constexpr const char* k_usage =
    "mpm: a material point method for soil, in 2D and 3D\n\n"
    "  mpm -options_file DECK [-NAME VALUE] ...    runs a deck; what the command line gives takes "
    "precedence\n"
    "  mpm -options_file DECK -dry_run             tells particles, memory, steps and run time; writes "
    "nothing\n"
    "  mpm -options_file DECK -restart latest      goes on from the last checkpoint\n"
    "  mpirun -n 4 mpm -options_file DECK          runs on four processes\n"
    "  mpm --version                               version, commit, libraries, back ends\n\n"
    "A deck holds one option a line, -NAME VALUE; # begins a comment. Units are SI; a list has commas and "
    "no\n"
    "spaces. NAME in an option below stands for a name that -materials, -bodies, -rigid_bodies, -loads or\n"
    "-probes gives. A mesh (-mesh_lower, -mesh_upper, -mesh_spacing), -time_end, a material and a body are "
    "all\n"
    "that a deck needs; inputs/ has decks to begin with. Results go to -output_dir, by default out/ and the\n"
    "name of the deck: history.csv, frames/ for ParaView, mpm.log. scripts/plot draws them.\n"
    "Manual: README.md, docs/soils.md (laws), docs/boundaries.md, docs/running.md, docs/verification.md.\n"
    "Some options of PETSc are taken too, as -log_view (docs/running.md); --kokkos-help lists those of "
    "Kokkos.\n"
    "Exit status: 0 finished, 2 wrong input, 3 the computation failed, 75 stopped with a checkpoint, else "
    "the\n"
    "system.\n";

PetscErrorCode print_lines(MPI_Comm comm, FILE* file, const std::string& text) {
  PetscFunctionBeginUser;
  PetscMPIInt rank = 0;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    PetscCheck(std::fputs(text.c_str(), file) >= 0 && std::fflush(file) == 0, PETSC_COMM_SELF,
               PETSC_ERR_FILE_WRITE, "Cannot write to the terminal");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

void list_all(OptionReader& in) {
  Config config;
  read_all(in, {Backend::serial}, "", config);
}

PetscErrorCode read_options(const char* prefix, const std::vector<Backend>& backends, Config& config,
                            InputReport& report) {
  PetscFunctionBeginUser;
  PetscCheck(!backends.empty(), PETSC_COMM_SELF, PETSC_ERR_ARG_WRONG, "No backend is compiled in");
  OptionReader in;
  config = {};
  if (report.help) {
    report.help_text = k_usage;
    in.list(report);
    PetscCallCXX(read_all(in, backends, "", config));
  } else if (!report.file_unread) {
    PetscCall(insert_words(report));
    PetscCall(in.load(prefix, report));
    const auto before = report.errors.size();
    std::vector<std::string> stages;
    PetscCallCXX(stages = read_stage_names(in));
    if (report.errors.size() > before)
      PetscFunctionReturn(PETSC_SUCCESS);  // they decide whose the others are
    if (stages.empty()) {
      PetscCallCXX(read_all(in, backends, report.options_file, config));
    } else {
      const EffectiveOption list = report.options.back();
      PetscCallCXX(read_stages(in, backends, stages, report));
      const bool balance = std::any_of(
          report.stages.begin(), report.stages.end(),
          [](const StageInput& stage) { return stage.config.stage.end == StageEnd::equilibrium; });
      for (StageInput& stage : report.stages)
        stage.options.insert(stage.options.begin(), list), stage.config.balance = balance;
      config = report.stages[0].config, report.options = report.stages[0].options;
    }
    if (!report.stages.empty() && !config.element.file.empty())
      in.reject("stages", "nothing here: -element_path drives a single point");
    if (prefix == nullptr) PetscCallCXX(check_log_view(config.output.directory, report));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode print_help(MPI_Comm comm, const InputReport& report) {
  return print_lines(comm, stdout, report.help_text);
}

PetscErrorCode print_errors(MPI_Comm comm, const InputReport& report) {
  return print_lines(comm, stderr, report.errors.empty() ? "" : join(report.errors, "\n") + "\n");
}

}  // namespace mpm
