#pragma once
// Memory that the other ranks of the node write into: of a GPU by CUDA's inter-process handles, of the host
// by MPI's shared windows.

#include <petscsys.h>

#include <atomic>
#include <vector>

namespace mpm {

class PeerMemory {
 public:
  PeerMemory() = default;
  PeerMemory(const PeerMemory&) = delete;
  PeerMemory& operator=(const PeerMemory&) = delete;
  ~PeerMemory();

  /// Tries whether the ranks of comm can reach each other's memory, that of their devices if `device`.
  /// Collective.
  PetscErrorCode start(MPI_Comm comm, bool device, bool* possible);
  /// At least `bytes` on each rank; the content is lost when it grows. Nobody may be using it. Collective.
  PetscErrorCode ensure(std::size_t bytes);
  /// This rank's memory, and that of another one as this one sees it.
  char* own() const { return own_; }
  PetscErrorCode of(int rank, char** memory);

  /// Reports to `rank` that its messages from this rank are complete up to message `number`.
  void notify(int rank, long number);
  /// Waits until `rank` has reported it.
  void wait_for(int rank, long number) const;

 private:
  /// A word of its own line of the cache.
  struct alignas(64) Word {
    std::atomic<long> number;
  };
  /// Collective.
  PetscErrorCode close();
  PetscErrorCode close_memory();
  PetscErrorCode allocate(std::size_t bytes);
  PetscErrorCode allocate_on_device();
  PetscErrorCode open(int rank);

  MPI_Comm comm_ = MPI_COMM_NULL;
  int rank_ = 0, ranks_ = 1;
  bool device_ = false, failed_ = false;
  std::size_t bytes_ = 0;
  char* own_ = nullptr;
  std::vector<char*> peers_;   // by rank; null until it is asked for
  std::vector<char> handles_;  // of a device's memory, by rank
  MPI_Win memory_ = MPI_WIN_NULL, words_ = MPI_WIN_NULL;
  std::vector<Word*> notices_;  // by rank: the words of that rank, one for each that writes to it
};

}  // namespace mpm
