#pragma once
// The exact return to Mohr and Coulomb's pyramid with a tension cut-off, in principal stress space: one
// plane, edge or corner of the surface is right, and each is a closed form (Clausen, Damkilde & Andersen
// 2006; de Souza Neto, Peric & Owen 2008, 8.2, with the cut-off beside). With m = k = 1 the pyramid is
// Tresca's prism.

#include <cmath>

#include "physics/materials/principal.hpp"

namespace mpm {

/// Coefficients of the return from the angles and Poisson's ratio. f = k s1 - s3 - sc, flow (m, 0, -1).
template <class T>
struct PyramidShape {
  T k, m;                // (1 + sin) / (1 - sin) of the angles of friction and dilation
  T inv_slopes;          // 1 / (1 + k)
  T steepness;           // largest change of k s1 - s3 with sqrt(J2), 2 sqrt((k^2 + k + 1) / 3)
  T contraction;         // nu / (1 + nu)
  T volume_share;        // (1 - 2 nu) / (1 + nu), 2 G / (3 K)
  T nu, across_cut_off;  // nu, nu / (1 - nu)
  /// Elastic stress of the plastic flow of the plane, over k times the first less the third, and the inverse
  /// of this.
  T plane[3], inv_plane;
  /// s1 on the edges s1 = s2 and s2 = s3: weights of the stresses along and across the edge.
  T edge_12[2], edge_23[2];

  /// Angles by their sines.
  static PyramidShape of(double sin_friction, double sin_dilation, double poisson) {
    const double k = (1 + sin_friction) / (1 - sin_friction), m = (1 + sin_dilation) / (1 - sin_dilation);
    const double h = poisson * (m - 1) / (1 - 2 * poisson), contraction = poisson / (1 + poisson);
    const double w_12 = contraction * (2 + m), w_23 = contraction * (1 + 2 * m);
    const double a[2] = {1 - w_12, m - w_12}, b[2] = {1 - w_23, m - w_23};
    const double plane = k * (m + h) - (h - 1), of_12 = 2 * a[0] + a[1] * k, of_23 = b[0] + 2 * b[1] * k;
    const auto t = [](double x) { return static_cast<T>(x); };
    return {.k = t(k),
            .m = t(m),
            .inv_slopes = t(1 / (1 + k)),
            .steepness = t(2 * std::sqrt((k * k + k + 1) / 3)),
            .contraction = t(contraction),
            .volume_share = t((1 - 2 * poisson) / (1 + poisson)),
            .nu = t(poisson),
            .across_cut_off = t(poisson / (1 - poisson)),
            .plane = {t((m + h) / plane), t(h / plane), t((h - 1) / plane)},
            .inv_plane = t(1 / plane),
            .edge_12 = {t(a[0] / of_12), t(a[1] / of_12)},
            .edge_23 = {t(b[0] / of_23), t(b[1] / of_23)}};
  }
};

/// The surface of one particle, or of those in the lanes of R.
template <class R>
struct PyramidSize {
  R sc;           // Pa, sc = 2 c cos / (1 - sin)
  R cut_off;      // Pa, largest s1
  R low;          // Pa, s3 on the plane where s1 is the cut-off: k cut_off - sc
  bool cuts;      // there is a cut-off
  Truth<R> apex;  // it is at the apex of the pyramid

  /// This surface for stresses from which a mean [Pa] is subtracted.
  KOKKOS_INLINE_FUNCTION PyramidSize without(const R& mean, RealOf<R> k) const {
    return {sc - (k - 1) * mean, cut_off - mean, low - mean, cuts, apex};
  }
};

/// How far principal stresses in descending order are outside of the surface [Pa].
template <class R, class T>
KOKKOS_INLINE_FUNCTION R outside(const PyramidShape<T>& shape, const PyramidSize<R>& size, const R& s1,
                                 const R& s3) {
  const R plane = (shape.k * s1 - s3 - size.sc) * shape.inv_slopes;
  return size.cuts ? Kokkos::fmax(plane, s1 - size.cut_off) : plane;
}

/// The best of the candidates so far: that which violates its conditions least.
template <class R>
struct Candidate {
  R s[3];       // Pa
  R violation;  // Pa

