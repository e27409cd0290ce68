#include "parallel/peer_memory.hpp"

#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <new>
#include <thread>

#include "base/spaces.hpp"
#include "common/collectives.hpp"

namespace mpm {
namespace {

#ifdef KOKKOS_ENABLE_CUDA
constexpr std::size_t k_handle = sizeof(cudaIpcMemHandle_t);
#else
constexpr std::size_t k_handle = 1;
#endif

/// Shared memory of the host, each rank's part by its rank, at the beginning of a line of the caches. MPI
/// promises no such place; pages begin at one in every process, so all find the same.
template <class T>
PetscErrorCode share_window(MPI_Comm comm, std::size_t own, MPI_Win* window, std::vector<T*>* parts) {
  PetscFunctionBeginUser;
  constexpr std::uintptr_t k_line = 64;
  void* start = nullptr;
  PetscCallMPI(
      MPI_Win_allocate_shared(static_cast<MPI_Aint>(own + k_line), 1, MPI_INFO_NULL, comm, &start, window));
  parts->assign(size_of(comm), nullptr);
  for (int r = 0; r < size_of(comm); ++r) {
    MPI_Aint bytes = 0;
    int unit = 0;
    PetscCallMPI(MPI_Win_shared_query(*window, r, &bytes, &unit, &start));
    (*parts)[r] =
        reinterpret_cast<T*>((reinterpret_cast<std::uintptr_t>(start) + k_line - 1) / k_line * k_line);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Whether all ranks come here within some seconds. A rank that failed alone does, and the others do not.
bool all_come(MPI_Comm comm) {
  constexpr int k_patience = 2000;  // ms
  MPI_Request all = MPI_REQUEST_NULL;
  int here = 0;
  MPI_Ibarrier(comm, &all);
  for (int n = 0; n < k_patience && !here; ++n) {
    MPI_Test(&all, &here, MPI_STATUS_IGNORE);
    if (!here) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return here != 0;
}

}  // namespace

PeerMemory::~PeerMemory() {
  int over = 0;
  MPI_Finalized(&over);
  if (!over && comm_ != MPI_COMM_NULL && all_come(comm_)) (void)close();
}

PetscErrorCode PeerMemory::start(MPI_Comm comm, bool device, bool* possible) {
  PetscFunctionBeginUser;
  MPI_Comm node = MPI_COMM_NULL;
  PetscCallMPI(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node));
  int fits = size_of(node) == size_of(comm);
  PetscCallMPI(MPI_Comm_free(&node));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &fits, 1, MPI_INT, MPI_MIN, comm));
  *possible = fits != 0;
  if (!*possible) PetscFunctionReturn(PETSC_SUCCESS);

  comm_ = comm, device_ = device;
  rank_ = rank_of(comm), ranks_ = size_of(comm);
  PetscCall(share_window(comm, ranks_ * sizeof(Word), &words_, &notices_));
  for (int r = 0; r < ranks_; ++r) new (&notices_[rank_][r]) Word{0};
  PetscCall(ensure(1));
  char* next = nullptr;
  PetscCall(of((rank_ + 1) % ranks_, &next));
  fits = !failed_ && next != nullptr;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &fits, 1, MPI_INT, MPI_MIN, comm));
  *possible = fits != 0;
  if (!*possible) PetscCall(close());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PeerMemory::ensure(std::size_t bytes) {
  constexpr std::size_t k_block = std::size_t(1)
                                  << 21;  // what CUDA hands out whole: a handle is of its start
  PetscFunctionBeginUser;
  unsigned long wanted = bytes;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &wanted, 1, MPI_UNSIGNED_LONG, MPI_MAX, comm_));
  if (wanted <= bytes_) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(close_memory());
  PetscCall(allocate((wanted + wanted / 4 + k_block - 1) / k_block * k_block));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PeerMemory::allocate(std::size_t bytes) {
  PetscFunctionBeginUser;
  bytes_ = bytes;
  if (device_) {
    peers_.assign(ranks_, nullptr);
    PetscCall(allocate_on_device());
  } else {
    PetscCall(share_window(comm_, bytes, &memory_, &peers_));
    own_ = peers_[rank_];
  }
  peers_[rank_] = own_;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PeerMemory::allocate_on_device() {
  PetscFunctionBeginUser;
  std::vector<char> own(k_handle);
#ifdef KOKKOS_ENABLE_CUDA
  void* memory = nullptr;
  cudaIpcMemHandle_t handle{};
  failed_ = failed_ || cudaMalloc(&memory, bytes_) != cudaSuccess;
  failed_ = failed_ || cudaIpcGetMemHandle(&handle, memory) != cudaSuccess;
  own_ = static_cast<char*>(memory);
  std::copy_n(reinterpret_cast<const char*>(&handle), k_handle, own.begin());
#endif
  handles_.resize(ranks_ * k_handle);
  PetscCallMPI(MPI_Allgather(own.data(), k_handle, MPI_BYTE, handles_.data(), k_handle, MPI_BYTE, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PeerMemory::open([[maybe_unused]] int rank) {
  PetscFunctionBeginUser;
#ifdef KOKKOS_ENABLE_CUDA
  cudaIpcMemHandle_t handle;
  std::copy_n(&handles_[rank * k_handle], k_handle, reinterpret_cast<char*>(&handle));
  void* memory = nullptr;
  if (failed_ || cudaIpcOpenMemHandle(&memory, handle, cudaIpcMemLazyEnablePeerAccess) != cudaSuccess) {
    (void)cudaGetLastError();  // it must not be found by the next kernel
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  peers_[rank] = static_cast<char*>(memory);
#endif
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PeerMemory::of(int rank, char** memory) {
  PetscFunctionBeginUser;
  if (peers_[rank] == nullptr) PetscCall(open(rank));
  *memory = peers_[rank];
  PetscFunctionReturn(PETSC_SUCCESS);
}

void PeerMemory::notify(int rank, long number) {
  notices_[rank][rank_].number.store(number, std::memory_order_release);
}

void PeerMemory::wait_for(int rank, long number) const {
  constexpr int k_spins = 2000;  // before others may have the core
  for (int n = 0; notices_[rank_][rank].number.load(std::memory_order_acquire) < number; ++n)
    if (n > k_spins) sched_yield();
}

/// Closes the memory of other ranks first, as CUDA requires.
PetscErrorCode PeerMemory::close_memory() {
  PetscFunctionBeginUser;
#ifdef KOKKOS_ENABLE_CUDA
  for (int r = 0; r < static_cast<int>(peers_.size()) && device_; ++r)
    if (r != rank_ && peers_[r] != nullptr) (void)cudaIpcCloseMemHandle(peers_[r]);
  if (device_ && bytes_ > 0) PetscCallMPI(MPI_Barrier(comm_));
  if (device_ && own_ != nullptr) (void)cudaFree(own_);
#endif
  if (memory_ != MPI_WIN_NULL) PetscCallMPI(MPI_Win_free(&memory_));
  peers_.clear();
  own_ = nullptr;
  bytes_ = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode PeerMemory::close() {
  PetscFunctionBeginUser;
  PetscCall(close_memory());
  if (words_ != MPI_WIN_NULL) PetscCallMPI(MPI_Win_free(&words_));
  comm_ = MPI_COMM_NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
