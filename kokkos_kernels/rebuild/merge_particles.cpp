#include "rebuild/merge_particles.hpp"

#include "base/number_of.hpp"
#include "physics/domain.hpp"
#include "rebuild/shift_particle.hpp"

namespace mpm {
namespace {

/// Particles that merging has taken, and the kinetic energy [J] that went with them.
struct Taken {
  double count = 0, energy = 0;
  KOKKOS_INLINE_FUNCTION Taken& operator+=(const Taken& other) {
    count += other.count, energy += other.energy;
    return *this;
  }
};

}  // namespace
}  // namespace mpm

namespace Kokkos {
template <>
struct reduction_identity<mpm::Taken> {
  KOKKOS_FORCEINLINE_FUNCTION static mpm::Taken sum() { return {}; }
};
}  // namespace Kokkos

namespace mpm {
namespace {

/// Brings the values of particle q to those of particle p, by the rule of each field.
template <class T>
struct TakeUp {
  int p, q;
  double mass_share;                // of p in the mass of both
  double volume_of_p, volume_of_q;  // shares in the volume of both

  template <class Field>
  KOKKOS_INLINE_FUNCTION void operator()(const ParticleField& row, const Field& field) const {
    using Value = typename Field::non_const_value_type;
    using N = Number<Value>;
    if constexpr (std::is_same_v<N, T>) {
      N* const to = reinterpret_cast<N*>(&field(p));
      const N* const from = reinterpret_cast<const N*>(&field(q));
      for (int k = 0; k < components_of<Value>; ++k) to[k] = joined(row.merged, to[k], from[k]);
    }
  }
  KOKKOS_INLINE_FUNCTION T joined(Merged rule, T at_p, T at_q) const {
    switch (rule) {
      case Merged::mass_mean: return T(mass_share * at_p + (1 - mass_share) * at_q);
      case Merged::volume_mean: return T(volume_of_p) * at_p + T(volume_of_q) * at_q;
      case Merged::sum: return T(double(at_p) + double(at_q));
      case Merged::kept: break;
    }
    return at_p;
  }
};

/// Merges particles of one body, cell by cell.
template <class Space, class T, int Dim>
struct MergeInCell {
  using Memory = typename Space::memory_space;
  Soil<Space, T, Dim> soil;
  Kokkos::View<int*, Memory> begin;  // of the last rebuild
  Kokkos::View<long*, Memory> address;
  decltype(Strays<Space>::alone) alone;
  Grid<T, Dim> grid;
  int body;

  KOKKOS_INLINE_FUNCTION void operator()(int cell, Taken& sum) const {
    constexpr double k_crowded = 2;
    const double most =
        k_crowded * filled_by<Dim>(double(soil.bodies(body).half_length.l)) * (1 + k_round_off);
    const int first = begin(cell), last = begin(cell + 1);
    if (last - first <= most || is_alone(alone, cell)) return;
    int left = 0;
    for (int p = first; p < last; ++p) left += address(p) >= 0;
    for (int p, q; left > most && find_pair(first, last, p, q); --left) {
      sum.count += 1, sum.energy += merge(p, q);
    }
  }

  /// Particles that loads act on stay: they may be at surfaces that face each other.
  KOKKOS_INLINE_FUNCTION bool may_merge(int p) const {
    bool loaded = false;
    for (int k = 0; k < soil.face_count; ++k) loaded = loaded || soil.faces[k](p)[FaceTerms<Dim>::load] > 0;
    return address(p) >= 0 && soil.body(p) == body && !loaded;
  }

  /// The pair whose common domain is smallest, of equal ones the first: a cell's particles lie by rising id.
  KOKKOS_INLINE_FUNCTION bool find_pair(int first, int last, int& p, int& q) const {
    constexpr double k_short = 0.85;  // of the length of a domain that is split
    const BodyProperties<T>& of = soil.bodies(body);
    const double most_mass = double(of.mass) * (1 + k_round_off);
    const double longest = k_short * split_length(double(of.half_length.l));
    double least = longest * longest;
    bool found = false;
    for (int a = first; a < last; ++a) {
      if (!may_merge(a)) continue;
      for (int b = a + 1; b < last; ++b) {
        if (!may_merge(b) || double(soil.mass(a)) + double(soil.mass(b)) > most_mass) continue;
        const double size = size_of(common_domain(a, b));
        if (size >= least) continue;
        least = size, p = a, q = b, found = true;
      }
    }
    return found;
  }