  /// `own`: the largest violation of the conditions of a candidate, beside those that all share.
  template <class T>
  KOKKOS_INLINE_FUNCTION void compare(const PyramidShape<T>& shape, const PyramidSize<R>& size, const R& s1,
                                      const R& s2, const R& s3, const R& own) {
    const R worst =
        Kokkos::fmax(Kokkos::fmax(own, outside(shape, size, s1, s3)), Kokkos::fmax(s2 - s1, s3 - s2));
    const auto better = worst < violation;
    s[0] = select(better, s1, s[0]), s[1] = select(better, s2, s[1]), s[2] = select(better, s3, s[2]);
    violation = select(better, worst, violation);
  }
};

/// Plastic strains of a return from t to s, times E / (1 + nu) [Pa].
template <class R>
struct PlasticStrain {
  R a, b, c;
  KOKKOS_INLINE_FUNCTION PlasticStrain(const R (&t)[3], const R& s1, const R& s2, const R& s3,
                                       RealOf<R> contraction)
      : a(t[0] - s1), b(t[1] - s2), c(t[2] - s3) {
    const R volume = contraction * (a + b + c);
    a -= volume, b -= volume, c -= volume;
  }
};

/// The largest of some numbers, for conditions of the form x <= 0.
template <class R>
KOKKOS_INLINE_FUNCTION R worst_of(const R& a, const R& b) {
  return Kokkos::fmax(a, b);
}
template <class R, class... More>
KOKKOS_INLINE_FUNCTION R worst_of(const R& a, const R& b, const More&... more) {
  return worst_of(Kokkos::fmax(a, b), more...);
}

/// The plane and the two edges of the pyramid.
template <class R, class T>
KOKKOS_INLINE_FUNCTION void compare_pyramid(const PyramidShape<T>& shape, const PyramidSize<R>& size,
                                            const R (&t)[3], Candidate<R>& best) {
  const R over = shape.k * t[0] - t[2] - size.sc;
  best.compare(shape, size, t[0] - over * shape.plane[0], t[1] - over * shape.plane[1],
               t[2] - over * shape.plane[2], -(over * shape.inv_plane));
  {
    const R s1 = shape.edge_12[0] * (t[0] + t[1]) + shape.edge_12[1] * (t[2] + size.sc);
    const R s3 = shape.k * s1 - size.sc;
    const PlasticStrain<R> e(t, s1, s1, s3, shape.contraction);
    best.compare(shape, size, s1, s1, s3, worst_of(-e.a, -e.b));
  }
  {
    const R s1 = shape.edge_23[0] * t[0] + shape.edge_23[1] * (t[1] + t[2] + 2 * size.sc);
    const R s3 = shape.k * s1 - size.sc;
    const PlasticStrain<R> e(t, s1, s3, s3, shape.contraction);
    best.compare(shape, size, s1, s3, s3, worst_of(e.b, e.c));
  }
}

/// The plane of the cut-off, and its edges and corners.
template <class R, class T>
KOKKOS_INLINE_FUNCTION void compare_cut_off(const PyramidShape<T>& shape, const PyramidSize<R>& size,
                                            const R (&t)[3], Candidate<R>& best) {
  const T m = shape.m;
  const R st = size.cut_off, low = size.low, down = st - t[0];
  const auto strain = [&](const R& s2, const R& s3) {
    return PlasticStrain<R>(t, st, s2, s3, shape.contraction);
  };
  {
    const R by = shape.across_cut_off * down, s2 = t[1] + by, s3 = t[2] + by;
    best.compare(shape, size, st, s2, s3, down);  // ep_1 has the sign of t1 - st
  }
  {
    const R s2 = t[1] + shape.nu * (down + (low - t[2]));
    const PlasticStrain<R> e = strain(s2, low);
    best.compare(shape, size, st, s2, low, worst_of(e.c, -(e.a + m * e.c)));
  }
  {
    const R s3 = t[2] + shape.nu * (down + (st - t[1]));
    const PlasticStrain<R> e = strain(st, s3);
    best.compare(shape, size, st, st, s3, worst_of(-e.a, -e.b));
  }
  {
    const PlasticStrain<R> e = strain(st, low);
    best.compare(shape, size, st, st, low, worst_of(-e.a, -e.b, e.c, -e.c - (e.a + e.b) / m));
  }
  {
    const PlasticStrain<R> e = strain(low, low);
    best.compare(shape, size, st, low, low, worst_of(e.b, e.c, -(e.a + m * (e.b + e.c))));
  }
  {
    const PlasticStrain<R> e = strain(st, st);
    const R at_apex = worst_of(-(e.a + e.b + m * e.c), -(e.a + m * (e.b + e.c)));
    best.compare(shape, size, st, st, st, select(size.apex, at_apex, -e.c));
  }
}

/// The principal stresses to which trial stresses t outside of the surface return; both in descending order.
/// No tolerance: of all candidates that one is taken whose worst violation is the least. The cut-off counts
/// where the pyramid alone has no right candidate. Returns where s is a candidate of the cut-off.
template <class R, class T>
KOKKOS_INLINE_FUNCTION Truth<R> return_to_pyramid(const PyramidShape<T>& shape, const PyramidSize<R>& size,
                                                  const R (&t)[3], const Truth<R>& returns, R (&s)[3]) {
  Candidate<R> best{{t[0], t[1], t[2]}, Kokkos::Experimental::finite_max_v<T>};
  compare_pyramid(shape, size, t, best);
  for (int k = 0; k < 3; ++k) s[k] = best.s[k];
  if (!size.cuts) return Truth<R>{};
  const R of_pyramid = best.violation;
  const Truth<R> wrong = of_pyramid > 0;
  if (!any_of(wrong & returns)) return Truth<R>{};
  compare_cut_off(shape, size, t, best);
  const Truth<R> cut = wrong & (best.violation < of_pyramid);
  for (int k = 0; k < 3; ++k) s[k] = select(cut, best.s[k], s[k]);
  return cut;
}

/// Whether a stress is inside of the surface for any direction of its deviator: a bound without principal
/// stresses, which spares most particles their axes. With r = sqrt(J2), s1 <= p + 2 r / sqrt(3) and
/// k s1 - s3 <= (k - 1) p + steepness r.
template <class R, class T, int Dim>
KOKKOS_INLINE_FUNCTION Truth<R> is_well_inside(const PyramidShape<T>& shape, const PyramidSize<R>& size,
                                               const SymTensor<R, Dim>& stress, const R& mean) {
  const R r = Kokkos::sqrt(second_invariant(stress, mean));
  const Truth<R> below = (shape.k - 1) * mean + shape.steepness * r < size.sc;
  if (!size.cuts) return below;
  return below & (mean + T(1.1547005383792515) * r < size.cut_off);
}

/// Plastic increment of a return to the surface: its engineering shear strain, sqrt(2 de_p : de_p) of its
/// deviator, and the plastic volume strain by which the soil parts.
template <class R>
struct PlasticFlow {
  R strain, opening;
};

/// A stress on the surface, and the plastic increment that led there.
template <class R, int Dim>
struct ReturnedStress {
  SymTensor<R, Dim> stress;
  PlasticFlow<R> flow;
};

/// Volume strain by which soil parts where principal stresses change by `by` [Pa] in a return to the cut-off:
/// that of the plastic strain, without what the angle of dilation makes of its shear. Each unit of plastic
/// strain that is compressive has m units across, so that the latter is m - 1 times the sum of them. The
/// shear of soil that is loose has no dilatancy.
template <class R, class T>
KOKKOS_INLINE_FUNCTION R opening_of(const PyramidShape<T>& shape, const R (&by)[3], const R& shear_modulus,
                                    const Truth<R>& loose) {
  const R sum = by[0] + by[1] + by[2];
  R compressive = 0;
  for (int k = 0; k < 3; ++k) compressive += Kokkos::fmax(R(0), by[k] - shape.contraction * sum);
  const R dilatancy = select(loose, R(0), (shape.m - 1) * compressive);
  return Kokkos::fmax(R(0), -(shape.volume_share * sum) - dilatancy) / (2 * shear_modulus);
}

/// The return of soil that is loose, having parted in all directions, so that its shear has no dilatancy: the
/// mean stress falls to that of the apex, and the deviator t to what is left of the strength there.
template <class R, class T>
KOKKOS_INLINE_FUNCTION void return_loose(const PyramidShape<T>& shape, const PyramidSize<R>& size,
                                         const R (&t)[3], const Truth<R>& loose, R (&s)[3]) {
  const R mean = Kokkos::fmin(R(0), size.cut_off), most = size.sc - (shape.k - 1) * mean;
  const R wanted = shape.k * t[0] - t[2];
  const R share = Kokkos::fmax(R(0), Kokkos::fmin(R(1), most / select(wanted > 0, wanted, R(1))));
  for (int k = 0; k < 3; ++k) s[k] = select(loose, mean + share * t[k], s[k]);
}

/// The return of a stress with this mean that may be outside of the surface, where `may_yield` holds.
template <class R, class T, int Dim>
MPM_CALLED_FUNCTION ReturnedStress<R, Dim> returned_stress(const PyramidShape<T>& shape, PyramidSize<R> whole,
                                                           R shear_modulus, SymTensor<R, Dim> stress, R mean,
                                                           Truth<R> may_yield, Truth<R> loose) {
  const auto principal = principal_of(stress, mean);
  const PyramidSize<R> size = whole.without(mean, shape.k);
  const Sorted3<R> trial = sorted_down(principal.value);
  const Truth<R> returns = may_yield & !(outside(shape, size, trial.value[0], trial.value[2]) <= 0);
  if (!any_of(returns)) return {stress, {R(0), R(0)}};
  R by[3];
  Truth<R> cut = return_to_pyramid(shape, size, trial.value, returns, by);
  if (any_of(loose)) return_loose(shape, size, trial.value, loose, by), cut = cut | loose;
  for (int k = 0; k < 3; ++k) by[k] = select(returns, by[k] - trial.value[k], R(0));
  const R opening = select(cut, opening_of(shape, by, shear_modulus, loose), R(0));
  const R mean_by = (by[0] + by[1] + by[2]) * T(1.0 / 3);
  R square = 0;
  for (int k = 0; k < 3; ++k) square += (by[k] - mean_by) * (by[k] - mean_by);
  unsort(trial, by);
  add_along_axes(stress, principal, by);
  return {stress, {Kokkos::sqrt(square / 2) / shear_modulus, opening}};
}

/// Returns a stress to the surface. The stress of a particle that does not yield keeps its bits. loose: the
/// soil has parted in all directions.
template <class R, class T, int Dim>
KOKKOS_INLINE_FUNCTION PlasticFlow<R> return_stress(const PyramidShape<T>& shape, const PyramidSize<R>& size,
                                                    const R& shear_modulus, const Truth<R>& loose,
                                                    SymTensor<R, Dim>& stress) {
  const R mean = mean_of(stress);
  const Truth<R> may_yield = !is_well_inside(shape, size, stress, mean);
  if (!any_of(may_yield)) return {R(0), R(0)};
  const ReturnedStress<R, Dim> back =
      returned_stress(shape, size, shear_modulus, stress, mean, may_yield, loose);
  stress = back.stress;
  return back.flow;
}

}  // namespace mpm
