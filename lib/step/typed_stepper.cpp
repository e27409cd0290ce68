#include "step/typed_stepper.hpp"
#include "parallel/gather.hpp"
#include "step/surface_input.hpp"
#include "step/traffic.hpp"

#include <algorithm>
#include <cstdio>

namespace mpm {
namespace {

constexpr long k_sample_every = 50;  // steps between two timed ones on a device

/// Absolute height of a particle [m]: the last direction is the vertical one.
template <int Dim>
double height_of(const std::vector<double>& position, std::size_t p, const MeshConfig& mesh) {
  return position[p * Dim + Dim - 1] + mesh.lower[Dim - 1];
}

template <int Dim>
BodyInput body_input(const Config& config, const BodyConfig& body, BodyParticles&& particles) {
  const MaterialConfig& material = config.materials[body.material];
  const AnyMaterial<double> law = make_material<double>(model_index(material.model), material.parameters);
  BodyInput in;
  in.position = std::move(particles.position);
  in.strength.resize(in.position.size() / Dim);
  for (std::size_t p = 0; p < in.strength.size(); ++p)
    in.strength[p] = strength_at(law, height_of<Dim>(in.position, p, config.mesh));
  in.particle_volume = particles.particle_volume;
  in.half_length = particles.spacing / config.mesh.spacing / 2;
  in.density = material.density;
  in.velocity = body.velocity;
  in.particle_velocity = std::move(particles.velocity);
  in.plastic_strain = std::move(particles.plastic_strain);
  in.stress = std::move(particles.stress);
  if (in.stress.empty() && body.stress != Sym6{})
    for (std::size_t p = 0; p < in.strength.size(); ++p)
      in.stress.insert(in.stress.end(), body.stress.begin(), body.stress.begin() + sym_size<Dim>);
  in.material = body.material;
  in.id = std::move(particles.id);
  in.velocity_gradient = std::move(particles.velocity_gradient);
  return in;
}

/// Vectors with three components, positions from the origin.
template <int Dim>
ParticleSnapshot node_snapshot(NodeFields&& nodes, const Vec3& lower) {
  ParticleSnapshot out;
  out.name = k_nodes;
  out.position.assign(3 * nodes.mass.size(), 0);
  out.velocity = out.position;
  for (std::size_t n = 0; n < nodes.mass.size(); ++n)
    for (int d = 0; d < Dim; ++d) {
      out.position[3 * n + d] = nodes.position[n * Dim + d] + lower[d];
      out.velocity[3 * n + d] = nodes.velocity[n * Dim + d];
    }
  out.mass = std::move(nodes.mass), out.number = std::move(nodes.number);
  return out;
}

RigidInput rigid_input(const Config& config, const RigidConfig& rigid, BodyParticles&& particles) {
  RigidInput in;
  in.position = std::move(particles.position);
  in.particle_volume = particles.particle_volume;
  in.half_length = particles.spacing / config.mesh.spacing / 2;
  in.dynamic = rigid.motion == Motion::dynamic;
  if (in.dynamic) in.density = rigid.density;
  if (rigid.motion != Motion::fixed) in.velocity = rigid.velocity;
  const double mass = in.density * in.particle_volume * (in.position.size() / config.dim);
  for (int d = 0; d < 3; ++d) in.force[d] = rigid.force[d] + mass * config.gravity[d];
  const bool only_friction = rigid.friction && !rigid.has_shear_limit;
  in.shear_limit = only_friction ? std::numeric_limits<double>::infinity() : rigid.shear_limit;
  in.friction = rigid.friction.value_or(-1);
  in.surface = surface_input(rigid.shape, config.mesh, config.dim);
  in.surface_normal = rigid.contact_normal == ContactNormal::surface;
  in.separates = rigid.separates;
  if (rigid.penalty) in.reach = rigid.penalty_reach * config.mesh.spacing;
  in.exponent = rigid.penalty_exponent;
  return in;
}

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::set_up(Model&& model, Failure* failure) {
  PetscFunctionBeginUser;
  PetscCall(timers_.create());
  PetscCheck(device_agrees(state_.space), PETSC_COMM_SELF, PETSC_ERR_LIB,
             "kernels do not see what the host sends them: this Kokkos was built so that nvcc and the host "
             "compiler lay out "
             "views differently; build it with Kokkos_ENABLE_IMPL_MDSPAN=OFF");
  timers_.sample(!is_device<Space>);
  GridInput grid{config_.mesh.spacing, config_.mesh.cells, model.patches, config_.mesh.walls};
  std::vector<MaterialInput> materials;
  for (const auto& m : config_.materials) materials.push_back({model_index(m.model), m.parameters});
  std::vector<BodyInput> bodies;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    first_.push_back(total_);
    const long here = static_cast<long>(model.bodies[b].position.size()) / Dim;
    total_ += std::max(model.bodies[b].total, here);
    bodies.push_back(body_input<Dim>(config_, config_.bodies[b], std::move(model.bodies[b])));
  }
  std::vector<RigidInput> rigids;
  for (std::size_t r = 0; r < model.rigids.size(); ++r)
    rigids.push_back(rigid_input(config_, config_.rigids[r], std::move(model.rigids[r])));

