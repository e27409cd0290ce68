#include "measure.hpp"

namespace mpm {
namespace {

/// The measure as a sum for parallel_reduce.
template <int Dim>
struct Sum {
  BodyMeasure m;
  KOKKOS_INLINE_FUNCTION Sum() : m{} {
    for (int d = 0; d < 3; ++d) {
      m.lower[d] = Kokkos::Experimental::finite_max<double>::value;
      m.upper[d] = -m.lower[d];
    }
  }
  KOKKOS_INLINE_FUNCTION Sum& operator+=(const Sum& other) {
    for (int d = 0; d < Dim; ++d) {
      m.lower[d] = Kokkos::fmin(m.lower[d], other.m.lower[d]);
      m.upper[d] = Kokkos::fmax(m.upper[d], other.m.upper[d]);
      m.momentum[d] += other.m.momentum[d];
    }
    m.kinetic_energy += other.m.kinetic_energy;
    return *this;
  }
};

}  // namespace
}  // namespace mpm

namespace Kokkos {
template <int Dim>
struct reduction_identity<mpm::Sum<Dim>> {
  KOKKOS_FORCEINLINE_FUNCTION static mpm::Sum<Dim> sum() { return {}; }
};
}  // namespace Kokkos

namespace mpm {

template <class Space, class T, int Dim>
BodyMeasure measure(const State<Space, T, Dim>& s, int body) {
  const auto soil = s.soil.points;
  const auto origin = s.patches.origin;
  const double spacing = s.spacing;
  Sum<Dim> total;
  Kokkos::parallel_reduce(
      "mpm::measure", Kokkos::RangePolicy<Space>(s.space, 0, soil.count),
      KOKKOS_LAMBDA(int p, Sum<Dim>& sum) {
        if (soil.body(p) != body) return;
        const Coord<Dim> from = origin(soil.cell(p) / Patch<Dim>::cells), cell = coord_of<Dim>(soil.cell(p));
        const double mass = soil.bodies(body).mass;
        for (int d = 0; d < Dim; ++d) {
          const double x = (double(from[d]) + cell[d] + soil.coordinate(p)[d]) * spacing;
          const double v = soil.velocity(p)[d];
          sum.m.lower[d] = Kokkos::fmin(sum.m.lower[d], x);
          sum.m.upper[d] = Kokkos::fmax(sum.m.upper[d], x);
          sum.m.momentum[d] += mass * v;
          sum.m.kinetic_energy += mass * v * v / 2;
        }
      },
      Kokkos::Sum<Sum<Dim>>(total));
  return total.m;
}

#define MPM_INSTANTIATE(Space, T, Dim) template BodyMeasure measure(const State<Space, T, Dim>&, int);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
