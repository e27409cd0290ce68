#pragma once
// State of a simulation while it runs. Its functions: simulation_start.cpp up to the first step (particles
// from files: simulation_from_file.cpp), simulation.cpp from there to the end.

#include <chrono>
#include <optional>

#include "checkpoint/changes.hpp"
#include "checkpoint/checkpoint.hpp"
#include "energy_watch.hpp"
#include "input/options.hpp"
#include "input/overlap.hpp"
#include "input/shapes.hpp"
#include "mpm/simulation.hpp"
#include "notices.hpp"
#include "output/folder_lock.hpp"
#include "output/frame_queue.hpp"
#include "output/history.hpp"
#include "output/log.hpp"
#include "output/performance.hpp"
#include "step/schedule.hpp"
#include "step/stepper.hpp"

namespace mpm {

/// Wall clock [s].
inline double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline constexpr double k_most_steps = 1e12;

/// Steps after which domains follow the soil where no rebuild came: an elastic wave crosses some 200 cells.
inline constexpr long k_domain_steps = 512;

struct Simulation::Body {
  MPI_Comm comm = MPI_COMM_NULL;
  Config config;
  InputReport report;
  Outcome outcome = Outcome::finished;
  bool ready = false;
  std::function<void()> on_first_step;

  FolderLock lock;  // of the output folder; goes when all is written and closed

  double dt = 0, last_dt = 0;  // s, of a whole step, and of the step before; 0: there is none
  bool follows = false;      // dt follows the stiffness of the soil and its domains, or is held against them
  bool laws_follow = false;  // the stiffness of some soil changes
  long waves_at = -1;        // step of the last computation of wave speeds
  WaveWatch waves;           // when the next one is due
  double told_dt = 0;        // s, the last one that the log has
  Schedule schedule;
  std::unique_ptr<Stepper> stepper;
  Log log;
  History history;
  FrameQueue frames;

  long step = 0;
  std::string partition_rows;                                       // of partition.csv
  double last_row_time = 0;                                         // s
  double wall_start = 0;                                            // s
  double bandwidth = 0;                                             // bytes/s of the device's copy
  double stepping = 0;                                              // s of wall time in steps and rebuilds
  long looks = 0;                                                   // at what the steps of a batch came to
  long since_rebuild = 0, rebuilds = 0, longest = 0, shortest = 0;  // steps between rebuilds

  double wall() const { return began.wall + seconds_now() - wall_start; }

  double born = seconds_now();        // s
  RunState began;                     // where this part of the run began
  std::optional<Checkpoint> restart;  // until it is on the device
  std::string restart_file, history_rows;
  std::vector<OptionChange> option_changes;  // that -restart_change allows
  std::vector<char> laws_changed;            // of each body, by them
  std::vector<std::string> passed_over;      // checkpoints that are damaged, as lines for the log
  std::string stopped_by;                    // signal or limit that stopped the run; empty if none did
  long checkpointed = -1;                    // step of the last checkpoint
  EnergyWatch energy;
  bool watching = false;    // energy has begun
  double step_seconds = 0;  // s of wall time of a step in the trial of a dry run
  Notices notices;

  ProbeState probes;
  Rasters rasters;

  int stage = 0;                                // index into report.stages
  Schedule::Begin stage_begin;                  // where it began
  bool stage_over = false;                      // the event that ends it has come
  EnergyRow last_energy{};                      // of the last row
  double last_unbalanced = 0;                   // -, of the last row
  RunState part;                                // where the present stepper began
  std::vector<double> rigid_zero, rigid_begin;  // m, 3 a rigid: displacements that the history counts from,
                                                // and those at which the stage began; empty: 0

  // simulation_stages.cpp
  void take_stage(int number);
  PetscErrorCode check_stages();
  PetscErrorCode take_restart_stage();
  Config history_config() const;
  void look_for_end(const HistoryRow& row);
  std::string missed_end() const;
  bool has_next_stage() const;
  double end_of_run() const;
  PetscErrorCode end_stage();
  PetscErrorCode next_stage();
  PetscErrorCode find_loads(SavedState& state);
  PetscErrorCode set_up_stage(SavedState&& state, const Present& present, const std::vector<char>& changed);

