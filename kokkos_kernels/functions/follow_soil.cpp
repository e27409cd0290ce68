#include "functions/follow_soil.hpp"

#include "base/small_matrix.hpp"
#include "loops/interpolation.hpp"
#include "physics/stretch_domain.hpp"
#include "rebuild/batches.hpp"

namespace mpm {
namespace {

constexpr double k_least_spread =
    0.01;                             // cells2, of the centres of nodes along each axis; a lattice has 0.06
constexpr double k_least_det = 0.05;  // of I - G: the soil was stretched by less than its inverse

/// Sums of a source over the soil at home, to `out`.
template <class Source, class Space, class T, int Dim>
void sum_at_home(ContactCore<Space, T, Dim>& s, const Source& source,
                 const NodeField<Space, T, Source::size>& out) {
  Kokkos::deep_copy(s.space, out, T(0));
  const auto sum = [&](const Bins<Space>& bins) {
    auto it = interpolation_of(s, bins, source, out, s.space);
    it.adds = true;
    it.control = s.never_paused;  // where a rebuild is due, s.control is paused
    particle_to_node(s.p2g.strategy, it);
  };
  if (!s.batches.in_use()) return sum(s.soil.bins);
  for (const auto& batch : s.batches.all) sum(batch.set.bins);
}

/// Means and second moments, with weights, of where nodes have their soil and of its way [cells].
template <int Dim>
struct WayOfNodes {
  double weight = 0, x[Dim] = {}, u[Dim] = {}, xx[Dim][Dim] = {}, ux[Dim][Dim] = {};

  KOKKOS_INLINE_FUNCTION void add(double w, const double (&at)[Dim], const double (&way)[Dim]) {
    weight += w;
    for (int i = 0; i < Dim; ++i) {
      x[i] += w * at[i], u[i] += w * way[i];
      for (int j = 0; j < Dim; ++j) xx[i][j] += w * at[i] * at[j], ux[i][j] += w * way[i] * at[j];
    }
  }
  /// The deformation gradient; I where the nodes do not determine it.
  KOKKOS_INLINE_FUNCTION void deformation(double (&f)[Dim][Dim]) const {
    double spread[Dim][Dim], inverse[Dim][Dim], back[Dim][Dim];
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        f[i][j] = i == j;
        spread[i][j] = weight > 0 ? (xx[i][j] - x[i] * x[j] / weight) / weight : 0;
      }
    if (!(invert(spread, inverse) > power(k_least_spread, Dim))) return;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        back[i][j] = i == j;
        for (int k = 0; k < Dim; ++k)
          back[i][j] -= (ux[i][k] - u[i] * x[k] / weight) / weight * inverse[k][j];
      }
    if (invert(back, inverse) < k_least_det) return;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) f[i][j] = inverse[i][j];
  }
};

/// F <- (I + c N) F with N = E^2 / tr E^2, E the small strain of F: dilates it by c [-] to first order, along
/// the directions in which the soil was strained.
template <int Dim>
KOKKOS_INLINE_FUNCTION void dilate_along_strain(double (&f)[Dim][Dim], double c) {
  double e[Dim][Dim], n[Dim][Dim], was[Dim][Dim], trace = 0;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) e[i][j] = (f[i][j] + f[j][i]) / 2 - (i == j), was[i][j] = f[i][j];
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      n[i][j] = 0;
      for (int k = 0; k < Dim; ++k) n[i][j] += e[i][k] * e[k][j];
      if (i == j) trace += n[i][j];
    }
  if (!(trace > 0)) return;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      for (int k = 0; k < Dim; ++k) f[i][j] += c / trace * n[i][k] * was[k][j];
}

