#include "device/device_agrees.hpp"

#include "base/copy.hpp"

namespace mpm {

template <class Space>
bool device_agrees(const Space& space) {
  using Memory = typename Space::memory_space;
  constexpr int count = 37;
  const Kokkos::View<int* [3], Kokkos::LayoutRight, Memory> first("mpm::first", count);
  const Kokkos::View<double*, Memory> second("mpm::second", count);
  Kokkos::parallel_for(
      "mpm::device_agrees", Kokkos::RangePolicy<Space>(space, 0, count), KOKKOS_LAMBDA(int n) {
        for (int k = 0; k < static_cast<int>(first.extent(1)); ++k) first(n, k) = n + k;
        second(n) = static_cast<double>(second.extent(0)) + n;
      });
  const auto a = mirror_of(first);
  const auto b = mirror_of(second);
  bool agrees = true;
  for (int n = 0; n < count; ++n)
    for (int k = 0; k < 3; ++k) agrees = agrees && a(n, k) == n + k && b(n) == count + n;
  return agrees;
}

template bool device_agrees(const Processor&);
#ifdef KOKKOS_ENABLE_CUDA
template bool device_agrees(const Kokkos::Cuda&);
#endif

}  // namespace mpm
