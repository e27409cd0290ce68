#pragma once
// A rank of several: the patches that it owns, the halo exchange of a step, and the migration of particles
// and patches at a rebuild. A run on one rank has no Decomposition.

#include <petscsys.h>

#include <string>
#include <utility>

#include "data/saved_state.hpp"
#include "data/state.hpp"
#include "device/stream_event.hpp"
#include "functions/halo.hpp"
#include "functions/node_impulses.hpp"
#include "mpm/config.hpp"
#include "parallel/global_bound.hpp"
#include "parallel/halo_plan.hpp"
#include "parallel/transport.hpp"
#include "parallel/work_clock.hpp"
#include "rebuild/migrate.hpp"

namespace mpm {

/// Least number of particles that a rank has room for, so that every field has its views.
inline constexpr int k_least_room = 16;

/// The figures of a rank at the end of a run.
struct RankReport {
  double work = 0, halo = 0, wait = 0;  // s: kernels; packing, copying, summing the halo; waiting for ranks
  double held = 0;                      // s, part of the wait in which a device had no other work
  double particles = 0, neighbours = 0, shared_nodes = 0;
  double sent = 0;  // bytes a step
};

/// Time of an exchange: in a step, whose work is timed already, or between two.
enum class When { in_step, between_steps };

template <class Space, class T, int Dim>
class Decomposition {
 public:
  using State_ = State<Space, T, Dim>;

  /// Brings the particles to the ranks that own their patches and makes the lists. After upload. Collective.
  PetscErrorCode start(MPI_Comm comm, const PartitionConfig& config, const Owners& owners, State_& s);

  /// The sum over ranks in function 3: the nodal sums of soil and boundary go to each neighbour in one
  /// message. If the message has been sent ahead, add_soil ends that exchange. Kernels that s.space and
  /// `stream` get after this call see the sums. stream: the stream in which the rigids moved at the end of
  /// the last step.
  PetscErrorCode add_soil(State_& s, const Space& stream);
  PetscErrorCode add_soil(State_& s) { return add_soil(s, s.space); }

