#pragma once
#include "physics/side_node.hpp"

namespace mpm {

/// A side of the tests, which check.py adds to a copy of the program: a Winkler foundation. The side gives a
/// node the force -k A u along its normal, with the stiffness k [Pa/m], the node's area A of the side and the
/// drift u [m] of the node since the start. The force is the mean over the drifts before, at and after the
/// step, (u- + 2 u + u+) / 4, so that it is stable at any stiffness and keeps the energy.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void press_springs(const ActingSides<Dim>& acting, const SideNode<Dim>& node,
                                          const Vector<T, Dim>& v_old, double* v) {
  using S = SideTerms<Dim>;
  for (int n = 0; n < 2 * Dim; ++n) {
    if (!node.on(n) || acting.all[n].kind != Wall::spring) continue;
    const Side<Dim>& side = acting.all[n];
    double* const kept = acting.node(n, node.at);
    const int d = n / 2;
    const double area = side.face * Kokkos::fmin(node.share_of(n), node.mass / side.unit_mass);
    const double spring = side.numbers.stiffness * area, part = spring * node.dt / 4;
    const double came = v[d];
    v[d] = (node.mass * came - spring * node.dt * kept[S::drift + d] + part * node.dt * v_old[d]) /
           (node.mass + part * node.dt);
    book(kept, node, v_old, d, node.mass * (v[d] - came), v[d]);
    if (node.keeps) kept[S::drift + d] += node.dt * v[d];
  }
}

}  // namespace mpm
