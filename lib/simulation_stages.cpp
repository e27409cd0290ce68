// Stages of a run: each is set up anew from the state that the one before has left.

#include <algorithm>
#include <cmath>

#include "checkpoint/changes.hpp"
#include "checkpoint/id_blocks.hpp"
#include "common/collectives.hpp"
#include "common/text.hpp"
#include "simulation_body.hpp"
#include "step/stage_loads.hpp"
#include "step/state_map.hpp"
#include "warnings.hpp"

namespace mpm {
namespace {

constexpr double k_energy_share = 0.01;  // of the unbalanced ratio: largest kinetic energy over m g h

/// Soil at rest that has never moved: velocities and plastic strains become zero.
void reset_state(const Config& config, SavedState& state) {
  for (SavedField& field : state.soil.fields)
    for (const char* name : {"velocity", "affine", "plastic_strain"})
      if (field.name == name) std::fill(field.values.begin(), field.values.end(), 0.0);
  for (std::size_t r = 0; r < state.rigids.size(); ++r)
    if (config.rigids[r].motion == Motion::dynamic) state.rigids[r].velocity = {};
}

double length_of(const Vec3& x) { return std::hypot(x[0], x[1], x[2]); }

}  // namespace

void Simulation::Body::take_stage(int number) {
  stage = number;
  config = report.stages[number].config;
  report.options = report.stages[number].options;
  config.time.start = stage_begin.time;
  config.time.end += stage_begin.time;
}

/// Checks each stage as a run of its own; the first is the one at hand then.
PetscErrorCode Simulation::Body::check_stages() {
  PetscFunctionBeginUser;
  for (StageInput& input : report.stages) {
    config = input.config;
    PetscCall(check_mesh_run());
    input.config.backend = config.backend;
    if (report.errors.empty())
      for (const std::string& warning : warnings_of(config, ranks()))
        if (std::find(report.warnings.begin(), report.warnings.end(), warning) == report.warnings.end())
          report.warnings.push_back(warning);
  }
  take_stage(0);
  if (report.errors.empty()) PetscCall(choose_time_step());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// After the checkpoint of a restart was read: the stage that it was written in.
PetscErrorCode Simulation::Body::take_restart_stage() {
  PetscFunctionBeginUser;
  const RunState& run = restart->run;
  if (report.stages.empty() || run.stage < 0 || run.stage >= static_cast<long>(report.stages.size()))
    PetscFunctionReturn(PETSC_SUCCESS);
  stage_begin = {run.stage_step, run.stage_time};
  stage_over = run.stage_over != 0;
  rigid_zero = run.rigid_zero, rigid_begin = run.rigid_begin;
  take_stage(static_cast<int>(run.stage));
  PetscCall(choose_time_step());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Config of the history's columns, which are the same in all stages: those of a side that some stage holds.
Config Simulation::Body::history_config() const {
  Config all = config;
  for (const StageInput& input : report.stages)
    for (int d = 0; d < 3; ++d)
      for (int side = 0; side < 2; ++side)
        if (!is_open(input.config.mesh.walls[d][side])) all.mesh.walls[d][side] = Wall::roller;
  return all;
}

/// Whether the event that ends the stage has come, by a row of the history.
void Simulation::Body::look_for_end(const HistoryRow& row) {
  const StageConfig& ends = config.stage;
  if (step == stage_begin.step) return;
  if (ends.end == StageEnd::displacement) {
    Vec3 moved = row.rigids[ends.end_rigid].displacement;
    for (std::size_t d = 0; d < 3 && !rigid_begin.empty(); ++d) {
      const std::size_t k = 3 * static_cast<std::size_t>(ends.end_rigid) + d;
      moved[d] += rigid_zero[k] - rigid_begin[k];
    }
    stage_over = length_of(moved) >= ends.end_displacement;
  } else if (ends.end == StageEnd::equilibrium) {
    double energy = 0, mass = 0;
    for (const BodyRow& body : row.bodies) energy += body.kinetic_energy, mass += body.mass;
    const double scale = mass * length_of(config.gravity) * config.mesh.spacing;
    stage_over = row.unbalanced_ratio < ends.unbalanced_ratio &&
                 energy < k_energy_share * ends.unbalanced_ratio * scale;
  }
}

/// Why the stage has not ended as it should, for a failure; empty if it has.
std::string Simulation::Body::missed_end() const {
  const StageConfig& ends = config.stage;
  if (ends.end == StageEnd::time || stage_over) return "";
  const double time = config.time.end - config.time.start;
  if (ends.end == StageEnd::displacement)
    return formatted("stage %s: rigid %s has not moved by %g m in the %g s of -%s_time_end",
                     ends.name.c_str(), config.rigids[ends.end_rigid].name.c_str(), ends.end_displacement,
                     time, ends.name.c_str());
  return formatted(
      "stage %s: the soil is not in equilibrium after the %g s of -%s_time_end: the unbalanced ratio is "
      "%.3g, "
      "and the stage takes less than %g and hardly any kinetic energy; more -damping or more time brings it "
      "there",
      ends.name.c_str(), time, ends.name.c_str(), last_unbalanced, ends.unbalanced_ratio);
}

/// Whether another stage follows once this one has ended.
bool Simulation::Body::has_next_stage() const {
  const bool cut = config.time.max_steps && step >= *config.time.max_steps;
  return stage + 1 < static_cast<int>(report.stages.size()) && !cut;
}

/// The last row and frame of a stage, and the next stage if there is one.
PetscErrorCode Simulation::Body::end_stage() {
  PetscFunctionBeginUser;
  PetscCall(write_last_output());
  const bool ended = stage_over || step >= schedule.last_step();
  const bool cut = config.time.max_steps && step >= *config.time.max_steps;
  if (outcome == Outcome::finished && ended && !cut)
    if (const std::string missed = missed_end(); !missed.empty()) PetscCall(fail(missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The run's time at its end [s], if each later stage takes the time it may take.
double Simulation::Body::end_of_run() const {
  double end = schedule.time_of(schedule.last_step());
  for (std::size_t k = stage + 1; k < report.stages.size(); ++k) end += report.stages[k].config.time.end;
  return end;
}

/// Ends the present stage, and sets up the next one from its state.
PetscErrorCode Simulation::Body::next_stage() {
  PetscFunctionBeginUser;
  SavedState state;
  std::vector<SectionSum> sections;
  HistoryRow row;  // before the soil changes
  PetscCall(stepper->sum_sections(&sections));
  if (config.output.energy) PetscCall(stepper->measure(0, &row));
  PetscCall(stepper->save(&state));
  PetscCall(bring_together(comm, &state));
  rigid_zero.resize(3 * config.rigids.size()), rigid_begin.resize(rigid_zero.size());
  for (std::size_t k = 0; k < rigid_zero.size(); ++k) {
    rigid_begin[k] = state.rigids[k / 3].displacement[k % 3];
    if (config.stage.reset) rigid_zero[k] = rigid_begin[k];
  }
  if (config.stage.reset) reset_state(config, state);
  if (config.stage.reset) PetscCall(reset_probes());
  const P2G strategy = config.p2g.strategy;  // as it was chosen
  const Config before = config;
  const std::vector<EffectiveOption> options = report.options;
  PetscCall(log.line(format_performance(performance())));
  stage_begin = {step, schedule.time_of(step)};
  stage_over = false;
  take_stage(stage + 1);
  config.p2g.strategy = strategy;
  PetscCall(choose_time_step());
  const std::vector<OptionChange> changes = changes_between(options, report.options);
  PetscCall(log.print("stage %s ends after step %ld at time %.9g s; stage %s begins%s",
                      before.stage.name.c_str(), step, stage_begin.time, config.stage.name.c_str(),
                      changes.empty() ? ", with the same options" : ""));
  for (const OptionChange& c : changes)
    PetscCall(log.line("changed here: " + c.name + " " + c.before + " -> " + c.after));
  Present present;
  PetscCall(change_bodies(state, &present));
  for (const int r : config.stage.place_rigids)  // their displacements begin with them
    for (int d = 0; d < 3; ++d) rigid_zero[3 * r + d] = rigid_begin[3 * r + d] = 0;
  apply_changes(changes, config, state);
  if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
  const std::vector<char> changed = changed_laws(before, config);
  const bool other_soil = changes_soil() || std::find(changed.begin(), changed.end(), 1) != changed.end() ||
                          !(before.water == config.water);
  PetscCall(set_up_stage(std::move(state), present, changed));
  if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
  if (changes_soil()) PetscCall(keep_sections(sections));
  if (!config.stage.place.empty()) PetscCall(follow_placed());
  if (config.output.energy && other_soil) PetscCall(stepper->keep_balance(row.energy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The surfaces of the loads that begin with the stage.
PetscErrorCode Simulation::Body::find_loads(SavedState& state) {
  PetscFunctionBeginUser;
  std::vector<LoadedSurface> surfaces;
  std::string fault;
  PetscCall(find_stage_faces(comm, config, &state, &surfaces, &fault));
  const std::vector<int> loads = loads_from_stage(config, config.stage.number);
  for (std::size_t n = 0; n < loads.size(); ++n)
    PetscCall(log.line(describe_surface(config, loads[n], surfaces[n])));
  if (!fault.empty()) PetscCall(fail(fault));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// A stepper for the options of the stage with a state.
PetscErrorCode Simulation::Body::set_up_stage(SavedState&& state, const Present& present,
                                              const std::vector<char>& changed) {
  PetscFunctionBeginUser;
  Model model;
  Failure failure;
  stepper.reset();  // before the next one takes memory
  PetscCall(load(&model));
  PetscCall(leave_out(&present, &model));
  stepper = make_stepper(config, comm);
  part = {.step = step, .stepping = stepping};
  if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(stepper->set_up(std::move(model), &failure));
  if (!failure.what.empty()) {
    PetscCall(fail(failure.what));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(adapt_state(changed, config.stage.place, state));
  if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(find_loads(state));
  if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
  bool rebuilt = false;
  PetscCall(stepper->restore(std::move(state), since_rebuild, &rebuilt));
  if (rebuilt) since_rebuild = 0;
  watching = false, waves_at = -1, waves = {.due = step}, told_dt = 0, looks = 0;
  notices.begin_stage();
  part.wall = wall();
  const bool other_laws = std::find(changed.begin(), changed.end(), 1) != changed.end();
  PetscCall(follow_stiffness(other_laws || !config.stage.place.empty()));
  PetscCall(log.print("time step %.9g s; stage %s goes on to %g s at most", dt, config.stage.name.c_str(),
                      config.time.end));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
