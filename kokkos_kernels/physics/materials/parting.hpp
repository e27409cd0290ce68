#pragma once
// Soil that has parted at its limit of tension: it takes no pressure until compression has used up the volume
// strain by which it parted. docs/soils.md, "Soil that parts", has the rules.

#include "physics/materials/mohr_coulomb_return.hpp"

namespace mpm {

/// The state variable of a law that can part: volume strain [-] that the limit of tension has taken, and that
/// compression has not given back yet.
constexpr StateVariable parted_variable() { return {"parted_volume", "-"}; }

/// Share of its strength that is left to soil that has parted by a volume strain in all directions. Beyond
/// twice the volume it falls as the volume grows, and the force on the nodes, stress times volume, does not
/// grow.
template <class R>
KOKKOS_INLINE_FUNCTION R share_across(const R& parted) {
  return Kokkos::fmin(R(1), 2 * Kokkos::exp(-parted));
}

/// Lets a gap close before the mean stress [Pa], which an elastic trial has brought below zero, becomes a
/// pressure. parted [-]: volume strain of the gap, 0 or more. Where there is no gap nothing changes.
template <class R>
KOKKOS_INLINE_FUNCTION void close_by_mean(R& mean, R& parted, const R& bulk_modulus) {
  const Truth<R> closes = (parted > 0) & (mean < 0);
  const R left = parted + mean / bulk_modulus;
  mean = select(closes, bulk_modulus * Kokkos::fmin(left, R(0)), mean);
  parted = select(closes, Kokkos::fmax(left, R(0)), parted);
}

/// A stress, and the volume strain of the gap that is left.
template <class R, int Dim>
struct ClosedGap {
  SymTensor<R, Dim> stress;
  R parted;
};

/// Closed gap for laws that limit the largest principal stress, where soil may have parted in one or two
/// directions and still be pressed in the others: a principal direction of the stress before the step that
/// was not pressed is open, and takes no pressure while a gap is left. `trial`: the elastic trial; whole: the
/// soil parts in all directions at once, so that no direction at all is pressed. Compression closes the gap
/// by plastic strain in the open directions alone, whose elastic stress also changes that of the others.
template <class R, class T, int Dim>
MPM_CALLED_FUNCTION ClosedGap<R, Dim> closed_gap(const PyramidShape<T>& shape, Truth<R> whole,
                                                 R shear_modulus, SymTensor<R, Dim> before,
                                                 SymTensor<R, Dim> trial, R parted) {
  constexpr T k_round_off = T(1e-3);  // of the gap: a compressive stress as small as this is none
  for (int k = 0; k < sym_size<Dim>; ++k) before[k] = select(whole, trial[k], before[k]);
  const R mean = mean_of(before), least = -k_round_off * shear_modulus * parted - mean;
  const auto axes = principal_of(before, mean);
  R by[3], sum = 0, number = 0;
  along_axes(trial, axes, by);
  for (int k = 0; k < 3; ++k) {
    const Truth<R> closes = (parted > 0) & (by[k] < 0) & (whole | (axes.value[k] > least));
    by[k] = select(closes, -by[k], R(0));
    sum += by[k];
    number += select(closes, R(1), R(0));
  }
  const R across = sum * select(number < T(1.5), R(shape.across_cut_off), R(shape.nu));
  for (int k = 0; k < 3; ++k) by[k] = select(by[k] > 0, by[k], across);
  const R closing = shape.volume_share * (by[0] + by[1] + by[2]) / (2 * shear_modulus);
  const Truth<R> is_used_up = closing > parted;
  const R share = select(is_used_up, parted / select(is_used_up, closing, R(1)), R(1));
  for (int k = 0; k < 3; ++k) by[k] *= share;
  add_along_axes(trial, axes, by);
  return {trial, select(is_used_up, R(0), parted - closing)};
}

}  // namespace mpm