  /// Share of p in the mass of p and q.
  KOKKOS_INLINE_FUNCTION double share(int p, int q) const {
    return double(soil.mass(p)) / (double(soil.mass(p)) + double(soil.mass(q)));
  }
  /// From p to q [cells].
  KOKKOS_INLINE_FUNCTION Vector<double, Dim> between(int p, int q) const {
    const Coord<Dim> from = cell_of(grid, address(p)), to = cell_of(grid, address(q));
    Vector<double, Dim> way;
    for (int d = 0; d < Dim; ++d)
      way[d] =
          grid.shortest(d, to[d] - from[d] + (double(soil.coordinate(q)[d]) - double(soil.coordinate(p)[d])));
    return way;
  }
  /// The moments of both domains about their centre of mass.
  KOKKOS_INLINE_FUNCTION DomainMoments<double, Dim> common_domain(int p, int q) const {
    const double a = share(p, q), b = 1 - a;
    const Vector<double, Dim> way = between(p, q);
    const DomainMoments<T, Dim> one = soil.domain(p), other = soil.domain(q);
    DomainMoments<double, Dim> m;
    for (int i = 0; i < Dim; ++i)
      for (int j = i; j < Dim; ++j) {
        const int k = moment_index<Dim>(i, j);
        m[k] = a * double(one[k]) + b * double(other[k]) + 3 * a * b * way[i] * way[j];
      }
    return m;
  }
  /// An upper bound of the square of a domain's longest half length [cells2]: the largest sum of a row.
  KOKKOS_INLINE_FUNCTION static double size_of(const DomainMoments<double, Dim>& m) {
    double most = 0;
    for (int i = 0; i < Dim; ++i) {
      double row = 0;
      for (int j = 0; j < Dim; ++j) row += Kokkos::fabs(m[moment_index<Dim>(i, j)]);
      most = Kokkos::fmax(most, row);
    }
    return most;
  }

  /// Makes p of both. Returns the kinetic energy [J] of one against the other.
  KOKKOS_INLINE_FUNCTION double merge(int p, int q) const {
    const double a = share(p, q), b = 1 - a, mass = double(soil.mass(p)) + double(soil.mass(q));
    const double volume = double(soil.volume(p)) + double(soil.volume(q));
    const DomainMoments<double, Dim> m = common_domain(p, q);
    Vector<double, Dim> way = between(p, q);
    for (int d = 0; d < Dim; ++d) way[d] *= b;
    Placed<T, Dim> middle{address(p), soil.coordinate(p)};
    if (shift(grid, way, middle)) put(soil, address, p, middle);  // both are in the mesh, and so is this
    double square = 0;
    for (int d = 0; d < Dim; ++d) {
      const double difference = double(soil.velocity(p)[d]) - double(soil.velocity(q)[d]);
      square += difference * difference;
    }
    const Soil<Space, T, Dim> points = soil;
    for_each_field_of(TakeUp<T>{p, q, a, double(soil.volume(p)) / volume, double(soil.volume(q)) / volume},
                      points);
    for (int k = 0; k < Dim * (Dim + 1) / 2; ++k) soil.domain(p)[k] = T(m[k]);
    soil.half_length(p) = to_store<Space>(bounded_half_lengths(soil.domain(p), soil.least_half_length));
    address(q) = -1;
    return a * b * mass * square / 2;
  }
};

}  // namespace

template <class Space, class T, int Dim>
void merge_particles(Core<Space, T, Dim>& s) {
  const int cells = s.patches.slots * Patch<Dim>::cells;
  for (int b = 0; b < static_cast<int>(s.strays.lost.size()); ++b) {
    const MergeInCell<Space, T, Dim> merge{
        s.soil.points, s.soil.bins.begin, s.soil.address, s.strays.alone, s.grid, b};
    Taken taken;
    Kokkos::parallel_reduce("mpm::merge_particles", Kokkos::RangePolicy<Space>(s.space, 0, cells), merge,
                            Kokkos::Sum<Taken>(taken));
    s.strays.lost[b].merged += taken.count, s.strays.lost[b].merged_energy += taken.energy;
  }
}

#define MPM_INSTANTIATE(Space, T, Dim) template void merge_particles(Core<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
