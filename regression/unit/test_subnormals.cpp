// Numbers below the smallest normal one, which processors are slow with.

#include <catch2/catch_test_macros.hpp>
#include <limits>

#include "base/spaces.hpp"
#include "base/subnormals.hpp"

namespace {

/// Number of results that are not zero among many products that would be subnormal, and sums with a subnormal
/// term.
template <class Space, class T>
int not_flushed() {
  constexpr T smallest = std::numeric_limits<T>::min(), subnormal = std::numeric_limits<T>::denorm_min();
  const int iterations = 64 * Space().concurrency();
  int found = 0;
  Kokkos::parallel_reduce(
      "test::subnormals", Kokkos::RangePolicy<Space, Kokkos::Schedule<Kokkos::Static>>(0, iterations),
      [=](int, int& sum) {
        const volatile T half = T(0.5), small = smallest, least = subnormal, none = 0;
        const volatile T product = half * small, total = least + none;
        sum += (product != none) + (total != none);
      },
      found);
  return found;
}

template <class Space>
void check_space() {
  INFO(Space::name());
  CHECK(not_flushed<Space, float>() == 0);
  CHECK(not_flushed<Space, double>() == 0);
}

}  // namespace

TEST_CASE("every thread takes subnormal numbers for zero", "[subnormals]") {
  if (!mpm::k_flushes_subnormals) SKIP("this processor cannot flush subnormals");
  check_space<mpm::Processor>();
  check_space<Kokkos::DefaultHostExecutionSpace>();
}
