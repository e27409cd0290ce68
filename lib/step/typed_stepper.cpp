#include "step/typed_stepper.hpp"
#include "base/copy.hpp"
#include "common/courant.hpp"
#include "common/f_bar.hpp"
#include "common/text.hpp"
#include "device/device_agrees.hpp"
#include "physics/materials/any.hpp"
#include "rebuild/limit_volumes.hpp"
#include "step/body_input.hpp"
#include "step/bytes_moved.hpp"
#include "step/follow_soil.hpp"
#include "step/load_input.hpp"
#include "step/schedule.hpp"
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
  const std::vector<MaterialInput> materials = material_input(config_);
  for (BodyParticles& particles : model.bodies) {
    first_.push_back(total_);
    total_ += std::max(particles.total, static_cast<long>(particles.position.size()) / Dim);
    note_heights<Dim>(config_.mesh, particles);
  }
  PetscCall(keep_heights(model));
  PetscCall(leave_out(&model));
  const std::vector<BodyInput> bodies = body_input<Dim>(config_, model.bodies);
  const std::vector<RigidInput> rigids = rigid_input(config_, model.rigids);

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
  PetscCallCXX(upload_loads(state_, load_input(config_, carried_masses(config_, rigids))));
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
  begin_rayleigh(*rayleigh_, config_.rayleigh_mass, config_.rayleigh_stiffness, shear_ratios(config_));
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