  state_.p2g = {config_.p2g.strategy, config_.p2g.margin, config_.p2g.mosaic_cells};
  for (int d = 0; d < Dim; ++d) state_.gravity[d] = config_.gravity[d];
  if (model.owners.empty() && !config_.p2g.rebuild_interval) state_.rebuild_late = rebuild_late();
  state_.damping = config_.damping;
  state_.flip_share = config_.flip_share;
  if (config_.velocity_update == VelocityUpdate::xpic) state_.xpic_order = config_.xpic_order;
  state_.affine = config_.velocity_update == VelocityUpdate::apic;
  // On several ranks the pressure of a cell is averaged once all its particles are here.
  state_.f_bar_share = model.owners.empty() ? config_.f_bar_share : 0;
  Fault fault{};
  PetscCallCXX(fault = upload(state_, grid, materials, bodies, rigids));
  *failure = describe(fault);
  PetscCall(share(failure));
  if (!model.owners.empty() && failure->what.empty()) {
    state_.f_bar_share = config_.f_bar_share;
    ranks_ = std::make_unique<Ranks<Space, T, Dim>>();
    PetscCallCXX(PetscCall(ranks_->start(comm_, config_.partition, model.owners, state_)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Before a step on a device: whether it is one of those that are timed. After it: none is.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::sample(bool on) {
  if (!is_device<Space>) return;
  const bool due = on && steps_enqueued_++ % k_sample_every == k_sample_every - 1;
  if (due) state_.space.fence("mpm::before a step that is timed");
  timers_.sample(due);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::advance(long steps, double dt, Batch* batch) {
  PetscFunctionBeginUser;
  if (ranks_) {
    PetscCall(advance_together(steps, dt, batch));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  const double start = WorkClock::wall();
  restart_count(state_);
  for (long n = 0; n < steps; ++n) {
    sample(true);
    PetscCall(step(state_, timers_, dt));
    sample(false);
  }
  const Control control = look(state_);
  batch->steps = control.steps;
  batch->bound = control.bound;
  batch->failure = control.fault_count > 0 ? describe(control.fault) : Failure{};
  batch->rebuild = control.paused != 0 && control.fault_count == 0;
  const double left = (config_.p2g.margin - control.bound) / std::max(control.increment, 1e-300);
  batch->estimate = static_cast<long>(std::min(left, 1e9)) + 1;
  batch->seconds = WorkClock::wall() - start;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::rebuild(Failure* failure) {
  PetscFunctionBeginUser;
  if (ranks_) {
    PetscCall(rebuild_together(failure));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  const bool sampling = timers_.sampling();
  timers_.sample(true);
  Control control{};
  const auto work = [&] {
    locate(state_);
    control = look(state_);
    if (control.fault_count == 0) sort_and_list(state_);
  };
  PetscCallCXX(PetscCall(timers_.run(Function::rebuild, work, [&] { state_.space.fence("mpm::rebuild"); })));
  timers_.sample(sampling);
  *failure = control.fault_count > 0 ? describe(control.fault) : Failure{};
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::measure(double interval, HistoryRow* row) {
  PetscFunctionBeginUser;
  row->bodies.clear(), row->rigids.clear();
  PetscCall(sum_soil());
  for (int b = 0; b < static_cast<int>(config_.bodies.size()); ++b) {
    BodyRow body;
    PetscCall(measure_body(b, &body));
    row->bodies.push_back(body);
  }
  for (const Rigid<Dim>& r : take_rigids(state_)) {
    RigidRow rigid;
    double impulse[Dim];
    for (int d = 0; d < Dim; ++d) impulse[d] = r.impulse[d];
    if (ranks_ && !ranks_->forces_shared())
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, impulse, Dim, MPI_DOUBLE, MPI_SUM, comm_));
    for (int d = 0; d < Dim; ++d) {
      rigid.displacement[d] = r.displacement[d];
      rigid.velocity[d] = r.velocity[d];
      rigid.force[d] = interval > 0 ? impulse[d] / interval : 0;
    }
    row->rigids.push_back(rigid);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::snapshot(Snapshot* out) {
  PetscFunctionBeginUser;
  const SoilFields soil = download_soil(state_);
  PetscCall(sum_soil());
  const std::vector<double> grid_velocity = grid_velocities(state_);
  out->bodies.clear(), out->rigids.clear(), out->nodes.clear();
  for (std::size_t b = 0; b < config_.bodies.size(); ++b) {
    const auto place_of = [&](long id) {
      return std::lower_bound(soil.id.begin(), soil.id.end(), id) - soil.id.begin();
    };
    const std::size_t from = place_of(first_[b]),
                      to = place_of(b + 1 < first_.size() ? first_[b + 1] : total_);
    ParticleSnapshot body;
    body.name = config_.bodies[b].name;
    for (std::size_t p = from; p < to && ranks_; ++p)
      body.id.push_back(soil.id[p] - static_cast<int>(first_[b]));
    body.position.assign(3 * (to - from), 0);
    body.velocity = body.grid_velocity = body.position;
    body.stress.assign(6 * (to - from), 0);
    for (std::size_t p = from; p < to; ++p) {
      for (int d = 0; d < Dim; ++d) {
        body.position[3 * (p - from) + d] = soil.position[p * Dim + d] + config_.mesh.lower[d];
        body.velocity[3 * (p - from) + d] = soil.velocity[p * Dim + d];
        body.grid_velocity[3 * (p - from) + d] = grid_velocity[p * Dim + d];
      }
      for (int k = 0; k < sym_size<Dim>; ++k)
        body.stress[6 * (p - from) + k] = soil.stress[p * sym_size<Dim> + k];
    }
    body.volume.assign(soil.volume.begin() + from, soil.volume.begin() + to);
    body.plastic_strain.assign(soil.plastic_strain.begin() + from, soil.plastic_strain.begin() + to);
    if (ranks_)
      PetscCall(order_particles(comm_, (b + 1 < first_.size() ? first_[b + 1] : total_) - first_[b], &body));
    out->bodies.push_back(std::move(body));
  }
  const auto rigids = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), state_.rigids);
  for (std::size_t r = 0; r < config_.rigids.size(); ++r) {
    const std::vector<double> position = download_rigid_positions(state_, static_cast<int>(r));
    ParticleSnapshot rigid;
    rigid.name = config_.rigids[r].name;
    rigid.position.assign(3 * (position.size() / Dim), 0);
    rigid.velocity = rigid.position;
    for (std::size_t p = 0; p < position.size() / Dim; ++p)
      for (int d = 0; d < Dim; ++d) {
        rigid.position[3 * p + d] = position[p * Dim + d] + config_.mesh.lower[d];
        rigid.velocity[3 * p + d] = rigids(r).velocity[d];
      }
    out->rigids.push_back(std::move(rigid));
  }
  if (config_.output.nodes) {
    out->nodes = {node_snapshot<Dim>(download_nodes(state_), config_.mesh.lower)};
    if (ranks_) PetscCall(gather_nodes(comm_, &out->nodes[0]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::save(SavedState* saved) const {
  PetscFunctionBeginUser;
  PetscCallCXX(*saved = save_state(state_));
  if (ranks_) PetscCall(ranks_->save(saved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::restore(SavedState&& saved, long since_rebuild, bool* rebuilt) {
  PetscFunctionBeginUser;
  const double bound = saved.bound, increment = saved.increment, margin = config_.p2g.margin;
  bool as_saved = true;
  Failure unfit;
  PetscCallCXX(unfit.what = take_saved(state_, saved));
  if (sum_over_ranks(state_.soil.points.count) != total_ && unfit.what.empty())
    unfit.what = "the number of particles";
  PetscCall(share(&unfit));
  PetscCheck(unfit.what.empty(), comm_, PETSC_ERR_ARG_SIZ,
             "The checkpoint does not fit to what the options describe: %s", unfit.what.c_str());
  if (ranks_) {
    PetscCallCXX(PetscCall(ranks_->restore(state_, saved, &as_saved)));
  } else {
    PetscCallCXX(list_saved(state_));
    PetscCallCXX(finish_saved(state_, saved));
  }
  const auto& forced = config_.p2g.rebuild_interval;
  const bool near = !as_saved && !forced && rebuild_due(bound, increment, margin, rebuild_late());
  *rebuilt = bound > margin || near || (forced && since_rebuild >= *forced);
  Failure failure;
  if (*rebuilt) PetscCall(rebuild(&failure));
  PetscCheck(failure.what.empty(), PETSC_COMM_SELF, PETSC_ERR_FP, "The checkpoint's %s",
             failure.what.c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
std::vector<FunctionTime> TypedStepper<Space, T, Dim>::times() const {
  std::vector<FunctionTime> times;
  for (int n = 0; n < k_functions; ++n) {
    const Function f = static_cast<Function>(n);
    double figures[2] = {timers_.seconds(f), timers_.calls(f) * bytes_of(f, state_)};
    if (ranks_) MPI_Allreduce(MPI_IN_PLACE, figures, 2, MPI_DOUBLE, MPI_MAX, comm_);
    times.push_back({name_of(f), timers_.calls(f), figures[0], figures[1]});
  }
  return times;
}

template <class Space, class T, int Dim>
std::string TypedStepper<Space, T, Dim>::strategy() const {
  switch (chosen(config_.p2g.strategy, backend_of<Space>)) {
    case P2G::sequential: return "sequential";
    case P2G::atomic: return "atomic";
    case P2G::mosaic: return "mosaic";
    case P2G::gather: return "gather";
    default: return "tile";
  }
}

template <class Space, class T, int Dim>
Failure TypedStepper<Space, T, Dim>::describe(const Fault& fault) const {
  if (fault.kind == FaultKind::none) return {};
  std::string who;
  if (fault.particle < 0) {
    who = "rigid " + config_.rigids[-1 - fault.particle].name;
  } else {
    std::size_t b = first_.size() - 1;
    while (b > 0 && first_[b] > fault.particle) --b;
    who = "particle " + std::to_string(fault.particle - first_[b]) + " of body " + config_.bodies[b].name;
  }
  char where[120];
  const double* x = fault.position;
  const Vec3& low = config_.mesh.lower;
  if (Dim == 2)
    std::snprintf(where, sizeof where, " at (%.9g, %.9g) m ", x[0] + low[0], x[1] + low[1]);
  else
    std::snprintf(where, sizeof where, " at (%.9g, %.9g, %.9g) m ", x[0] + low[0], x[1] + low[1],
                  x[2] + low[2]);
  const char* what = fault.kind == FaultKind::outside ? "is outside the mesh"
                     : fault.kind == FaultKind::not_finite
                         ? "has a position, velocity, stress or volume that is not finite"
                     : fault.kind == FaultKind::inverted ? "has no volume left"
                                                         : "moved more than a cell in one step";
  return {who + where + what};
}

#define MPM_INSTANTIATE(Space, T, Dim) template class TypedStepper<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
