#pragma once
// The way of nodal values from rank to rank: packed where kernels run, and brought to where they run.

#include <string>
#include <type_traits>

#include "mpm/config.hpp"
#include "parallel/exchange.hpp"
#include "parallel/peer_memory.hpp"
#include "spaces.hpp"

namespace mpm {

/// One exchange after the other: send, start, finish, deliver. Entries are those of HaloPlan, neighbour by
/// neighbour.
template <class Space, class T>
class Transport {
 public:
  /// Finds the path. Collective.
  PetscErrorCode start(MPI_Comm comm, HaloPath wanted);
  /// Room for entries of up to `width` values and who gets which; nothing may be under way. Collective.
  PetscErrorCode set_up(const std::vector<int>& neighbours, const std::vector<int>& begin, int width);

  /// Where kernels put the entries that go out.
  T* out() const { return out_.data(); }
  /// What is packed in `space` goes on its way behind it, as far as a device can send it.
  PetscErrorCode send(const Space& space, int width);
  /// After the fence of that space: what the host does for it; start does not wait for others.
  PetscErrorCode start(int width);
  PetscErrorCode finish();
  /// Where the entries are that came in, for kernels of `space` behind this call.
  const T* deliver(const Space& space, int width);

  HaloPath path() const { return path_; }
  /// The path in words, for the log.
  const char* words() const;
  std::size_t memory() const;

 private:
  using Memory = typename Space::memory_space;
  /// Memory that MPI reads: the device's own where that is the host's.
  using Staging = std::conditional_t<is_device<Space>, Kokkos::SharedHostPinnedSpace, Memory>;
  PetscErrorCode choose(HaloPath wanted);
  PetscErrorCode send_to_peers(const Space& space, int width);
  T* half_of(char* memory) const;
  std::size_t entries() const { return begin_.empty() ? 0 : begin_.back(); }
  bool staged() const { return is_device<Space> && path_ == HaloPath::host; }

  MPI_Comm comm_ = MPI_COMM_NULL;
  HaloPath path_ = HaloPath::host;
  std::vector<int> neighbours_, begin_;
  NodeExchange exchange_;
  PeerMemory peers_;
  std::size_t half_ = 0;  // values of one of the two halves of a peer's memory, which messages take in turn
  long number_ = 0;       // of the last message
  Kokkos::View<T*, Memory> out_, in_;
  Kokkos::View<T*, Staging> host_out_, host_in_;  // the same where MPI reads and writes them
};

}  // namespace mpm
