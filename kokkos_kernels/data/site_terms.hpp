#pragma once
// Numbers that a site of contact keeps from step to step.

namespace mpm {

/// Sites of a node: the corners of the square (cube) of half a cell from the node on.
template <int Dim>
inline constexpr int k_sites = 1 << Dim;

/// Numbers of one rigid body at a site: the normal force on the soil and its shear force [N], and what
/// friction keeps of the normal impulses there, as ImpulseTerms: sum and store [N s], and weight [-].
template <int Dim>
struct SiteTerms {
  static constexpr int normal = 0, shear = 1, sum = 1 + Dim, weight = 2 + Dim, store = 3 + Dim,
                       size = 4 + Dim;
};

}  // namespace mpm
