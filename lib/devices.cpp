// Kokkos up and down, with a GPU or without.

#include "mpm/devices.hpp"

#include <mpi.h>
#include <sched.h>
#include <unistd.h>

#include <Kokkos_Core.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "base/subnormals.hpp"
#include "check/gpu.hpp"
#include "input/deck/launch.hpp"

#ifdef KOKKOS_ENABLE_CUDA
#define KOKKOS_IMPL_PUBLIC_INCLUDE  // the header refuses others than Kokkos' own
#include <impl/Kokkos_ExecSpaceManager.hpp>
#undef KOKKOS_IMPL_PUBLIC_INCLUDE
#endif

namespace mpm {
namespace {

#ifdef KOKKOS_ENABLE_CUDA
/// Stands for the CUDA back end where there is no GPU.
struct NoDevice : Kokkos::Impl::ExecSpaceBase {
  void initialize(const Kokkos::InitializationSettings&) override {}
  void finalize() override {}
  void static_fence(const std::string&) override {}
  void print_configuration(std::ostream&, bool) override {}
};

/// Kokkos::initialize starts every back end that it was built with, and CUDA's aborts without a GPU. Kokkos
/// has no setting that leaves one out, so its entry in the list of back ends is replaced.
void leave_cuda_out() {
  constexpr const char* k_entry = "150_Cuda";
  Kokkos::Impl::ExecSpaceManager::get_instance().register_space_factory(k_entry,
                                                                        std::make_unique<NoDevice>());
}
#endif

/// Divides a node among its ranks where the user has not chosen: a device each, in turn (--kokkos-device-id,
/// KOKKOS_DEVICE_ID), and a part of the cores (OMP_NUM_THREADS, KOKKOS_NUM_THREADS). One rank prints the
/// warnings of Kokkos for all of them.
void share_node() {
  MPI_Comm node = MPI_COMM_NULL;
  int world = 0, rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &world);
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  MPI_Comm_rank(node, &rank);
  MPI_Comm_size(node, &size);
  MPI_Comm_free(&node);
  const int devices = gpu_count();
  if (devices > 0) setenv("KOKKOS_DEVICE_ID", std::to_string(rank % devices).c_str(), 0);
  cpu_set_t mine;
  const int usable = sched_getaffinity(0, sizeof mine, &mine) == 0 ? CPU_COUNT(&mine) : 1;
  const int part = std::max(1, static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN)) / size);
  if (size > 1 && std::getenv("OMP_NUM_THREADS") == nullptr)
    setenv("KOKKOS_NUM_THREADS", std::to_string(std::min(usable, part)).c_str(), 0);
  if (world > 0) setenv("KOKKOS_DISABLE_WARNINGS", "1", 0);
}

/// Kokkos::initialize ends the program itself after --kokkos-help; to MPI this must not look like a failure.
void start_kokkos(int* argc, char** argv) {
  static bool starts = false;
  std::atexit([] {
    if (starts) MPI_Finalize();
  });
  starts = true;
  Kokkos::initialize(*argc, argv);
  starts = false;
}

/// Whether Kokkos can start with the settings of every process; the first process for which it cannot prints
/// the reason.
bool can_launch(int argc, char** argv) {
  const auto faults = launch_faults(argc, argv, gpu_count());
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  int first = faults.empty() ? size : rank;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  if (first == rank)
    for (const auto& fault : faults) std::fprintf(stderr, "%s\n", fault.c_str());
  return first == size;
}

}  // namespace

bool start_devices(int* argc, char** argv) {
  setenv("OMP_PROC_BIND", "false", 0);  // what an unset variable means; Kokkos would warn of it
  flush_subnormals();
  share_node();
  if (!can_launch(*argc, argv)) return false;
#ifdef KOKKOS_ENABLE_CUDA
  if (gpu_count() == 0) leave_cuda_out();
#endif
  start_kokkos(argc, argv);
  return true;
}

void end_devices() { Kokkos::finalize(); }

}  // namespace mpm
