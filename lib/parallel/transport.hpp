#pragma once
// Halo messages: nodal values that kernels pack on one rank, and that kernels on another rank read.

#include <string>
#include <type_traits>

#include "base/spaces.hpp"
#include "mpm/config.hpp"
#include "parallel/exchange.hpp"
#include "parallel/peer_memory.hpp"

namespace mpm {

/// An exchange is send, start, finish, deliver; the next exchange begins after it. The entries are those of
/// HaloPlan, neighbour by neighbour.
template <class Space, class T>
class Transport {
 public:
  /// Chooses the path of the messages. Collective.
  PetscErrorCode start(MPI_Comm comm, HaloPath wanted);
  /// Makes room for entries of up to `width` values, and sets which neighbour gets which entries. No exchange
  /// may be under way. Collective.
  PetscErrorCode set_up(const std::vector<int>& neighbours, const std::vector<int>& begin, int width);

  /// The entries to send, where kernels write them.
  T* out() const { return out_.data(); }
  /// Sends the entries that kernels of `space` have packed, as far as a device can send them itself.
  PetscErrorCode send(const Space& space, int width);
  /// The host's part of the message, after a fence of that space. start does not wait for other ranks.
  PetscErrorCode start(int width);
  PetscErrorCode finish();
  /// The entries received, for kernels that `space` gets after this call.
  const T* deliver(const Space& space, int width);

  HaloPath path() const { return path_; }
  /// The path in words, for the log.
  const char* words() const;
  std::size_t memory() const;

 private:
  using Memory = typename Space::memory_space;
  /// Memory that MPI reads; where kernels run on the host, that is their memory.
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
  std::size_t half_ = 0;  // values of a half of a peer's memory; messages use the two halves in turn
  long number_ = 0;       // of the last message
  Kokkos::View<T*, Memory> out_, in_;
  Kokkos::View<T*, Staging> host_out_, host_in_;  // the same entries where MPI reads and writes them
};

}  // namespace mpm
