#pragma once
// A run of the material point method, from the checks before it to its end. Run owns what a run is made of
// and calls it in turn: Clock (the step, the time and the stage), TimeStep (how long a step is), Effort (what
// the steps have taken), a Stepper for each stage, Outputs (results), Restarts (checkpoints). None of these
// holds another; each is given what it needs. Stages are functions of job, clock and saved state
// (stages.hpp, stage_bodies.hpp).

#include <functional>

#include "run/effort.hpp"
#include "run/outputs.hpp"
#include "run/restarts.hpp"
#include "run/stage_bodies.hpp"

namespace mpm {

class Run {
 public:
  explicit Run(Job& job) : job_(job) {}

  /// Checks the options against the machine, the folder and the checkpoint to go on from; mistakes become
  /// lines of the report.
  PetscErrorCode check();
  /// Runs to the end, or makes the trial of a dry run. `on_first_step` is called when all is set up.
  PetscErrorCode execute(const std::function<void()>& on_first_step);

 private:
  // start.cpp
  PetscErrorCode start();
  PetscErrorCode first_set_up();
  PetscErrorCode set_up(Model&& model);
  PetscErrorCode resume();
  PetscErrorCode next_stage();
  PetscErrorCode enter_stage(SavedState&& state, const Present& present, NewBodies&& bodies);

  // run.cpp
  PetscErrorCode run_stage();
  PetscErrorCode advance_to(long target);
  long batch_steps(long target, long wanted) const;
  PetscErrorCode take_steps(long count, Batch* batch);
  PetscErrorCode prepare_steps(const Batch& batch);
  PetscErrorCode rebuild(const Batch& batch);
  bool domains_changed() const;
  PetscErrorCode write_row();
  PetscErrorCode end_stage();
  PetscErrorCode write_checkpoint();
  PetscErrorCode stop();
  PetscErrorCode finish();

  Job& job_;
  Clock clock_;
  TimeStep time_step_;
  Effort effort_;
  std::unique_ptr<Stepper> stepper_;
  Outputs outputs_;
  Restarts restarts_;
  std::string stopped_by_;             // signal or limit that stopped the run; empty if none did
  const double born_ = seconds_now();  // s
};

}  // namespace mpm
