#include "functions/absorbing_sides.hpp"

#include <algorithm>
#include <cmath>

#include "base/copy.hpp"
#include "functions/free_field.hpp"
#include "functions/side_moduli.hpp"
#include "loops/particle_to_node.hpp"
#include "physics/pore_water.hpp"

namespace mpm {
namespace {

// Sums are whole numbers, which have the same value in any order of particles, threads and ranks.
constexpr double k_resolution = 1e12;  // of the largest term of one particle

/// Sums at the nodes of absorbing sides: mass times the speed of pressure and of shear waves [kg m/s], volume
/// [m3], volume times the normal gradient of the weight [m3/cell], mass [kg]. The sum of the gradients is the
/// area of the node's part of the side (Gauss). For rings this holds with the divergence of a vector along
/// the radius, dS/dr + S/r.
enum SideSum { k_pressure_waves, k_shear_waves, k_volume, k_area, k_mass, k_sums };

/// Source of the sums at the nodes of absorbing sides.
template <class Space, class T, int Dim>
struct GiveSides {
  using Memory = typename Space::memory_space;
  using Sum = Kokkos::View<long long* [k_sums], Kokkos::LayoutRight, Memory>;
  Soil<Space, T, Dim> soil;
  NodePlaces<Space, T, Dim> places;
  ActingSides<Dim> acting;
  unsigned sides;
  Kokkos::View<double*, Memory> shear_ratio;
  Sum sums;
  double unit[k_sums];

