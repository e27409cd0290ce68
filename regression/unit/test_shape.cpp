// Shape functions: what holds at any position of a particle and any half length.

#include <array>
#include <catch2/catch_test_macros.hpp>

#include "clouds.hpp"
#include "physics/shape_gimp.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_half_lengths[] = {1. / 2, 1. / 4, 1. / 8, 1. / 32};

/// Positions of a particle along an axis: random ones, and those where the shape function changes its branch,
/// in cells on both sides of zero; also barely beyond, down to the round-off.
template <class T>
std::vector<T> positions(double l) {
  std::vector<T> x;
  Dice dice{std::mt19937_64(11)};
  for (int n = 0; n < 2000; ++n) x.push_back(static_cast<T>(dice.uniform(-2, 3)));
  for (int cell = -2; cell <= 2; ++cell)
    for (double branch : {0., l, 1 - l, 1 + l, 0.5})
      for (double beyond : {0., 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-14})
        for (int sign : {-1, 1}) x.push_back(static_cast<T>(cell + branch + sign * beyond));
  return x;
}

/// A view with the values of a vector.
template <class Space, class V>
Kokkos::View<V*, typename Space::memory_space> on_device(const std::vector<V>& values) {
  Kokkos::View<V*, typename Space::memory_space> view("test", values.size());
  Kokkos::View<const V*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(values.data(), values.size());
  Kokkos::deep_copy(view, host);
  return view;
}
template <class View>
std::vector<typename View::value_type> from_device(const View& view) {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), view);
  return {host.data(), host.data() + host.extent(0)};
}

template <class T>
struct Axis {
  AxisWeights<T> a;
  T s[3], ds[3];  // of node_weight at the three nodes, and
  T beyond;       // at those next to them
};

/// Weights along an axis at every x, computed on Space.
template <class Space, class T>
std::vector<Axis<T>> axis_on(const std::vector<T>& positions, T l) {
  const auto x = on_device<Space>(positions);
  const Kokkos::View<Axis<T>*, typename Space::memory_space> out("test", positions.size());
  Kokkos::parallel_for(
      "test::axis", Kokkos::RangePolicy<Space>(0, positions.size()), KOKKOS_LAMBDA(int n) {
        Axis<T> axis;
        axis.a = axis_weights(x(n), l);
        for (int k = 0; k < 3; ++k) node_weight(x(n) - (axis.a.first + k), l, axis.s[k], axis.ds[k]);
        T low, high, slope;
        node_weight(x(n) - (axis.a.first - 1), l, low, slope);
        node_weight(x(n) - (axis.a.first + 3), l, high, slope);
        axis.beyond = low + high;
        out(n) = axis;
      });
  return from_device(out);
}

/// Sums over the nodes that a particle reaches.
template <class T, int Dim>
struct Sums {
  T weight, smallest, gradient[Dim], linear[Dim], slope[Dim][Dim];
};
template <class Space, class T, int Dim>
std::vector<Sums<T, Dim>> sums_on(const std::vector<Vector<T, Dim>>& positions, T l) {
  const auto x = on_device<Space>(positions);
  const Kokkos::View<Sums<T, Dim>*, typename Space::memory_space> out("test", positions.size());
  Kokkos::parallel_for(
      "test::sums", Kokkos::RangePolicy<Space>(0, positions.size()), KOKKOS_LAMBDA(int n) {
        Sums<T, Dim> sums{};
        sums.smallest = 1;
        with_weights(x(n), HalfLength<T>(l), [&](const AxisWeights<T>(&a)[Dim]) {
          for_each_weight(a, [&](const Vector<int, Dim>& k, T w, const Vector<T, Dim>& grad) {
            sums.weight += w;
            sums.smallest = Kokkos::fmin(sums.smallest, w);
            for (int d = 0; d < Dim; ++d) {
              sums.gradient[d] += grad[d];
              sums.linear[d] += w * (a[d].first + k[d] - x(n)[d]);
              for (int e = 0; e < Dim; ++e) sums.slope[d][e] += grad[d] * (a[e].first + k[e] - x(n)[e]);
            }
          });
        });
        out(n) = sums;
      });
  return from_device(out);
}

