#include "grid_velocity.hpp"

#include "particle_to_node.hpp"

namespace mpm {

template <class Space, class T, int Dim>
double fastest_node(const State<Space, T, Dim>& s) {
  using S = SoilShare<Dim>;
  const auto soil = s.nodes.soil;
  const double cut = s.mass_cut;
  double fastest = 0;
  Kokkos::parallel_reduce(
      "mpm::fastest_node", Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()),
      KOKKOS_LAMBDA(int i, double& largest) {
        const double m_i = soil(i, S::mass);
        if (!(m_i > cut)) return;
        double square = 0;
        for (int d = 0; d < Dim; ++d) {
          const double v = soil(i, S::momentum + d) / m_i;
          square += v * v;
        }
        largest = Kokkos::fmax(largest, Kokkos::sqrt(square));
      },
      Kokkos::Max<double>(fastest));
  return Kokkos::fmax(fastest, 0.0);
}

template <class Space, class T, int Dim>
std::vector<double> grid_velocities(const State<Space, T, Dim>& s) {
  using S = SoilShare<Dim>;
  const auto points = s.soil.points;
  const auto soil = s.nodes.soil;
  const auto around = s.patches.around;
  const Kokkos::View<double*, typename Space::memory_space> velocity("mpm::grid_velocity",
                                                                     std::size_t(points.count) * Dim);
  Kokkos::parallel_for(
      "mpm::grid_velocities", Kokkos::RangePolicy<Space>(s.space, 0, points.count), KOKKOS_LAMBDA(int p) {
        const std::size_t to = std::size_t(points.id(p)) * Dim;
        with_weights(points.coordinate(p), points.bodies(points.body(p)).half_length,
                     [&](const AxisWeights<T>(&a)[Dim]) {
                       const Stencil<Dim> stencil(points.cell(p), a);
                       for_each_weight(a, [&](const Vector<int, Dim>& k, T w, const Vector<T, Dim>&) {
                         if (!(w > 0)) return;
                         const int i = stencil.node(around, k);
                         const double m_i = soil(i, S::mass);
                         if (!(m_i > 0)) return;  // a share too small for T
                         for (int d = 0; d < Dim; ++d)
                           velocity(to + d) += w * (soil(i, S::momentum + d) / m_i);
                       });
                     });
      });
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), velocity);
  return {host.data(), host.data() + host.extent(0)};
}

#define MPM_INSTANTIATE(Space, T, Dim)                       \
  template double fastest_node(const State<Space, T, Dim>&); \
  template std::vector<double> grid_velocities(const State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