  /// Terms of a particle, without its weight at the node.
  KOKKOS_INLINE_FUNCTION void terms_of(int p, double (&terms)[k_sums]) const {
    const auto of = soil.properties(p);
    const SideModuli moduli = side_moduli(soil, shear_ratio(of.material), p);
    const double volume = soil.volume(p), mass = of.mass;
    terms[k_pressure_waves] = Kokkos::sqrt((moduli.wave + moduli.pore) * volume * mass);
    terms[k_shear_waves] = shear_ratio(of.material) * Kokkos::sqrt(moduli.wave * volume * mass);
    terms[k_volume] = terms[k_area] = volume, terms[k_mass] = mass;
  }
  /// About the largest force that a particle gives a node [N]: its stress times volume over the edge of a
  /// cell.
  KOKKOS_INLINE_FUNCTION double force_of(int p) const {
    SymTensor<T, Dim> stress = soil.stress(p);
    add_isotropic(stress,
                  soil.excess_pore_pressure(material_in(soil.materials(soil.properties(p).material)), p));
    double largest = 0;
    for (int k = 0; k < sym_size<Dim>; ++k) largest = Kokkos::fmax(largest, Kokkos::fabs(double(stress[k])));
    return largest * soil.volume(p) * places.grid.inv_spacing;
  }
  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    const int cell = soil.cell(p);
    const Coord<Dim> first = in_mesh(places.origin(cell / Patch<Dim>::cells), coord_of<Dim>(cell));
    bool near = false;
    for (int d = 0; d < Dim; ++d) near |= first[d] < 2 || first[d] >= places.grid.cells[d] - 2;
    if (!near) return;
    double terms[k_sums];
    terms_of(p, terms);
    with_any_domain(soil, p, [&](const auto& domain) { give_terms(p, first, domain, terms); });
  }
  template <class Domain>
  KOKKOS_INLINE_FUNCTION void give_terms(int p, const Coord<Dim>& first, const Domain& domain,
                                         const double (&terms)[k_sums]) const {
    with_weights(soil.coordinate(p), domain, [&](const auto& a) {
      for_each_weight(a, [&](const Vector<int, Dim>& step, T w, const auto& grad) {
        Coord<Dim> at;
        for (int d = 0; d < Dim; ++d)
          at[d] = places.grid.in_period(d, image_along(places.grid, d, first[d] + a[d].first + step[d]));
        const unsigned on = sides_of(places.grid, at) & sides;
        for (int n = 0; n < 2 * Dim; ++n) {
          if (!(on >> n & 1u)) continue;
          const int row = acting.all[n].row(at);
          double normal = grad[n / 2] * (n % 2 == 0 ? -1 : 1);
          if constexpr (std::is_same_v<Domain, RingDomain<T>>)
            if (n / 2 == 0) normal += grad[Dim];
          for (int k = 0; k < k_sums; ++k) add(row, k, (k == k_area ? normal : double(w)) * terms[k]);
        }
      });
    });
  }
  KOKKOS_INLINE_FUNCTION void add(int row, int k, double value) const {
    Kokkos::atomic_add(&sums(row, k), static_cast<long long>(Kokkos::round(value / unit[k])));
  }
};

/// The largest of one of the terms of all particles; of their forces for k = k_sums.
template <class Space, class T, int Dim>
struct LargestTerm {
  GiveSides<Space, T, Dim> give;
  int k;
  KOKKOS_INLINE_FUNCTION void operator()(int p, double& largest) const {
    double terms[k_sums];
    give.terms_of(p, terms);
    largest = Kokkos::fmax(largest, k < k_sums ? terms[k] : give.force_of(p));
  }
};

/// Forces that particles give the nodes beyond the sides, as whole numbers.
template <class Space, class T, int Dim, ParticleDomain domain>
struct GiveBeyond {
  using Source = SoilSource<Space, T, Dim, domain>;
  Source source;
  GiveSides<Space, T, Dim> sides;
  Kokkos::View<long long* [Dim], Kokkos::LayoutRight, typename Space::memory_space> sums;
  double unit;  // N

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    const auto& grid = sides.places.grid;
    const int cell = source.points.cell(p);
    const Coord<Dim> first = in_mesh(sides.places.origin(cell / Patch<Dim>::cells), coord_of<Dim>(cell));
    bool near = false;
    for (int d = 0; d < Dim; ++d) near |= first[d] < 1 || first[d] >= grid.cells[d] - 1;
    if (!near) return;
    const typename Source::Point q = source.load(p);
    with_weights(source.points.coordinate(p), q.half_length, [&](const auto& a) {
      for_each_weight(a, [&](const Vector<int, Dim>& step, T w, const auto& grad) {
        T force[Dim] = {};
        give<Source>(
            q, w, grad, [] { return 0; },
            [&](int value, T v) {
              if (value >= SoilTerms<Dim>::force) force[value - SoilTerms<Dim>::force] += v;
            });
        Coord<Dim> at, image;
        for (int d = 0; d < Dim; ++d) {
          at[d] = grid.in_period(d, first[d] + a[d].first + step[d]);
          image[d] = image_along(grid, d, at[d]);
        }
        const unsigned on = sides_of(grid, at) & sides.sides;
        for (int n = 0; n < 2 * Dim; ++n)
          if ((on >> n & 1u) && image[n / 2] != at[n / 2])
            for (int k = 0; k < Dim; ++k)
              Kokkos::atomic_add(&sums(sides.acting.all[n].row(image), k),
                                 static_cast<long long>(Kokkos::round(double(force[k]) / unit)));
      });
    });
  }
};

/// The force on each node of the sides that they have held till now, with the opposite sign.
template <class Space, class T, int Dim>
void set_reactions(State<Space, T, Dim>& s) {
  using S = SoilTerms<Dim>;
  const auto grid = s.grid;
  const auto origin = s.patches.origin;
  const auto soil = s.nodes.soil;
  const auto gravity = s.gravity;
  const ActingSides<Dim> sides = acting(s.sides);
  const unsigned unknown = s.sides.unknown;
  Kokkos::Array<unsigned, 2 * Dim> held;
  for (int n = 0; n < 2 * Dim; ++n) held[n] = s.sides.held[n];
  Kokkos::parallel_for(
      "mpm::set_reactions", Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()),
      KOKKOS_LAMBDA(int i) {
        Coord<Dim> at = coord_of<Dim>(i);
        for (int d = 0; d < Dim; ++d) at[d] += origin(i / Patch<Dim>::cells)[d];
        const unsigned on = sides_of(grid, at) & unknown;
        if (on == 0 || !(soil(i, S::mass) > 0)) return;
        unsigned taken = 0;  // components: where sides meet, the first one carries
        for (int n = 0; n < 2 * Dim; ++n) {
          if (!(on >> n & 1u)) continue;
          double* const kept = sides.node(n, at);
          for (int k = 0; k < Dim; ++k) {
            const bool carries = (held[n] & ~taken) >> k & 1u;
            const double force = double(soil(i, S::force + k)) + double(soil(i, S::mass)) * gravity[k];
            kept[SideTerms<Dim>::reaction + k] = carries ? -force : 0.0;
          }
          taken |= held[n];
        }
      });
}

}  // namespace

