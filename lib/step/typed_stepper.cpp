#include "step/typed_stepper.hpp"
#include "base/copy.hpp"
#include "common/courant.hpp"
#include "common/f_bar.hpp"
#include "common/revolution.hpp"
#include "common/text.hpp"
#include "device/device_agrees.hpp"
#include "input/geometry/shapes.hpp"
#include "physics/materials/any.hpp"
#include "rebuild/limit_volumes.hpp"
#include "step/bytes_moved.hpp"
#include "step/follow_soil.hpp"
#include "step/load_input.hpp"
#include "step/schedule.hpp"
#include "step/surface_input.hpp"
#include "step/water.hpp"

#include "common/collectives.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace mpm {
namespace {

// On a device functions are timed in step 20, 40, 80 ... of the run, later each 5000 steps. A step that is
// timed takes longer, in a small problem as long as ten.
constexpr long k_samples_apart = 5000;

/// Cells that the fastest wave crosses in the time over which friction takes the mean normal impulse: some
/// periods with which the impulse of a node rings with the waves of its cells. With five, a block creeps that
/// has 1.04 times the friction that it needs.
constexpr double k_friction_cells = 10;

/// The reference heights of particles that are created now are their heights [m, absolute]; the last
/// direction is the vertical one.
template <int Dim>
void note_heights(const MeshConfig& mesh, BodyParticles& particles) {
  if (!particles.reference_height.empty()) return;
  for (std::size_t p = 0; p < particles.position.size() / Dim; ++p)
    particles.reference_height.push_back(particles.position[p * Dim + Dim - 1] + mesh.lower[Dim - 1]);
}

/// The state variables of the particles of a body: those of their creation, but for those that a law changes
/// and a file gives. Own parameters that a field or a file gives are the particles'. Behind them comes the
/// excess pore pressure, where it is given.
template <int Dim>
std::vector<StateField> start_state(const Config& config, const AnyMaterial<double>& law,
                                    ParticleColumns& in) {
  const auto variables = state_variables(law);
  const std::size_t count = in.position.size() / Dim;
  std::vector<StateField> state;
  for (const StateVariable& variable : variables)
    state.push_back({variable.name, std::vector<double>(count)});
  ParticleStart start;
  start.up = Dim - 1;
  std::array<const StateField*, k_most_own> own{};
  const auto keys = own_parameters(variables);
  for (const StateField& given : in.own_parameters)
    if (const auto key = std::find(keys.begin(), keys.end(), given.name); key != keys.end())
      own[key - keys.begin()] = &given;
  for (std::size_t p = 0; p < count && !variables.empty(); ++p) {
    start.height = in.reference_height[p];
    for (std::size_t k = 0; k < own.size(); ++k)
      if (own[k] != nullptr) start.own[k] = own[k]->values[p];
    for (int d = 0; d < Dim; ++d) start.position[d] = in.position[p * Dim + d] + config.mesh.lower[d];
    for (int k = 0; k < sym_size<Dim> && !in.stress.empty(); ++k)
      start.stress[k] = in.stress[p * sym_size<Dim> + k];
    const auto values = initial_state(law, start);
    for (std::size_t k = 0; k < values.size(); ++k) state[k].values[p] = values[k];
  }
  for (StateField& given : in.state)
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (variables[k].changes && given.name == variables[k].name) state[k].values = std::move(given.values);
  for (StateField& given : in.state)
    if (given.name == k_excess_pore_pressure) state.push_back(std::move(given));
  return state;
}

/// Makes the stress of a body total, after its state was made of the effective one.
template <int Dim>
void add_excess_pressure(ParticleColumns& in) {
  if (in.state.empty() || in.state.back().name != k_excess_pore_pressure) return;
  const std::vector<double>& excess = in.state.back().values;
  in.stress.resize(excess.size() * sym_size<Dim>);
  for (std::size_t p = 0; p < excess.size(); ++p)
    for (int k = 0; k < 3; ++k) in.stress[p * sym_size<Dim> + k] -= excess[p];
}

template <int Dim>
BodyInput body_input(const Config& config, const BodyConfig& body, BodyParticles&& particles) {
  const MaterialConfig& material = config.materials[body.material];
  const AnyMaterial<double> law =
      make_material<double>(model_index(material.model), material.parameters, material.object.get());
  BodyInput in{{std::move(static_cast<ParticleColumns&>(particles))}, std::move(particles.id)};
  in.common_velocity = body.velocity;
  in.particle_volume = particles.particle_volume;
  in.least_volume = particles.least_volume, in.most_volume = particles.most_volume;
  in.particle_mass = particles.particle_mass, in.least_mass = particles.least_mass;
  in.half_length = particles.spacing / config.mesh.spacing / 2;
  in.density = density_of(config, body);
  in.weighed = body.shape.kind != ShapeKind::particles;
  in.material = body.material;
  if (in.stress.empty() && body.stress != Sym6{})
    for (std::size_t p = 0; p < in.position.size() / Dim; ++p)
      in.stress.insert(in.stress.end(), body.stress.begin(), body.stress.begin() + sym_size<Dim>);
  in.state = start_state<Dim>(config, law, in);
  add_excess_pressure<Dim>(in);
  return in;
}

/// Mass of the water that a rigid displaces where it begins [kg].
template <int Dim>
double displaced_mass(const Config& config, const RigidInput& rigid) {
  const Water<Dim> water = water_of<Dim>(config);
  double volume = 0;
  for (std::size_t p = 0; p < rigid.position.size() / Dim && water.is_there(); ++p) {
    Vector<double, Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = rigid.position[p * Dim + d];
    volume += rigid.particle_volume * revolved_length(config, x[0]) *
              water.submerged_share(x, filled<double, Dim>(rigid.half_length * config.mesh.spacing));
  }
  return water.density * volume;
}

/// Mass of a rigid less that of the water it displaces [kg].
double carried_mass(const Config& config, const RigidInput& in) {
  const double mass = config.geometry == Geometry::axisymmetric
                          ? in.density * in.revolved_volume
                          : in.density * in.particle_volume * (in.position.size() / config.dim);
  return mass - (config.dim == 2 ? displaced_mass<2>(config, in) : displaced_mass<3>(config, in));
}

RigidInput rigid_input(const Config& config, const RigidConfig& rigid, BodyParticles&& particles) {
  RigidInput in;
  in.position = std::move(particles.position);
  in.particle_volume = particles.particle_volume;
  if (config.geometry == Geometry::axisymmetric)
    for (std::size_t p = 0; p < in.position.size(); p += config.dim)
      in.revolved_volume += in.particle_volume * revolved_length(config, in.position[p]);
  in.half_length = particles.spacing / config.mesh.spacing / 2;
  in.dynamic = rigid.motion == Motion::dynamic;
  if (in.dynamic) in.density = rigid.density;
  if (rigid.motion != Motion::fixed) in.velocity = rigid.velocity;
  const double carried = carried_mass(config, in);
  for (int d = 0; d < 3; ++d) in.force[d] = rigid.force[d] + carried * config.gravity[d];
  in.timed = rigid.velocity_table || rigid.displacement_table;
  const bool only_friction = rigid.friction && !rigid.has_shear_limit && !rigid.shear_fraction;
  in.shear_limit = only_friction ? std::numeric_limits<double>::infinity() : rigid.shear_limit;
  in.shear_fraction = rigid.shear_fraction.value_or(-1);
  in.friction = rigid.friction.value_or(-1);
  const Cuts cuts = cuts_of(rigid.shape, config.mesh, config.dim);
  for (int d = 0; d < config.dim; ++d) in.held[d] = cuts[d][0] || cuts[d][1];
  if (config.geometry == Geometry::axisymmetric) in.held[0] = true;
  in.surface = surface_input(rigid.shape, config.mesh, config.dim);
  in.surface_normal = rigid.contact_normal == ContactNormal::surface;
  in.separates = rigid.separates;
  if (rigid.contact_gap_scaling) in.reach = rigid.contact_gap_reach * config.mesh.spacing;
  in.exponent = rigid.contact_gap_exponent;
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
  const double f_bar = f_bar_range(config_).largest;
  std::vector<MaterialInput> materials;
  for (const auto& m : config_.materials)
    materials.push_back({model_index(m.model), m.parameters, m.object, m.pore_stiffness,
                         f_bar > 0 ? f_bar_fraction(config_, m) / f_bar : 1.0});
  for (BodyParticles& particles : model.bodies) {
    first_.push_back(total_);
    total_ += std::max(particles.total, static_cast<long>(particles.position.size()) / Dim);
    note_heights<Dim>(config_.mesh, particles);
  }
  PetscCall(keep_heights(model));
  PetscCall(leave_out(&model));
  std::vector<BodyInput> bodies;
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    bodies.push_back(body_input<Dim>(config_, config_.bodies[b], std::move(model.bodies[b])));
  std::vector<RigidInput> rigids;
  std::vector<double> carried;
  for (std::size_t r = 0; r < model.rigids.size(); ++r) {
    rigids.push_back(rigid_input(config_, config_.rigids[r], std::move(model.rigids[r])));
    carried.push_back(carried_mass(config_, rigids.back()));
  }

  set_up_correction();
  set_up_rayleigh();
  state_.p2g.strategy = config_.p2g.strategy, state_.p2g.margin = config_.p2g.margin;
  state_.p2g.mosaic_cells = config_.p2g.mosaic_cells;
  for (int d = 0; d < Dim; ++d) state_.gravity[d] = gravity_on_soil(config_)[d];
  state_.water = water_of_kernels<Dim>(config_);
  if (model.owners.empty() && !config_.p2g.rebuild_interval) state_.rebuild_late = GlobalBound::k_late;
  state_.batches.limit = config_.device_memory_limit.value_or(0) * k_gib;
  state_.damping = config_.damping;
  goes_on_ = model.from_run;
  state_.friction_time = k_friction_cells * critical_time_step(config_);
  state_.flip_fraction = config_.flip_fraction;
  if (config_.velocity_update == VelocityUpdate::xpic) state_.xpic_order = config_.xpic_order;
  state_.soil.points.has_affine = config_.velocity_update == VelocityUpdate::apic;
  state_.strays.rule = config_.stray_particles;
  state_.soil.points.has_domain = config_.particle_domain != ParticleDomain::fixed;
  state_.soil.points.rings = config_.geometry == Geometry::axisymmetric;
  state_.soil.points.splits = config_.particle_domain == ParticleDomain::split;
  state_.rim_scale = rim_scale(config_);
  // On several ranks the pressure of a cell is averaged once all its particles are here.
  state_.f_bar_fraction = model.owners.empty() ? f_bar : 0;
  state_.keeps_stress = model.from_run;
  state_.energy.on = config_.output.energy;
  planes_ = planes_of(config_);
  lost_beyond_.resize(planes_.size());
  Fault fault{};
  PetscCallCXX(set_up_sides(&grid));
  PetscCallCXX(set_up_loads(model));
  PetscCallCXX(upload_loads(state_, load_input(config_, carried)));
  PetscCallCXX(fault = upload(state_, grid, materials, bodies, rigids));
  *failure = fault.kind == FaultKind::none ? too_small() : describe(fault);
  PetscCall(share(failure));
  if (!model.owners.empty() && failure->what.empty()) {
    state_.f_bar_fraction = f_bar;
    ranks_ = std::make_unique<Decomposition<Space, T, Dim>>();
    PetscCallCXX(PetscCall(ranks_->start(comm_, config_.partition, model.owners, state_)));
  }
  state_.keeps_stress = false;
  if (config_.output.energy && failure->what.empty()) PetscCallCXX(PetscCall(begin_energy()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::set_up_rayleigh() {
  if (!(config_.rayleigh_mass > 0 || config_.rayleigh_stiffness > 0)) return;
  rayleigh_ = std::make_unique<Rayleigh<Space, T, Dim>>();
  state_.rayleigh = true;
  std::vector<double> ratios;
  for (const MaterialConfig& material : config_.materials)
    ratios.push_back(shear_wave_ratio(material).value_or(0));
  begin_rayleigh(*rayleigh_, config_.rayleigh_mass, config_.rayleigh_stiffness, ratios);
}

/// Steps up to the next one that is timed, or that one.
template <class Space, class T, int Dim>
long TypedStepper<Space, T, Dim>::until_sample() const {
  return std::max(1L, next_sample_ - 1 - steps_enqueued_);
}

/// Before a step on a device: whether it is one of those that are timed. After it: none is.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::sample(bool on) {
  if (!is_device<Space>) return;
  const bool due = on && steps_enqueued_ == next_sample_ - 1;
  if (due) {
    next_sample_ += std::min(next_sample_, k_samples_apart);
    overlap_.join(state_.space);
    state_.space.fence("mpm::before a step that is timed");
  }
  timers_.sample(due);
}

/// Steps that the movement bound will probably still allow, of soil that accelerates as it did since the host
/// last looked. rebuilt: the bound begins anew.
template <class Space, class T, int Dim>
long TypedStepper<Space, T, Dim>::steps_to_rebuild(const Control& control, bool rebuilt) {
  if (control.steps > 0) growth_ = (control.increment - seen_increment_) / control.steps;
  seen_increment_ = control.increment;
  const double left = config_.p2g.margin - (rebuilt ? 0 : control.bound);
  return static_cast<long>(std::min(steps_to_move(left, control.increment, growth_), 1e9)) + 1;
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::advance(const StepRange& range, Batch* batch) {
  PetscFunctionBeginUser;
  const double dt = step_ = range.dt;
  long steps = range.count;
  // Velocities are means over a step: from one to the next they change by half of each step's length, and
  // from rest by half of the first step's.
  const double before = range.before > 0 || !goes_on_ ? range.before : dt;
  state_.kick = before == dt ? 1 : (before + dt) / (2 * dt);
  state_.time = range.time;
  PetscCall(begin_sides());
  begin_loads(state_, {range.origin - config_.time.start, dt, range.first, before});
  if (ranks_) {
    PetscCall(advance_together(steps, dt, batch));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  const double start = WorkClock::wall();
  restart_count(state_);
  while (steps > 0) {
    sample(true);
    const long most = std::min(steps, until_sample());
    long left = most;
    PetscCall(step<Space, T, Dim>(state_, timers_, dt, nullptr, is_device<Space> ? &overlap_ : nullptr, &left,
                                  rayleigh_.get()));
    sample(false);
    steps -= most - left;
    steps_enqueued_ += most - left;
  }
  overlap_.join(state_.space);
  const Control control = read_control(state_);
  if constexpr (is_device<Space>)
    if ((control.paused & Pause::not_co_resident) != 0) resume_single_steps(state_);
  batch->steps = control.steps;
  batch->bound = control.bound;
  batch->failure = control.fault_count > 0 ? describe(control.fault) : Failure{};
  batch->rebuild = (control.paused & Pause::due) != 0 && control.fault_count == 0;
  batch->estimate = steps_to_rebuild(control, batch->rebuild);
  batch->seconds = WorkClock::wall() - start;
  stepping_ += batch->seconds;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::rebuild(double elapsed, Failure* failure) {
  PetscFunctionBeginUser;
  if (ranks_) {
    PetscCall(rebuild_together(elapsed, failure));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  const bool sampling = timers_.sampling();
  timers_.sample(true);
  Control control{};
  PetscErrorCode failed = PETSC_SUCCESS;
  const auto work = [&] {
    const BeyondMask<Space> beyond = mark_beyond();
    limit_volumes(state_);
    failed = mpm::follow_soil(state_);
    locate(state_);
    control = read_control(state_);
    if (control.lost > 0) note_all_lost(beyond);
    if (control.fault_count == 0 && failed == PETSC_SUCCESS) failed = split_and_merge();
    if (control.fault_count > 0 || failed != PETSC_SUCCESS) return;
    sort_and_list(state_);
    failed = correct_positions(elapsed);
    begin_domains(state_);
  };
  PetscCallCXX(PetscCall(timers_.run(StepPhase::rebuild, work, [&] { state_.space.fence("mpm::rebuild"); })));
  PetscCall(failed);
  timers_.sample(sampling);
  *failure = control.fault_count > 0 ? describe(control.fault) : too_small();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::follow_soil() {
  PetscFunctionBeginUser;
  overlap_.join(state_.space);
  PetscCallCXX(PetscCall(mpm::follow_soil(state_, ranks_.get())));
  PetscCallCXX(begin_domains(state_));
  state_.summed = {};  // by the domains of before
  state_.batches.loaded = false;
  state_.space.fence("mpm::follow_soil");
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::save(SavedState* saved) const {
  PetscFunctionBeginUser;
  collect_soil(state_);
  PetscCallCXX(*saved = save_state(state_));
  PetscCall(save_for_starts(saved));
  saved->particles = ids();
  saved->unused = unused_;
  name_columns(saved);
  PetscCall(save_energy(saved));
  PetscCall(save_sections(saved));
  if (ranks_) PetscCall(gather_strays(saved));
  if (ranks_) PetscCall(ranks_->save(saved));
  rigids_.widen(*saved);
  PetscCall(save_sides(&saved->sides));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::restore(SavedState&& saved, long since_rebuild, bool* rebuilt) {
  PetscFunctionBeginUser;
  rigids_.narrow(saved);
  unused_ = saved.unused;
  const double margin = config_.p2g.margin;
  const auto& forced = config_.p2g.rebuild_interval;
  if (forced) saved.due_in = 0;
  // By another rule the rebuild may be due already.
  const bool unforeseen = saved.due_in == 0 && saved.bound > 0 &&
                          rebuild_due(saved.bound, saved.increment, margin, GlobalBound::k_late);
  const bool near = !forced && (saved.margin > margin || unforeseen);
  *rebuilt = saved.bound > margin || near || (forced && since_rebuild >= *forced);
  if (ranks_ && rank_of(comm_) > 0) std::fill(saved.lost.begin(), saved.lost.end(), 0);  // rank 0 has them
  Failure unfit;
  PetscCallCXX(unfit.what = take_saved(state_, saved));
  restore_energy(saved);
  restore_sections(saved);
  double lost = 0;
  for (const Lost& of_body : state_.strays.lost) lost += of_body.count + of_body.merged;
  if (state_.soil.points.splits) children_ = std::max(0L, saved.particles - total_);
  const long unused = std::accumulate(unused_.begin(), unused_.end(), 0L);
  if (sum_over_ranks(state_.soil.points.count + lost) + static_cast<double>(unused) != ids() &&
      unfit.what.empty())
    unfit.what = "the number of particles";
  PetscCall(share(&unfit));
  PetscCheck(unfit.what.empty(), comm_, PETSC_ERR_ARG_SIZ,
             "-restart: given \"%s\", takes a checkpoint of what the options describe; they differ in %s",
             config_.output.restart.c_str(), unfit.what.c_str());
  if (ranks_) {
    PetscCallCXX(PetscCall(ranks_->restore(state_, saved)));
  } else {
    PetscCallCXX(list_saved(state_));
    PetscCallCXX(finish_saved(state_, saved));
  }
  PetscCallCXX(PetscCall(restore_sides(saved.sides)));
  Failure failure = too_small();
  if (*rebuilt && failure.what.empty()) PetscCall(rebuild(0, &failure));
  PetscCheck(failure.what.empty(), PETSC_COMM_SELF, PETSC_ERR_FP, "The checkpoint's %s",
             failure.what.c_str());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::split_and_merge() {
  PetscFunctionBeginUser;
  if (!state_.soil.points.splits) PetscFunctionReturn(PETSC_SUCCESS);
  merge_particles(state_);
  const std::vector<Splitting> own = find_splittings(state_);
  std::vector<int> all;  // ids of the particles of all ranks that are split
  for (const Splitting& splitting : own) all.push_back(splitting.id);
  if (ranks_) {
    PetscCall(share_records(comm_, &all));
    std::sort(all.begin(), all.end());
  }
  PetscCheck(ids() + static_cast<long>(all.size()) <= std::numeric_limits<int>::max(), comm_,
             PETSC_ERR_ARG_OUTOFRANGE,
             "-particle_domain split: there are no numbers left for more particles");
  std::vector<int> children;  // the same ids whatever the ranks are
  for (const Splitting& splitting : own)
    children.push_back(
        static_cast<int>(ids() + (std::lower_bound(all.begin(), all.end(), splitting.id) - all.begin())));
  PetscCallCXX(split_particles(state_, own, children));
  children_ += static_cast<long>(all.size());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Index of the body of a particle that is on this rank; 0 where it is not.
template <class Space, class T, int Dim>
std::size_t TypedStepper<Space, T, Dim>::body_of(int id) const {
  const auto& soil = state_.soil.points;
  const auto held = Kokkos::make_pair(0, soil.count);
  const auto ids = mirror_of(Kokkos::subview(soil.id, held));
  const auto body = mirror_of(Kokkos::subview(soil.body, held));
  for (int p = 0; p < soil.count; ++p)
    if (ids(p) == id) return body(p);
  return 0;
}

template <class Space, class T, int Dim>
std::vector<FunctionTime> TypedStepper<Space, T, Dim>::times() const {
  std::vector<FunctionTime> times;
  for (int n = 0; n < k_functions; ++n) {
    const StepPhase f = static_cast<StepPhase>(n);
    const bool seldom = f == StepPhase::persistent || f == StepPhase::energy;
    if (seldom && timers_.calls(f) == 0) continue;
    double figures[2] = {timers_.seconds(f), timers_.calls(f) * bytes_of(f, state_)};
    if (ranks_) MPI_Allreduce(MPI_IN_PLACE, figures, 2, MPI_DOUBLE, MPI_MAX, comm_);
    times.push_back({name_of(f), timers_.calls(f), figures[0], figures[1]});
  }
  return times;
}

template <class Space, class T, int Dim>
std::string TypedStepper<Space, T, Dim>::strategy() const {
  return word_of(chosen(config_.p2g.strategy));
}

template <class Space, class T, int Dim>
Failure TypedStepper<Space, T, Dim>::describe(const Fault& fault) const {
  if (fault.kind == FaultKind::none) return {};
  std::string who;
  const char* of_law = "";
  if (fault.particle < 0) {
    who = "rigid " + config_.rigids[-1 - fault.particle].name;
  } else {
    std::size_t b = fault.particle < total_ ? first_.size() - 1 : body_of(fault.particle);
    while (fault.particle < total_ && b > 0 && first_[b] > fault.particle) --b;
    const long number = fault.particle < total_ ? fault.particle - first_[b] : fault.particle;
    who = "particle " + std::to_string(number) + " of body " + config_.bodies[b].name;
    of_law = failure_of(model_index(config_.materials[config_.bodies[b].material].model));
  }
  char where[120];
  const double* x = fault.position;
  const Vec3& low = config_.mesh.lower;
  if (Dim == 2)
    std::snprintf(where, sizeof where, " at (%.9g, %.9g) m ", x[0] + low[0], x[1] + low[1]);
  else
    std::snprintf(where, sizeof where, " at (%.9g, %.9g, %.9g) m ", x[0] + low[0], x[1] + low[1],
                  x[2] + low[2]);
  const char* what =
      fault.kind == FaultKind::outside      ? "is outside the mesh"
      : fault.kind == FaultKind::not_finite ? "has a position, velocity, stress or volume that is not finite"
      : fault.kind == FaultKind::volume
          ? "has left 0.2 to 2 times its volume at the start (-stray_particles stop)"
      : fault.kind == FaultKind::law   ? of_law
      : fault.kind == FaultKind::state ? "has a state variable of its law that is not finite"
      : fault.kind == FaultKind::alone ? "is alone, with no other soil in reach (-stray_particles stop)"
                                       : "moved more than a cell in one step";
  return {who + where + what};
}

#define MPM_INSTANTIATE(Space, T, Dim) template class TypedStepper<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
