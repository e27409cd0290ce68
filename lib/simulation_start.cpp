// From the options to the first step.

#include <cmath>
#include <cstdio>

#include "common/collectives.hpp"
#include "common/hdf5_handle.hpp"
#include "common/text.hpp"
#include "gpu.hpp"
#include "input/courant.hpp"
#include "input/load_faces.hpp"
#include "input/overlap.hpp"
#include "input/run_options.hpp"
#include "memory_need.hpp"
#include "mesh/background.hpp"
#include "output/files.hpp"
#include "output/history_columns.hpp"
#include "output/measurement_cache.hpp"
#include "output/performance_json.hpp"
#include "signals.hpp"
#include "simulation_body.hpp"
#include "warnings.hpp"
#include "warnings_soil.hpp"

namespace mpm {
Simulation::Simulation() : body_(std::make_unique<Body>()) {}
Simulation::~Simulation() = default;
bool Simulation::ready() const { return body_->ready; }
Outcome Simulation::outcome() const { return body_->outcome; }
void Simulation::on_first_step(std::function<void()> call) { body_->on_first_step = std::move(call); }

PetscErrorCode Simulation::set_from_options(MPI_Comm comm, const char* prefix, const InputReport& arguments) {
  PetscFunctionBeginUser;
  Body& b = *body_;
  silence_hdf5();
  keep_hdf5_memory();
  b.comm = comm;
  b.report = arguments;
  PetscCall(read_options(prefix, available_backends(), b.config, b.report));
  if (b.report.help) {
    PetscCall(print_help(comm, b.report));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!b.report.stages.empty() && b.report.errors.empty())
    PetscCall(b.check_stages());
  else if (!b.is_element())
    PetscCall(b.check_mesh_run());
  if (b.report.errors.empty() && !b.is_element())
    if (const std::string fault = equal_columns(b.history_config()); !fault.empty())
      b.report.errors.push_back(fault);
  if (b.report.errors.empty() && rank_of(comm) == 0) PetscCallCXX(b.check_files());
  PetscCall(b.share_errors());
  if (!b.is_element()) PetscCall(b.check_places());
  if (b.report.errors.empty() && b.report.stages.empty())
    for (const std::string& warning : warnings_of(b.config, b.ranks())) b.report.warnings.push_back(warning);
  if (b.report.errors.empty() && !b.config.output.restart.empty()) {
    if (!b.config.dry_run) PetscCall(b.lock_folder());
    if (b.report.errors.empty()) PetscCall(b.read_restart());
    PetscCall(b.share_errors());
  }
  if (!b.report.errors.empty()) {
    if (prefix == nullptr) PetscCall(forget_options(b.report));
    PetscCall(print_errors(comm, b.report));
    b.outcome = Outcome::bad_input;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  b.ready = true;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Checks that the machine and the program allow a run of this mesh.
PetscErrorCode Simulation::Body::check_mesh_run() {
  PetscFunctionBeginUser;
  if (report.errors.empty()) PetscCall(check_device());
  if (report.errors.empty()) check_build();
  if (report.errors.empty()) check_mesh();
  if (report.errors.empty()) PetscCall(choose_time_step());
  if (report.errors.empty())
    if (const std::string fault = memory_fault(config, comm); !fault.empty()) report.errors.push_back(fault);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The mistakes that the lowest rank with any has found, on every rank.
PetscErrorCode Simulation::Body::share_errors() {
  PetscFunctionBeginUser;
  std::string text = join(report.errors, "\n");
  PetscCall(share_text(comm, &text));
  if (!text.empty()) report.errors = {text};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Nothing is in the place of something else. A rank that found another mistake keeps the others from it.
PetscErrorCode Simulation::Body::check_places() {
  PetscFunctionBeginUser;
  int wrong = report.errors.empty() ? 0 : 1;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &wrong, 1, MPI_INT, MPI_MAX, comm));
  if (wrong) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<Overlap> overlaps;
  PetscCall(find_overlaps(comm, config, &overlaps));
  report.errors = describe(overlaps, config);
  PetscCall(check_placed());
  PetscCall(check_load_faces(comm, config, &report.errors, &report.warnings));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A run with -backend cuda needs a GPU on every rank. A dry run goes to the processor instead, so that a
/// deck for a GPU can be checked on a login node.
PetscErrorCode Simulation::Body::check_device() {
  PetscFunctionBeginUser;
  int gpus = gpu_count();
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &gpus, 1, MPI_INT, MPI_MIN, comm));
  if (config.backend != Backend::cuda || gpus > 0) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<std::string> words;
  Backend host = Backend::serial;  // the fastest
  for (const Backend backend : available_backends())
    if (backend != Backend::cuda) words.push_back(word_of(host = backend));
  if (config.dry_run) {
    config.backend = host;
    report.warnings.push_back(
        formatted("warning: -backend cuda: there is no GPU here, or no driver for it; this dry run is one of "
                  "-backend %s, whose memory and wall time are not those of a GPU",
                  word_of(host)));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  bool given = false;
  for (const EffectiveOption& option : report.options)
    given = given || (option.name == "-backend" && !option.standard);
  const std::string why = why_no_gpu();
  report.errors.push_back(
      formatted("mpm: -backend: %s, takes %s where there is no GPU or no driver for it%s%s",
                given ? "given \"cuda\"" : "not given, which stands for \"cuda\"",
                join(words, " or ").c_str(), why.empty() ? "" : "; CUDA says: ", why.c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A program may be built for one dimension or precision only.
void Simulation::Body::check_build() {
  if (make_stepper(config, comm)) return;
  report.errors.push_back(
      formatted("mpm: -precision: given \"%s\" with -dim %d, takes what this program was built for "
                "(MPM_REALS, MPM_DIMS)",
                word_of(config.precision), config.dim));
}

/// The patch table is counted by int.
void Simulation::Body::check_mesh() {
  constexpr double k_most_patches = 2147483647;
  const double patches = patch_count(config.mesh, config.dim);
  if (patches <= k_most_patches) return;
  char line[200];
  std::snprintf(line, sizeof line,
                "mpm: -mesh_spacing: given \"%g\", takes an edge that gives at most %.0f patches of %d cells "
                "a side; this is %.4g",
                config.mesh.spacing, k_most_patches, patch_edge(config.dim), patches);
  report.errors.push_back(line);
}

/// A stepper for these options, and the log's first lines, to the terminal until the file is open.
PetscErrorCode Simulation::Body::begin() {
  PetscFunctionBeginUser;
  stepper = make_stepper(config, comm);
  PetscCheck(stepper, comm, PETSC_ERR_SUP,
             "This program was built without this backend, precision or dimension");
  PetscCall(log.start(comm, config.output.progress));
  PetscCall(log.line(format_header(k_version, kokkos_version(),
                                   std::string(word_of(config.backend)) + ", " + device_name(config.backend),
                                   ranks())));
  for (const std::string& warning : report.warnings) PetscCall(log.line(warning));
  if (const std::string note = note_of_touching(config); !note.empty()) PetscCall(log.line(note));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::start() {
  PetscFunctionBeginUser;
  const bool first = rank_of(comm) == 0;
  int removed = 0;
  catch_signals();  // until here there is nothing to save: they end the program
  PetscCall(agree(comm, first ? make_folder(config.output.directory) : PETSC_SUCCESS));
  PetscCall(lock_folder());
  if (!report.errors.empty()) {
    PetscCall(print_errors(comm, report));
    outcome = Outcome::bad_input;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(begin());
  const std::string& folder = config.output.directory;
  PetscCall(agree(comm, !first    ? PETSC_SUCCESS
                        : restart ? forget_performance_json(folder)
                                  : prepare_output_folder(folder, &removed)));
  PetscCall(place_log_view(report, folder));
  PetscCall(agree(comm, log.open(config.output.directory, restart.has_value())));
  if (!lock.left_by().empty())
    PetscCall(log.line("the lock of the folder was left by " + lock.left_by() + ", which is gone"));
  if (removed > 0)
    PetscCall(log.print("%d files of an earlier run were removed from %s", removed,
                        config.output.directory.c_str()));
  std::vector<EffectiveOption> options = report.options;
  options.insert(options.end(), report.stage_options.begin(), report.stage_options.end());
  PetscCall(log.line("options in force\n" + format_options(options)));
  PetscCall(
      agree(comm, first ? write_options_json(config.output.directory, k_version, options) : PETSC_SUCCESS));

  const Backend backend = config.backend;
  const std::string processor = backend == Backend::cuda ? "" : processor_name();
  const std::string device =
      formatted("%s, %s %s", word_of(backend), device_name(backend).c_str(), processor.c_str());
  if (first)
    bandwidth = cached_measurement("copy_bandwidth", device, [&] { return copy_bandwidth(backend); });
  Model model;
  Failure failure;
  PetscCall(load(&model));
  PetscCall(leave_out(nullptr, &model));
  if (restart) keep_strategy();
  if (config.p2g.strategy == P2G::automatic) PetscCall(choose_strategy(model, device));
  stepper = make_stepper(config, comm);
  PetscCall(stepper->set_up(std::move(model), &failure));
  if (!failure.what.empty()) {
    PetscCall(fail(failure.what));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!restart) PetscCall(follow_stiffness());
  if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(log.print("%ld particles in %d patches, %.1f MB on the device%s; strategy %s",
                      stepper->particles(), stepper->patches(), stepper->memory() / 1e6,
                      ranks() > 1 ? "s" : "", stepper->strategy().c_str()));
  if (const auto figures = stepper->rank_figures()) PetscCall(log.line(format_ranks(*figures)));
  if (const std::string report = stepper->batches_report(); !report.empty()) PetscCall(log.line(report));
  if (follows && !config.time.step)
    PetscCall(log.print(
        "time step %.9g s, which follows the stiffness of the soil: Courant number %.4f, of at most %.4f", dt,
        config.time.courant, largest_courant(config)));
  else
    PetscCall(log.print("time step %.9g s, Courant number %.4f, of at most %.4f; %ld steps to %g s", dt,
                        dt / critical_time_step(config), largest_courant(config), schedule.last_step(),
                        schedule.time_of(schedule.last_step())));
  if (const StepLimits limits{critical_time_step(config), viscous_time_step(config)};
      std::isfinite(limits.viscous)) {
    const auto [waves, viscosity] = largest_steps(limits, config);
    PetscCall(log.print("stable time step: %.6g s by waves alone, %.6g s by viscosity alone: %s governs",
                        waves, viscosity, waves < viscosity ? "the speed of waves" : "the viscosity"));
  }
  PetscCall(tell_damped_step());
  if (restart) {
    PetscCall(resume());
    wall_start = seconds_now();
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(agree(comm, first ? history.open(history_config()) : PETSC_SUCCESS));
  frames.open(config.output.directory, config.precision, {config.output.fields, config.output.compression},
              comm);
  wall_start = seconds_now();
  PetscCall(begin_probes());
  PetscCall(write_row());
  PetscCall(write_frame());
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::unique_ptr<InputReport, void (*)(InputReport*)> prepare_arguments(MPI_Comm comm, int* argc,
                                                                       char*** argv) {
  auto report =
      std::unique_ptr<InputReport, void (*)(InputReport*)>(new InputReport, [](InputReport* r) { delete r; });
  prepare_arguments(comm, argc, argv, *report);
  return report;
}

}  // namespace mpm