/// S and dS/dx of the formula as it is printed (uGIMP, edge of the cell 1).
void printed_formula(double r, double l, double& s, double& ds) {
  const double a = std::fabs(r), sign = r < 0 ? -1 : 1;
  if (a < l)
    s = 1 - (r * r + l * l) / (2 * l), ds = -r / l;
  else if (a < 1 - l)
    s = 1 - a, ds = -sign;
  else if (a < 1 + l)
    s = (1 + l - a) * (1 + l - a) / (4 * l), ds = -sign * (1 + l - a) / (2 * l);
  else
    s = 0, ds = 0;
}

}  // namespace

TEST_CASE("weights are a partition of unity, reproduce a linear field and are not negative", "[shape]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    using T = typename B::real;
    constexpr int Dim = B::dim;
    const double tolerance = B::of(1e-13, 1e-6);
    for (double l : k_half_lengths) {
      const auto along = positions<T>(l);
      Dice dice{std::mt19937_64(12)};
      std::vector<Vector<T, Dim>> x(8000);
      for (auto& x_p : x)
        for (int d = 0; d < Dim; ++d) x_p[d] = along[dice.below(static_cast<int>(along.size()))];
      double unity = 0, gradient = 0, linear = 0, slope = 0, smallest = 1;
      for (const auto& sums : sums_on<typename B::Space>(x, static_cast<T>(l))) {
        unity = std::max(unity, std::fabs(double(sums.weight) - 1));
        smallest = std::min(smallest, double(sums.smallest));
        for (int d = 0; d < Dim; ++d) {
          gradient = std::max(gradient, std::fabs(double(sums.gradient[d])));
          linear = std::max(linear, std::fabs(double(sums.linear[d])));
          for (int e = 0; e < Dim; ++e)
            slope = std::max(slope, std::fabs(double(sums.slope[d][e]) - (d == e)));
        }
      }
      INFO(build.name() << " half length " << l);
      CHECK(unity < tolerance);
      CHECK(gradient < tolerance);
      CHECK(linear < tolerance);
      CHECK(slope <
            tolerance / (2 * l));  // a gradient divides the round-off of the position by the particle's edge
      CHECK(smallest >= 0);
    }
  });
}

TEST_CASE("weights along an axis equal the weight of each node and the printed formula", "[shape]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    using T = typename B::real;
    const double tolerance = B::of(1e-13, 1e-6);
    for (double l : k_half_lengths) {
      const auto x = positions<T>(l);
      const auto axes = axis_on<typename B::Space>(x, static_cast<T>(l));
      double by_node = 0, slope_by_node = 0, printed = 0, slope_printed = 0, beyond = 0;
      for (std::size_t n = 0; n < x.size(); ++n)
        for (int k = 0; k < 3; ++k) {
          const Axis<T>& axis = axes[n];
          double s, ds;
          printed_formula(double(x[n]) - (axis.a.first + k), l, s, ds);
          by_node = std::max(by_node, std::fabs(double(axis.a.w[k] - axis.s[k])));
          slope_by_node = std::max(slope_by_node, std::fabs(double(axis.a.g[k] - axis.ds[k])));
          printed = std::max(printed, std::fabs(axis.a.w[k] - s));
          slope_printed = std::max(slope_printed, std::fabs(axis.a.g[k] - ds));
          beyond = std::max(beyond, double(axis.beyond));
        }
      INFO(build.name() << " half length " << l);
      CHECK(by_node < tolerance);
      CHECK(printed < tolerance);
      CHECK(slope_by_node < tolerance / (2 * l));
      CHECK(slope_printed < tolerance / (2 * l));
      CHECK(beyond < tolerance);
    }
  });
}

TEST_CASE("an outer node that has a gradient has a weight, however small", "[shape]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    using T = typename B::real;
    for (double l : k_half_lengths) {
      int lost = 0, lost_by_node = 0;
      for (const Axis<T>& axis : axis_on<typename B::Space>(positions<T>(l), static_cast<T>(l)))
        for (int k : {0, 2}) {
          lost += axis.a.g[k] != 0 && !(axis.a.w[k] > 0);
          lost_by_node += axis.ds[k] != 0 && !(axis.s[k] > 0);
        }
      INFO(build.name() << " half length " << l);
      CHECK(lost == 0);
      CHECK(lost_by_node == 0);
    }
  });
}
