#pragma once
// update_pores on a processor: a thread takes the particles of a patch, which find the nodes in its window.

#include "loops/cpu/host_weights.hpp"
#include "loops/pore_update.hpp"
#include "physics/walls.hpp"

namespace mpm {

/// Pore pressure and flux of the particles of patches.
template <class Space, class T, int Dim, ParticleDomain domain>
struct HostPores {
  static constexpr int W = native_lanes<T>, cells = Patch<Dim>::cells, window = Patch<Dim>::window;
  static constexpr int k_motion = NodeKinematics<Dim>::size, slopes = k_slopes<Dim, domain>;
  static_assert(int(FluxTerms<Dim>::size) == k_motion);
  /// Values of a node: FluxTerms, then NodeKinematics, and a gap in 3D.
  static constexpr int k_node = Dim == 2 ? 8 : 16;
  using R = Lanes<T, W>;
  using Node = Lanes<T, k_node>;
  using Window = const T (&)[window][k_node];

  PoreUpdate<Space, T, Dim> pores;
  Grid<T, Dim> grid, flow_grid;  // as the soil and as the flux meet its sides
  decltype(Bins<Space>::begin) begin;
  decltype(Patches<Space, Dim>::neighbours) neighbours;
  decltype(Patches<Space, Dim>::origin) origin;
  decltype(Nodes<Space, T, Dim>::kinematics) kinematics;
  decltype(Nodes<Space, T, Dim>::flux) flux;

  /// The particles of a slot.
  void operator()(int slot) const {
    alignas(Node) T nodes[window][k_node];
    for_each_run<Dim>(neighbours, slot, [&](int place, int node, auto count) {
      for (int n = 0; n < count; ++n)
        for (int k = 0; k < k_motion; ++k) {
          nodes[place + n][k] = flux(node + n, k);
          nodes[place + n][k_motion + k] = kinematics(node + n, k);
        }
    });
    for (int n = 0; n < window; ++n)
      for (int k = 2 * k_motion; k < k_node; ++k) nodes[n][k] = 0;
    const Coord<Dim> from = origin(slot);
    if (reaches_wall(grid, from)) mirror_images(grid, from, [&](int n) -> T* { return nodes[n] + k_motion; });
    if (reaches_wall(flow_grid, from)) mirror_images(flow_grid, from, [&](int n) -> T* { return nodes[n]; });
    PoreSums sums[cells] = {};
    take(nodes, begin(slot * cells), begin((slot + 1) * cells), sums);
    for (int c = 0; c < cells; ++c)
      if (sums[c].volume > 0) pores.press_cell(begin(slot * cells + c), begin(slot * cells + c + 1), sums[c]);
  }

 private:
  /// The particles [from, to) take from the nodes, and give the sums of their cells; the weights of many at
  /// once, then the values of a node at once.
  void take(Window nodes, int from, int to, PoreSums (&sums)[cells]) const {
    const auto& soil = pores.soil;
    for (int p = from; p < to; p += W) {
      const int count = Kokkos::min(W, to - p);
      Vector<R, Dim> x;
      load_field(soil.coordinate, p, count, x.c);
      const auto half = domains_of<domain, R, Dim>(soil, p, count, bodies_of<R>(soil, p, count));
      HostWeights<T, Dim, domain> weights;
      weights.find(x, half);
      for (int l = 0; l < count; ++l) {
        if (!pores.is_wet(p + l)) continue;
        typename HostWeights<T, Dim, domain>::OfOne a;
        weights.take(l, a);
        const int cell = soil.cell(p + l) % cells;
        pores.add(p + l, sample(nodes[window_base<Dim>(cell) + weights.first(l)], a), sums[cell]);
      }
    }
  }

  /// Values at a particle with the weights `a`; first: the lowest node that it reaches.
  template <class Weights>
  KOKKOS_INLINE_FUNCTION PoreSample<Dim> sample(const T* first, const Weights& a) const {
    Node value[1], gradient[1][slopes];
    sample_window<Dim>(first, a, value, gradient);
    PoreSample<Dim> sample;
    for (int d = 0; d < Dim; ++d) {
      sample.flux[d] = double(value[0][FluxTerms<Dim>::flux + d]);
      sample.rate[d] = double(value[0][FluxTerms<Dim>::rate + d]);
    }
    for (int d = 0; d < slopes; ++d) {  // the hoop has the radial component
      const int k = d < Dim ? d : 0;
      sample.of_flux += double(gradient[0][d][FluxTerms<Dim>::flux + k]);
      sample.of_grains += double(gradient[0][d][k_motion + NodeKinematics<Dim>::velocity + k]);
    }
    sample.of_flux *= double(grid.inv_spacing), sample.of_grains *= double(grid.inv_spacing);
    return sample;
  }
};

}  // namespace mpm
