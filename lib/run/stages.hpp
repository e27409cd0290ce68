#pragma once
// Stages of a run: which one holds, when it ends, and the state with which the next one begins.

#include "run/changes.hpp"
#include "run/clock.hpp"
#include "run/time_step.hpp"

namespace mpm {

/// Checks that the machine and the program allow a run of this mesh, and chooses its time step.
PetscErrorCode check_mesh_run(Job& job, TimeStep& time_step, Clock& clock);
/// Checks each stage as a run of its own; the first is the one at hand then.
PetscErrorCode check_stages(Job& job, TimeStep& time_step, Clock& clock);

/// Gives the job the options of the clock's stage.
void take_stage(Job& job, const Clock& clock);
/// Config of the history's columns, which are the same in all stages: those of a side that some stage holds.
Config history_config(const Job& job);

/// Whether the event that ends the stage has come, by a row of the history.
bool is_over(const Config& config, const Clock& clock, const HistoryRow& row);
/// Why the stage has not ended as it should, for a failure; empty if it has.
std::string missed_end(const Config& config, const Clock& clock, const HistoryRow& last);
/// Whether the run ends here by -time_max_steps.
bool is_cut(const Config& config, const Clock& clock);
/// Whether another stage follows once this one has ended.
bool has_next_stage(const Job& job, const Clock& clock);
/// The run's time at its end [s], if each later stage takes the time it may take.
double end_of_run(const Job& job, const Clock& clock);

/// Ends the stage: the rigids' displacements count from here, and -STAGE_reset sets the soil to rest.
void leave_stage(const Config& config, SavedState& state, StageState& stage);
/// Makes the next stage the present one, and prints the options that it changes. `before`: the options of the
/// former one.
PetscErrorCode begin_stage(Job& job, TimeStep& time_step, Clock& clock, Config* before,
                           std::vector<OptionChange>* changes);

}  // namespace mpm
