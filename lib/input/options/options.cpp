#include "input/options/options.hpp"

#include <algorithm>
#include <map>

#include "common/snapshot.hpp"
#include "common/text.hpp"
#include "input/options/groups.hpp"
#include "input/options/reader.hpp"
#include "input/options/revolution_options.hpp"

namespace mpm {
namespace {

void read_run(OptionReader& in, const std::vector<Backend>& backends, Config& config) {
  static const Words<Backend> all = {
      {"serial", Backend::serial}, {"openmp", Backend::openmp}, {"cuda", Backend::cuda}};
  Words<Backend> compiled;
  for (const Backend backend : backends) compiled.push_back(all[static_cast<int>(backend)]);
  config.backend = backends.back();
  in.word({.name = "backend",
           .meaning = "where the time step runs",
           .standard = "the fastest compiled in",
           .aside = in.listing() ? "" : ", which are compiled in",
           .change = k_at_any_restart},
          in.listing() ? all : compiled, config.backend);
  in.word({.name = "precision", .meaning = "arithmetic of the fields", .change = k_at_any_restart},
          Words<Precision>{{"double", Precision::double_}, {"single", Precision::single}}, config.precision);
  in.number({.name = "device_memory_limit",
             .meaning = "what the run may take of its device's memory; more soil goes through it in batches, "
                        "from the host's memory",
             .unit = "GiB",
             .range = k_positive,
             .change = k_at_any_restart},
            config.device_memory_limit);
  in.flag({.name = "dry_run",
           .meaning =
               "prints particles, memory, steps, output and about how long the run takes, and writes nothing",
           .change = k_at_any_restart},
          config.dry_run);
}

void read_p2g(OptionReader& in, P2GConfig& p2g) {
  static const Words<P2G> words(std::begin(k_p2g_words), std::end(k_p2g_words));
  in.section("Particle-to-node interpolation");
  in.word(
      {.name = "p2g", .meaning = "strategy; auto is the fastest for the backend", .change = k_at_any_restart},
      words, p2g.strategy);
  in.word(
      {.name = "p2g_bins",
       .meaning = "what the soil is sorted by: its cell, or the nearest node, where a GPU has kernels for "
                  "all that a 3D run asks for",
       .change = k_at_any_restart},
      Words<BinsOf>{{"cells", BinsOf::cells}, {"nodes", BinsOf::nodes}}, p2g.bins);
  in.number({.name = "rebuild_margin",
             .meaning = "how far a particle may move before lists and bins are rebuilt",
             .unit = "cells",
             .range = {.lowest = 0, .highest = 0.5, .open_lowest = true},
             .change = k_at_any_restart},
            p2g.margin);
  if (const auto only = in.where("p2g", {"mosaic", "auto"});
      p2g.strategy == P2G::mosaic || p2g.strategy == P2G::automatic || in.listing())
    in.integer({.name = "p2g_mosaic_cells",
                .meaning = "edge of the blocks of the mosaic",
                .unit = "cells",
                .range = {.lowest = 3},
                .change = k_at_any_restart},
               p2g.mosaic_cells);
  else
    in.not_taken("p2g_mosaic_cells", "-p2g is " + in.given_text("p2g"));
  in.integer({.name = "p2g_rebuild_interval",
              .meaning = "forces the interval of rebuilding instead of the bound on the movement",
              .unit = "steps",
              .range = {.lowest = 1},
              .change = k_at_any_restart},
             p2g.rebuild_interval);
}

void read_partition(OptionReader& in, PartitionConfig& partition) {
  in.section("Several ranks");
  in.word(
      {.name = "partition",
       .meaning = "how patches are given to ranks: boxes of the mesh, or parts that METIS cuts by their load",
       .change = k_at_any_restart},
      Words<PartitionKind>{{"box", PartitionKind::box}, {"metis", PartitionKind::metis}}, partition.kind);
  if (const auto only = in.where("partition", {"metis"});
      partition.kind == PartitionKind::metis || in.listing())
    in.number({.name = "rebalance_threshold",
               .meaning = "largest over mean work of the ranks above which patches change hands, with metis",
               .unit = "-",
               .range = {.lowest = 1, .open_lowest = true},
               .change = k_at_any_restart},
              partition.rebalance_threshold);
  else
    in.not_taken("rebalance_threshold", "-partition is not metis");
  in.word(
      {.name = "halo_path",
       .meaning = "how sums of nodes travel between ranks: host: through the host's memory, on a GPU pinned; "
                  "device: by an MPI that takes GPU memory; peer: straight into the other's memory, between "
                  "GPUs by CUDA IPC, on one node; auto: on GPUs the first of device, peer and host that "
                  "works, else host",
       .change = k_at_any_restart},
      Words<HaloPath>{{"auto", HaloPath::automatic},
                      {"host", HaloPath::host},
                      {"device", HaloPath::device},
                      {"peer", HaloPath::peer}},
      partition.halo_path);
  in.word({.name = "halo_overlap",
           .meaning =
               "on: with -p2g tile, where kernels run on a GPU or on one thread, sums of nodes travel while "
               "patches that no other rank waits for are computed",
           .change = k_at_any_restart},
          Words<bool>{{"on", true}, {"off", false}}, partition.halo_overlap);
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
  if (sound && in.errors() == errors) choose_contact(in, before, config);
  if (sound) check_absorbing(in, config);
  check_rayleigh(in, config);
  if (sound && in.errors() == errors) check_pores(in, config);
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

/// Lets a rigid body keep its rotation, about the same point, in the stages in which it does not turn.
void keep_rotations(std::vector<StageInput>& stages) {
  for (const StageInput& input : stages)
    for (std::size_t r = 0; r < input.config.rigids.size(); ++r) {
      const RigidConfig& rigid = input.config.rigids[r];
      for (StageInput& other : stages) {
        if (!rigid.turns() || r >= other.config.rigids.size()) continue;
        RigidConfig& same = other.config.rigids[r];
        same.turns_in_run = true;
        if (!same.centre_of_mass) same.centre_of_mass = rigid.centre_of_mass;
        if (!same.moment_point) same.moment_point = rigid.moment_point;
      }
    }
}

/// Reports options given for all stages that none takes; aside: what each stage has set aside.
void report_untaken(const std::vector<std::map<std::string, std::string>>& aside, InputReport& report) {
  for (const auto& [name, line] : aside.front())
    if (std::all_of(aside.begin(), aside.end(), [&](const auto& of) { return of.count(name) > 0; }))
      report.errors.push_back(line);
}

/// Every stage as a run of its own, by the options of the run with those of the stage in their place.
void read_stages(OptionReader& in, const std::vector<Backend>& backends,
                 const std::vector<std::string>& names, InputReport& report) {
  std::vector<std::map<std::string, std::string>> aside;
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
    check_pores_kept(reader, report.stages.front().config, input.config);
    check_periodic_kept(reader, input.config.dim, report.stages.front().config.mesh, input.config.mesh);
    input.options = std::move(of_stage.options);
    aside.push_back(reader.set_aside());
    for (const std::string& key : reader.of_stage())
      report.stage_options.push_back({"-" + name + "_" + key, reader.given_text(key), "", false});
    for (auto [from, to] :
         {std::pair{&of_stage.errors, &report.errors}, {&of_stage.warnings, &report.warnings}})
      for (const std::string& line : *from)
        if (std::find(to->begin(), to->end(), line) == to->end()) to->push_back(line);
  }
  report_untaken(aside, report);
  keep_rotations(report.stages);
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
    "  mpm -options_file DECK -dry_run             prints particles, memory, steps and run time; writes "
    "nothing\n"
    "  mpm -options_file DECK -restart latest      goes on from the last checkpoint\n"
    "  mpirun -n 4 mpm -options_file DECK          runs on four processes\n"
    "  mpm -help NAME                              the help of one option\n"
    "  mpm -schema                                 every option as JSON\n"
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

}  // namespace mpm
