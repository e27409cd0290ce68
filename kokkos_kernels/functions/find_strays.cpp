#include "functions/find_strays.hpp"

#include "loops/particle_to_node.hpp"

namespace mpm {
namespace {

/// A particle is alone where its nodes hold less than this many times its mass. The stiffness between so few
/// particles depends on where they are in a cell, and at most places there no time step of the soil is stable
/// for them (docs/method.md, "Strays"). The nodes of a particle at the corner of a body hold at least n^Dim
/// times its mass, n particles along a cell's edge. in_cell: that number of particles, as many as fill a
/// cell.
KOKKOS_INLINE_FUNCTION double alone_below(double in_cell) {
  constexpr double k_share = 0.9, k_least = 1.5;
  return Kokkos::fmax(k_least, k_share * in_cell);
}

/// So many particles like p, which is of this body, fill a cell.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION double number_in_cell(const Soil<Space, T, Dim>& soil, int p,
                                             const BodyProperties<T>& of) {
  if (!soil.has_domain) return power(0.5 / double(of.half_length), Dim);
  const HalfLengths<T, Dim> half = any_domain_of(soil, p);
  double number = 1;
  for (int d = 0; d < Dim; ++d) number *= 0.5 / double(half[d]);
  return number;
}

/// Mass of particles one cell closer to the axis than p, of its own: that of rings grows with the radius.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION double inner_share(const Soil<Space, T, Dim>& soil, int p) {
  if constexpr (Dim == 2)
    if (soil.rings) {
      const double radius = double(soil.coordinate(p)[0]) - axis_of<double>(soil, soil.cell(p));
      return Kokkos::fmax(0.0, radius - 1) / radius;
    }
  return 1;
}

/// Mass [kg] of the nodes that a particle reaches; of a node beyond a wall and its image once.
template <class Space, class T, int Dim>
struct MassInReach {
  Soil<Space, T, Dim> soil;
  NodePlaces<Space, T, Dim> places;
  NodeField<Space, T, SoilTerms<Dim>::size> nodes;

  KOKKOS_INLINE_FUNCTION T operator()(int p) const {
    T sum = 0;
    with_any_domain(soil, p, [&](const auto& domain) {
      with_weights(soil.coordinate(p), domain, [&](const auto& a) {
        const Stencil<Kind::geometry, T, Dim> stencil(places, soil.cell(p), a);
        for_each_weight(a, [&](const Vector<int, Dim>& k, T, const auto&) {
          bool own = true;
          for (int d = 0; d < Dim; ++d) {
            const bool beyond = stencil.normal[d][k[d]] < 0;
            own = own && a[d].w[k[d]] > T(k_reached) && !beyond;
          }
          if (own) sum += nodes(stencil.node(places.neighbours, k), SoilTerms<Dim>::mass);
        });
      });
    });
    return sum;
  }
};

}  // namespace

template <class Space, class T, int Dim>
void mark_strays(Core<Space, T, Dim>& s, const Space& stream) {
  constexpr int cells = Patch<Dim>::cells;
  const auto alone = s.strays.alone;
  const auto soil = s.soil.points;
  const auto begin = s.soil.bins.begin;
  const auto origin = s.patches.origin;
  const auto control = s.control;
  const double spacing = s.spacing;
  const bool stops = s.strays.rule == StrayRule::stop;
  const MassInReach<Space, T, Dim> mass_in_reach{soil, {s.grid, s.patches}, s.nodes.soil};
  Kokkos::parallel_for(
      "mpm::mark_strays", Kokkos::RangePolicy<Space>(stream, 0, s.patches.node_count()),
      KOKKOS_LAMBDA(int cell) {
        const int first = begin(cell), last = begin(cell + 1);
        for (int p = first; p < last; ++p) {
          const BodyProperties<T> of = soil.properties(p);
          const double few = alone_below(number_in_cell(soil, p, of));
          if (last - first > few || mass_in_reach(p) > few * inner_share(soil, p) * of.mass) return;
        }
        if (first == last) return;
        Kokkos::atomic_or(&alone(cell / cells), std::uint64_t(1) << (cell % cells));
        if (!stops) return;
        double position[3] = {};
        const Coord<Dim> place = coord_of<Dim>(cell);
        for (int d = 0; d < Dim; ++d)
          position[d] = (double(origin(cell / cells)[d]) + place[d] + soil.coordinate(first)[d]) * spacing;
        report(control, FaultKind::alone, soil.id(first), position, Dim);
      });
  s.strays.known = true;
}

template <class Space, class T, int Dim>
void note_lost(Core<Space, T, Dim>& s) {
  constexpr int quantities = 3 + Dim;  // number, mass, kinetic energy, momentum
  const auto soil = s.soil.points;
  const auto address = s.soil.address;
  for (int b = 0; b < static_cast<int>(s.strays.lost.size()); ++b) {
    double sums[quantities] = {};
    for (int k = 0; k < quantities; ++k)
      Kokkos::parallel_reduce(
          "mpm::note_lost", Kokkos::RangePolicy<Space>(s.space, 0, soil.count),
          KOKKOS_LAMBDA(int p, double& sum) {
            if (address(p) >= 0 || soil.body(p) != b) return;
            const double mass = soil.mass_of(p, soil.bodies(b));
            double square = 0;
            for (int d = 0; d < Dim; ++d) square += double(soil.velocity(p)[d]) * soil.velocity(p)[d];
            sum += k == 0 ? 1 : k == 1 ? mass : k == 2 ? mass * square / 2 : mass * soil.velocity(p)[k - 3];
          },
          sums[k]);
    Lost& lost = s.strays.lost[b];
    lost.count += sums[0], lost.mass += sums[1], lost.kinetic_energy += sums[2];
    for (int d = 0; d < Dim; ++d) lost.momentum[d] += sums[3 + d];
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                           \
  template void mark_strays(Core<Space, T, Dim>&, const Space&); \
  template void note_lost(Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
