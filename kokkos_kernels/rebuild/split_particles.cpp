#include "rebuild/split_particles.hpp"

#include <algorithm>

#include "base/copy.hpp"
#include "physics/domain.hpp"
#include "rebuild/migrate.hpp"
#include "rebuild/rebuild.hpp"
#include "rebuild/shift_particle.hpp"

namespace mpm {
namespace {

/// The longest axis of a domain: its half length [cells] and its direction.
template <int Dim>
struct LongestAxis {
  double half_length = 0;
  Vector<double, Dim> direction{};
};

/// By Jacobi rotations of the moments, which in 2D end after the first.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION LongestAxis<Dim> longest_axis(const DomainMoments<T, Dim>& m) {
  constexpr int k_sweeps = Dim == 2 ? 1 : 8;
  double a[Dim][Dim], axes[Dim][Dim] = {};
  for (int i = 0; i < Dim; ++i) {
    axes[i][i] = 1;
    for (int j = 0; j < Dim; ++j) a[i][j] = m[moment_index<Dim>(i, j)];
  }
  for (int sweep = 0; sweep < k_sweeps; ++sweep)
    for (int p = 0; p < Dim; ++p)
      for (int q = p + 1; q < Dim; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (Kokkos::fabs(theta) + Kokkos::sqrt(theta * theta + 1));
        const double c = 1 / Kokkos::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < Dim; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq, a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < Dim; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk, a[q][k] = s * pk + c * qk;
        }
        for (int k = 0; k < Dim; ++k) {
          const double kp = axes[k][p], kq = axes[k][q];
          axes[k][p] = c * kp - s * kq, axes[k][q] = s * kp + c * kq;
        }
      }
  int longest = 0;
  for (int d = 1; d < Dim; ++d)
    if (a[d][d] > a[longest][longest]) longest = d;
  LongestAxis<Dim> axis;
  axis.half_length = Kokkos::sqrt(Kokkos::fmax(0.0, a[longest][longest]));
  for (int d = 0; d < Dim; ++d) axis.direction[d] = axes[d][longest];
  return axis;
}

/// Which particles are split.
template <class Space, class T, int Dim>
struct IsSplit {
  Soil<Space, T, Dim> soil;
  Kokkos::View<int*, typename Space::memory_space> begin;  // of the last rebuild
  Kokkos::View<long*, typename Space::memory_space> address;
  decltype(Strays<Space>::alone) alone;

  KOKKOS_INLINE_FUNCTION bool operator()(int p) const {
    const int cell = soil.cell(p);
    if (address(p) < 0 || is_alone(alone, cell)) return false;
    const BodyProperties<T>& of = soil.bodies(soil.body(p));
    const double l = of.half_length.l;
    if (begin(cell + 1) - begin(cell) > filled_by<Dim>(l) * (1 + k_round_off)) return false;
    if (soil.mass(p) < 2 * k_least_piece * double(of.mass) * (1 - k_round_off)) return false;
    return longest_axis<T, Dim>(soil.domain(p)).half_length > split_length(l);
  }
};

/// Halves the sums of a particle.
struct Halve {
  int p, other;

  template <class Field>
  KOKKOS_INLINE_FUNCTION void operator()(const ParticleField& row, const Field& field) const {
    if constexpr (std::is_floating_point_v<typename Field::non_const_value_type>)
      if (row.merged == Merged::sum) field(p) = field(other) = field(p) / 2;
  }
};

/// Splits particle p; `other`, which is its copy, becomes the second half.
template <class Space, class T, int Dim>
struct Split {
  Soil<Space, T, Dim> soil;
  Kokkos::View<long*, typename Space::memory_space> address;
  Grid<T, Dim> grid;