  /// Whether the step overlaps the halo exchange: it computes the border patches, whose nodes other ranks
  /// reach too, on their own stream, calls send_ahead, and computes the inner patches while the messages
  /// travel.
  bool overlaps(const State_& s) const;
  /// The two parts of the soil. The border's stream waits for the work that s.space has now.
  Part<Space> border(const State_& s);
  Part<Space> inner(const State_& s) const;
  /// Sends the nodal sums of the border, which kernels have made on its stream.
  PetscErrorCode send_ahead(State_& s);
  /// Kernels that s.space gets after this call see the border's particles as its stream leaves them.
  void join(const State_& s) { border_there_.wait(s.space); }
  /// Whether the border's sums have been sent since the last add_soil.
  bool sent_ahead() const { return ahead_ != Ahead::nothing; }
  /// The sum over ranks of a nodal field. read: by slot, where its nodes are read; null: everywhere.
  template <class Field>
  PetscErrorCode add_field(const State_& s, const Field& field, When when, const int* read = nullptr) {
    return add_values(s, field.data(), static_cast<int>(field.extent(1)), when, read);
  }
  /// Other values of shared nodes: pack(lists, out) writes `width` numbers of each to its entry, and
  /// combine(lists, in) takes those that came in, for which it needs no other order than that of its kernels.
  template <class Pack, class Combine>
  PetscErrorCode exchange_nodes(const State_& s, int width, When when, Pack&& pack, Combine&& combine) {
    PetscFunctionBeginUser;
    if (when == When::between_steps) clock_.go_on();
    PetscCall(send(s.space, width, [&](T* out) { pack(lists_, out); }));
    PetscCall(receive(s.space, width, false));
    const double start = WorkClock::wall();
    combine(lists_, transport_.deliver(s.space, width));
    if (!is_device<Space>) halo_ += WorkClock::wall() - start;
    if (when == When::between_steps) clock_.stop();
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// The sum over ranks of the soil after sum_present_soil, for measures between two steps.
  PetscErrorCode add_present_soil(State_& s);
  /// The sum over ranks of the forces on dynamic rigids.
  PetscErrorCode add_forces(State_& s);
  /// The sum over ranks of the systems of light rigids, which are made on `stream`. open: the solution of
  /// some rigid goes on, on all ranks or on none.
  PetscErrorCode add_light_sums(State_& s, const Space& stream, bool* open);
  /// The movement bound of all ranks some steps ago (GlobalBound::k_late).
  PetscErrorCode look_back(bool* known, BoundReport* all) { return bound_.last_but_one(known, all); }
  /// Call it once a step. Whether a rebuild is due now that was already due in the checkpoint of a restart.
  bool count_down() { return bound_.count_down(); }
  /// Ends the reductions under way.
  PetscErrorCode drain() { return bound_.drain(); }
  /// Drops the sums of the next step that are on their way or there: it makes them anew.
  void drop_ahead();

  /// The parts of a checkpoint that are not in the ranks' states: owners, and the movement bounds of all
  /// ranks. Collective.
  PetscErrorCode save(SavedState* saved) const;
  /// Call it after take_saved. Brings the points to their owners, makes the lists, and restores the rest of
  /// the state. The owners are those of the checkpoint if it has as many ranks. `saved` becomes this rank's
  /// part. Collective.
  PetscErrorCode restore(State_& s, SavedState& saved);

  /// Call it after locate. Brings patches and particles to their owners, sorts, and makes the lists.
  /// Collective.
  PetscErrorCode rebuild(State_& s);

  MPI_Comm comm() const { return comm_; }
  const Owners& owners() const { return owners_; }
  /// Whether the rigids' impulses are sums over all ranks already.
  bool forces_shared() const { return forces_shared_; }
  /// Whether State::rigid_force is what this rank answers for: its own part, or on rank 0 that of all.
  bool counts_forces() const { return !forces_shared_ || rank_ == 0; }
  WorkClock& clock() { return clock_; }
  /// The path of halo messages, in words.
  std::string halo_words(const State_& s) const;
  RankReport report(const State_& s) const;
  std::size_t memory() const;
  /// Lines for the log since the last call; empty where there are none.
  std::string drain_log() { return std::exchange(log_lines_, {}); }

 private:
  using Memory = typename Space::memory_space;
  /// The sum over ranks of numbers that are made on the stream `from`, for the stream `to`. last: the last of
  /// the sums.
  PetscErrorCode add_numbers(const Kokkos::View<double*, Memory>& numbers, const Space& from, const Space& to,
                             double* last = nullptr);
  /// Memory of the host that a device writes to.
  using Staging = std::conditional_t<is_device<Space>, Kokkos::SharedHostPinnedSpace, Memory>;
  /// Fields that travel together, next to each other in an entry.
  struct Fields {
    HaloField<T> of[2];
    int count = 0, width = 0;
    void add(T* values, int size, const int* read = nullptr) {
      of[count++] = {values, size, width, read};
      width += size;
    }
  };
  enum class Ahead { nothing, under_way, added };  // of the ghost sums that were sent ahead

  Fields soil_fields(const State_& s, bool soil, bool boundary) const;
  PetscErrorCode send(const Space& space, const Fields& fields);
  /// Sends entries of `width` numbers that pack(out) writes, as far as the device can do so on the same
  /// stream; a processor sends them at once.
  template <class Pack>
  PetscErrorCode send(const Space& space, int width, Pack&& pack) {
    PetscFunctionBeginUser;
    const double start = WorkClock::wall();
    pack(transport_.out());
    PetscCall(transport_.send(space, width));
    if (!is_device<Space>) halo_ += WorkClock::wall() - start;
    if (!is_device<Space>) PetscCall(transport_.start(width));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /// Waits until the entries of the neighbours have come in.
  PetscErrorCode receive(const Space& space, int width, bool with_bound);
  PetscErrorCode exchange(int width, bool with_bound);
  void sum(const Space& space, const Fields& fields);
  PetscErrorCode add(const Space& space, const Fields& fields, bool with_bound);
  PetscErrorCode add_values(const State_& s, T* values, int size, When when, const int* read);
  PetscErrorCode end_ahead(const State_& s, const Space& stream, bool with_bound);
  /// Forgets reports and messages of the steps before a rebuild.
  PetscErrorCode forget();
  bool measures() const { return exchanges_ % k_measured_each == 0; }
  void measure_ahead();
  PetscErrorCode post_bound();
  void note_bound(const State_& s, const Space& stream);
  void put_border_first(State_& s, std::vector<int> held, const std::vector<char>& border);
  PetscErrorCode take_own(SavedState& saved);
  PetscErrorCode rebalance(State_& s);
  PetscErrorCode choose_owners(State_& s, const std::vector<double>& figures, double imbalance, bool timed);
  PetscErrorCode migrate(State_& s, long* moved);
  PetscErrorCode borrow_patches(State_& s);
  PetscErrorCode make_lists(State_& s);
  PetscErrorCode exchange_impulses(State_& s, const NodeImpulses<T>& own);
  void send_owners_to_device();

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  PartitionConfig config_;
  PatchGrid grid_;
  Owners owners_;
  Kokkos::View<int*, Memory> owner_;
  std::vector<std::uint8_t> occupied_;  // by patch, on all ranks together

  HaloLists<Space> lists_;
  Transport<Space, T> transport_;
  int neighbours_ = 0;
  SideStream<Space> side_;  // of the border's kernels and of the halo
  Ahead ahead_ = Ahead::nothing;
  Fields on_their_way_;
  using Event = StreamEvent<Space>;
  Event nodes_there_, border_there_, added_;
  Event packing_{Event::timed}, packed_{Event::timed}, idle_{Event::timed}, adding_{Event::timed},
      over_{Event::timed};  // of one exchange in k_measured_each
  static constexpr int k_measured_each = 8;
  long exchanges_ = 0;  // that were sent ahead
  Kokkos::View<Control, Staging> seen_;
  GlobalBound bound_;
  bool present_added_ = false;  // nodes.soil and its boundary hold the sums over ranks of the soil as it is
  bool forces_shared_ = false;

  WorkClock clock_;
  double halo_ = 0;     // s, packing and summing ghost sums; on a device where they were sent ahead
  double held_ = 0;     // s, a device's that waited for it
  double futile_ = 0;   // imbalance that a new cut could not mend
  bool timed_ = false;  // the balance has been judged by measured work
  std::string log_lines_;
};

}  // namespace mpm