template <class Space, class T, int Dim>
struct StretchDomains {
  Soil<Space, T, Dim> soil;
  NodePlaces<Space, T, Dim> places;
  NodeField<Space, T, CentreTerms<Dim>::size> centre;
  NodeField<Space, T, Dim> drift;
  decltype(Strays<Space>::alone) alone;

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    if (is_alone(alone, soil.cell(p))) return;
    double f[Dim][Dim];
    look_around(p).deformation(f);
    const double dilatation = double(soil.volume(p)) / double(soil.begun_volume(p));
    dilate_along_strain(f, Kokkos::log(dilatation / determinant(f)));
    const double scale = Kokkos::pow(dilatation / determinant(f), 2.0 / Dim);
    DomainMoments<T, Dim> m = soil.domain(p);
    stretch_domain(m, f, scale);
    soil.domain(p) = m;
    for (int i = 0; i < Dim; ++i)  // half of it once more
      for (int j = 0; j < Dim; ++j) f[i][j] = ((i == j) + f[i][j]) / 2;
    stretch_domain(m, f, Kokkos::sqrt(scale));
    soil.half_length(p) = to_store<Space>(bounded_half_lengths(m, soil.least_half_length));
  }

 private:
  KOKKOS_INLINE_FUNCTION WayOfNodes<Dim> look_around(int p) const {
    using C = CentreTerms<Dim>;
    WayOfNodes<Dim> near;
    const Vector<T, Dim> x = soil.coordinate(p);
    with_weights(x, any_domain_of(soil, p), [&](const auto& a) {
      const Stencil<Kind::motion, T, Dim> stencil(places, soil.cell(p), a);
      for_each_weight(a, [&](const Vector<int, Dim>& k, T w, const auto&) {
        if (!(w > 0)) return;
        const int i = stencil.node(places.neighbours, k);
        const double m_i = centre(i, C::mass);
        if (!(m_i > 0)) return;  // a mass too small for T
        const Vector<T, Dim> to_node = offset_to(x, a, k);
        double at[Dim], way[Dim];
        for (int d = 0; d < Dim; ++d) {
          at[d] = to_node[d] + stencil.normal[d][k[d]] * (centre(i, C::way + d) / m_i);
          way[d] = stencil.sign(k, d) * (drift(i, d) / m_i);
        }
        near.add(w, at, way);
      });
    });
    return near;
  }
};

}  // namespace

template <class Space, class T, int Dim>
void sum_drift(ContactCore<Space, T, Dim>& s) {
  collect_soil(s);
  const auto soil = s.soil.points;
  sum_at_home(s, CentreSource<Space, T, Dim>{soil}, s.nodes.centre);
  Kokkos::parallel_for(
      "mpm::drift", Kokkos::RangePolicy<Space>(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
        for (int d = 0; d < Dim; ++d) soil.begun(p)[d] = soil.coordinate(p)[d] - soil.begun(p)[d];
      });
  sum_at_home(s, VectorSource<Space, T, Dim>{soil, soil.begun, {}, Times::mass}, s.nodes.drift);
}

template <class Space, class T, int Dim>
void stretch_domains(ContactCore<Space, T, Dim>& s) {
  Kokkos::parallel_for(
      "mpm::stretch_domains", light(Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count)),
      StretchDomains<Space, T, Dim>{
          s.soil.points, {s.grid, s.patches}, s.nodes.centre, s.nodes.drift, s.strays.alone});
}

template <class Space, class T, int Dim>
void begin_domains(ContactCore<Space, T, Dim>& s) {
  if (!s.soil.points.has_domain) return;
  const auto soil = s.soil.points;
  Kokkos::parallel_for(
      "mpm::begin_domains", Kokkos::RangePolicy<Space>(s.space, 0, soil.count), KOKKOS_LAMBDA(int p) {
        soil.begun(p) = soil.coordinate(p);
        soil.begun_volume(p) = soil.volume(p);
      });
}

#define MPM_INSTANTIATE(Space, T, Dim)                        \
  template void sum_drift(ContactCore<Space, T, Dim>&);       \
  template void stretch_domains(ContactCore<Space, T, Dim>&); \
  template void begin_domains(ContactCore<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
