#pragma once
// The exact return to Mohr and Coulomb's pyramid with a tension cut-off, in principal stress space: one
// plane, edge or corner of the surface is right, and each is a closed form (Clausen, Damkilde & Andersen
// 2006; de Souza Neto, Peric & Owen 2008, 8.2, with the cut-off beside). With m = k = 1 the pyramid is
// Tresca's prism.

#include <cmath>

#include "physics/materials/principal.hpp"

namespace mpm {

/// What the return takes of the angles and of Poisson's ratio. f = k s1 - s3 - sc, flow (m, 0, -1).
template <class T>
struct PyramidShape {
  T k, m;                // (1 + sin) / (1 - sin) of the angles of friction and dilation
  T steepness;           // largest change of k s1 - s3 with sqrt(J2), 2 sqrt((k^2 + k + 1) / 3)
  T contraction;         // nu / (1 + nu)
  T nu, across_cut_off;  // nu, nu / (1 - nu)
  /// Elastic stress of the plastic flow of the plane, and k times the first less the third.
  T plane[3], plane_divisor;
  /// Weights of the edges s1 = s2 and s2 = s3, and of the sums that they are divided by.
  T edge_12[2], edge_12_divisor, edge_23[2], edge_23_divisor;

  /// Angles by their sines.
  static PyramidShape of(double sin_friction, double sin_dilation, double poisson) {
    const double k = (1 + sin_friction) / (1 - sin_friction), m = (1 + sin_dilation) / (1 - sin_dilation);
    const double h = poisson * (m - 1) / (1 - 2 * poisson), contraction = poisson / (1 + poisson);
    const double w_12 = contraction * (2 + m), w_23 = contraction * (1 + 2 * m);
    const double a[2] = {1 - w_12, m - w_12}, b[2] = {1 - w_23, m - w_23};
    const auto t = [](double x) { return static_cast<T>(x); };
    return {.k = t(k),
            .m = t(m),
            .steepness = t(2 * std::sqrt((k * k + k + 1) / 3)),
            .contraction = t(contraction),
            .nu = t(poisson),
            .across_cut_off = t(poisson / (1 - poisson)),
            .plane = {t(m + h), t(h), t(h - 1)},
            .plane_divisor = t(k * (m + h) - (h - 1)),
            .edge_12 = {t(a[0]), t(a[1])},
            .edge_12_divisor = t(2 * a[0] + a[1] * k),
            .edge_23 = {t(b[0]), t(b[1])},
            .edge_23_divisor = t(b[0] + 2 * b[1] * k)};
  }
};

/// The surface of one particle.
template <class T>
struct PyramidSize {
  T sc;       // Pa, sc = 2 c cos / (1 - sin)
  T cut_off;  // Pa, largest s1
  T low;      // Pa, s3 on the plane where s1 is the cut-off: k cut_off - sc
  bool cuts;  // there is a cut-off
  bool apex;  // it is at the apex of the pyramid

  /// The same surface for stresses from which a mean [Pa] is subtracted.
  KOKKOS_INLINE_FUNCTION PyramidSize without(T mean, T k) const {
    return {sc - (k - 1) * mean, cut_off - mean, low - mean, cuts, apex};
  }
};

/// How far principal stresses in descending order are outside of the surface [Pa].
template <class T>
KOKKOS_INLINE_FUNCTION T outside(const PyramidShape<T>& shape, const PyramidSize<T>& size, T s1, T s3) {
  const T plane = (shape.k * s1 - s3 - size.sc) / (1 + shape.k);
  return size.cuts ? Kokkos::fmax(plane, s1 - size.cut_off) : plane;
}

/// The best of the candidates so far: that which violates its conditions least.
template <class T>
struct Candidate {
  T s[3];       // Pa
  T violation;  // Pa