template <class Space, class T, int Dim>
void begin_absorbing(State<Space, T, Dim>& s, const std::vector<double>& shear_ratio,
                     const SideRanks& ranks) {
  using Give = GiveSides<Space, T, Dim>;
  using S = SideTerms<Dim>;
  const unsigned sides = s.sides.unknown;
  if (sides == 0) return;
  Give give{
      s.soil.points, {s.grid, s.patches}, acting(s.sides), sides, shear_ratios<Space>(shear_ratio), {}, {}};
  give.sums = typename Give::Sum("mpm::side_sums", s.sides.nodes.extent(0));
  const Kokkos::RangePolicy<Space> range(s.space, 0, s.soil.points.count);
  const auto unit_of = [&](int k) {  // of the whole numbers
    double largest = 0;
    Kokkos::parallel_reduce("mpm::largest_of_sides", range, LargestTerm<Space, T, Dim>{give, k},
                            Kokkos::Max<double>(largest));
    ranks.largest(&largest);
    return std::max(largest, 1e-300) / k_resolution;
  };
  for (int k = 0; k < k_sums; ++k) give.unit[k] = unit_of(k);
  const double unit_force = unit_of(k_sums);
  Kokkos::parallel_for("mpm::give_sides", range, give);
  Kokkos::View<long long* [Dim], Kokkos::LayoutRight, typename Space::memory_space> beyond(
      "mpm::beyond_sides", s.sides.nodes.extent(0));
  with_domain(s.soil.points, [&](auto domain) {
    const GiveBeyond<Space, T, Dim, domain()> forces{
        {s.soil.points, s.grid.inv_spacing}, give, beyond, unit_force};
    Kokkos::parallel_for("mpm::give_beyond_sides", range, forces);
  });
  set_reactions(s);
  s.space.fence("mpm::begin_absorbing");
  const auto sums = mirror_of(give.sums);
  ranks.sum(sums.data(), static_cast<int>(sums.size()));
  const auto mirrored = mirror_of(beyond);
  ranks.sum(mirrored.data(), static_cast<int>(mirrored.size()));
  const auto table = mirror_of(s.sides.nodes);
  for (int n = 0; n < 2 * Dim; ++n) {
    if (!(sides >> n & 1u)) continue;
    const SideNumbers& of = s.sides.host[n].numbers;
    const int first = s.sides.host[n].first;
    for (int row = first; row < first + side_rows(s.grid.cells, Dim, n / 2); ++row) {
      const auto sum_of = [&](int k) { return sums(row, k) * give.unit[k]; };
      const double volume = sum_of(k_volume), area = sum_of(k_area) / s.spacing;
      for (int k = 0; k < 2 && volume > 0; ++k) {
        const double impedance = sum_of(k == 0 ? k_pressure_waves : k_shear_waves) / volume;  // kg/m2/s
        const double density = sum_of(k_mass) / volume, length = of.spring_length;
        table(row, S::dashpot + k) = of.dashpot_factor * std::max(0.0, area) * impedance;
        if (length > 0)
          table(row, S::spring + k) = std::max(0.0, area) * impedance * impedance / density / length;
      }
      // A mirror returns the force on the nodes beyond it, so twice that force has passed the side.
      for (int k = 0; k < Dim; ++k)
        if (s.sides.mirrored[n] >> k & 1u) table(row, S::reaction + k) -= mirrored(row, k) * unit_force;
    }
  }
  copy(s.sides.nodes, table);
  begin_columns(s, shear_ratio, ranks, {table.data(), table.data() + table.size()});
  s.sides.unknown = 0;
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template void begin_absorbing(State<Space, T, Dim>&, const std::vector<double>&, const SideRanks&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
