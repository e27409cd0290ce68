#include "transfer/measure.hpp"

#include "base/copy.hpp"
#include "physics/materials/any.hpp"
#include "physics/p2g_terms.hpp"
#include "physics/pore_flow.hpp"
#include "physics/pore_water.hpp"
#include "rebuild/limit_volumes.hpp"
#include "transfer/positions.hpp"

namespace mpm {
namespace {

/// The measure as a sum for parallel_reduce.
template <int Dim>
struct Sum {
  BodyMeasure m;
  KOKKOS_INLINE_FUNCTION Sum() : m{} {
    for (int d = 0; d < 3; ++d) {
      m.lower[d] = Kokkos::Experimental::finite_max<double>::value;
      m.upper[d] = -m.lower[d];
    }
  }
  KOKKOS_INLINE_FUNCTION Sum& operator+=(const Sum& other) {
    for (int d = 0; d < Dim; ++d) {
      m.lower[d] = Kokkos::fmin(m.lower[d], other.m.lower[d]);
      m.upper[d] = Kokkos::fmax(m.upper[d], other.m.upper[d]);
      m.momentum[d] += other.m.momentum[d];
      m.centre[d] += other.m.centre[d];
    }
    m.kinetic_energy += other.m.kinetic_energy;
    m.stored_energy += other.m.stored_energy;
    m.pore_water += other.m.pore_water, m.outflow += other.m.outflow;
    m.mass += other.m.mass, m.weight += other.m.weight, m.water_energy += other.m.water_energy;
    m.count += other.m.count, m.alone += other.m.alone, m.limited += other.m.limited;
    m.stretched += other.m.stretched;
    return *this;
  }
};

/// Porosity of particle p, in whose pores water flows.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION double porosity_of(const Soil<Space, T, Dim>& soil, int p) {
  return 1 - double(soil.solid_volume(p)) / double(soil.volume(p));
}

/// Adds the water in the pores of particle p, and that which has left: its volumes without pressure [m3].
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION void add_pore_water(const Soil<Space, T, Dim>& soil, const WaterInPores& water, int p,
                                           BodyMeasure& m) {
  const double pressure = soil.history.column[soil.history.pore](p);
  m.pore_water +=
      (double(soil.volume(p)) - double(soil.solid_volume(p))) * water_compression(pressure, water);
  m.outflow += soil.outflow(p);
}

/// Energy [J/m3] that particle p can give back, its pore water's among it. bulk_modulus [Pa]: of water that
/// flows.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION double stored_energy(const Soil<Space, T, Dim>& soil, int material,
                                            double bulk_modulus, int p) {
  const AnyMaterial<T>& of = material_in(soil.materials(material));
  const double stiffness = of.saturated ? bulk_modulus / porosity_of(soil, p) : double(of.pore_stiffness);
  const double excess = soil.excess_pore_pressure(of, p);
  SymTensor<T, Dim> stress = soil.stress(p);
  add_isotropic(stress, static_cast<T>(excess));
  double energy = excess == 0 ? 0 : excess * excess / (2 * stiffness);
  of.visit([&](const auto& law) { energy += law.stored_energy(stress, soil.state_of(law, p)); });
  return energy;
}

/// Energy [J] of the water that particle p displaces, from nothing far above the level: its weight times the
/// integral of the submerged share over the depth.
template <class Space, class T, int Dim, class Density>
KOKKOS_INLINE_FUNCTION double water_energy(const Soil<Space, T, Dim>& soil, const Water<Dim>& water,
                                           const Density& density, const Positions<Space, T, Dim>& position,
                                           int p) {
  const BodyProperties<T> body = soil.properties(p);
  Vector<double, Dim> x;
  for (int d = 0; d < Dim; ++d) x[d] = position(p, d);
  const HalfLengths<T, Dim> half_length = any_domain_of(soil, p);
  Vector<double, Dim> half;  // m
  for (int d = 0; d < Dim; ++d) half[d] = double(half_length[d].l) * position.spacing;
  const double reach = water.reach(half);
  const double depth = water.depth(x), in = Kokkos::fmax(0.0, Kokkos::fmin(2 * reach, depth + reach));
  const double sunk = in * in / (4 * reach) + Kokkos::fmax(0.0, depth - reach);  // m
  const double volume = soil.has_flow && soil.solid_volume(p) > 0 ? double(soil.volume(p))
                                                                  : double(body.mass) / density(soil.body(p));
  return water.density * water.gravity * sunk * volume;
}

/// A coordinate as a whole number of steps from the lower end of an extent. It never falls where x grows, so
/// that an order by it is an order by x.
struct Ruler {
  static constexpr int digit = 12, digits = 2;  // bits of a digit
  double lower, scale;                          // m, steps/m