  KOKKOS_INLINE_FUNCTION void operator()(int p, int other) const {
    const LongestAxis<Dim> axis = longest_axis<T, Dim>(soil.domain(p));
    // A domain longer than the shape functions see is that of soil which others filled up while it flowed:
    // its halves stay near, and forget how long it was.
    const double length = axis.half_length, half = Kokkos::fmin(length, k_most_half_length) / 2;
    Vector<double, Dim> offset, back;
    for (int d = 0; d < Dim; ++d) offset[d] = half * axis.direction[d];
    DomainMoments<T, Dim> m = soil.domain(p);
    for (int i = 0; i < Dim; ++i)
      for (int j = i; j < Dim; ++j)
        m[moment_index<Dim>(i, j)] -=
            T((length * length - half * half) * axis.direction[i] * axis.direction[j]);
    soil.domain(p) = soil.domain(other) = m;
    soil.half_length(p) = soil.half_length(other) =
        to_store<Space>(bounded_half_lengths(m, soil.least_half_length));
    const Soil<Space, T, Dim> points = soil;
    for_each_field_of(Halve{p, other}, points);
    for (int k = 0; k < soil.face_count; ++k) {
      Face<Dim>& face = soil.faces[k](p);
      for (int d = 0; d < FaceTerms<Dim>::steps; ++d) face[d] /= 2;  // the areas
      soil.faces[k](other) = face;
    }
    // Near a side of the mesh both halves stay as much nearer to the place of the whole.
    constexpr int k_tries = 4;
    for (int n = 0; n < k_tries; ++n) {
      for (int d = 0; d < Dim; ++d) back[d] = -offset[d];
      Placed<T, Dim> here{address(p), soil.coordinate(p)}, there = here;
      if (shift(grid, offset, there) && shift(grid, back, here)) {
        put(soil, address, p, here), put(soil, address, other, there);
        return;
      }
      for (int d = 0; d < Dim; ++d) offset[d] /= 2;
    }
  }
};

/// Copies the entries at `places` of a field behind its first ones.
template <class Space, class Field>
void copy_some(const Space& space, const Field& field,
               const Kokkos::View<int*, typename Space::memory_space>& places, int first) {
  Kokkos::parallel_for(
      "mpm::copy_some", Kokkos::RangePolicy<Space>(space, 0, places.extent(0)),
      KOKKOS_LAMBDA(int n) { field(first + n) = field(places(n)); });
}

}  // namespace

template <class Space, class T, int Dim>
std::vector<Splitting> find_splittings(Core<Space, T, Dim>& s) {
  using Range = Kokkos::RangePolicy<Space>;
  const int count = s.soil.points.count;
  const auto id = s.soil.points.id;
  const IsSplit<Space, T, Dim> is_split{s.soil.points, s.soil.bins.begin, s.soil.address, s.strays.alone};
  int found = 0;
  Kokkos::parallel_reduce(
      "mpm::count_splittings", Range(s.space, 0, count), KOKKOS_LAMBDA(int p, int& n) { n += is_split(p); },
      found);
  if (found == 0) return {};
  const Kokkos::View<Splitting*, typename Space::memory_space> list(
      Kokkos::view_alloc("mpm::splittings", Kokkos::WithoutInitializing), found);
  Kokkos::parallel_scan(
      "mpm::find_splittings", Range(s.space, 0, count), KOKKOS_LAMBDA(int p, int& n, bool last) {
        if (!is_split(p)) return;
        if (last) list(n) = {p, id(p)};
        ++n;
      });
  const auto host = mirror_of(list);
  std::vector<Splitting> all(host.data(), host.data() + found);
  std::sort(all.begin(), all.end(), [](const Splitting& a, const Splitting& b) { return a.id < b.id; });
  return all;
}

template <class Space, class T, int Dim>
void split_particles(Core<Space, T, Dim>& s, const std::vector<Splitting>& splittings,
                     const std::vector<int>& ids) {
  using Range = Kokkos::RangePolicy<Space>;
  const int more = static_cast<int>(splittings.size()), first = s.soil.points.all;
  if (more == 0) return;
  reserve_particles(s, first + more);
  const Kokkos::View<int*, typename Space::memory_space> places("mpm::splitting_places", more),
      numbers("mpm::splitting_ids", more);
  const auto place = Kokkos::create_mirror_view(places), number = Kokkos::create_mirror_view(numbers);
  for (int n = 0; n < more; ++n) place(n) = splittings[n].place, number(n) = ids[n];
  copy(places, place), copy(numbers, number);
  const auto copy = [&](const auto& field) { copy_some(s.space, field, places, first); };
  auto points = s.soil.points;
  for_each_field(points, copy);
  copy(points.cell), copy(s.soil.address);
  const Split<Space, T, Dim> split{points, s.soil.address, s.grid};
  Kokkos::parallel_for(
      "mpm::split", Range(s.space, 0, more), KOKKOS_LAMBDA(int n) {
        points.id(first + n) = numbers(n);
        split(places(n), first + n);
      });
  s.soil.points.count = s.soil.points.all = first + more;
  s.space.fence("mpm::split_particles");
}

#define MPM_INSTANTIATE(Space, T, Dim)                                   \
  template std::vector<Splitting> find_splittings(Core<Space, T, Dim>&); \
  template void split_particles(Core<Space, T, Dim>&, const std::vector<Splitting>&, const std::vector<int>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