  /// `own`: the largest violation of the conditions of a candidate, beside those that all share.
  KOKKOS_INLINE_FUNCTION void compare(const PyramidShape<T>& shape, const PyramidSize<T>& size, T s1, T s2,
                                      T s3, T own) {
    const T worst =
        Kokkos::fmax(Kokkos::fmax(own, outside(shape, size, s1, s3)), Kokkos::fmax(s2 - s1, s3 - s2));
    if (!(worst < violation)) return;
    s[0] = s1, s[1] = s2, s[2] = s3;
    violation = worst;
  }
};

/// Plastic strains of a return from t to s, times E / (1 + nu) [Pa].
template <class T>
struct PlasticStrain {
  T a, b, c;
  KOKKOS_INLINE_FUNCTION PlasticStrain(const T (&t)[3], T s1, T s2, T s3, T contraction)
      : a(t[0] - s1), b(t[1] - s2), c(t[2] - s3) {
    const T volume = contraction * (a + b + c);
    a -= volume, b -= volume, c -= volume;
  }
};

/// The largest of some numbers, for conditions of the form x <= 0.
template <class T>
KOKKOS_INLINE_FUNCTION T worst_of(T a, T b) {
  return Kokkos::fmax(a, b);
}
template <class T, class... More>
KOKKOS_INLINE_FUNCTION T worst_of(T a, T b, More... more) {
  return worst_of(Kokkos::fmax(a, b), more...);
}

/// The plane and the two edges of the pyramid.
template <class T>
KOKKOS_INLINE_FUNCTION void compare_pyramid(const PyramidShape<T>& shape, const PyramidSize<T>& size,
                                            const T (&t)[3], Candidate<T>& best) {
  const T l = (shape.k * t[0] - t[2] - size.sc) / shape.plane_divisor;
  best.compare(shape, size, t[0] - l * shape.plane[0], t[1] - l * shape.plane[1], t[2] - l * shape.plane[2],
               -l);
  {
    const T s1 =
        (shape.edge_12[0] * (t[0] + t[1]) + shape.edge_12[1] * (t[2] + size.sc)) / shape.edge_12_divisor;
    const T s3 = shape.k * s1 - size.sc;
    const PlasticStrain<T> e(t, s1, s1, s3, shape.contraction);
    best.compare(shape, size, s1, s1, s3, worst_of(-e.a, -e.b));
  }
  {
    const T s1 =
        (shape.edge_23[0] * t[0] + shape.edge_23[1] * (t[1] + t[2] + 2 * size.sc)) / shape.edge_23_divisor;
    const T s3 = shape.k * s1 - size.sc;
    const PlasticStrain<T> e(t, s1, s3, s3, shape.contraction);
    best.compare(shape, size, s1, s3, s3, worst_of(e.b, e.c));
  }
}

/// The plane of the cut-off, and its edges and corners.
template <class T>
KOKKOS_INLINE_FUNCTION void compare_cut_off(const PyramidShape<T>& shape, const PyramidSize<T>& size,
                                            const T (&t)[3], Candidate<T>& best) {
  const T st = size.cut_off, low = size.low, m = shape.m, down = st - t[0];
  const auto strain = [&](T s2, T s3) { return PlasticStrain<T>(t, st, s2, s3, shape.contraction); };
  {
    const T by = shape.across_cut_off * down, s2 = t[1] + by, s3 = t[2] + by;
    best.compare(shape, size, st, s2, s3, down);  // ep_1 has the sign of t1 - st
  }
  {
    const T s2 = t[1] + shape.nu * (down + (low - t[2]));
    const PlasticStrain<T> e = strain(s2, low);
    best.compare(shape, size, st, s2, low, worst_of(e.c, -(e.a + m * e.c)));
  }
  {
    const T s3 = t[2] + shape.nu * (down + (st - t[1]));
    const PlasticStrain<T> e = strain(st, s3);
    best.compare(shape, size, st, st, s3, worst_of(-e.a, -e.b));
  }
  {
    const PlasticStrain<T> e = strain(st, low);
    best.compare(shape, size, st, st, low, worst_of(-e.a, -e.b, e.c, -e.c - (e.a + e.b) / m));
  }
  {
    const PlasticStrain<T> e = strain(low, low);
    best.compare(shape, size, st, low, low, worst_of(e.b, e.c, -(e.a + m * (e.b + e.c))));
  }
  {
    const PlasticStrain<T> e = strain(st, st);
    const T at_apex = worst_of(-(e.a + e.b + m * e.c), -(e.a + m * (e.b + e.c)));
    best.compare(shape, size, st, st, st, size.apex ? at_apex : -e.c);
  }
}

/// The principal stresses to which trial stresses t outside of the surface return; both in descending order.
/// No tolerance: of all candidates that one is taken whose worst violation is the least.
template <class T>
KOKKOS_INLINE_FUNCTION void return_to_pyramid(const PyramidShape<T>& shape, const PyramidSize<T>& size,
                                              const T (&t)[3], T (&s)[3]) {
  Candidate<T> best{{t[0], t[1], t[2]}, Kokkos::Experimental::finite_max_v<T>};
  compare_pyramid(shape, size, t, best);
  if (size.cuts && best.violation > 0) compare_cut_off(shape, size, t, best);
  for (int k = 0; k < 3; ++k) s[k] = best.s[k];
}

/// Whether a stress is inside of the surface for any direction of its deviator: a bound without principal
/// stresses, which spares most particles their axes. With r = sqrt(J2), s1 <= p + 2 r / sqrt(3) and
/// k s1 - s3 <= (k - 1) p + steepness r.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool is_well_inside(const PyramidShape<T>& shape, const PyramidSize<T>& size,
                                           const SymTensor<T, Dim>& stress, T mean) {
  const T r = Kokkos::sqrt(second_invariant(stress, mean));
  return (shape.k - 1) * mean + shape.steepness * r < size.sc &&
         (!size.cuts || mean + T(1.1547005383792515) * r < size.cut_off);
}

