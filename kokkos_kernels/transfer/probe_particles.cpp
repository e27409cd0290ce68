#include "transfer/probe_particles.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "base/copy.hpp"
#include "physics/materials/any.hpp"
#include "transfer/body_mask.hpp"
#include "transfer/particle_box.hpp"

namespace mpm {
namespace {

/// A ProbeRegion for kernels.
struct Region {
  double centre[3], reach[3];
  bool box;
  int id;
};

/// Which particle is in which region.
template <class Space, class T, int Dim>
struct Membership {
  Positions<Space, T, Dim> position;
  Kokkos::View<Region*, typename Space::memory_space> regions;
  BodyMask<Space> counts;

  KOKKOS_INLINE_FUNCTION bool operator()(int n, int p) const {
    const auto& soil = position.soil;
    const Region& region = regions(n);
    if (!counts(n, soil.body(p))) return false;
    if (region.id >= 0)
      return soil.id(p) == region.id || (soil.splits && static_cast<int>(soil.ancestor(p)) == region.id);
    const ParticleBox<Dim> box = box_of(position, p);
    for (int d = 0; d < Dim; ++d) {
      const double reach = region.reach[d] + (region.box ? box.half[d] : 0.0);
      if (!(Kokkos::fabs(box.centre[d] - region.centre[d]) <= reach)) return false;
    }
    return true;
  }
};

/// The record of particle p of a region.
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION ProbeParticle record_of(const Positions<Space, T, Dim>& position, int region, int p) {
  const auto& soil = position.soil;
  const BodyProperties<T> of = soil.properties(p);
  const ParticleBox<Dim> box = box_of(position, p);
  ProbeParticle record{};
  record.region = region, record.id = soil.id(p), record.body = soil.body(p);
  record.mass = of.mass, record.volume = soil.volume(p);
  record.excess_pressure = soil.excess_pore_pressure(material_in(soil.materials(of.material)), p);
  for (int d = 0; d < Dim; ++d) {
    record.position[d] = position(p, d);
    record.half_length[d] = box.half[d];
    record.velocity[d] = soil.velocity(p)[d];
  }
  for (int k = 0; k < sym_size<Dim>; ++k) record.stress[k] = soil.stress(p)[k];
  return record;
}

/// Square of the distance of a particle from a place [m2].
template <class Space, class T, int Dim>
struct SquareTo {
  Positions<Space, T, Dim> position;
  Vector<double, Dim> place;

  KOKKOS_INLINE_FUNCTION double operator()(int p) const {
    double square = 0;
    for (int d = 0; d < Dim; ++d) square += (position(p, d) - place[d]) * (position(p, d) - place[d]);
    return square;
  }
};

template <class Space>
Kokkos::View<Region*, typename Space::memory_space> to_device(const std::vector<ProbeRegion>& regions) {
  const Kokkos::View<Region*, typename Space::memory_space> view("mpm::probe_regions", regions.size());
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t n = 0; n < regions.size(); ++n) {
    const ProbeRegion& from = regions[n];
    for (int d = 0; d < 3; ++d) host(n).centre[d] = from.centre[d], host(n).reach[d] = from.reach[d];
    host(n).box = from.box, host(n).id = from.id;
  }
  copy(view, host);
  return view;
}

}  // namespace

template <class Space, class T, int Dim>
std::vector<ProbeParticle> particles_in(const Core<Space, T, Dim>& s,
                                        const std::vector<ProbeRegion>& regions) {
  using Memory = typename Space::memory_space;
  const Membership<Space, T, Dim> is_in{positions_of(s), to_device<Space>(regions), mask_of(s, regions)};
  const auto position = is_in.position;
  const int all = static_cast<int>(regions.size());
  const Kokkos::RangePolicy<Space> range(s.space, 0, s.soil.points.count);
  long found = 0;
  Kokkos::parallel_reduce(
      "mpm::count_probe_particles", range,
      KOKKOS_LAMBDA(int p, long& sum) {
        for (int n = 0; n < all; ++n) sum += is_in(n, p);
      },
      found);
  const Kokkos::View<ProbeParticle*, Memory> records("mpm::probe_particles", found);
  const Kokkos::View<int, Memory> next("mpm::next_probe_particle");
  Kokkos::parallel_for(
      "mpm::take_probe_particles", range, KOKKOS_LAMBDA(int p) {
        for (int n = 0; n < all; ++n) {
          if (is_in(n, p)) records(Kokkos::atomic_fetch_add(&next(), 1)) = record_of(position, n, p);
        }
      });
  s.space.fence("mpm::particles_in");
  const auto host = mirror_of(records);
  std::vector<ProbeParticle> particles(host.data(), host.data() + host.extent(0));
  std::sort(particles.begin(), particles.end(), [](const ProbeParticle& a, const ProbeParticle& b) {
    return std::tie(a.region, a.id) < std::tie(b.region, b.id);
  });
  return particles;
}

template <class Space, class T, int Dim>
NearestParticle nearest_particle(const Core<Space, T, Dim>& s, const std::array<double, 3>& place,
                                 const std::vector<int>& bodies, const std::function<void(double*)>& least) {
  const std::vector<SectionPlane> lists{{0, 0, bodies}};
  const BodyMask<Space> counts = mask_of(s, lists);
  const auto position = positions_of(s);
  Vector<double, Dim> at;
  for (int d = 0; d < Dim; ++d) at[d] = place[d];
  const SquareTo<Space, T, Dim> square_of{position, at};
  const Kokkos::RangePolicy<Space> range(s.space, 0, s.soil.points.count);
  NearestParticle nearest{std::numeric_limits<double>::infinity(), std::numeric_limits<int>::max()};
  Kokkos::parallel_reduce(
      "mpm::nearest_distance", range,
      KOKKOS_LAMBDA(int p, double& smallest) {
        if (counts(0, position.soil.body(p))) smallest = Kokkos::fmin(smallest, square_of(p));
      },
      Kokkos::Min<double>(nearest.square));
  if (least) least(&nearest.square);
  const double square = nearest.square;
  Kokkos::parallel_reduce(
      "mpm::nearest_particle", range,
      KOKKOS_LAMBDA(int p, int& smallest) {
        if (counts(0, position.soil.body(p)) && square_of(p) == square)
          smallest = Kokkos::min(smallest, position.soil.id(p));
      },
      Kokkos::Min<int>(nearest.id));
  return nearest;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                \
  template std::vector<ProbeParticle> particles_in(const Core<Space, T, Dim>&,                        \
                                                   const std::vector<ProbeRegion>&);                  \
  template NearestParticle nearest_particle(const Core<Space, T, Dim>&, const std::array<double, 3>&, \
                                            const std::vector<int>&, const std::function<void(double*)>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
