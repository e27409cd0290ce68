#include "run/stages.hpp"

#include <algorithm>
#include <cmath>

#include "check/machine.hpp"
#include "check/memory_need.hpp"
#include "check/warnings.hpp"
#include "common/text.hpp"

namespace mpm {
namespace {

constexpr double k_energy_share = 0.01;  // of the unbalanced ratio: largest kinetic energy over m g h

/// Soil at rest that has never moved: velocities and plastic strains become zero.
void reset_state(const Config& config, SavedState& state) {
  for (SavedField& field : state.soil.fields)
    for (const char* name : {"velocity", "affine", "plastic_strain", "darcy_flux"})
      if (field.name == name) std::fill(field.values.begin(), field.values.end(), 0.0);
  for (std::size_t r = 0; r < state.rigids.size(); ++r)
    if (config.rigids[r].motion == Motion::dynamic)
      for (const int vector : {MotionTerms::velocity, MotionTerms::momentum, MotionTerms::spin})
        set_vector(state.rigids[r], vector, {});
}

double length_of(const Vec3& x) { return std::hypot(x[0], x[1], x[2]); }

}  // namespace

PetscErrorCode check_mesh_run(Job& job, TimeStep& time_step, Clock& clock) {
  PetscFunctionBeginUser;
  std::vector<std::string>& errors = job.report.errors;
  if (errors.empty()) PetscCall(check_machine(job.comm, job.config, job.report));
  if (errors.empty()) PetscCall(time_step.choose(job, clock));
  if (errors.empty())
    if (const std::string fault = memory_fault(job.config, job.comm); !fault.empty()) errors.push_back(fault);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode check_stages(Job& job, TimeStep& time_step, Clock& clock) {
  PetscFunctionBeginUser;
  InputReport& report = job.report;
  for (StageInput& input : report.stages) {
    job.config = input.config;
    PetscCall(check_mesh_run(job, time_step, clock));
    input.config.backend = job.config.backend;
    if (report.errors.empty())
      for (const std::string& warning : warnings_of(job.config, job.ranks()))
        if (std::find(report.warnings.begin(), report.warnings.end(), warning) == report.warnings.end())
          report.warnings.push_back(warning);
  }
  take_stage(job, clock);
  if (report.errors.empty()) PetscCall(time_step.choose(job, clock));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void take_stage(Job& job, const Clock& clock) {
  const StageInput& input = job.report.stages[clock.stage.index];
  job.config = input.config;
  job.report.options = input.options;
  job.config.time.start = clock.stage.time;
  job.config.time.end += clock.stage.time;
}

Config history_config(const Job& job) {
  Config all = job.config;
  for (const StageInput& input : job.report.stages) {
    const Config& stage = input.config;
    for (int d = 0; d < 3; ++d)
      for (int side = 0; side < 2; ++side)
        if (!is_open(stage.mesh.walls[d][side])) all.mesh.walls[d][side] = Wall::roller;
    for (std::size_t r = 0; r < stage.rigids.size(); ++r) {
      const RigidConfig& rigid = stage.rigids[r];
      if (rigid.motion == Motion::dynamic) all.rigids[r].motion = Motion::dynamic;
      if (rigid.is_sprung())
        all.rigids[r].stiffness = rigid.stiffness, all.rigids[r].viscosity = rigid.viscosity;
    }
  }
  return all;
}

bool is_over(const Config& config, const Clock& clock, const HistoryRow& row) {
  const StageConfig& ends = config.stage;
  const StageState& stage = clock.stage;
  if (clock.step == stage.step || ends.end == StageEnd::time) return stage.over != 0;
  if (ends.end == StageEnd::displacement) {
    Vec3 moved = row.rigids[ends.end_rigid].displacement;
    for (std::size_t d = 0; d < 3 && !stage.rigid_begin.empty(); ++d) {
      const std::size_t k = 3 * static_cast<std::size_t>(ends.end_rigid) + d;
      moved[d] += stage.rigid_zero[k] - stage.rigid_begin[k];
    }
    return length_of(moved) >= ends.end_displacement;
  }
  double energy = 0, mass = 0;
  for (const BodyRow& body : row.bodies) energy += body.kinetic_energy, mass += body.mass;
  const double scale = mass * length_of(config.gravity) * config.mesh.spacing;
  return row.unbalanced_ratio < ends.unbalanced_ratio &&
         energy < k_energy_share * ends.unbalanced_ratio * scale;
}

std::string missed_end(const Config& config, const Clock& clock, const HistoryRow& last) {
  const StageConfig& ends = config.stage;
  if (ends.end == StageEnd::time || clock.stage.over) return "";
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
      ends.name.c_str(), time, ends.name.c_str(), last.unbalanced_ratio, ends.unbalanced_ratio);
}

bool is_cut(const Config& config, const Clock& clock) {
  return config.time.max_steps && clock.step >= *config.time.max_steps;
}

bool has_next_stage(const Job& job, const Clock& clock) {
  return clock.stage.index + 1 < static_cast<long>(job.report.stages.size()) && !is_cut(job.config, clock);
}

double end_of_run(const Job& job, const Clock& clock) {
  double end = clock.schedule.time_of(clock.schedule.last_step());
  for (std::size_t k = clock.stage.index + 1; k < job.report.stages.size(); ++k)
    end += job.report.stages[k].config.time.end;
  return end;
}

void leave_stage(const Config& config, SavedState& state, StageState& stage) {
  stage.rigid_zero.resize(3 * config.rigids.size()), stage.rigid_begin.resize(stage.rigid_zero.size());
  for (std::size_t k = 0; k < stage.rigid_zero.size(); ++k) {
    stage.rigid_begin[k] = state.rigids[k / 3][MotionTerms::displacement + k % 3];
    if (config.stage.reset) stage.rigid_zero[k] = stage.rigid_begin[k];
  }
  if (config.stage.reset) reset_state(config, state);
}

PetscErrorCode begin_stage(Job& job, TimeStep& time_step, Clock& clock, Config* before,
                           std::vector<OptionChange>* changes) {
  PetscFunctionBeginUser;
  *before = job.config;
  const std::vector<EffectiveOption> options = job.report.options;
  StageState& stage = clock.stage;
  ++stage.index, stage.step = clock.step, stage.time = clock.time(), stage.over = 0;
  take_stage(job, clock);
  job.config.p2g.strategy = before->p2g.strategy;  // as it was chosen
  PetscCall(time_step.choose(job, clock));
  *changes = changes_between(options, job.report.options);
  PetscCall(job.log.print("stage %s ends after step %ld at time %.9g s; stage %s begins%s",
                          before->stage.name.c_str(), clock.step, stage.time, job.config.stage.name.c_str(),
                          changes->empty() ? ", with the same options" : ""));
  for (const OptionChange& c : *changes) PetscCall(job.log.line(line_of(c)));
  for (const int r : job.config.stage.place_rigids)  // their displacements begin with them
    for (int d = 0; d < 3; ++d) stage.rigid_zero[3 * r + d] = stage.rigid_begin[3 * r + d] = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
