#pragma once
// One rank among several: what it owns, what it exchanges in a step, and how particles and patches move
// between ranks at a rebuild. On one rank there is none of it.

#include <petscsys.h>

#include <initializer_list>
#include <string>
#include <utility>

#include "halo.hpp"
#include "migrate.hpp"
#include "mpm/config.hpp"
#include "parallel/exchange.hpp"
#include "parallel/global_bound.hpp"
#include "parallel/halo_plan.hpp"
#include "parallel/work_clock.hpp"
#include "saved_state.hpp"
#include "share_impulse.hpp"

namespace mpm {

/// Particles there is room for at least, so that every field has its views.
inline constexpr int k_least_room = 16;

/// What a rank reports of itself at the end.
struct RankReport {
  double work = 0, halo = 0, wait = 0;  // s: kernels; packing, copying and summing shares; waiting for others
  double particles = 0, neighbours = 0, shared_nodes = 0;
  double sent = 0;  // bytes a step
};

template <class Space, class T, int Dim>
class Ranks {
 public:
  using State_ = State<Space, T, Dim>;

  /// Brings the particles to the ranks that own their patches and makes the lists. After upload. Collective.
  PetscErrorCode start(MPI_Comm comm, const PartitionConfig& config, const Owners& owners, State_& s);

  /// Function 3, the sum over ranks: the shares of soil and boundary, in one message a neighbour.
  PetscErrorCode add_soil(State_& s);
  /// The same of what XPIC interpolates once more.
  PetscErrorCode add_rest(State_& s);
  /// After sum_present_soil: the soil's shares, for what is measured between two steps.
  PetscErrorCode add_present_soil(State_& s);
  /// The forces on rigids that move by them.
  PetscErrorCode add_forces(State_& s);
  /// The movement bound of all ranks as it was some steps ago (GlobalBound::k_late).
  PetscErrorCode look_back(bool* known, BoundReport* all) { return bound_.last_but_one(known, all); }

  /// Ends the reductions under way.
  PetscErrorCode drain() { return bound_.drain(); }

  /// What a checkpoint needs of the ranks beside their states: owners, and the movement bounds of all ranks.
  /// Collective.
  PetscErrorCode save(SavedState* saved) const;
  /// After take_saved: the points to their owners, which are those of the checkpoint if it is of as many
  /// ranks, the lists, and the rest of the state; `saved` becomes this rank's own. Collective.
  PetscErrorCode restore(State_& s, SavedState& saved);

  /// After locate: patches and particles to their owners, order and lists. Collective.
  PetscErrorCode rebuild(State_& s);

  MPI_Comm comm() const { return comm_; }
  const Owners& owners() const { return owners_; }
  /// Whether the rigids' impulses are already those of all ranks.
  bool forces_shared() const { return forces_shared_; }
  WorkClock& clock() { return clock_; }
  RankReport report(const State_& s) const;
  std::size_t memory() const;
  /// What the log should tell since the last call; empty where there is nothing.
  std::string take_news() { return std::exchange(news_, {}); }

 private:
  using Memory = typename Space::memory_space;
  /// Memory that MPI reads: the device's own where that is the host's.
  using Staging = std::conditional_t<is_device<Space>, Kokkos::SharedHostPinnedSpace, Memory>;

  PetscErrorCode add(State_& s, std::initializer_list<HaloField<T>> fields, int width, bool with_bound);
  PetscErrorCode take_own(SavedState& saved);
  PetscErrorCode rebalance(State_& s);
  PetscErrorCode choose_owners(State_& s, const std::vector<double>& figures, double imbalance, bool timed);
  PetscErrorCode migrate(State_& s, long* moved);
  PetscErrorCode make_lists(State_& s);
  PetscErrorCode share_impulses(State_& s, const NodeImpulses<T>& own);
  void send_owners_to_device();

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  PartitionConfig config_;
  PatchGrid grid_;
  Owners owners_;
  Kokkos::View<int*, Memory> owner_;
  std::vector<std::uint8_t> occupied_;  // by patch, on all ranks together

  HaloLists<Space> lists_;
  NodeExchange exchange_;
  int neighbours_ = 0;
  Kokkos::View<T*, Memory> out_, in_;             // entries, neighbour by neighbour
  Kokkos::View<T*, Staging> host_out_, host_in_;  // the same where MPI reads and writes them
  Kokkos::View<Control, Staging> seen_;
  GlobalBound bound_;
  bool present_added_ = false;  // nodes.soil holds the sums over ranks of the soil as it is
  bool forces_shared_ = false;

  WorkClock clock_;
  double halo_ = 0;    // s, packing and summing shares, where that can be seen: on the host
  double futile_ = 0;  // imbalance that a new cut could not mend
  std::string news_;
};

}  // namespace mpm