  Ruler(double low, double high) : lower(low), scale(high > low ? (1 << digit * digits) / (high - low) : 0) {}
  KOKKOS_INLINE_FUNCTION int operator()(double x) const {
    constexpr double last = (1 << digit * digits) - 1;
    return static_cast<int>(Kokkos::fmax(0.0, Kokkos::fmin(last, (x - lower) * scale)));
  }
};

}  // namespace
}  // namespace mpm

namespace Kokkos {
template <int Dim>
struct reduction_identity<mpm::Sum<Dim>> {
  KOKKOS_FORCEINLINE_FUNCTION static mpm::Sum<Dim> sum() { return {}; }
};
}  // namespace Kokkos

namespace mpm {

template <class Space, class T, int Dim>
BodyMeasure measure(const Core<Space, T, Dim>& s, int body) {
  // A sum of as many equal numbers, one after the other, would gather round-off of their number. A device
  // adds pair by pair.
  constexpr int together = is_device<Space> ? 1 : 256;
  const auto soil = s.soil.points;
  const auto position = positions_of(s);
  const int count = soil.count;
  const auto alone = s.strays.alone;
  const T least = static_cast<T>(s.strays.least_volume), most = static_cast<T>(s.strays.most_volume);
  const auto start_volume = s.strays.start_volume;
  const auto water = s.water;
  const auto density = s.density;
  const WaterInPores in_pores = s.flow.water;
  Sum<Dim> total;
  Kokkos::parallel_reduce(
      "mpm::measure", Kokkos::RangePolicy<Space>(s.space, 0, (count + together - 1) / together),
      KOKKOS_LAMBDA(int part, Sum<Dim>& sum) {
        Sum<Dim> own;
        const auto common = soil.bodies(body);
        const int end = Kokkos::min(count, (part + 1) * together);
        for (int p = part * together; p < end; ++p) {
          if (soil.body(p) != body) continue;
          const double mass = soil.mass_of(p, common), weight = soil.has_own_mass ? mass : 1;
          for (int d = 0; d < Dim; ++d) {
            const double x = position(p, d), v = soil.velocity(p)[d];
            own.m.lower[d] = Kokkos::fmin(own.m.lower[d], x);
            own.m.upper[d] = Kokkos::fmax(own.m.upper[d], x);
            own.m.momentum[d] += mass * v;
            own.m.centre[d] += weight * position.on_its_way(p, d);
            own.m.kinetic_energy += mass * v * v / 2;
          }
          own.m.mass += mass, own.m.weight += weight;
          own.m.stored_energy +=
              double(soil.volume(p)) * stored_energy(soil, common.material, in_pores.bulk_modulus, p);
          if (material_in(soil.materials(common.material)).saturated)
            add_pore_water(soil, in_pores, p, own.m);
          if (water.is_there()) own.m.water_energy += water_energy(soil, water, density, position, p);
          own.m.alone += is_alone(alone, soil.cell(p));
          own.m.limited += is_volume_at_bound({least, most}, own_volume_bounds(start_volume, soil, p), soil,
                                              p, T(position.spacing));
          if (soil.has_domain) own.m.stretched += is_longest(soil.domain(p));
          ++own.m.count;
        }
        sum += own;
      },
      Kokkos::Sum<Sum<Dim>>(total));
  for (int d = 0; d < Dim && total.m.weight > 0; ++d) total.m.centre[d] /= total.m.weight;
  return total.m;
}

/// By how much the square of a particle's wave speed counts more for the time step, where its domain is so
/// short or so long that a node of the rim is less stable than the Courant number allows for. A particle that
/// was split counts as a lone one: its neighbours may be lighter or gone.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION double rim_factor(const Soil<Space, T, Dim>& soil, int p, double rim_scale) {
  if (!soil.has_domain) return 1;
  const HalfLengths<T, Dim> half = any_domain_of(soil, p);
  double sum = 0;
  constexpr double k_whole = 0.75;  // of the mass of a particle that was not split
  const bool piece = soil.splits && soil.mass(p) < k_whole * double(soil.bodies(soil.body(p)).mass);
  for (int d = 0; d < Dim; ++d) {
    const double l = half[d];
    sum += piece ? 2 / l + 1 / (1 - l) : Kokkos::fmax(1 / l, 2 + 8 * l);
  }
  return Kokkos::fmax(1.0, rim_scale * sum);
}

/// lambda + 2 G [Pa] of a law at most, once soil in this state has been compressed by a volume strain.
template <class Law, class T, int Dim>
KOKKOS_INLINE_FUNCTION double modulus_after(const Law& law, const SymTensor<T, Dim>& stress,
                                            const LawState<T, state_size<Law>>& state, double compression) {
  if constexpr (requires { law.wave_modulus_after(stress, state, T(compression)); })
    if (compression > 0) return law.wave_modulus_after(stress, state, T(compression));
  return law.wave_modulus(stress, state);
}