  // simulation_stage_bodies.cpp
  bool changes_soil() const;
  PetscErrorCode check_placed();
  PetscErrorCode look_at_present(const SavedState& state, Present* present);
  PetscErrorCode change_bodies(SavedState& state, Present* present);
  PetscErrorCode cut_present(SavedState& state);
  PetscErrorCode leave_out(const Present* present, Model* model);
  PetscErrorCode adapt_state(const std::vector<char>& changed, const std::vector<int>& placed,
                             SavedState& state);

  // simulation_probes.cpp
  PetscErrorCode begin_probes();
  PetscErrorCode update_rasters();
  PetscErrorCode write_rasters();
  std::string probes_fault() const;
  PetscErrorCode reset_probes();
  PetscErrorCode follow_placed();
  PetscErrorCode keep_sections(const std::vector<SectionSum>& before);

  // simulation_files.cpp
  void check_files();
  PetscErrorCode lock_folder();

  PetscErrorCode check_mesh_run();
  PetscErrorCode check_device();
  void check_build();
  void check_mesh();
  PetscErrorCode check_places();
  PetscErrorCode begin();
  PetscErrorCode start();
  PetscErrorCode load(Model* model);
  PetscErrorCode load_shape(const std::string& name, const Shape& shape, const std::vector<Shape>& cut_out,
                            LatticePart part, BodyParticles* particles);
  PetscErrorCode take_field(const BodyConfig& body, BodyParticles* particles);
  PetscErrorCode take_level_ground(const BodyConfig& body, Model* model, BodyParticles* particles);
  PetscErrorCode load_file(const BodyConfig& body, BodyParticles* particles, bool* from_run);
  PetscErrorCode choose_strategy(const Model& model, const std::string& device);
  PetscErrorCode log_shape(const std::string& name, const Lattice& lattice, bool in_parts);
  PetscErrorCode log_cuts(const std::string& name, const Shape& shape);
  PetscErrorCode fail(const std::string& what);
  PetscErrorCode run_stage();
  PetscErrorCode advance_to(long target);
  PetscErrorCode rebuild(const Batch& batch);
  bool domains_follow() const;
  bool domains_changed() const;  // at this step, by a rebuild or by follow_soil
  PetscErrorCode follow_soil();
  PetscErrorCode write_row();
  PetscErrorCode watch(const HistoryRow& row);
  PetscErrorCode write_frame();
  PetscErrorCode write_last_output();
  PetscErrorCode write_partition();
  Performance performance() const;
  PetscErrorCode report_performance();
  PetscErrorCode share_errors();
  PetscErrorCode finish();

  // simulation_time_step.cpp
  PetscErrorCode choose_time_step();
  PetscErrorCode tell_damped_step();
  PetscErrorCode follow_stiffness(bool now = false);
  PetscErrorCode look_ahead(double* speed);
  PetscErrorCode wave_within(double seconds, double closing, double* speed);
  long next_stiffness_check() const;  // the step at which follow_stiffness has something to do

  // simulation_element.cpp
  bool is_element() const { return !config.element.file.empty(); }
  PetscErrorCode run_element();
  PetscErrorCode open_element();
  PetscErrorCode drive_element(std::string* failure);

  // simulation_dry_run.cpp
  PetscErrorCode dry_run();
  PetscErrorCode tell_need();
  PetscErrorCode tell_stages();
  PetscErrorCode time_steps(double* seconds);

  // simulation_checkpoint.cpp
  std::vector<std::string> restart_files() const;
  PetscErrorCode read_restart();
  PetscErrorCode check_restart();
  bool history_agrees() const;
  void find_history();
  void keep_strategy();
  PetscErrorCode resume();
  Checkpoint description() const;
  PetscErrorCode write_checkpoint();
  PetscErrorCode forget_later();
  PetscErrorCode look_for_stop(bool* stop);
  PetscErrorCode stop();
  int ranks() const;
};

}  // namespace mpm
