// Between the steps: who owns which patch, particles that go to their owners, and the lists of shared nodes.

#include <algorithm>
#include <set>

#include "base/copy.hpp"
#include "common/collectives.hpp"
#include "common/text.hpp"
#include "functions/contact_sites.hpp"
#include "functions/step_kernels.hpp"
#include "parallel/decomposition.hpp"
#include "parallel/partition.hpp"
#include "rebuild/rebuild_state.hpp"
#include "transfer/restore_state.hpp"

namespace mpm {
namespace {

/// Brings a list of the host to a view of the device that has room for it.
template <class View, class Value>
void fill(View& view, const std::vector<Value>& values) {
  ensure(view, values.size());
  if (values.empty()) return;
  const Kokkos::View<const Value*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(values.data(),
                                                                                    values.size());
  copy(Kokkos::subview(view, Kokkos::make_pair(std::size_t(0), values.size())), host);
}

/// Sets the marks that any rank has set.
PetscErrorCode share_marks(MPI_Comm comm, std::vector<std::uint8_t>* marks) {
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, marks->data(), static_cast<int>(marks->size()), MPI_UNSIGNED_CHAR,
                             MPI_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

// Numbers of a rank in SavedState::bounds: bound, increment, whether a report is under way, the two numbers
// of it, sum, and the two numbers of the next report.
constexpr int k_bounds = k_saved_bounds;
constexpr int k_impulse = MotionTerms::impulse_size;  // of a rigid, behind them
constexpr double k_worth = 0.02;                      // least gain in balance for which patches change hands

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::rebuild(State_& s) {
  PetscFunctionBeginUser;
  clock_.stop();
  PetscCall(forget());
  NodeImpulses<T> impulses;
  if (impulse_rows(s) > 0) impulses = list_impulses(s);
  PetscCall(rebalance(s));
  const double before = WorkClock::wall();
  long moved = 0;
  PetscCall(migrate(s, &moved));
  sort_and_list(s);
  PetscCall(make_lists(s));
  if (impulse_rows(s) > 0) PetscCall(exchange_impulses(s, impulses));
  present_added_ = false;
  note_bound(s, s.space);
  s.space.fence("mpm::note_bound");
  if (!log_lines_.empty())
    log_lines_ += formatted("; %ld particles changed their rank, %.3g s", moved, WorkClock::wall() - before);
  clock_.stop();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Gives patches to other ranks where that mends the balance of the work since it was judged last. Work that
/// is too short to measure is kept for the next time; until the first time the balance is that of the
/// particles.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::rebalance(State_& s) {
  constexpr double k_measurable = 0.05;  // s of work a rank
  PetscFunctionBeginUser;
  if (config_.kind != PartitionKind::metis) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<double> figures(2 * size_), work, particles;
  const double own[2] = {clock_.recent(), double(s.soil.points.count)};
  PetscCallMPI(MPI_Allgather(own, 2, MPI_DOUBLE, figures.data(), 2, MPI_DOUBLE, comm_));
  double all_work = 0;
  for (int r = 0; r < size_; ++r) {
    work.push_back(figures[2 * r]);
    particles.push_back(figures[2 * r + 1]);
    all_work += work.back();
  }
  const bool timed = all_work > k_measurable * size_;
  if (!timed && timed_) PetscFunctionReturn(PETSC_SUCCESS);
  timed_ = timed;
  if (timed) clock_.forget();
  const double imbalance = imbalance_of(timed ? work : particles);
  if (imbalance > config_.rebalance_threshold && imbalance > futile_ + k_worth)
    PetscCall(choose_owners(s, figures, imbalance, timed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// figures: work [s] and particles of each rank; timed: the work gives the cost of a particle.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::choose_owners(State_& s, const std::vector<double>& figures,
                                                           double imbalance, bool timed) {
  constexpr double k_dearest = 2;  // times the mean: beyond it the clock is not believed
  PetscFunctionBeginUser;
  const double start = WorkClock::wall();
  std::vector<int> counts = count_by_patch(s);
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, counts.data(), static_cast<int>(counts.size()), MPI_INT, MPI_SUM, comm_));
  double work = 0, particles = 0;
  for (int r = 0; r < size_; ++r) work += figures[2 * r], particles += figures[2 * r + 1];
  Loads loads(counts.begin(), counts.end());
  for (std::size_t n = 0; n < loads.size() && timed; ++n) {
    const double *own = &figures[2 * owners_[n]], mean = work / particles;
    const double cost = own[1] > 0 ? own[0] / own[1] / mean : 1;
    loads[n] *= std::clamp(cost, 1 / k_dearest, k_dearest);
  }
  Owners owners;
  PetscCall(cut_graph(comm_, grid_, loads, owners_, &owners));
  const double now = imbalance_of(loads_of(owners_, loads, size_)),
               then = imbalance_of(loads_of(owners, loads, size_));
  futile_ = then > now - k_worth ? imbalance : 0;
  if (futile_ > 0) PetscFunctionReturn(PETSC_SUCCESS);
  owners_ = owners;
  send_owners_to_device();
  log_lines_ = formatted("patches changed hands: imbalance of the %s %.3f, now about %.3f (cut in %.3g s)",
                         timed ? "work" : "particles", imbalance, then, WorkClock::wall() - start);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// moved: particles of all ranks that changed theirs.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::migrate(State_& s, long* moved) {
  PetscFunctionBeginUser;
  std::vector<Leaver> leavers = find_leavers(s, owner_, rank_);
  std::stable_sort(leavers.begin(), leavers.end(),
                   [](const Leaver& a, const Leaver& b) { return a.rank < b.rank; });
  std::vector<int> particles;
  for (const Leaver& leaver : leavers) particles.push_back(leaver.particle);
  const std::vector<char> records = take_particles(s, particles);
  const std::size_t size = record_size(s);
  std::vector<std::vector<char>> out(size_);
  for (std::size_t n = 0; n < leavers.size(); ++n)
    out[leavers[n].rank].insert(out[leavers[n].rank].end(), records.begin() + n * size,
                                records.begin() + (n + 1) * size);
  std::vector<char> in;
  PetscCall(exchange_records(comm_, size, out, &in));
  add_particles(s, in);
  long own = static_cast<long>(leavers.size());
  PetscCallMPI(MPI_Allreduce(&own, moved, 1, MPI_LONG, MPI_SUM, comm_));
  if (s.interfaces.in_use()) PetscCall(borrow_patches(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Finds the patches that hold soil on any rank (occupied_). A patch with soil of one velocity field counts
/// as occupied by another field that reaches its nodes: its rank takes part in the sums of both.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::borrow_patches(State_& s) {
  PetscFunctionBeginUser;
  std::vector<std::uint8_t> occupied = occupied_by_field(s);
  PetscCall(share_marks(comm_, &occupied));
  const long count = grid_.count();
  std::vector<int> own;
  occupied_ = occupied;
  for (long patch = 0; patch < count; ++patch)
    for (int field = 0; field < grid_.fields; ++field) {
      const long n = field * count + patch;
      bool met = false, near = false;
      for (int other = 0; other < grid_.fields; ++other) met |= occupied[other * count + patch] != 0;
      if (!met || occupied[n] != 0) continue;
      grid_.for_each_around(n, [&](long at, const std::array<int, 3>&) { near |= occupied[at] != 0; });
      if (!near) continue;
      occupied_[n] = 1;
      if (owners_[patch] == rank_) own.push_back(static_cast<int>(n));
    }
  s.interfaces.borrowed = decltype(s.interfaces.borrowed)("mpm::borrowed", own.size());
  fill(s.interfaces.borrowed, own);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::make_lists(State_& s) {
  PetscFunctionBeginUser;
  const auto number = mirror_of(s.patches.number, s.patches.slots);
  const int holding = s.soil.bins.last_active;
  const auto held = mirror_of(s.soil.bins.active_slots, holding);
  const std::vector<long> slots(number.data(), number.data() + s.patches.slots);
  if (!s.interfaces.in_use()) {  // else borrow_patches has found them
    occupied_.assign(grid_.fields * grid_.count(), 0);
    for (int n = 0; n < holding; ++n) occupied_[slots[held(n)]] = 1;
    PetscCall(share_marks(comm_, &occupied_));
  }
  const HaloPlan plan = plan_halo(grid_, owners_, occupied_, slots, rank_);
  lists_.sent = static_cast<int>(plan.node.size());
  lists_.shared = static_cast<int>(plan.shared.size());
  neighbours_ = static_cast<int>(plan.neighbours.size());
  fill(lists_.node, plan.node);
  fill(lists_.shared_node, plan.shared);
  fill(lists_.begin, plan.first);
  fill(lists_.source, plan.source);
  ensure(s.owned_nodes,
         std::max<std::size_t>(plan.owned_nodes.size(), 1));  // of extent 0 it would mean one rank
  fill(s.owned_nodes, plan.owned_nodes);

  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &s.contact.near.widest, 1, MPI_INT, MPI_MAX, comm_));
  int width = SoilTerms<Dim>::size + BoundaryTerms<Dim>::size;
  if (s.at_sites.in_use)
    for (const SiteField field : {SiteField::gaps, SiteField::counts, SiteField::momentum, SiteField::kept})
      width = std::max(width, SitePasses<Space, T, Dim>{s, 1, s.control}.width(field));
  PetscCall(transport_.set_up(plan.neighbours, plan.begin, width));
  s.plan = plan_step(s);
  if (overlaps(s)) s.plan.form = StepForm::overlapped;
  if (overlaps(s)) put_border_first(s, std::vector<int>(held.data(), held.data() + holding), plan.border);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Orders the slots that hold particles, `held`, so that those on the border (HaloPlan) come first.
template <class Space, class T, int Dim>
void Decomposition<Space, T, Dim>::put_border_first(State_& s, std::vector<int> held,
                                                    const std::vector<char>& border) {
  const auto inner =
      std::stable_partition(held.begin(), held.end(), [&](int slot) { return border[slot] != 0; });
  s.soil.bins.border = static_cast<int>(inner - held.begin());
  fill(s.soil.bins.active_slots, held);
}

/// Sends the impulses of the nodes that this rank answered for to all ranks that reach them now.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::exchange_impulses(State_& s, const NodeImpulses<T>& own) {
  PetscFunctionBeginUser;
  const std::size_t numbers = impulse_numbers(s), size = sizeof(long) + numbers * sizeof(T);
  std::vector<std::vector<char>> out(size_);
  for (std::size_t n = 0; n < own.node.size(); ++n) {
    std::set<int> reaching;
    grid_.for_each_around(own.node[n] / Patch<Dim>::cells, [&](long other, const std::array<int, 3>&) {
      if (occupied_[other]) reaching.insert(owners_[grid_.in_first_field(other)]);
    });
    for (const int r : reaching) {
      const char* const node = reinterpret_cast<const char*>(&own.node[n]);
      const char* const value = reinterpret_cast<const char*>(&own.value[n * numbers]);
      out[r].insert(out[r].end(), node, node + sizeof(long));
      out[r].insert(out[r].end(), value, value + numbers * sizeof(T));
    }
  }
  std::vector<char> in;
  PetscCall(exchange_records(comm_, size, out, &in));
  NodeImpulses<T> all;
  for (std::size_t at = 0; at < in.size(); at += size) {
    all.node.push_back(0);
    all.value.resize(all.value.size() + numbers);
    std::copy_n(&in[at], sizeof(long), reinterpret_cast<char*>(&all.node.back()));
    std::copy_n(&in[at + sizeof(long)], numbers * sizeof(T),
                reinterpret_cast<char*>(&*(all.value.end() - numbers)));
  }
  put_impulses(s, all);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Saves the numbers that differ from rank to rank in SavedState::bounds: k_bounds numbers and the impulse of
/// each rigid, of each rank.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::save(SavedState* saved) const {
  PetscFunctionBeginUser;
  const std::optional<BoundReport> report = bound_.pending();
  std::vector<double> own{saved->bound,
                          saved->increment,
                          report ? 1.0 : 0.0,
                          report ? report->bound : 0,
                          report ? report->increment : 0,
                          bound_.sum(),
                          seen_().bound,
                          seen_().increment};
  for (const SavedRigid& rigid : saved->rigids)
    own.insert(own.end(), &rigid[MotionTerms::impulse], &rigid[MotionTerms::impulse] + k_impulse);
  const int width = static_cast<int>(own.size());
  saved->bounds.resize(std::size_t(size_) * width);
  PetscCallMPI(MPI_Allgather(own.data(), width, MPI_DOUBLE, saved->bounds.data(), width, MPI_DOUBLE, comm_));
  // For other numbers of ranks: the largest increments of the steps that have yet to be tested, as one rank
  // sums them, and when the first of them lets lists be rebuilt.
  double late[GlobalBound::k_late] = {report && report->bound > 0 ? report->increment : 0,
                                      seen_().bound > 0 ? seen_().increment : 0, saved->increment};
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, late, GlobalBound::k_late, MPI_DOUBLE, MPI_MAX, comm_));
  saved->increment = late[2];
  saved->bound = bound_.sum();
  saved->due_in = bound_.due_in();
  for (int k = 0; k < GlobalBound::k_late; ++k) {
    saved->bound += late[k];
    const bool due = late[k] > 0 && rebuild_due(saved->bound, late[k], saved->margin, GlobalBound::k_late);
    if (due && saved->due_in == 0) saved->due_in = k + 1;
  }
  for (SavedRigid& rigid : saved->rigids)
    if (!forces_shared_)
      PetscCallMPI(
          MPI_Allreduce(MPI_IN_PLACE, &rigid[MotionTerms::impulse], k_impulse, MPI_DOUBLE, MPI_SUM, comm_));
  saved->owners.assign(owners_.begin(), owners_.end());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The part of a checkpoint that differs from rank to rank: that of this rank, if it is of as many.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::take_own(SavedState& saved) {
  PetscFunctionBeginUser;
  const std::size_t width = k_bounds + k_impulse * saved.rigids.size();
  seen_() = {};
  bound_.set_due_in(saved.due_in);
  const auto sound = [&](long r) { return r >= 0 && r < size_; };
  const bool as_many = saved.bounds.size() == size_ * width && saved.owners.size() == owners_.size() &&
                       std::all_of(saved.owners.begin(), saved.owners.end(), sound);
  if (!as_many) {
    bound_.set_sum(saved.bound - saved.increment);  // which the first step notes
    for (SavedRigid& rigid : saved.rigids)
      if (rank_ > 0 && !forces_shared_)  // rank 0 has those of all
        std::fill_n(&rigid[MotionTerms::impulse], k_impulse, 0.0);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  owners_.assign(saved.owners.begin(), saved.owners.end());
  send_owners_to_device();
  const double* const own = &saved.bounds[rank_ * width];
  saved.bound = own[0], saved.increment = own[1];
  bound_.set_sum(own[5]);
  seen_().bound = own[6], seen_().increment = own[7];
  for (std::size_t r = 0; r < saved.rigids.size(); ++r)
    std::copy_n(own + k_bounds + k_impulse * r, k_impulse, &saved.rigids[r][MotionTerms::impulse]);
  if (own[2] != 0) PetscCall(bound_.post(comm_, {own[3], own[4], 0}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::restore(State_& s, SavedState& saved) {
  PetscFunctionBeginUser;
  long moved = 0;
  PetscCall(take_own(saved));
  reserve_particles(s, std::max(s.soil.points.all, k_least_room));
  PetscCall(migrate(s, &moved));
  list_saved(s);
  PetscCall(make_lists(s));
  present_added_ = false;
  finish_saved(s, saved);
  s.space.fence("mpm::restore");
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                               \
  template PetscErrorCode Decomposition<Space, T, Dim>::save(SavedState*) const;                     \
  template PetscErrorCode Decomposition<Space, T, Dim>::restore(State<Space, T, Dim>&, SavedState&); \
  template PetscErrorCode Decomposition<Space, T, Dim>::rebuild(State<Space, T, Dim>&);              \
  template PetscErrorCode Decomposition<Space, T, Dim>::migrate(State<Space, T, Dim>&, long*);       \
  template PetscErrorCode Decomposition<Space, T, Dim>::make_lists(State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
