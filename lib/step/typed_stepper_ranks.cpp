// Functions that the steppers of all ranks do together.

#include <algorithm>
#include <limits>

#include "base/copy.hpp"
#include "common/collectives.hpp"
#include "common/text.hpp"
#include "data/memory_of.hpp"
#include "rebuild/limit_volumes.hpp"
#include "step/follow_soil.hpp"
#include "step/typed_stepper.hpp"

namespace mpm {

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::share(Failure* failure) const {
  PetscFunctionBeginUser;
  PetscCall(share_text(comm_, &failure->what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
double TypedStepper<Space, T, Dim>::sum_over_ranks(double own) const {
  if (ranks_) MPI_Allreduce(MPI_IN_PLACE, &own, 1, MPI_DOUBLE, MPI_SUM, comm_);
  return own;
}

template <class Space, class T, int Dim>
std::size_t TypedStepper<Space, T, Dim>::memory() const {
  return static_cast<std::size_t>(
      sum_over_ranks(static_cast<double>(memory_of(state_) + (ranks_ ? ranks_->memory() : 0))));
}

/// Steps until all are done, or until the ranks know, all at the same step, that lists must be rebuilt or
/// that one of them cannot go on. What they know of each other is some steps old; a rank whose bound has
/// passed the margin does no more steps, so that no particle is ever looked for where it is not. Soil that is
/// so fast that it may cross the margin in as many steps is looked at after each of them, and so is the first
/// step of all.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::advance_together(long steps, double dt, Batch* batch) {
  PetscFunctionBeginUser;
  const double start = WorkClock::wall(), margin = config_.p2g.margin;
  const int late =
      config_.p2g.rebuild_interval ? 0 : GlobalBound::k_late;  // a forced interval has no reserve
  constexpr double k_growth = 2;  // of the speeds till the reports of a step are there
  const auto is_swift = [&](double increment) {
    return late > 0 && !(k_growth * (late + 1) * increment < margin);
  };
  if (is_swift(last_increment_)) steps = 1;
  restart_count(state_);
  ranks_->clock().go_on();
  long done = 0;
  bool due = false;
  for (; done < steps && !due; ++done) {
    sample(true);
    PetscCall(step<Space, T, Dim>(state_, timers_, dt, ranks_.get(), is_device<Space> ? &overlap_ : nullptr,
                                  nullptr, rayleigh_.get()));
    sample(false);
    ++steps_enqueued_;
    BoundReport all;
    bool known = false;
    PetscCall(ranks_->look_back(&known, &all));
    // A report without a bound is of a step before the lists were built.
    const bool passed =
        late > 0 && known && all.bound > 0 && rebuild_due(all.bound, all.increment, margin, late);
    due = ranks_->count_down() || passed || (known && all.stopped > 0);
    if (known && is_swift(all.increment)) steps = done + 1;
  }
  overlap_.join(state_.space);
  const Control own = read_control(state_);
  ranks_->clock().pause();
  const bool missed = own.steps != done;
  BoundReport now{own.bound, own.increment, own.fault_count > 0 || missed ? 1.0 : 0.0};
  PetscCall(GlobalBound::now(comm_, &now));
  last_increment_ = now.increment;
  ranks_->clock().go_on();
  ranks_->clock().stop();

  batch->steps = done;
  batch->bound = now.bound;
  batch->estimate = std::numeric_limits<long>::max();  // it ends by itself
  batch->failure = {};
  if (now.stopped > 0) {
    long least = own.steps;
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_LONG, MPI_MIN, comm_));
    batch->steps = least;
    if (own.fault_count > 0)
      batch->failure = describe(own.fault);
    else if (missed && !config_.p2g.rebuild_interval)
      batch->failure.what = formatted(
          "a particle moved %.3g cells since the last rebuild, and the lists hold for %.3g: its speed grew "
          "more "
          "than by half while the ranks exchanged their bounds; lower -time_courant or -rebuild_margin",
          own.bound, margin);
    PetscCall(share(&batch->failure));
  }
  // Where a batch ends must not matter, so what is known by now decides nothing but with a forced interval,
  // and that the margin is passed: soil for which that can be is looked at after each step.
  const bool beyond = rebuild_due(now.bound, 0, margin, 0);
  batch->rebuild = batch->failure.what.empty() && (beyond || (late > 0 && due));
  batch->seconds = WorkClock::wall() - start;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &batch->seconds, 1, MPI_DOUBLE, MPI_MAX, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::rebuild_together(double elapsed, Failure* failure) {
  PetscFunctionBeginUser;
  const bool sampling = timers_.sampling();
  timers_.sample(true);
  PetscErrorCode failed = PETSC_SUCCESS;
  std::vector<double> sides;  // of all ranks: other ranks may come to reach their nodes
  PetscCall(gather_sides(&sides));
  const auto work = [&] {
    const BeyondMask<Space> beyond = mark_beyond();
    limit_volumes(state_);
    failed = mpm::follow_soil(state_, ranks_.get());
    locate(state_);
    const Control control = read_control(state_);
    *failure = control.fault_count > 0 ? describe(control.fault) : Failure{};
    if (failed == PETSC_SUCCESS) failed = share(failure);
    if (control.lost > 0) note_all_lost(beyond);
    if (failed == PETSC_SUCCESS && failure->what.empty()) failed = split_and_merge();
    if (failed == PETSC_SUCCESS && failure->what.empty()) failed = ranks_->rebuild(state_);
    if (failed == PETSC_SUCCESS && failure->what.empty()) failed = correct_positions(elapsed);
    begin_domains(state_);
  };
  PetscCallCXX(PetscCall(timers_.run(StepPhase::rebuild, work, [&] { state_.space.fence("mpm::rebuild"); })));
  PetscCall(failed);
  if (failure->what.empty()) PetscCall(put_sides(sides));
  timers_.sample(sampling);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The nodal sums of the soil as it is, of all ranks.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::sum_soil() {
  PetscFunctionBeginUser;
  sum_present_soil(state_);
  if (ranks_) PetscCall(ranks_->add_present_soil(state_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::measure_body(int b, BodyRow* body) {
  PetscFunctionBeginUser;
  BodyMeasure m = mpm::measure(state_, b);
  OverRanks over;
  double speed = largest_grid_speed(state_, b);
  if (ranks_) {
    const auto reduce = [&](void* values, int count, MPI_Datatype type, MPI_Op op) {
      MPI_Allreduce(MPI_IN_PLACE, values, count, type, op, comm_);
    };
    for (int d = 0; d < 3; ++d) m.centre[d] = m.count > 0 ? m.centre[d] * m.weight : 0;
    reduce(m.lower, 3, MPI_DOUBLE, MPI_MIN);
    reduce(m.upper, 3, MPI_DOUBLE, MPI_MAX);
    reduce(&m.kinetic_energy, 1, MPI_DOUBLE, MPI_SUM);
    reduce(&m.stored_energy, 1, MPI_DOUBLE, MPI_SUM);
    reduce(m.momentum, 3, MPI_DOUBLE, MPI_SUM);
    reduce(m.centre, 3, MPI_DOUBLE, MPI_SUM);
    reduce(&m.mass, 1, MPI_DOUBLE, MPI_SUM);
    reduce(&m.water_energy, 1, MPI_DOUBLE, MPI_SUM);
    reduce(&m.weight, 1, MPI_DOUBLE, MPI_SUM);
    for (long* count : {&m.count, &m.alone, &m.limited, &m.stretched}) reduce(count, 1, MPI_LONG, MPI_SUM);
    reduce(&speed, 1, MPI_DOUBLE, MPI_MAX);
    for (int d = 0; d < 3 && m.weight > 0; ++d) m.centre[d] /= m.weight;
    over.sum = [=](int* counts, int n) { reduce(counts, n, MPI_INT, MPI_SUM); };
    over.largest = [=](double* value) { reduce(value, 1, MPI_DOUBLE, MPI_MAX); };
  }
  PetscCall(note_out_of_order(b, body));
  body->mass = m.mass, body->water_energy = m.water_energy, body->strays = m.alone, body->limited = m.limited;
  body->particles = m.count, body->stretched = m.stretched;
  if (m.count == 0) PetscFunctionReturn(PETSC_SUCCESS);
  const long rank = m.count - m.count / 1000;  // of the 99.9th percentile, the nearest one above
  const Vec3& origin = config_.mesh.lower;
  for (int d = 0; d < Dim; ++d) {
    body->lower[d] = m.lower[d] + origin[d];
    body->upper[d] = m.upper[d] + origin[d];
    body->momentum[d] = m.momentum[d];
    body->quantile[d] = ranked_coordinate(state_, b, d, rank, m, over) + origin[d];
    body->centre[d] = m.centre[d] + origin[d];
  }
  body->kinetic_energy = m.kinetic_energy;
  body->stored_energy = m.stored_energy;
  body->grid_velocity = speed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Notes soil that has left the run, and the number of particles that were put back on a wall.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::note_out_of_order(int b, BodyRow* body) {
  PetscFunctionBeginUser;
  const Lost& lost = state_.strays.lost[b];
  const auto put_back = mirror_of(state_.strays.put_back);
  double sums[11] = {lost.mass,          lost.kinetic_energy, lost.momentum[0], lost.momentum[1],
                     lost.momentum[2],   double(put_back(b)), lost.count,       lost.merged,
                     lost.merged_energy, lost.corrected,      lost.raised};
  if (ranks_) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 11, MPI_DOUBLE, MPI_SUM, comm_));
  body->lost_mass = sums[0], body->lost_energy = sums[1];
  for (int d = 0; d < 3; ++d) body->lost_momentum[d] = sums[2 + d];
  body->put_back = static_cast<long>(sums[5]), body->lost_count = static_cast<long>(sums[6]);
  body->merged = static_cast<long>(sums[7]), body->merged_energy = sums[8];
  body->corrected = sums[9], body->raised = sums[10];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Gathers, on every rank, the soil that has left on all ranks, and all cells whose particles are alone.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::gather_strays(SavedState* saved) const {
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, saved->lost.data(), static_cast<int>(saved->lost.size()),
                             MPI_DOUBLE, MPI_SUM, comm_));
  PetscCall(share_records(comm_, &saved->alone));
  std::sort(saved->alone.begin(), saved->alone.end());
  saved->alone.erase(std::unique(saved->alone.begin(), saved->alone.end()), saved->alone.end());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::ownership(std::vector<OwnedPatch>* patches) {
  PetscFunctionBeginUser;
  const auto origin =
      mirror_of(Kokkos::subview(state_.patches.origin, Kokkos::make_pair(0, state_.patches.slots)));
  const auto begin = mirror_of(state_.soil.bins.begin);
  std::vector<char> own, all;
  for (int slot = 0; slot < state_.patches.slots; ++slot) {
    OwnedPatch patch{
        {}, begin((slot + 1) * Patch<Dim>::cells) - begin(slot * Patch<Dim>::cells), rank_of(comm_)};
    if (patch.particles == 0) continue;
    for (int d = 0; d < Dim; ++d) patch.place[d] = origin(slot)[d] / Patch<Dim>::edge;
    const char* const bytes = reinterpret_cast<const char*>(&patch);
    own.insert(own.end(), bytes, bytes + sizeof patch);
  }
  std::vector<std::vector<char>> out(size_of(comm_));
  out[0] = std::move(own);
  PetscCall(exchange_records(comm_, sizeof(OwnedPatch), out, &all));
  patches->resize(all.size() / sizeof(OwnedPatch));
  std::copy(all.begin(), all.end(), reinterpret_cast<char*>(patches->data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
std::optional<RankFigures> TypedStepper<Space, T, Dim>::rank_figures() const {
  if (!ranks_) return std::nullopt;
  const RankReport r = ranks_->report(state_);
  std::array<double, 8> low{r.work,       r.wait,         r.halo, r.particles,
                            r.neighbours, r.shared_nodes, r.sent, r.held},
      high = low, sum = low;
  MPI_Allreduce(MPI_IN_PLACE, low.data(), 8, MPI_DOUBLE, MPI_MIN, comm_);
  MPI_Allreduce(MPI_IN_PLACE, high.data(), 8, MPI_DOUBLE, MPI_MAX, comm_);
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 8, MPI_DOUBLE, MPI_SUM, comm_);
  const int ranks = size_of(comm_);
  const auto spread = [&](int k) { return Spread{low[k], high[k], sum[k] / ranks}; };
  RankFigures figures;
  figures.ranks = ranks;
  figures.compute = spread(0), figures.wait = spread(1), figures.halo = spread(2);
  figures.particles = spread(3), figures.neighbours = spread(4), figures.halo_nodes = spread(5);
  figures.sent = spread(6);
  if (is_device<Space> && ranks_->overlaps(state_)) figures.held = spread(7);
  figures.halo_path = ranks_->halo_words(state_);
  return figures;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                         \
  template PetscErrorCode TypedStepper<Space, T, Dim>::share(Failure*) const;                  \
  template double TypedStepper<Space, T, Dim>::sum_over_ranks(double) const;                   \
  template std::size_t TypedStepper<Space, T, Dim>::memory() const;                            \
  template PetscErrorCode TypedStepper<Space, T, Dim>::advance_together(long, double, Batch*); \
  template PetscErrorCode TypedStepper<Space, T, Dim>::rebuild_together(double, Failure*);     \
  template PetscErrorCode TypedStepper<Space, T, Dim>::sum_soil();                             \
  template PetscErrorCode TypedStepper<Space, T, Dim>::measure_body(int, BodyRow*);            \
  template PetscErrorCode TypedStepper<Space, T, Dim>::note_out_of_order(int, BodyRow*);       \
  template PetscErrorCode TypedStepper<Space, T, Dim>::gather_strays(SavedState*) const;       \
  template PetscErrorCode TypedStepper<Space, T, Dim>::ownership(std::vector<OwnedPatch>*);    \
  template std::optional<RankFigures> TypedStepper<Space, T, Dim>::rank_figures() const;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