template <class Space, class T, int Dim>
double fastest_wave(const Core<Space, T, Dim>& s, double compression) {
  const auto soil = s.soil.points;
  const double rim_scale = s.scheme.rim_scale;
  const auto flow = s.flow;
  double fastest = 0;  // m2/s2
  Kokkos::parallel_reduce(
      "mpm::fastest_wave", Kokkos::RangePolicy<Space>(s.space, 0, soil.count),
      KOKKOS_LAMBDA(int p, double& largest) {
        const auto of = soil.properties(p);
        const AnyMaterial<T>& material = material_in(soil.materials(of.material));
        SymTensor<T, Dim> stress = soil.stress(p);
        add_isotropic(stress, soil.excess_pore_pressure(material, p));
        material.visit([&](const auto& law) {
          const double modulus = modulus_after(law, stress, soil.state_of(law, p), compression) +
                                 double(material.pore_stiffness);
          const double volume = soil.volume(p) / gap_room(soil, p);  // as it is once it takes pressure
          const double square =
              material.saturated
                  ? fast_wave_square(modulus, porosity_of(soil, p), flow.pores(of.material).solid_density,
                                     flow.water.density, flow.water.bulk_modulus)
                  : modulus * volume / of.mass;
          largest = Kokkos::fmax(largest, square * rim_factor(soil, p, rim_scale));
        });
      },
      Kokkos::Max<double>(fastest));
  return Kokkos::sqrt(Kokkos::fmax(0.0, fastest));
}

template <class Space, class T, int Dim>
VelocityRange velocity_range(const Core<Space, T, Dim>& s) {
  const auto soil = s.soil.points;
  VelocityRange range;
  for (int d = 0; d < Dim; ++d) {
    Kokkos::MinMaxScalar<double> ends{0, 0};
    Kokkos::parallel_reduce(
        "mpm::velocity_range", Kokkos::RangePolicy<Space>(s.space, 0, soil.count),
        KOKKOS_LAMBDA(int p, Kokkos::MinMaxScalar<double>& sum) {
          const double v = soil.velocity(p)[d];
          sum.min_val = Kokkos::fmin(sum.min_val, v), sum.max_val = Kokkos::fmax(sum.max_val, v);
        },
        Kokkos::MinMax<double>(ends));
    range.least[d] = Kokkos::fmin(0.0, ends.min_val), range.most[d] = Kokkos::fmax(0.0, ends.max_val);
  }
  return range;
}

template <class Space, class T, int Dim>
double ranked_coordinate(const Core<Space, T, Dim>& s, int body, int d, long rank, const BodyMeasure& m,
                         const OverRanks& over) {
  const auto soil = s.soil.points;
  const auto position = positions_of(s);
  const Ruler ruler(m.lower[d], m.upper[d]);
  const Kokkos::RangePolicy<Space> range(s.space, 0, soil.count);
  const Kokkos::View<int*, typename Space::memory_space> counts("mpm::ranked_coordinate", 1 << Ruler::digit);
  int place = 0;  // on the ruler, of the particle sought: digit by digit, the highest first
  for (int shift = Ruler::digit * (Ruler::digits - 1); shift >= 0; shift -= Ruler::digit) {
    Kokkos::deep_copy(s.space, counts, 0);
    Kokkos::parallel_for(
        "mpm::count_by_digit", range, KOKKOS_LAMBDA(int p) {
          if (soil.body(p) != body) return;
          const int at = ruler(position(p, d)) >> shift;
          if (at >> Ruler::digit == place) Kokkos::atomic_inc(&counts(at - (place << Ruler::digit)));
        });
    const auto count = mirror_of(counts);
    if (over.sum) over.sum(count.data(), 1 << Ruler::digit);
    int digit = 0;
    while (rank > count(digit)) rank -= count(digit++);
    place = (place << Ruler::digit) + digit;
  }
  double x = m.lower[d];
  Kokkos::parallel_reduce(
      "mpm::largest_of_digits", range,
      KOKKOS_LAMBDA(int p, double& largest) {
        if (soil.body(p) == body && ruler(position(p, d)) == place)
          largest = Kokkos::fmax(largest, position(p, d));
      },
      Kokkos::Max<double>(x));
  if (over.largest) over.largest(&x);
  return x;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                              \
  template BodyMeasure measure(const Core<Space, T, Dim>&, int);                                    \
  template double fastest_wave(const Core<Space, T, Dim>&, double);                                 \
  template VelocityRange velocity_range(const Core<Space, T, Dim>&);                                \
  template double ranked_coordinate(const Core<Space, T, Dim>&, int, int, long, const BodyMeasure&, \
                                    const OverRanks&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
