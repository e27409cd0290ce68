#include "mpm/simulation.hpp"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "input/options.hpp"
#include "input/shapes.hpp"
#include "mesh/background.hpp"
#include "output/files.hpp"
#include "output/frames.hpp"
#include "output/history.hpp"
#include "output/log.hpp"
#include "output/run_options.hpp"
#include "step/schedule.hpp"
#include "step/stepper.hpp"

namespace mpm {
namespace {

constexpr double k_most_steps = 1e12;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

struct Simulation::Body {
  MPI_Comm comm = MPI_COMM_NULL;
  Config config;
  InputReport report;
  Outcome outcome = Outcome::finished;
  bool ready = false;

  double dt = 0;  // s
  Schedule schedule;
  std::unique_ptr<Stepper> stepper;
  Log log;
  History history;
  Frames frames;

  long step = 0;
  double last_row_time = 0;                                         // s
  double wall_start = 0;                                            // s
  double stepping = 0;                                              // s of wall time in steps and rebuilds
  long since_rebuild = 0, rebuilds = 0, longest = 0, shortest = 0;  // steps between rebuilds

  double wall() const { return seconds_now() - wall_start; }

  void check_mesh();
  PetscErrorCode choose_time_step();
  PetscErrorCode start();
  PetscErrorCode load(Model* model);
  PetscErrorCode log_shape(const std::string& name, const Lattice& lattice);
  PetscErrorCode fail(const std::string& what);
  PetscErrorCode advance_to(long target);
  PetscErrorCode rebuild(const Batch& batch);
  PetscErrorCode write_row();
  PetscErrorCode write_frame();
  PetscErrorCode finish();
};

Simulation::Simulation() : body_(std::make_unique<Body>()) {}
Simulation::~Simulation() = default;
bool Simulation::ready() const { return body_->ready; }
Outcome Simulation::outcome() const { return body_->outcome; }

PetscErrorCode Simulation::set_from_options(MPI_Comm comm, const char* prefix, const InputReport& arguments) {
  PetscFunctionBeginUser;
  Body& b = *body_;
  b.comm = comm;
  b.report = arguments;
  PetscMPIInt ranks = 1;
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(read_options(prefix, available_backends(), b.config, b.report));
  if (b.report.help) {
    PetscCall(print_help(comm, b.report));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (ranks > 1)
    b.report.errors = {"mpm: started with " + std::to_string(ranks) +
                       " ranks, takes 1: runs over several ranks are not there yet"};
  if (b.report.errors.empty()) b.check_mesh();
  if (b.report.errors.empty()) PetscCall(b.choose_time_step());
  if (!b.report.errors.empty()) {
    PetscCall(print_errors(comm, b.report));
    b.outcome = Outcome::bad_input;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  b.ready = true;
  PetscFunctionReturn(PETSC_SUCCESS);
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

/// The step from the Courant number (Eq. 14), or the user's where it is stable.
PetscErrorCode Simulation::Body::choose_time_step() {
  PetscFunctionBeginUser;
  const double critical = critical_time_step(config);
  dt = config.time.step.value_or(config.time.courant * critical);
  if (dt > k_largest_courant * critical) {
    char line[200];
    std::snprintf(
        line, sizeof line,
        "mpm: -time_step: given \"%g\", takes a time in s of at most %.6g, above which the step is unstable",
        dt, k_largest_courant * critical);
    report.errors.push_back(line);
  }
  if (config.time.end / dt > k_most_steps) {
    char line[200];
    std::snprintf(line, sizeof line,
                  "mpm: -time_end: given \"%g\", takes at most %g s with time steps of %g s (1e12 steps)",
                  config.time.end, k_most_steps * dt, dt);
    report.errors.push_back(line);
  } else {
    schedule = Schedule(config.time, config.output, dt);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::run() {
  PetscFunctionBeginUser;
  Body& b = *body_;
  PetscCall(b.start());
  while (b.outcome == Outcome::finished && b.step < b.schedule.last_step()) {
    PetscCall(b.advance_to(b.schedule.next_stop(b.step)));
    if (b.outcome != Outcome::finished) break;
    if (b.schedule.row_due(b.step)) PetscCall(b.write_row());
    if (b.schedule.frame_due(b.step)) PetscCall(b.write_frame());
  }
  PetscCall(b.finish());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::start() {
  PetscFunctionBeginUser;
  stepper = make_stepper(config);
  PetscCheck(stepper, comm, PETSC_ERR_SUP,
             "This program was built without this backend, precision or dimension");
  PetscCall(log.start(comm, config.output.progress));
  int removed = 0;
  PetscCall(prepare_output_folder(config.output.directory, &removed));
  PetscCall(
      log.line(format_header(k_version, kokkos_version(),
                             std::string(word_of(config.backend)) + ", " + device_name(config.backend), 1)));
  PetscCall(log.open(config.output.directory));
  if (removed > 0)
    PetscCall(log.print("%d files of an earlier run were removed from %s", removed,
                        config.output.directory.c_str()));
  PetscCall(log.line("options in force\n" + format_options(report.options)));
  PetscCall(write_options_json(config.output.directory, k_version, report.options));

  Model model;
  Failure failure;
  PetscCall(load(&model));
  PetscCall(stepper->set_up(std::move(model), &failure));
  if (!failure.what.empty()) {
    PetscCall(fail(failure.what));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(log.print("%ld particles in %d patches, %.1f MB on the device; strategy %s", stepper->particles(),
                      stepper->patches(), stepper->memory() / 1e6, stepper->strategy().c_str()));
  PetscCall(log.print("time step %.9g s, Courant number %.4f; %ld steps to %g s", dt,
                      dt / critical_time_step(config), schedule.last_step(),
                      schedule.time_of(schedule.last_step())));
  PetscCall(history.open(config));
  frames.open(config.output.directory, config.precision);
  wall_start = seconds_now();
  PetscCall(write_row());
  PetscCall(write_frame());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Mesh and particles.
PetscErrorCode Simulation::Body::load(Model* model) {
  PetscFunctionBeginUser;
  BackgroundMesh mesh;
  PetscCall(mesh.create(comm, config.mesh, config.dim));
  PetscCall(mesh.patches_with_ring(model->patches));
  const auto add = [&](const std::string& name, const Shape& shape,
                       std::vector<BodyParticles>& into) -> PetscErrorCode {
    PetscFunctionBeginUser;
    Lattice lattice;
    PetscCall(fill(shape, config.mesh, config.dim, lattice));
    PetscCall(log_shape(name, lattice));
    for (std::size_t k = 0; k < lattice.position.size(); ++k)
      lattice.position[k] -= config.mesh.lower[k % config.dim];
    into.push_back({std::move(lattice.position), lattice.spacing, lattice.particle_volume});
    PetscFunctionReturn(PETSC_SUCCESS);
  };
  for (const auto& body : config.bodies) PetscCall(add("body " + body.name, body.shape, model->bodies));
  for (const auto& rigid : config.rigids) PetscCall(add("rigid " + rigid.name, rigid.shape, model->rigids));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::log_shape(const std::string& name, const Lattice& lattice) {
  PetscFunctionBeginUser;
  const long count = static_cast<long>(lattice.position.size()) / config.dim;
  const char* unit = config.dim == 2 ? "m2" : "m3";
  PetscCall(log.print("%s: %ld particles stand for %.6g %s, the shape has %.6g %s", name.c_str(), count,
                      count * lattice.particle_volume, unit, lattice.shape_volume, unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::fail(const std::string& what) {
  PetscFunctionBeginUser;
  outcome = Outcome::failed;
  char place[80];
  std::snprintf(place, sizeof place, "mpm: step %ld, time %.9g s: ", step, schedule.time_of(step));
  PetscCall(log.error(place + what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Steps up to `target`, in batches that end where the movement bound will probably ask for a rebuild.
PetscErrorCode Simulation::Body::advance_to(long target) {
  PetscFunctionBeginUser;
  constexpr double k_look_every = 0.5;  // s of wall time between two looks at the steps
  long estimate = 1, batch_limit = 16;
  while (step < target) {
    long steps = std::min({target - step, std::max(estimate, 1L), batch_limit});
    if (config.p2g.rebuild_interval) steps = std::min(steps, *config.p2g.rebuild_interval - since_rebuild);
    const double step_dt = schedule.step_size(step);
    if (step_dt == dt)
      steps = std::min(steps, std::max(schedule.last_whole_step() - step, 1L));
    else
      steps = 1;
    Batch batch;
    const double before = seconds_now();
    PetscCall(stepper->advance(steps, step_dt, &batch));
    const double took = seconds_now() - before;
    stepping += took;
    batch_limit = std::max(16L, static_cast<long>(k_look_every * batch.steps / std::max(took, 1e-9)));
    estimate = batch.estimate;
    step += batch.steps;
    since_rebuild += batch.steps;
    if (!batch.failure.what.empty()) {
      PetscCall(fail(batch.failure.what));
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    if (batch.rebuild || (config.p2g.rebuild_interval && since_rebuild >= *config.p2g.rebuild_interval))
      PetscCall(rebuild(batch));
    if (outcome != Outcome::finished) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(log.progress({step, schedule.time_of(step), 0, schedule.time_of(schedule.last_step()), stepping,
                            double(step) * stepper->particles()}));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::rebuild(const Batch& batch) {
  PetscFunctionBeginUser;
  const std::optional<int>& forced = config.p2g.rebuild_interval;
  if (forced && batch.rebuild && since_rebuild < *forced) {
    char what[300];
    std::snprintf(what, sizeof what,
                  "-p2g_rebuild_interval %d is unsafe: after %ld steps a particle can have moved %.3g cells, "
                  "and the lists hold for "
                  "%.3g (-p2g_margin)",
                  *forced, since_rebuild, batch.bound, config.p2g.margin);
    PetscCall(fail(what));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  shortest = rebuilds == 0 ? since_rebuild : std::min(shortest, since_rebuild);
  longest = std::max(longest, since_rebuild);
  ++rebuilds;
  since_rebuild = 0;
  Failure failure;
  const double before = seconds_now();
  PetscCall(stepper->rebuild(&failure));
  stepping += seconds_now() - before;
  if (!failure.what.empty()) PetscCall(fail(failure.what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::write_row() {
  PetscFunctionBeginUser;
  HistoryRow row;
  row.step = step;
  row.time = schedule.time_of(step);
  row.dt = step > 0 ? schedule.step_size(step - 1) : dt;
  row.wall_time = wall();
  stepper->measure(row.time - last_row_time, &row);
  last_row_time = row.time;
  PetscCall(history.write(row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::write_frame() {
  PetscFunctionBeginUser;
  Snapshot snapshot;
  stepper->snapshot(&snapshot);
  snapshot.step = step;
  snapshot.time = schedule.time_of(step);
  PetscCall(frames.write(snapshot));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::finish() {
  PetscFunctionBeginUser;
  PetscCall(history.close());
  if (step > 0) {
    if (rebuilds > 0)
      PetscCall(log.print("bins and lists were rebuilt %ld times, after %ld to %ld steps, %.1f on average",
                          rebuilds, shortest, longest, double(step - since_rebuild) / rebuilds));
    PetscCall(log.line("time of the functions\n" + format_times(stepper->times(), wall(), 0, 0)));
    PetscCall(log.print("%.4g us a step without output; %s particle updates", 1e6 * stepping / step,
                        format_rate(double(step) * stepper->particles() / stepping).c_str()));
  }
  PetscCall(log.print("%s after %ld steps at time %g s; results are in %s",
                      outcome == Outcome::finished ? "finished" : "failed", step, schedule.time_of(step),
                      config.output.directory.c_str()));
  PetscCall(log.close());
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::unique_ptr<InputReport, void (*)(InputReport*)> prepare_arguments(MPI_Comm comm, int* argc,
                                                                       char** argv) {
  auto report =
      std::unique_ptr<InputReport, void (*)(InputReport*)>(new InputReport, [](InputReport* r) { delete r; });
  prepare_arguments(comm, argc, argv, *report);
  return report;
}

}  // namespace mpm
