#include "functions/velocity_update.hpp"

#include "loops/particle_to_node.hpp"

namespace mpm {

namespace {

template <ParticleDomain domain, class Space, class T, int Dim>
void xpic_pass_for(ContactCore<Space, T, Dim>& s, int pass) {
  using S = SoilTerms<Dim>;
  const auto soil = s.soil.points;
  const NodePlaces places(s.grid, s.patches);
  const auto sums = s.nodes.soil;
  const auto again = s.nodes.residual;
  const auto residual = residual_of(s);
  const auto control = s.control;
  const bool first = pass == 0, last = pass == s.scheme.xpic_order - 1;
  const T xpic = T(1 - s.scheme.flip_fraction);
  Kokkos::parallel_for(
      "mpm::xpic_pass", light(Kokkos::RangePolicy<Space>(s.space, 0, soil.count)), KOKKOS_LAMBDA(int p) {
        if (control().paused) return;
        Vector<T, Dim> r = first ? soil.velocity(p) : residual(p);
        for_each_node<Kind::motion>(soil, domain_of<domain>(soil, p, soil.bodies(soil.body(p))), places, p,
                                    [&](int i, T w, const auto&, auto&&, auto&& sign) {
                                      const T m_i = sums(i, S::mass);
                                      if (!(m_i > 0)) return;  // a mass too small for T
                                      for (int d = 0; d < Dim; ++d)
                                        r[d] -= w * sign(d) *
                                                ((first ? sums(i, S::momentum + d) : again(i, d)) / m_i);
                                    });
        if (last) {
          for (int d = 0; d < Dim; ++d) soil.velocity(p)[d] -= xpic * r[d];
        } else {
          residual(p) = r;
        }
      });
}

template <ParticleDomain domain, class Space, class T, int Dim>
void take_affine_for(ContactCore<Space, T, Dim>& s) {
  const auto soil = s.soil.points;
  const NodePlaces places(s.grid, s.patches);
  const auto kinematics = s.nodes.kinematics;
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::take_affine", light(Kokkos::RangePolicy<Space>(s.space, 0, soil.count)), KOKKOS_LAMBDA(int p) {
        if (control().paused) return;
        Matrix<T, Dim> c{};
        Vector<T, Dim> spread{};  // D_p, diagonal because weights are products that reproduce linear fields
        for_each_node<Kind::motion>(soil, domain_of<domain>(soil, p, soil.bodies(soil.body(p))), places, p,
                                    [&](int i, T w, const auto&, auto&& offset, auto&& sign) {
                                      const Vector<T, Dim> r = offset();
                                      Vector<T, Dim> v;
                                      for (int d = 0; d < Dim; ++d)
                                        v[d] = sign(d) * kinematics(i, NodeKinematics<Dim>::velocity + d);
                                      for (int e = 0; e < Dim; ++e) {
                                        spread[e] += w * r[e] * r[e];
                                        for (int d = 0; d < Dim; ++d) c(d, e) += w * v[d] * r[e];
                                      }
                                    });
        for (int d = 0; d < Dim; ++d)
          for (int e = 0; e < Dim; ++e) c(d, e) /= spread[e];
        soil.affine(p) = c;
      });
}

}  // namespace

template <class Space, class T, int Dim>
void xpic_pass(ContactCore<Space, T, Dim>& s, int pass) {
  with_domain(s.soil.points, [&](auto domain) { xpic_pass_for<domain()>(s, pass); });
}

template <class Space, class T, int Dim>
void take_affine(ContactCore<Space, T, Dim>& s) {
  with_domain(s.soil.points, [&](auto domain) { take_affine_for<domain()>(s); });
}

#define MPM_INSTANTIATE(Space, T, Dim)                       \
  template void xpic_pass(ContactCore<Space, T, Dim>&, int); \
  template void take_affine(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
