#include "run/restarts.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "checkpoint/earlier.hpp"
#include "checkpoint/folder.hpp"
#include "common/text.hpp"
#include "run/probes.hpp"
#include "run/stages.hpp"

namespace mpm {
namespace {

P2G strategy_of(const std::string& word) {
  for (const auto& [name, strategy] : k_p2g_words)
    if (word == name) return strategy;
  return P2G::automatic;
}

/// The files that -restart may mean, the best first.
std::vector<std::string> restart_files(const OutputConfig& output) {
  if (output.restart != "latest") return {output.restart};
  std::vector<std::string> files;
  for (const long step : checkpoint_steps(output.directory))
    files.insert(files.begin(), checkpoint_path(output.directory, step));
  return files;
}

/// Whether a checkpoint has the times of a run that can go on.
bool has_times(const RunState& run, const TimeConfig& time) {
  return run.dt_since >= 0 && run.dt_since <= run.step && run.dt * k_most_steps >= time.end &&
         run.dt_since_time >= 0 && run.dt_since_time <= run.time && run.last_dt >= 0 &&
         std::isfinite(run.last_dt);
}

std::string refusal(const Config& config, const std::string& what) {
  return "mpm: -restart: given \"" + config.output.restart + "\", takes " + what;
}

}  // namespace

PetscErrorCode Restarts::read(Job& job, TimeStep& time_step, Clock& clock) {
  PetscFunctionBeginUser;
  std::string fault;
  PetscCall(find(job, &fault));
  if (fault.empty()) {
    PetscCall(enter_stage(job, time_step, clock));
    fault = compare(job);
    if (!job.report.errors.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  }
  const std::size_t earlier = passed_over_.size();
  if (fault.empty())
    PetscCallCXX(check(job, time_step, clock));
  else
    job.report.errors.push_back(
        refusal(job.config, fault) +
        (earlier > 1 ? " (and so for " + std::to_string(earlier - 1) + " earlier ones)" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Reads the best checkpoint of those that -restart may mean. `fault`: what it should have been.
PetscErrorCode Restarts::find(const Job& job, std::string* fault) {
  PetscFunctionBeginUser;
  const OutputConfig& output = job.config.output;
  *fault = "a folder with a checkpoint_STEP.h5, and " + output.directory + " has none";
  checkpoint_.emplace();
  const auto files = restart_files(output);
  std::string without_rows;  // the best checkpoint that is sound but for its history
  for (const std::string& file : files) {
    PetscCall(read_checkpoint(job.comm, file, *checkpoint_, fault));
    PetscCall(share_text(job.comm, fault));
    file_ = file;
    if (fault->empty() && (files.size() == 1 || history_agrees(job.config))) break;
    if (fault->empty()) {
      *fault = "a checkpoint with whose rows history.csv begins";
      if (without_rows.empty()) without_rows = file;
    }
    passed_over_.push_back(file + " is passed over; a restart takes " + *fault);
  }
  if (!fault->empty() && !without_rows.empty()) {
    file_ = without_rows;
    PetscCall(read_checkpoint(job.comm, file_, *checkpoint_, fault));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The stage in which the checkpoint was written.
PetscErrorCode Restarts::enter_stage(Job& job, TimeStep& time_step, Clock& clock) const {
  PetscFunctionBeginUser;
  const StageState& stage = checkpoint_->run.stage;
  if (stage.index < 0 || stage.index >= static_cast<long>(job.report.stages.size()))
    PetscFunctionReturn(PETSC_SUCCESS);
  clock.stage = stage;
  take_stage(job, clock);
  PetscCall(time_step.choose(job, clock));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Compares the options and the state with the checkpoint. Returns what that should have been; contradicting
/// options are lines of the report.
std::string Restarts::compare(Job& job) {
  keep_contact(checkpoint_->options, job.config, job.report.options);
  for (StageInput& stage : job.report.stages) keep_contact(checkpoint_->options, stage.config, stage.options);
  const Config& config = job.config;
  const Comparison found = compare_options(*checkpoint_, options_to_keep(job.report.options, config), config,
                                           file_, config.output.restart_change);
  job.report.errors = found.lines;
  if (!found.lines.empty()) return "";
  changes_ = found.changes;
  complete_earlier(config, checkpoint_->state);
  std::string fault = state_fault(checkpoint_->state, config);
  if (fault.empty()) fault = probes_fault(*checkpoint_, config);
  if (fault.empty()) apply_changes(changes_, config, checkpoint_->state);
  laws_changed_ = changed_laws(changes_, config);
  return fault;
}

/// Whether times and the history of the output folder go on where the checkpoint is.
void Restarts::check(Job& job, const TimeStep& time_step, Clock& clock) {
  const Config& config = job.config;
  const RunState& run = checkpoint_->run;
  const bool begins = has_times(run, config.time);
  const bool other_laws = std::find(laws_changed_.begin(), laws_changed_.end(), 1) != laws_changed_.end();
  const bool same_step = clock.dt == run.dt;  // since then, where a change of laws has brought it
  if (other_laws && begins && !same_step) {
    clock.schedule = Schedule(config.time, config.output, clock.dt, {run.step, run.time});
  } else if ((time_step.follows() || same_step) && begins) {
    if (time_step.follows()) clock.dt = config.time.step.value_or(run.dt);
    clock.schedule = Schedule(config.time, config.output, clock.dt, {run.dt_since, run.dt_since_time});
  }
  if (!begins || run.step < 0 || run.rebuilds.since < 0 || checkpoint_->history.bytes < 0 ||
      checkpoint_->frames < 0 || checkpoint_->frames - 1 > run.step)  // one a step
    job.report.errors.push_back(refusal(config, "a checkpoint with a sound step"));
  else
    check_times(job, clock);
  if (job.report.errors.empty()) find_history(job);
}

/// Whether the run ends at or after the checkpoint.
void Restarts::check_times(Job& job, const Clock& clock) const {
  const TimeConfig& time = job.config.time;
  const RunState& run = checkpoint_->run;
  const long last = clock.schedule.last_step();
  if (run.step > last)
    job.report.errors.push_back(
        time.max_steps && *time.max_steps <= last
            ? formatted("mpm: -time_max_steps: given \"%ld\", takes at least the %ld steps of %s",
                        *time.max_steps, run.step, file_.c_str())
            : formatted("mpm: -time_end: given \"%g\", takes at least the %.9g s of %s", time.end, run.time,
                        file_.c_str()));
  else if (std::fabs(clock.schedule.time_of(run.step) - run.time) > 1e-9 * clock.dt)
    job.report.errors.push_back(
        formatted("mpm: -time_end: given \"%g\", takes %.9g here, where %s has ended with a "
                  "shorter step; an earlier checkpoint takes any",
                  time.end, run.time, file_.c_str()));
}

/// Whether the history of the output folder begins with the rows of the checkpoint, or there is none. Another
/// run may have gone back and on from an earlier checkpoint and ended before it wrote one of its own.
bool Restarts::history_agrees(const Config& config) const {
  const std::string path = config.output.directory + "/history.csv";
  std::error_code none;
  return !std::filesystem::exists(path, none) ||
         mark_of(path, checkpoint_->history.bytes, nullptr) == checkpoint_->history;
}

/// The rows to go on with: those of the output folder, or of the checkpoint's own where that is another.
void Restarts::find_history(Job& job) {
  namespace fs = std::filesystem;
  const HistoryMark& wanted = checkpoint_->history;
  const std::string& output = job.config.output.directory;
  const std::string here = output + "/history.csv";
  const fs::path folder = fs::path(file_).parent_path();
  std::error_code none;
  for (const std::string& file : {here, (folder / "history.csv").string()}) {
    if (!fs::is_regular_file(file, none)) continue;
    if (mark_of(file, wanted.bytes, &history_rows_) == wanted) return;
    history_rows_.clear();
    if (file == here)
      return job.report.errors.push_back("mpm: -output_dir: given \"" + output +
                                         "\", takes a folder without a history.csv or with that of " + file_);
  }
}

void Restarts::keep_strategy(Config& config) const {
  if (config.p2g.strategy == P2G::automatic && checkpoint_->backend == word_of(config.backend))
    config.p2g.strategy = strategy_of(checkpoint_->strategy);
}

PetscErrorCode Restarts::report(Job& job, const Clock& clock, const Checkpoint& now) const {
  PetscFunctionBeginUser;
  Log& log = job.log;
  const std::string machine = changed_machine(*checkpoint_, now);
  for (const std::string& line : passed_over_) PetscCall(log.line(line));
  PetscCall(log.print("goes on from %s: step %ld, time %.9g s%s", file_.c_str(), clock.step,
                      checkpoint_->run.time,
                      job.report.stages.empty() ? "" : (", in stage " + job.config.stage.name).c_str()));
  if (checkpoint_->version != k_version)
    PetscCall(log.print("it was written by version %s", checkpoint_->version.c_str()));
  for (const OptionChange& c : changes_) PetscCall(log.line(line_of(c)));
  PetscCall(log.line(!changes_.empty() ? "results are no longer those of the run that was left"
                     : machine.empty()
                         ? "backend, precision, strategy and ranks are the same, and so will be the bits"
                         : machine + ": results will be the same up to round-off"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void Restarts::let_go() {
  began_ = checkpoint_->run.step;
  checkpoint_.reset();
  history_rows_.clear();
}

PetscErrorCode Restarts::write(Job& job, long step, Checkpoint&& checkpoint) {
  PetscFunctionBeginUser;
  const std::string& folder = job.config.output.directory;
  const long frames = checkpoint.frames;
  PetscCall(write_checkpoint(job.comm, checkpoint_path(folder, step), std::move(checkpoint)));
  written_ = step;
  PetscCall(forget_later(job, frames));
  PetscCall(agree(job.comm, job.is_first() ? keep_last_checkpoints(folder) : PETSC_SUCCESS));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Restarts::forget_later(Job& job, long frames) const {
  PetscFunctionBeginUser;
  const std::string& folder = job.config.output.directory;
  int removed = 0;
  if (job.is_first() && began_ > 0) {
    if (written_ >= 0) PetscCall(remove_later_checkpoints(folder, written_, &removed));
    PetscCall(remove_later_frames(folder, frames, &removed));
  }
  if (removed > 0) PetscCall(job.log.print("%d files of a later state were removed", removed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

Checkpoint describe(const Job& job, const std::string& strategy) {
  return {k_version,
          job.config.dim,
          job.ranks(),
          word_of(job.config.backend),
          word_of(job.config.precision),
          strategy,
          options_to_keep(job.report.options, job.config),
          {},
          {},
          0,
          {}};
}

}  // namespace mpm
