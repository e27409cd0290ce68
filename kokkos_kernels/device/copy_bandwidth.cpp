#include "device/copy_bandwidth.hpp"

#include <algorithm>

namespace mpm {
namespace {

/// One copy. Each array is read, or written, once.
template <class Space, class View>
void copy_entries(const Space& space, const View& to, const View& from) {
  Kokkos::parallel_for(
      "mpm::copy_bandwidth", Kokkos::RangePolicy<Space, Kokkos::IndexType<long>>(space, 0, from.extent(0)),
      KOKKOS_LAMBDA(long n) { to(n) = from(n); });
}

}  // namespace

template <class Space>
double copy_bandwidth(const Space& space) {
  using View = Kokkos::View<double*, typename Space::memory_space>;
  constexpr std::size_t bytes = std::size_t(is_device<Space> ? 512 : 128) << 20;  // of each array
  constexpr int repeats = 5,
                copies = is_device<Space> ? 16 : 1;  // in a row, as waiting for a device takes time
  double best = 0;
  try {
    const View from("mpm::copied", bytes / sizeof(double)), to("mpm::copy", bytes / sizeof(double));
    for (int n = 0; n <= repeats; ++n) {
      space.fence("mpm::before the copies");
      const Kokkos::Timer timer;
      for (int k = 0; k < copies; ++k) copy_entries(space, to, from);
      space.fence("mpm::after the copies");
      if (n > 0) best = std::max(best, copies * 2.0 * bytes / timer.seconds());  // the first time warms up
    }
  } catch (const std::exception&) {
    return 0;
  }
  return best;
}

template double copy_bandwidth(const Processor&);
#ifdef KOKKOS_ENABLE_CUDA
template double copy_bandwidth(const Kokkos::Cuda&);
#endif

}  // namespace mpm
