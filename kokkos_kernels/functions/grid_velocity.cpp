#include "functions/grid_velocity.hpp"

#include <algorithm>
#include <cmath>

#include "base/copy.hpp"
#include "loops/particle_to_node.hpp"

namespace mpm {
namespace {

/// The nodes' velocity at a particle, m/s.
template <class Space, class T, int Dim>
struct GridVelocity {
  Soil<Space, T, Dim> points;
  NodeField<Space, T, SoilTerms<Dim>::size> nodes;
  NodePlaces<Space, T, Dim> places;

  explicit GridVelocity(const Core<Space, T, Dim>& s)
      : points(s.soil.points), nodes(s.nodes.soil), places(s.grid, s.patches) {}

  KOKKOS_INLINE_FUNCTION Vector<double, Dim> operator()(int p) const {
    using S = SoilTerms<Dim>;
    Vector<double, Dim> v = filled<double, Dim>(0);
    with_any_domain(points, p, [&](const auto& domain) {
      for_each_node<Kind::motion>(points, domain, places, p,
                                  [&](int i, T w, const auto&, auto&&, auto&& sign) {
                                    const double m_i = nodes(i, S::mass);
                                    if (!(m_i > 0)) return;  // a mass too small for T
                                    for (int d = 0; d < Dim; ++d)
                                      v[d] += w * sign(d) * (nodes(i, S::momentum + d) / m_i);
                                  });
    });
    return v;
  }
};

}  // namespace

template <class Space, class T, int Dim>
double largest_grid_speed(const Core<Space, T, Dim>& s, int body) {
  const GridVelocity<Space, T, Dim> velocity(s);
  const auto body_of = s.soil.points.body;
  double square = 0;
  Kokkos::parallel_reduce(
      "mpm::largest_grid_speed", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
      KOKKOS_LAMBDA(int p, double& largest) {
        if (body_of(p) != body) return;
        const Vector<double, Dim> v = velocity(p);
        largest = Kokkos::fmax(largest, dot(v, v));
      },
      Kokkos::Max<double>(square));
  return std::sqrt(std::max(square, 0.0));
}

template <class Space, class T, int Dim>
std::vector<double> grid_velocities(const Core<Space, T, Dim>& s, const std::vector<int>& order) {
  const GridVelocity<Space, T, Dim> velocity(s);
  const int count = s.soil.points.count;
  const Kokkos::View<Vector<double, Dim>*, typename Space::memory_space> values("mpm::grid_velocity", count);
  Kokkos::parallel_for(
      "mpm::grid_velocities", Kokkos::RangePolicy<Space>(s.space, 0, count),
      KOKKOS_LAMBDA(int p) { values(p) = velocity(p); });
  const auto host = mirror_of(values);
  std::vector<double> out;
  out.reserve(std::size_t(count) * Dim);
  for (const int p : order)
    for (int d = 0; d < Dim; ++d) out.push_back(host(p)[d]);
  return out;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                 \
  template double largest_grid_speed(const Core<Space, T, Dim>&, int); \
  template std::vector<double> grid_velocities(const Core<Space, T, Dim>&, const std::vector<int>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
