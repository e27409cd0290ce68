// Up to the first step of a run, of one that goes on, and of a stage.

#include <algorithm>

#include "check/gpu.hpp"
#include "check/own_folder.hpp"
#include "check/places.hpp"
#include "check/warnings.hpp"
#include "checkpoint/id_blocks.hpp"
#include "common/text.hpp"
#include "output/history_columns.hpp"
#include "output/measurement_cache.hpp"
#include "run/choose_strategy.hpp"
#include "run/element_run.hpp"
#include "run/load_model.hpp"
#include "run/run.hpp"
#include "run/setup.hpp"
#include "run/signals.hpp"
#include "run/stages.hpp"
#include "step/state_map.hpp"

namespace mpm {
namespace {

/// The mistakes that the lowest rank with any has found, on every rank.
PetscErrorCode share_errors(MPI_Comm comm, std::vector<std::string>& errors) {
  PetscFunctionBeginUser;
  std::string text = join(errors, "\n");
  PetscCall(share_text(comm, &text));
  if (!text.empty()) errors = {text};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Log lines on the particles of a stepper that was set up.
PetscErrorCode report_soil(const Stepper& stepper, int ranks, Log& log) {
  PetscFunctionBeginUser;
  PetscCall(log.print("%ld particles in %d patches, %.1f MB on the device%s; strategy %s",
                      stepper.particles(), stepper.patches(), stepper.memory() / 1e6, ranks > 1 ? "s" : "",
                      stepper.strategy().c_str()));
  if (const std::string bins = stepper.bins_report(); !bins.empty()) PetscCall(log.line(bins));
  if (const auto figures = stepper.rank_figures()) PetscCall(log.line(format_ranks(*figures)));
  if (const std::string batches = stepper.batches_report(); !batches.empty()) PetscCall(log.line(batches));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace

PetscErrorCode Run::check() {
  PetscFunctionBeginUser;
  const bool element = is_element(job_.config);
  InputReport& report = job_.report;
  std::vector<std::string>& errors = report.errors;
  if (!report.stages.empty() && errors.empty())
    PetscCall(check_stages(job_, time_step_, clock_));
  else if (!element)
    PetscCall(check_mesh_run(job_, time_step_, clock_));
  if (errors.empty() && !element)
    if (const std::string fault = equal_columns(history_config(job_)); !fault.empty())
      errors.push_back(fault);
  if (errors.empty() && job_.is_first()) PetscCallCXX(check_own_folder(job_.config, report));
  PetscCall(share_errors(job_.comm, errors));
  if (!element) PetscCall(check_places(job_.comm, job_.config, report));
  if (errors.empty() && report.stages.empty())
    for (const std::string& warning : warnings_of(job_.config, job_.ranks()))
      report.warnings.push_back(warning);
  if (errors.empty() && !job_.config.output.restart.empty()) {
    if (!job_.config.dry_run) PetscCall(lock_folder(job_));
    if (errors.empty()) PetscCall(restarts_.read(job_, time_step_, clock_));
    PetscCall(share_errors(job_.comm, errors));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Run::start() {
  PetscFunctionBeginUser;
  const bool goes_on = restarts_.checkpoint() != nullptr;
  catch_signals();  // until here there is nothing to save: they end the program
  PetscCall(take_folder(job_));
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(begin_log(job_));
  PetscCall(open_folder(job_, goes_on));
  PetscCall(first_set_up());
  if (job_.goes_well() && !goes_on) PetscCall(time_step_.follow(job_, *stepper_, domains_changed(), clock_));
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(report_soil(*stepper_, job_.ranks(), job_.log));
  PetscCall(time_step_.report(job_, clock_));
  if (goes_on) {
    PetscCall(resume());
    effort_.begin = seconds_now();
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(outputs_.open(job_, history_config(job_)));
  effort_.begin = seconds_now();
  PetscCall(outputs_.probes().begin(job_, clock_, *stepper_));
  PetscCall(write_row());
  PetscCall(outputs_.write_frame(job_, clock_, *stepper_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Particles of the options, on a stepper of the fastest strategy.
PetscErrorCode Run::first_set_up() {
  PetscFunctionBeginUser;
  const Backend backend = job_.config.backend;
  const std::string device = device_key(backend);
  if (backend == Backend::cuda) effort_.count_gpu(gpu_bus());
  if (job_.is_first())
    effort_.bandwidth = cached_measurement("copy_bandwidth", device, [&] { return copy_bandwidth(backend); });
  Model model;
  PetscCall(load_model(job_, &model));
  PetscCall(leave_out(job_, clock_, nullptr, &model));
  if (restarts_.checkpoint()) restarts_.keep_strategy(job_.config);
  if (job_.config.p2g.strategy == P2G::automatic) PetscCall(choose_strategy(job_, model, clock_.dt, device));
  stepper_ = make_stepper(job_.config, job_.comm);
  PetscCall(set_up(std::move(model)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Run::set_up(Model&& model) {
  PetscFunctionBeginUser;
  Failure failure;
  PetscCall(stepper_->set_up(std::move(model), &failure));
  if (!failure.what.empty()) PetscCall(fail(job_, clock_, failure.what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Steps on from the checkpoint, after set_up. The folder is touched last.
PetscErrorCode Run::resume() {
  PetscFunctionBeginUser;
  Checkpoint& c = *restarts_.checkpoint();
  clock_.step = c.run.step, clock_.last_dt = c.run.last_dt;
  effort_.before = c.run.wall, effort_.stepping = c.run.stepping, effort_.rebuilds = c.run.rebuilds;
  effort_.part = {c.run.step,          c.run.wall, c.run.stepping, c.run.time, effort_.energy.joules(),
                  effort_.gpu.joules()};
  time_step_.go_on(c.run.waves);
  outputs_.take(c);
  PetscCall(adapt_state(job_, clock_, *stepper_, {restarts_.laws_changed(), {}, true}, c.state));
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  bool rebuilt = false;
  const PetscErrorCode unfit = stepper_->restore(std::move(c.state), effort_.rebuilds.since, &rebuilt);
  if (unfit == PETSC_ERR_ARG_SIZ) {  // reported; only a checkpoint that somebody has altered gets here
    job_.outcome = Outcome::bad_input;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(unfit);
  if (rebuilt) effort_.rebuilds.since = 0;
  PetscCall(restarts_.report(job_, clock_, describe(job_, stepper_->strategy())));
  PetscCall(outputs_.go_on(job_, history_config(job_), restarts_.history_rows(), c.frames));
  restarts_.let_go();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Ends the present stage, and sets up the next one from its state.
PetscErrorCode Run::next_stage() {
  PetscFunctionBeginUser;
  SavedState state;
  std::vector<SectionSum> sections;
  HistoryRow row;  // before the soil changes
  PetscCall(stepper_->sum_sections(&sections));
  if (job_.config.output.energy) PetscCall(stepper_->measure(0, &row));
  PetscCall(stepper_->save(&state));
  PetscCall(bring_together(job_.comm, &state));
  leave_stage(job_.config, state, clock_.stage);
  if (job_.config.stage.reset) PetscCall(outputs_.probes().reset(job_.config, *stepper_));
  PetscCall(job_.log.line(format_performance(performance_of(job_, clock_, effort_, *stepper_))));
  Config before;
  std::vector<OptionChange> changes;
  PetscCall(begin_stage(job_, time_step_, clock_, &before, &changes));
  const StageConfig& stage = job_.config.stage;
  Present present;
  PetscCall(change_bodies(job_, clock_, state, &present));
  apply_changes(changes, job_.config, state);
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  NewBodies bodies{changed_laws(before, job_.config), stage.place};
  const bool other_soil = changes_soil(stage) || bodies.any_changed() || !(before.water == job_.config.water);
  PetscCall(enter_stage(std::move(state), present, std::move(bodies)));
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  if (changes_soil(stage)) PetscCall(outputs_.probes().keep_sections(job_.config, sections, *stepper_));
  if (!stage.place.empty()) PetscCall(outputs_.probes().follow_placed(job_.config, *stepper_));
  if (job_.config.output.energy && other_soil) PetscCall(stepper_->keep_balance(row.energy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A stepper for the options of the stage with a state.
PetscErrorCode Run::enter_stage(SavedState&& state, const Present& present, NewBodies&& bodies) {
  PetscFunctionBeginUser;
  Model model;
  stepper_.reset();  // before the next one takes memory
  PetscCall(load_model(job_, &model));
  PetscCall(leave_out(job_, clock_, &present, &model));
  stepper_ = make_stepper(job_.config, job_.comm);
  effort_.part = {.step = clock_.step,
                  .stepping = effort_.stepping,
                  .time = clock_.time(),
                  .joules = effort_.energy.joules(),
                  .gpu = effort_.gpu.joules()};
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(set_up(std::move(model)));
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(adapt_state(job_, clock_, *stepper_, bodies, state));
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(find_loads(job_, clock_, state));
  if (!job_.goes_well()) PetscFunctionReturn(PETSC_SUCCESS);
  bool rebuilt = false;
  PetscCall(stepper_->restore(std::move(state), effort_.rebuilds.since, &rebuilt));
  if (rebuilt) effort_.rebuilds.since = 0;
  outputs_.begin_stage(), time_step_.begin_stage(clock_), effort_.looks = 0;
  effort_.part.wall = effort_.wall();
  const bool now = domains_changed() || bodies.any_changed() || !bodies.placed.empty();
  PetscCall(time_step_.follow(job_, *stepper_, now, clock_));
  PetscCall(job_.log.print("time step %.9g s; stage %s goes on to %g s at most", clock_.dt,
                           job_.config.stage.name.c_str(), job_.config.time.end));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