/// A stress on the surface, and the engineering shear strain of the plastic increment that led there,
/// sqrt(2 de_p : de_p) of its deviator.
template <class T, int Dim>
struct ReturnedStress {
  SymTensor<T, Dim> stress;
  T strain;
};

/// The return of a stress with this mean that may be outside of the surface.
template <class T, int Dim>
MPM_CALLED_FUNCTION ReturnedStress<T, Dim> returned_stress(const PyramidShape<T>& shape, PyramidSize<T> whole,
                                                           T shear_modulus, SymTensor<T, Dim> stress,
                                                           T mean) {
  const auto principal = principal_of(stress, mean);
  const PyramidSize<T> size = whole.without(mean, shape.k);
  const Sorted3<T> trial = sorted_down(principal.value);
  if (outside(shape, size, trial.value[0], trial.value[2]) <= 0) return {stress, 0};
  T by[3];
  return_to_pyramid(shape, size, trial.value, by);
  for (int k = 0; k < 3; ++k) by[k] -= trial.value[k];
  const T mean_by = (by[0] + by[1] + by[2]) * T(1.0 / 3);
  T square = 0;
  for (int k = 0; k < 3; ++k) square += (by[k] - mean_by) * (by[k] - mean_by);
  unsort(trial, by);
  add_along_axes(stress, principal, by);
  return {stress, Kokkos::sqrt(square / 2) / shear_modulus};
}

/// Returns a stress to the surface. The stress of a particle that does not yield keeps its bits. The result
/// is ReturnedStress::strain.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T return_stress(const PyramidShape<T>& shape, const PyramidSize<T>& size,
                                       T shear_modulus, SymTensor<T, Dim>& stress) {
  const T mean = mean_of(stress);
  if (is_well_inside(shape, size, stress, mean)) return 0;
  const ReturnedStress<T, Dim> back = returned_stress(shape, size, shear_modulus, stress, mean);
  stress = back.stress;
  return back.strain;
}

}  // namespace mpm
