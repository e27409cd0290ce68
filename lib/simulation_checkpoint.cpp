// Going on: checkpoints of a run, and runs from checkpoints.

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "checkpoint/changes.hpp"
#include "checkpoint/earlier.hpp"
#include "checkpoint/folder.hpp"
#include "common/collectives.hpp"
#include "common/text.hpp"
#include "output/files.hpp"
#include "signals.hpp"
#include "simulation_body.hpp"

namespace mpm {
namespace {

P2G strategy_of(const std::string& word) {
  for (const auto& [name, strategy] : k_p2g_words)
    if (word == name) return strategy;
  return P2G::automatic;
}

}  // namespace

/// The files that -restart may mean, the best first.
std::vector<std::string> Simulation::Body::restart_files() const {
  if (config.output.restart != "latest") return {config.output.restart};
  std::vector<std::string> files;
  for (const long step : checkpoint_steps(config.output.directory))
    files.insert(files.begin(), checkpoint_path(config.output.directory, step));
  return files;
}

/// Reads the checkpoint to go on from, and checks it against the options; touches nothing.
PetscErrorCode Simulation::Body::read_restart() {
  PetscFunctionBeginUser;
  const std::string given = "mpm: -restart: given \"" + config.output.restart + "\", takes ";
  std::string fault = "a folder with a checkpoint_STEP.h5, and " + config.output.directory + " has none";
  restart.emplace();
  const auto files = restart_files();
  std::string without_rows;  // the best checkpoint that is sound but for its history
  for (const std::string& file : files) {
    PetscCall(read_checkpoint(comm, file, *restart, &fault));
    PetscCall(share_text(comm, &fault));
    restart_file = file;
    if (fault.empty() && (files.size() == 1 || history_agrees())) break;
    if (fault.empty()) {
      fault = "a checkpoint with whose rows history.csv begins";
      if (without_rows.empty()) without_rows = file;
    }
    passed_over.push_back(file + " is passed over; a restart takes " + fault);
  }
  if (!fault.empty() && !without_rows.empty()) {
    restart_file = without_rows;
    PetscCall(read_checkpoint(comm, restart_file, *restart, &fault));
  }
  if (fault.empty()) {
    PetscCall(take_restart_stage());
    const Comparison found = compare_options(*restart, options_to_keep(report.options, config), config,
                                             restart_file, config.output.restart_change);
    report.errors = found.lines;
    if (!report.errors.empty()) PetscFunctionReturn(PETSC_SUCCESS);
    option_changes = found.changes;
    complete_earlier(config, restart->state);
    fault = state_fault(restart->state, config);
    if (fault.empty()) fault = probes_fault();
    if (fault.empty()) apply_changes(option_changes, config, restart->state);
    laws_changed = changed_laws(option_changes, config);
  }
  if (!fault.empty())
    report.errors.push_back(given + fault +
                            (passed_over.size() > 1
                                 ? " (and so for " + std::to_string(passed_over.size() - 1) + " earlier ones)"
                                 : ""));
  else
    PetscCall(check_restart());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Whether times and the history of the output folder go on where the checkpoint is.
PetscErrorCode Simulation::Body::check_restart() {
  PetscFunctionBeginUser;
  const RunState& run = restart->run;
  const bool begins = run.dt_since >= 0 && run.dt_since <= run.step &&
                      run.dt * k_most_steps >= config.time.end && run.dt_since_time >= 0 &&
                      run.dt_since_time <= run.time && run.last_dt >= 0 && std::isfinite(run.last_dt);
  const bool other_laws = std::find(laws_changed.begin(), laws_changed.end(), 1) != laws_changed.end();
  const bool same_step = begins && dt == run.dt;  // since then, where a change of laws has brought it
  if (other_laws && begins && !same_step) {
    schedule = Schedule(config.time, config.output, dt, {run.step, run.time});
  } else if ((follows || same_step) && begins) {
    if (follows) dt = config.time.step.value_or(run.dt);
    schedule = Schedule(config.time, config.output, dt, {run.dt_since, run.dt_since_time});
  }
  const long last = schedule.last_step();
  if (!begins || run.step < 0 || run.since_rebuild < 0 || restart->history.bytes < 0 || restart->frames < 0 ||
      restart->frames - 1 > run.step)  // one a step
    report.errors.push_back("mpm: -restart: given \"" + config.output.restart +
                            "\", takes a checkpoint with a sound step");
  else if (run.step > last)
    report.errors.push_back(
        config.time.max_steps && *config.time.max_steps <= last
            ? formatted("mpm: -time_max_steps: given \"%ld\", takes at least the %ld steps of %s",
                        *config.time.max_steps, run.step, restart_file.c_str())
            : formatted("mpm: -time_end: given \"%g\", takes at least the %.9g s of %s", config.time.end,
                        run.time, restart_file.c_str()));
  else if (std::fabs(schedule.time_of(run.step) - run.time) > 1e-9 * dt)
    report.errors.push_back(
        formatted("mpm: -time_end: given \"%g\", takes %.9g here, where %s has ended with a "
                  "shorter step; an earlier checkpoint takes any",
                  config.time.end, run.time, restart_file.c_str()));
  if (!report.errors.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallCXX(find_history());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Whether the history of the output folder begins with the rows of the checkpoint, or there is none. Another
/// run may have gone back and on from an earlier checkpoint and ended before it wrote one of its own.
bool Simulation::Body::history_agrees() const {
  const std::string path = config.output.directory + "/history.csv";
  std::error_code none;
  return !std::filesystem::exists(path, none) ||
         mark_of(path, restart->history.bytes, nullptr) == restart->history;
}

/// The rows to go on with: those of the output folder, or of the checkpoint's own where that is another.
void Simulation::Body::find_history() {
  namespace fs = std::filesystem;
  const HistoryMark& wanted = restart->history;
  const std::string here = config.output.directory + "/history.csv";
  const fs::path folder = fs::path(restart_file).parent_path();
  std::error_code none;
  for (const std::string& file : {here, (folder / "history.csv").string()}) {
    if (!fs::is_regular_file(file, none)) continue;
    if (mark_of(file, wanted.bytes, &history_rows) == wanted) return;
    history_rows.clear();
    if (file == here)
      return report.errors.push_back("mpm: -output_dir: given \"" + config.output.directory +
                                     "\", takes a folder without a history.csv or with that of " +
                                     restart_file);
  }
}

/// Steps on from the checkpoint, after set_up. The folder is touched last.
PetscErrorCode Simulation::Body::resume() {
  PetscFunctionBeginUser;
  const std::string changes = changed_machine(*restart, description());
  began = part = restart->run;
  step = began.step;
  last_row_time = began.last_row_time, last_dt = began.last_dt;
  stepping = began.stepping;
  since_rebuild = began.since_rebuild, rebuilds = began.rebuilds;
  longest = began.longest, shortest = began.shortest;
  waves = began.waves;
  waves.every = std::max(1L, waves.every);
  probes = std::move(restart->probes), rasters = std::move(restart->rasters);
  PetscCall(adapt_state(laws_changed, {}, restart->state));
  if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
  bool rebuilt = false;
  const PetscErrorCode unfit = stepper->restore(std::move(restart->state), since_rebuild, &rebuilt);
  if (unfit == PETSC_ERR_ARG_SIZ) {  // reported; only a checkpoint that somebody has altered gets here
    outcome = Outcome::bad_input;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(unfit);
  if (rebuilt) since_rebuild = 0;
  for (const std::string& line : passed_over) PetscCall(log.line(line));
  PetscCall(log.print("goes on from %s: step %ld, time %.9g s%s", restart_file.c_str(), step, began.time,
                      report.stages.empty() ? "" : (", in stage " + config.stage.name).c_str()));
  if (restart->version != k_version)
    PetscCall(log.print("it was written by version %s", restart->version.c_str()));
  for (const OptionChange& c : option_changes)
    PetscCall(log.line("changed here: " + c.name + " " + c.before + " -> " + c.after));
  PetscCall(log.line(!option_changes.empty() ? "results are no longer those of the run that was left"
                     : changes.empty()
                         ? "backend, precision, strategy and ranks are the same, and so will be the bits"
                         : changes + ": results will be the same up to round-off"));
  int removed = 0;
  const bool first = rank_of(comm) == 0;
  PetscCall(agree(comm, first ? remove_unfinished(config.output.directory, &removed) : PETSC_SUCCESS));
  if (removed > 0) PetscCall(log.print("%d files that were not finished were removed", removed));
  if (history_rows.empty())
    PetscCall(log.line("there is no history.csv to go on with: a new one begins here"));
  PetscCall(agree(comm, first ? history.open(history_config(), history_rows) : PETSC_SUCCESS));
  PetscCall(frames.resume(config, restart->frames, comm));
  restart.reset();
  history_rows.clear();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// `-p2g auto` at a restart keeps the strategy, and with it the bits, where the backend is the same.
void Simulation::Body::keep_strategy() {
  if (config.p2g.strategy == P2G::automatic && restart->backend == word_of(config.backend))
    config.p2g.strategy = strategy_of(restart->strategy);
}

/// A checkpoint of this run but for its state.
Checkpoint Simulation::Body::description() const {
  return {k_version,
          config.dim,
          ranks(),
          word_of(config.backend),
          word_of(config.precision),
          stepper->strategy(),
          options_to_keep(report.options, config),
          {},
          {},
          frames.count(),
          {}};
}

PetscErrorCode Simulation::Body::write_checkpoint() {
  PetscFunctionBeginUser;
  if (checkpointed == step) PetscFunctionReturn(PETSC_SUCCESS);
  const SignalsWait until_written;
  const std::string& folder = config.output.directory;
  Checkpoint c = description();
  c.run = {.step = step,
           .time = schedule.time_of(step),
           .dt = dt,
           .dt_since = schedule.begin().step,
           .dt_since_time = schedule.begin().time,
           .last_dt = last_dt,
           .last_row_time = last_row_time,
           .wall = wall(),
           .stepping = stepping,
           .since_rebuild = since_rebuild,
           .rebuilds = rebuilds,
           .longest = longest,
           .shortest = shortest,
           .stage = stage,
           .stage_step = stage_begin.step,
           .stage_time = stage_begin.time,
           .waves = waves,
           .stage_over = stage_over ? 1 : 0,
           .rigid_zero = rigid_zero,
           .rigid_begin = rigid_begin};
  PetscCall(frames.settle());
  const bool first = rank_of(comm) == 0;
  PetscCall(agree(comm, first ? history.settle(&c.history) : PETSC_SUCCESS));
  double mark[2] = {double(c.history.bytes), double(c.history.crc)};
  PetscCall(share_numbers(comm, 2, mark));
  c.history = {static_cast<long>(mark[0]), static_cast<std::uint32_t>(mark[1])};
  PetscCall(stepper->save(&c.state));
  c.probes = probes, c.rasters = rasters;
  PetscCall(mpm::write_checkpoint(comm, checkpoint_path(folder, step), std::move(c)));
  checkpointed = step;
  PetscCall(forget_later());
  PetscCall(agree(comm, first ? keep_last_checkpoints(folder) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Removes what a run had written in the folder that was further than the checkpoint from which this one goes
/// on: checkpoints once there is a newer one, frames then or at the end.
PetscErrorCode Simulation::Body::forget_later() {
  PetscFunctionBeginUser;
  const std::string& folder = config.output.directory;
  int removed = 0;
  if (rank_of(comm) == 0 && began.step > 0) {
    if (checkpointed >= 0) PetscCall(remove_later_checkpoints(folder, checkpointed, &removed));
    PetscCall(remove_later_frames(folder, frames.count(), &removed));
  }
  if (removed > 0) PetscCall(log.print("%d files of a later state were removed", removed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Whether any rank has had a signal to stop, or the time limit is reached. Collective.
PetscErrorCode Simulation::Body::look_for_stop(bool* stop) {
  PetscFunctionBeginUser;
  constexpr int k_clock = 1 << 20;  // more than any signal
  int why = signal_caught();
  if (why == 0 && config.output.wall_time_limit && seconds_now() - born >= *config.output.wall_time_limit)
    why = k_clock;
  if (ranks() > 1) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &why, 1, MPI_INT, MPI_MAX, comm));
  if (why != 0) stopped_by = why == k_clock ? "-wall_time_limit" : name_of_signal(why);
  *stop = why != 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::stop() {
  PetscFunctionBeginUser;
  ignore_signals();
  PetscCall(write_checkpoint());
  outcome = Outcome::stopped;
  PetscCall(log.print("told to stop by %s; %s is written, and -restart latest goes on from it",
                      stopped_by.c_str(), checkpoint_path(config.output.directory, step).c_str()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int Simulation::Body::ranks() const {
  PetscMPIInt size = 1;
  MPI_Comm_size(comm, &size);
  return size;
}

}  // namespace mpm
