// What the stepper does together with those of the other ranks.

#include <algorithm>
#include <limits>

#include "output/log.hpp"
#include "parallel/together.hpp"
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
/// passed the margin does no more steps, so that no particle is ever looked for where it is not.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::advance_together(long steps, double dt, Batch* batch) {
  PetscFunctionBeginUser;
  const double start = WorkClock::wall(), margin = config_.p2g.margin;
  const int late =
      config_.p2g.rebuild_interval ? 0 : GlobalBound::k_late;  // a forced interval has no reserve
  restart_count(state_);
  ranks_->clock().go_on();
  long done = 0;
  bool due = false;
  for (; done < steps && !due; ++done) {
    sample(true);
    PetscCall(step<Space, T, Dim>(state_, timers_, dt, ranks_.get(), is_device<Space> ? &beside_ : nullptr));
    sample(false);
    ++steps_enqueued_;
    BoundReport all;
    bool known = false;
    PetscCall(ranks_->look_back(&known, &all));
    const bool passed = late > 0 && known && rebuild_due(all.bound, all.increment, margin, late);
    due = ranks_->count_down() || passed || (known && all.stopped > 0);
  }
  beside_.join(state_.space);
  const Control own = look(state_);
  ranks_->clock().pause();
  const bool missed = own.steps != done;
  BoundReport now{own.bound, own.increment, own.fault_count > 0 || missed ? 1.0 : 0.0};
  PetscCall(GlobalBound::now(comm_, &now));
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
          "than by half while the ranks exchanged their bounds; lower -time_courant or -p2g_margin",
          own.bound, margin);
    PetscCall(share(&batch->failure));
  }
  // Where a batch ends must not matter, so what is known by now decides nothing but with a forced interval.
  batch->rebuild = batch->failure.what.empty() && (late == 0 ? rebuild_due(now.bound, 0, margin, 0) : due);
  batch->seconds = WorkClock::wall() - start;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &batch->seconds, 1, MPI_DOUBLE, MPI_MAX, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::rebuild_together(Failure* failure) {
  PetscFunctionBeginUser;
  const bool sampling = timers_.sampling();
  timers_.sample(true);
  PetscErrorCode failed = PETSC_SUCCESS;
  const auto work = [&] {
    locate(state_);
    const Control control = look(state_);
    *failure = control.fault_count > 0 ? describe(control.fault) : Failure{};
    failed = share(failure);
    if (failed == PETSC_SUCCESS && failure->what.empty()) failed = ranks_->rebuild(state_);
  };
  PetscCallCXX(PetscCall(timers_.run(Function::rebuild, work, [&] { state_.space.fence("mpm::rebuild"); })));
  PetscCall(failed);
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
    for (int d = 0; d < 3; ++d) m.centre[d] = m.count > 0 ? m.centre[d] * m.count : 0;
    reduce(m.lower, 3, MPI_DOUBLE, MPI_MIN);
    reduce(m.upper, 3, MPI_DOUBLE, MPI_MAX);
    reduce(&m.kinetic_energy, 1, MPI_DOUBLE, MPI_SUM);
    reduce(m.momentum, 3, MPI_DOUBLE, MPI_SUM);
    reduce(m.centre, 3, MPI_DOUBLE, MPI_SUM);
    reduce(&m.count, 1, MPI_LONG, MPI_SUM);
    reduce(&speed, 1, MPI_DOUBLE, MPI_MAX);
    for (int d = 0; d < 3; ++d) m.centre[d] /= m.count;
    over.sum = [=](int* counts, int n) { reduce(counts, n, MPI_INT, MPI_SUM); };
    over.largest = [=](double* value) { reduce(value, 1, MPI_DOUBLE, MPI_MAX); };
  }
  const long rank = m.count - m.count / 1000;  // of the 99.9 % quantile, the nearest one above
  const Vec3& origin = config_.mesh.lower;
  for (int d = 0; d < Dim; ++d) {
    body->lower[d] = m.lower[d] + origin[d];
    body->upper[d] = m.upper[d] + origin[d];
    body->momentum[d] = m.momentum[d];
    body->quantile[d] = ranked_coordinate(state_, b, d, rank, m, over) + origin[d];
    body->centre[d] = m.centre[d] + origin[d];
  }
  body->kinetic_energy = m.kinetic_energy;
  body->grid_velocity = speed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::ownership(std::vector<OwnedPatch>* patches) {
  PetscFunctionBeginUser;
  const auto origin = Kokkos::create_mirror_view_and_copy(
      Kokkos::HostSpace(),
      Kokkos::subview(state_.patches.origin, Kokkos::make_pair(0, state_.patches.slots)));
  const auto begin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), state_.soil.bins.begin);
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

/// Collective: a line for each figure, smallest and largest over the ranks.
template <class Space, class T, int Dim>
std::string TypedStepper<Space, T, Dim>::ranks_report() const {
  if (!ranks_) return {};
  const RankReport r = ranks_->report(state_);
  std::array<double, 8> low{r.work,       r.wait,         r.halo, r.particles,
                            r.neighbours, r.shared_nodes, r.sent, r.held},
      high = low, sum = low;
  MPI_Allreduce(MPI_IN_PLACE, low.data(), 8, MPI_DOUBLE, MPI_MIN, comm_);
  MPI_Allreduce(MPI_IN_PLACE, high.data(), 8, MPI_DOUBLE, MPI_MAX, comm_);
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 8, MPI_DOUBLE, MPI_SUM, comm_);
  const int ranks = size_of(comm_);
  const auto balance = [&](int k) { return sum[k] > 0 ? high[k] * ranks / sum[k] : 1.0; };
  std::string text = formatted("%d ranks: %.0f to %.0f particles a rank, largest over mean %.3f\n", ranks,
                               low[3], high[3], balance(3));
  text += formatted("  halo of at most %.0f nodes with %.0f neighbours, %.1f kB sent a step, %s\n", high[5],
                    high[4], high[6] / 1e3, ranks_->halo_words(state_).c_str());
  if (high[0] > 0)
    text += formatted(
        "  compute %.3f to %.3f s a rank, largest over mean %.3f; halo (pack and sum) %.3f to %.3f s, wait "
        "%.3f to "
        "%.3f s\n",
        low[0], high[0], balance(0), low[2], high[2], low[1], high[1]);
  if (high[0] > 0 && is_device<Space> && ranks_->overlaps(state_))
    text += formatted("  devices held up by the halo for %.3f to %.3f s of it\n", low[7], high[7]);
  return text;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                         \
  template PetscErrorCode TypedStepper<Space, T, Dim>::share(Failure*) const;                  \
  template double TypedStepper<Space, T, Dim>::sum_over_ranks(double) const;                   \
  template std::size_t TypedStepper<Space, T, Dim>::memory() const;                            \
  template PetscErrorCode TypedStepper<Space, T, Dim>::advance_together(long, double, Batch*); \
  template PetscErrorCode TypedStepper<Space, T, Dim>::rebuild_together(Failure*);             \
  template PetscErrorCode TypedStepper<Space, T, Dim>::sum_soil();                             \
  template PetscErrorCode TypedStepper<Space, T, Dim>::measure_body(int, BodyRow*);            \
  template PetscErrorCode TypedStepper<Space, T, Dim>::ownership(std::vector<OwnedPatch>*);    \
  template std::string TypedStepper<Space, T, Dim>::ranks_report() const;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
