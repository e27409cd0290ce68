#include "transfer/section_sums.hpp"

#include "base/copy.hpp"
#include "transfer/body_mask.hpp"
#include "transfer/particle_box.hpp"

namespace mpm {
namespace {

/// SectionSum of one body, for parallel_reduce.
template <int Dim>
struct Passing {
  double mass = 0, mass_flux = 0, volume_flux = 0, momentum_flux[Dim] = {};

  KOKKOS_INLINE_FUNCTION Passing& operator+=(const Passing& other) {
    mass += other.mass, mass_flux += other.mass_flux, volume_flux += other.volume_flux;
    for (int d = 0; d < Dim; ++d) momentum_flux[d] += other.momentum_flux[d];
    return *this;
  }
};

/// Adds particle p: what of it is beyond the plane, and what passes, as a mean over a strip of one cell
/// around the plane: at the plane itself particles come and go one by one.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION void add(const Positions<Space, T, Dim>& position, int p, int axis, double place,
                                Passing<Dim>& sum) {
  const auto& soil = position.soil;
  const ParticleBox<Dim> box = box_of(position, p);
  const double low = box.centre[axis] - box.half[axis], high = box.centre[axis] + box.half[axis];
  const bool ring = soil.rings && axis == 0;
  const double half = ring ? Kokkos::fmin(place, position.spacing / 2) : position.spacing / 2;
  if (!(high > place - half)) return;
  const double mass = soil.mass_of(p, soil.bodies(soil.body(p)));
  sum.mass += low >= place ? mass : mass * share_between(low, high, place, high, ring);
  if (low >= place + half) return;
  // share of the particle in a unit of length of the strip [1/m], times the velocity
  const double rate = share_between(low, high, place - half, place + half, ring) / (2 * half) *
                      double(soil.velocity(p)[axis]);
  sum.mass_flux += mass * rate, sum.volume_flux += double(soil.volume(p)) * rate;
  for (int d = 0; d < Dim; ++d) sum.momentum_flux[d] += mass * rate * double(soil.velocity(p)[d]);
}

}  // namespace
}  // namespace mpm

namespace Kokkos {
template <int Dim>
struct reduction_identity<mpm::Passing<Dim>> {
  KOKKOS_FORCEINLINE_FUNCTION static mpm::Passing<Dim> sum() { return {}; }
};
}  // namespace Kokkos

namespace mpm {
namespace {

/// The bodies of a plane.
std::vector<int> bodies_of(const SectionPlane& plane, std::size_t bodies) {
  if (!plane.bodies.empty()) return plane.bodies;
  std::vector<int> all;
  for (std::size_t b = 0; b < bodies; ++b) all.push_back(static_cast<int>(b));
  return all;
}

}  // namespace

template <class Space, class T, int Dim>
SectionSum section_sum(const Core<Space, T, Dim>& s, const SectionPlane& plane) {
  constexpr int together = is_device<Space> ? 1 : 256;  // as in measure()
  const auto position = positions_of(s);
  const auto density = mirror_of(s.density);
  const int count = s.soil.points.count, axis = plane.axis;
  const double place = plane.place;
  SectionSum all;
  for (const int body : bodies_of(plane, density.extent(0))) {
    Passing<Dim> sum;
    Kokkos::parallel_reduce(
        "mpm::section_sum", Kokkos::RangePolicy<Space>(s.space, 0, (count + together - 1) / together),
        KOKKOS_LAMBDA(int part, Passing<Dim>& total) {
          Passing<Dim> own;
          const int end = Kokkos::min(count, (part + 1) * together);
          for (int p = part * together; p < end; ++p) {
            if (position.soil.body(p) == body) add(position, p, axis, place, own);
          }
          total += own;
        },
        Kokkos::Sum<Passing<Dim>>(sum));
    all.mass += sum.mass, all.initial_volume += sum.mass / density(body);
    all.mass_flux += sum.mass_flux, all.volume_flux += sum.volume_flux;
    for (int d = 0; d < Dim; ++d) all.momentum_flux[d] += sum.momentum_flux[d];
  }
  return all;
}

template <class Space, class T, int Dim>
BeyondMask<Space> beyond_mask(const Core<Space, T, Dim>& s, const std::vector<SectionPlane>& planes) {
  const auto position = positions_of(s);
  const BeyondMask<Space> mask("mpm::beyond_mask", s.soil.points.count);
  for (std::size_t n = 0; n < planes.size(); ++n) {
    const int axis = planes[n].axis;
    const double place = planes[n].place;
    const std::uint64_t bit = std::uint64_t(1) << n;
    Kokkos::parallel_for(
        "mpm::beyond_mask", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
        KOKKOS_LAMBDA(int p) {
          if (position(p, axis) > place) mask(p) |= bit;
        });
  }
  return mask;
}

template <class Space, class T, int Dim>
void add_lost_beyond(const Core<Space, T, Dim>& s, const std::vector<SectionPlane>& planes,
                     const BeyondMask<Space>& beyond, std::vector<SectionSum>& lost) {
  const auto soil = s.soil.points;
  const auto address = s.soil.address;
  const auto density = mirror_of(s.density);
  for (std::size_t n = 0; n < planes.size(); ++n) {
    const std::uint64_t bit = std::uint64_t(1) << n;
    for (const int body : bodies_of(planes[n], density.extent(0))) {
      double mass = 0;
      Kokkos::parallel_reduce(
          "mpm::add_lost_beyond", Kokkos::RangePolicy<Space>(s.space, 0, soil.count),
          KOKKOS_LAMBDA(int p, double& sum) {
            if (address(p) < 0 && soil.body(p) == body && (beyond(p) & bit) != 0)
              sum += soil.mass_of(p, soil.bodies(body));
          },
          mass);
      lost[n].mass += mass, lost[n].initial_volume += mass / density(body);
    }
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                  \
  template SectionSum section_sum(const Core<Space, T, Dim>&, const SectionPlane&);                     \
  template BeyondMask<Space> beyond_mask(const Core<Space, T, Dim>&, const std::vector<SectionPlane>&); \
  template void add_lost_beyond(const Core<Space, T, Dim>&, const std::vector<SectionPlane>&,           \
                                const BeyondMask<Space>&, std::vector<SectionSum>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
