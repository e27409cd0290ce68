// From the options to the first step.

#include <cmath>
#include <cstdio>

#include "input/particle_file.hpp"
#include "input/text.hpp"
#include "memory_need.hpp"
#include "mesh/background.hpp"
#include "output/files.hpp"
#include "output/remembered.hpp"
#include "output/run_options.hpp"
#include "parallel/distribute.hpp"
#include "parallel/together.hpp"
#include "simulation_body.hpp"

namespace mpm {
namespace {

constexpr double k_most_steps = 1e12;

}  // namespace

Simulation::Simulation() : body_(std::make_unique<Body>()) {}
Simulation::~Simulation() = default;
bool Simulation::ready() const { return body_->ready; }
Outcome Simulation::outcome() const { return body_->outcome; }

PetscErrorCode Simulation::set_from_options(MPI_Comm comm, const char* prefix, const InputReport& arguments) {
  PetscFunctionBeginUser;
  Body& b = *body_;
  b.comm = comm;
  b.report = arguments;
  PetscCall(read_options(prefix, available_backends(), b.config, b.report));
  if (b.report.help) {
    PetscCall(print_help(comm, b.report));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (b.report.errors.empty()) b.check_mesh();
  if (b.report.errors.empty()) PetscCall(b.choose_time_step());
  if (b.report.errors.empty())
    if (const std::string fault = memory_fault(b.config, comm); !fault.empty())
      b.report.errors.push_back(fault);
  if (size_of(comm) > 1 && b.config.output.compression > 0)
    b.report.errors.push_back(
        formatted("mpm: -output_compression: given \"%d\", takes 0 on several ranks, which write their parts "
                  "of a frame as they are",
                  b.config.output.compression));
  if (b.report.errors.empty() && !b.config.output.restart.empty()) PetscCall(b.read_restart());
  PetscCall(b.share_errors());
  if (!b.report.errors.empty()) {
    PetscCall(print_errors(comm, b.report));
    b.outcome = Outcome::bad_input;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  b.ready = true;
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode Simulation::Body::start() {
  PetscFunctionBeginUser;
  PetscCall(begin());
  const bool first = rank_of(comm) == 0;
  int removed = 0;
  if (restart)
    PetscCall(agree(comm, first ? make_folder(config.output.directory) : PETSC_SUCCESS));
  else
    PetscCall(agree(comm, first ? prepare_output_folder(config.output.directory, &removed) : PETSC_SUCCESS));
  PetscCall(agree(comm, log.open(config.output.directory, restart.has_value())));
  if (removed > 0)
    PetscCall(log.print("%d files of an earlier run were removed from %s", removed,
                        config.output.directory.c_str()));
  PetscCall(log.line("options in force\n" + format_options(report.options)));
  PetscCall(agree(
      comm, first ? write_options_json(config.output.directory, k_version, report.options) : PETSC_SUCCESS));

  const Backend backend = config.backend;
  const std::string processor = backend == Backend::cuda ? "" : processor_name();
  const std::string device =
      formatted("%s, %s %s", word_of(backend), device_name(backend).c_str(), processor.c_str());
  if (first) bandwidth = remembered("copy_bandwidth", device, [&] { return copy_bandwidth(backend); });
  Model model;
  Failure failure;
  PetscCall(load(&model));
  if (restart) keep_strategy();
  if (config.p2g.strategy == P2G::automatic) PetscCall(choose_strategy(model, device));
  stepper = make_stepper(config, comm);
  PetscCall(stepper->set_up(std::move(model), &failure));
  if (!failure.what.empty()) {
    PetscCall(fail(failure.what));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(log.print("%ld particles in %d patches, %.1f MB on the device%s; strategy %s",
                      stepper->particles(), stepper->patches(), stepper->memory() / 1e6,
                      ranks() > 1 ? "s" : "", stepper->strategy().c_str()));
  if (const std::string report = stepper->ranks_report(); !report.empty()) PetscCall(log.line(report));
  if (const std::string report = stepper->batches_report(); !report.empty()) PetscCall(log.line(report));
  PetscCall(log.print("time step %.9g s, Courant number %.4f; %ld steps to %g s", dt,
                      dt / critical_time_step(config), schedule.last_step(),
                      schedule.time_of(schedule.last_step())));
  if (restart) {
    PetscCall(resume());
    wall_start = seconds_now();
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(agree(comm, first ? history.open(config) : PETSC_SUCCESS));
  frames.open(config.output.directory, config.precision, {config.output.fields, config.output.compression},
              comm);
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
  model->patches = mesh.patches_with_ring();
  for (const auto& body : config.bodies) {
    const bool listed = body.shape.kind == ShapeKind::particles;
    BodyParticles& particles = model->bodies.emplace_back();
    PetscCall(listed ? load_file(body, &particles)
                     : load_shape("body " + body.name, body.shape, cut_out_of(config, body),
                                  {rank_of(comm), ranks()}, &particles));
  }
  for (const auto& rigid : config.rigids)
    PetscCall(load_shape("rigid " + rigid.name, rigid.shape, {}, {}, &model->rigids.emplace_back()));
  for (auto* all : {&model->bodies, &model->rigids})
    for (BodyParticles& particles : *all)
      for (std::size_t k = 0; k < particles.position.size(); ++k)
        particles.position[k] -= config.mesh.lower[k % config.dim];
  PetscCall(distribute(comm, config, mesh, model));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Particles of a shape's lattice, or this rank's part of them. Their positions are absolute, as in a file.
PetscErrorCode Simulation::Body::load_shape(const std::string& name, const Shape& shape,
                                            const std::vector<Shape>& cut_out, LatticePart part,
                                            BodyParticles* particles) {
  PetscFunctionBeginUser;
  Lattice lattice;
  PetscCall(fill(shape, config.mesh, config.dim, lattice, cut_out, part));
  PetscCall(log_shape(name, lattice, part.of > 1));
  particles->position = std::move(lattice.position);
  particles->spacing = lattice.spacing;
  particles->particle_volume = lattice.particle_volume;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Particles that a file lists, read again after they were checked with the options.
PetscErrorCode Simulation::Body::load_file(const BodyConfig& body, BodyParticles* particles) {
  PetscFunctionBeginUser;
  ParticleTable table;
  std::string fault;
  PetscCallCXX(fault = read_particles(body.shape.file, body.name, config.mesh, config.dim, table));
  PetscCheck(fault.empty(), comm, PETSC_ERR_FILE_READ, "%s has changed: it should be %s",
             body.shape.file.c_str(), fault.c_str());
  const long count = static_cast<long>(table.position.size()) / config.dim;
  PetscCall(log.print("body %s: %ld particles of %s stand for %.6g %s", body.name.c_str(), count,
                      body.shape.file.c_str(), count * table.particle_volume, config.dim == 2 ? "m2" : "m3"));
  particles->position = std::move(table.position);
  particles->spacing = config.mesh.spacing / body.shape.particles_per_cell;
  particles->particle_volume = table.particle_volume;
  particles->velocity = std::move(table.velocity);
  particles->stress = std::move(table.stress);
  particles->plastic_strain = std::move(table.plastic_strain);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// in_parts: each rank has a part of the lattice.
PetscErrorCode Simulation::Body::log_shape(const std::string& name, const Lattice& lattice, bool in_parts) {
  PetscFunctionBeginUser;
  long counts[2] = {static_cast<long>(lattice.position.size()) / config.dim, lattice.cut_out};
  if (in_parts) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_LONG, MPI_SUM, comm));
  const auto [count, cut_out] = counts;
  const char* unit = config.dim == 2 ? "m2" : "m3";
  PetscCall(log.print("%s: %ld particles stand for %.6g %s, the shape has %.6g %s", name.c_str(), count,
                      count * lattice.particle_volume, unit, lattice.shape_volume, unit));
  if (cut_out > 0)
    PetscCall(log.print("%s: %ld particles, %.6g %s, were cut out", name.c_str(), cut_out,
                        cut_out * lattice.particle_volume, unit));
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
