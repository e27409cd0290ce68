#include "parallel/transport.hpp"

#include <mpi.h>

#include <algorithm>
#if __has_include(<mpi-ext.h>)
#include <mpi-ext.h>
#endif

#include "rebuild/rebuild.hpp"

namespace mpm {
namespace {

template <class T>
MPI_Datatype mpi_type() {
  return sizeof(T) == sizeof(double) ? MPI_DOUBLE : MPI_FLOAT;
}

/// Whether this MPI, as it runs, takes pointers to a device's memory.
bool mpi_takes_device_memory() {
#ifdef MPIX_CUDA_AWARE_SUPPORT
  return MPIX_Query_cuda_support() == 1;
#else
  return false;
#endif
}

/// Copies values from and to memory that kernels of `space` see, behind what it has been given.
template <class Space, class T>
void copy_behind([[maybe_unused]] const Space& space, const T* from, T* to, std::size_t values) {
  if constexpr (is_device<Space>) {
#ifdef KOKKOS_ENABLE_CUDA
    KOKKOS_IMPL_CUDA_SAFE_CALL(
        cudaMemcpyAsync(to, from, values * sizeof(T), cudaMemcpyDefault, space.cuda_stream()));
#endif
  } else {
    std::copy_n(from, values, to);
  }
}

}  // namespace

template <class Space, class T>
PetscErrorCode Transport<Space, T>::start(MPI_Comm comm, HaloPath wanted) {
  PetscFunctionBeginUser;
  comm_ = comm;
  PetscCall(choose(wanted));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// On a device the first that works: MPI from device to device, peers' memory, the host's memory. On a
/// processor the host's, if nothing else is asked for.
template <class Space, class T>
PetscErrorCode Transport<Space, T>::choose(HaloPath wanted) {
  PetscFunctionBeginUser;
  const bool any = wanted == HaloPath::automatic, device = is_device<Space>;
  path_ = HaloPath::host;
  if (wanted == HaloPath::device || (any && device)) {
    int takes = !device || mpi_takes_device_memory();
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &takes, 1, MPI_INT, MPI_MIN, comm_));
    PetscCheck(takes || any, comm_, PETSC_ERR_SUP,
               "-halo_path device needs an MPI that takes device memory, and this one does not; take auto");
    if (takes) path_ = HaloPath::device;
  }
  if (wanted == HaloPath::peer || (any && device && path_ == HaloPath::host)) {
    bool possible = false;
    PetscCall(peers_.start(comm_, device, &possible));
    PetscCheck(possible || any, comm_, PETSC_ERR_SUP,
               "-halo_path peer needs ranks of one node that can reach each other's memory; take auto");
    if (possible) path_ = HaloPath::peer;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T>
PetscErrorCode Transport<Space, T>::set_up(const std::vector<int>& neighbours, const std::vector<int>& begin,
                                           int width) {
  PetscFunctionBeginUser;
  neighbours_ = neighbours, begin_ = begin;
  const std::size_t values = entries() * width;
  ensure(out_, values);
  if (path_ == HaloPath::peer) {
    unsigned long half = values;
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &half, 1, MPI_UNSIGNED_LONG, MPI_MAX, comm_));
    half_ = half;
    PetscCall(peers_.ensure(2 * half_ * sizeof(T)));
  } else {
    ensure(in_, values);
  }
  if (path_ == HaloPath::host) {
    host_out_ = Kokkos::create_mirror_view(Kokkos::WithoutInitializing, Staging(), out_);
    host_in_ = Kokkos::create_mirror_view(Kokkos::WithoutInitializing, Staging(), in_);
  }
  PetscCall(exchange_.set_up(comm_, neighbours, begin, path_ == HaloPath::host));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T>
PetscErrorCode Transport<Space, T>::send(const Space& space, int width) {
  PetscFunctionBeginUser;
  const std::size_t values = entries() * width;
  if (!is_device<Space>) space.fence("mpm::halo is packed");
  if (path_ == HaloPath::peer)
    PetscCall(send_to_peers(space, width));
  else if (staged() && values > 0)
    copy_behind(space, out_.data(), host_out_.data(), values);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// The half of a rank's memory that this message goes to. That of the message before is being read; the one
/// before that has been, by all from whom the message before came.
template <class Space, class T>
T* Transport<Space, T>::half_of(char* memory) const {
  return reinterpret_cast<T*>(memory) + (number_ % 2) * half_;
}

template <class Space, class T>
PetscErrorCode Transport<Space, T>::send_to_peers(const Space& space, int width) {
  PetscFunctionBeginUser;
  ++number_;
  for (std::size_t n = 0; n < neighbours_.size(); ++n) {
    char* memory = nullptr;
    PetscCall(peers_.of(neighbours_[n], &memory));
    PetscCheck(memory != nullptr, PETSC_COMM_SELF, PETSC_ERR_LIB,
               "the memory of rank %d cannot be reached any more; take -halo_path host", neighbours_[n]);
    copy_behind(space, out_.data() + std::size_t(begin_[n]) * width,
                half_of(memory) + std::size_t(exchange_.there()[n]) * width,
                std::size_t(begin_[n + 1] - begin_[n]) * width);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T>
PetscErrorCode Transport<Space, T>::start(int width) {
  PetscFunctionBeginUser;
  if (path_ == HaloPath::peer)
    for (const int rank : neighbours_) peers_.notify(rank, number_);
  else if (path_ == HaloPath::device)
    PetscCall(exchange_.start_messages(mpi_type<T>(), width, out_.data(), in_.data()));
  else
    PetscCall(exchange_.start(mpi_type<T>(), width, host_out_.data(), host_in_.data()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T>
PetscErrorCode Transport<Space, T>::finish() {
  PetscFunctionBeginUser;
  if (path_ == HaloPath::peer)
    for (const int rank : neighbours_) peers_.wait_for(rank, number_);
  else if (path_ == HaloPath::device)
    PetscCall(exchange_.finish_messages());
  else
    PetscCall(exchange_.finish());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T>
const T* Transport<Space, T>::deliver(const Space& space, int width) {
  const std::size_t values = entries() * width;
  if (path_ == HaloPath::peer) return half_of(peers_.own());
  if (staged() && values > 0) copy_behind(space, host_in_.data(), in_.data(), values);
  return in_.data();
}

template <class Space, class T>
const char* Transport<Space, T>::words() const {
  if (path_ == HaloPath::peer)
    return is_device<Space> ? "from device to device by CUDA IPC" : "through memory that the ranks share";
  if (path_ == HaloPath::device)
    return is_device<Space> ? "from device to device by MPI" : "by MPI's messages";
  return is_device<Space> ? "through pinned memory of the host" : "by PetscSF";
}

template <class Space, class T>
std::size_t Transport<Space, T>::memory() const {
  const std::size_t in = path_ == HaloPath::peer ? 2 * half_ : in_.span();
  return (out_.span() + in) * sizeof(T);
}

// Once for both dimensions.
#define MPM_TRANSPORT_2(Space, T) template class Transport<Space, T>;
#define MPM_TRANSPORT_3(Space, T)
#define MPM_INSTANTIATE(Space, T, Dim) MPM_TRANSPORT_##Dim(Space, T)
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
