#include "functions/surface_loads.hpp"

#include "base/ensure.hpp"
#include "base/small_matrix.hpp"
#include "loops/particle_to_node.hpp"

namespace mpm {
namespace {

/// Half of the thickness of a face [cells]: so little that the weights are those of a plane to round-off.
template <class T>
inline constexpr T k_thin = sizeof(T) == sizeof(double) ? T(1e-12) : T(1e-6);

/// Cells by which a face may reach beyond a row of nodes and still act at that row: the nodes beyond may have
/// less than TimeScheme::mass_cut, where no force acts.
template <class T>
inline constexpr T k_at_row = sizeof(T) == sizeof(double) ? T(1e-6) : T(1e-5);

/// Particles that loads act on.
template <class Space, class T, int Dim>
struct LoadedParticles {
  Soil<Space, T, Dim> soil;
  decltype(SurfaceLoads<Space, T, Dim>::loaded) loaded;
  decltype(Strays<Space>::alone) alone;

  LoadedParticles(const Core<Space, T, Dim>& s, const SurfaceLoads<Space, T, Dim>& loads)
      : soil(s.soil.points), loaded(loads.loaded), alone(s.strays.alone) {}
  /// Number of the load of face k of particle p; -1 where there is none.
  KOKKOS_INLINE_FUNCTION int load_of(int p, int k) const {
    return static_cast<int>(soil.faces[k](p)[FaceTerms<Dim>::load]) - 1;
  }
  /// Area of all faces of particle p along an axis [m2].
  KOKKOS_INLINE_FUNCTION double area_along(int p, int axis) const {
    double area = 0;
    for (int k = 0; k < soil.face_count; ++k)
      if (load_of(p, k) >= 0) area += soil.faces[k](p)[FaceTerms<Dim>::area + axis];
    return area;
  }
  KOKKOS_INLINE_FUNCTION bool in_loaded_slot(int p) const {
    return loaded(soil.cell(p) / Patch<Dim>::cells) != 0;
  }
  /// Whether loads act on particle p: particles that are alone fly free.
  KOKKOS_INLINE_FUNCTION bool has_load(int p) const {
    if (!in_loaded_slot(p) || is_alone(alone, soil.cell(p))) return false;
    for (int k = 0; k < soil.face_count; ++k)
      if (load_of(p, k) >= 0) return true;
    return false;
  }
};

/// The box of a particle in the plane: its centre and half lengths [cells, in the frame of its cell]. Along
/// the radius of a ring it is as far out as the mean of a linear field over the ring asks, and no further
/// than the ring.
template <class T, int Dim>
struct FaceBox {
  Vector<T, Dim> centre, half;
};
template <class Space, class T, int Dim>
KOKKOS_INLINE_FUNCTION FaceBox<T, Dim> box_across(const Soil<Space, T, Dim>& soil, int p, int axis) {
  FaceBox<T, Dim> box;
  const HalfLengths<T, Dim> half = any_domain_of(soil, p);
  for (int d = 0; d < Dim; ++d) box.centre[d] = soil.coordinate(p)[d], box.half[d] = half[d].l;
  if constexpr (Dim == 2)
    if (soil.rings) {
      const RingDomain<T> ring{half[0], axis_of<T>(soil, soil.cell(p))};
      const RadialPart<T> part = radial_part(box.centre[0], ring);
      const T shift = axis == 0 ? T(0) : radial_centroid(part, ring) - part.centre;
      box.centre[0] = part.centre + shift, box.half[0] = part.half.l - shift;
    }
  return box;
}

/// The side of a particle's box that faces along an axis with this area stand on, `half` [cells] from the
/// box's centre; the middle of the box where the area is 0. It is thinner than round-off sees.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION FaceBox<T, Dim> side_of(FaceBox<T, Dim> box, int axis, double area, T half) {
  const T side = area > 0 ? T(1) : area < 0 ? T(-1) : T(0);
  T& at = box.centre[axis];
  at += side * half;
  if (const T row = Kokkos::round(at), beyond = side * (at - row); beyond > 0 && beyond < k_at_row<T>)
    at = row;
  box.half[axis] = k_thin<T>;
  return box;
}

/// The faces of particles along an axis, and the forces on them.
template <class Space, class T, int Dim>
struct PlaceFaces {
  using F = FaceTerms<Dim>;
  LoadedParticles<Space, T, Dim> particles;
  SurfaceLoads<Space, T, Dim> loads;
  int axis;
  LoadsOn on;

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    if (!particles.in_loaded_slot(p)) return;
    double force[Dim] = {};
    if (particles.has_load(p))
      for (int k = 0; k < particles.soil.face_count; ++k) add_face(p, k, force);
    const FaceBox<T, Dim> box = box_across(particles.soil, p, axis);
    const double area = particles.has_load(p) ? particles.area_along(p, axis) : 0;
    const FaceBox<T, Dim> side = side_of(box, axis, area, box.half[axis]);
    loads.coordinate(p) = side.centre, loads.half_length(p) = to_store<Space>(side.half);
    for (int d = 0; d < Dim; ++d) loads.force(p)[d] = static_cast<T>(force[d]);
  }

 private:
  /// Each component of a pressure acts on the face that is normal to it. A traction is divided among the
  /// faces as the components of the area.
  KOKKOS_INLINE_FUNCTION void add_face(int p, int k, double (&force)[Dim]) const {
    const int load = particles.load_of(p, k);
    if (load < 0) return;
    const Face<Dim> face = particles.soil.faces[k](p);
    const SurfaceLoad<Dim>& now = loads.now(load);
    if (on == LoadsOn::pores) {
      if (now.on_pores != 0) force[axis] -= now.pressure * face[F::area + axis];
      return;
    }
    double size = 0;
    for (int d = 0; d < Dim; ++d) size += Kokkos::fabs(face[F::area + d]);
    const double share = size > 0 ? Kokkos::fabs(face[F::area + axis]) / size : axis == 0 ? 1.0 : 0.0;
    force[axis] -= now.pressure * face[F::area + axis];
    for (int d = 0; d < Dim; ++d) force[d] += now.traction[d] * face[F::start] * share;
  }
};

/// Areas after a step. The part of an area vector along an axis is that of a side of the box, which stretches
/// and turns as the velocities along that side do: da_k = (sum of dv_e/dx_e, e not k) a_k, da_j = - dv_k/dx_j
/// a_k, which is Nanson's formula with the gradient at the side. The rule of the mean (Cayley) keeps the size
/// of the area in a spin.
template <class Space, class T, int Dim>
struct FollowSurfaces {
  using F = FaceTerms<Dim>;
  LoadedParticles<Space, T, Dim> particles;
  NodePlaces<Space, T, Dim> places;
  decltype(Nodes<Space, T, Dim>::kinematics) kinematics;
  ControlView<Space> control;
  double half_step;  // s

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    if (control().paused || !particles.has_load(p)) return;
    double before[Dim][Dim] = {}, after[Dim][Dim] = {},
           inverse[Dim][Dim];  // I - K dt/2, I + K dt/2, da/dt = K a
    for (int axis = 0; axis < Dim; ++axis) {
      double rates[Dim] = {};
      side_rates(p, axis, rates);
      for (int d = 0; d < Dim; ++d) {
        before[d][axis] = (d == axis ? 1.0 : 0.0) - rates[d];
        after[d][axis] = (d == axis ? 1.0 : 0.0) + rates[d];
      }
    }
    invert(before, inverse);
    for (int k = 0; k < particles.soil.face_count; ++k) {
      if (particles.load_of(p, k) < 0) continue;
      Face<Dim>& face = particles.soil.faces[k](p);
      double area[Dim], middle[Dim] = {};
      for (int d = 0; d < Dim; ++d) area[d] = face[F::area + d];
      for (int d = 0; d < Dim; ++d)
        for (int e = 0; e < Dim; ++e) middle[d] += after[d][e] * area[e];
      for (int d = 0; d < Dim; ++d) {
        double sum = 0;
        for (int e = 0; e < Dim; ++e) sum += inverse[d][e] * middle[e];
        face[F::area + d] = sum;
      }
    }
  }

 private:
  /// Rates of the area vector with the part of it along an axis, times half the step.
  KOKKOS_INLINE_FUNCTION void side_rates(int p, int axis, double (&rates)[Dim]) const {
    const auto& soil = particles.soil;
    const FaceBox<T, Dim> box = box_across(soil, p, axis);
    const double area = particles.area_along(p, axis);
    // Soil that has become thinner ends before the side of a box that keeps its size.
    const double thickness = double(soil.volume(p)) / Kokkos::fabs(area) * double(places.grid.inv_spacing);
    const T depth = thickness < 2 * double(box.half[axis]) ? static_cast<T>(thickness / 2) : box.half[axis];
    const FaceBox<T, Dim> side = side_of(box, axis, area, depth);
    HalfLengths<T, Dim> half;
    for (int d = 0; d < Dim; ++d) half[d] = HalfLength<T>(side.half[d]);
    const double scale = half_step * double(places.grid.inv_spacing);
    double hoop = 0;  // 1 / radius [1/cell]
    if constexpr (Dim == 2)
      if (soil.rings) {
        const double radius = side.centre[0] - axis_of<T>(soil, soil.cell(p));
        hoop = radius > 0 ? 1 / radius : 0;
      }
    for_each_node_at<Kind::motion>(
        side.centre, soil.cell(p), half, places, [&](int i, T w, const auto& grad, auto&&, auto&& sign) {
          const auto v = [&](int d) {
            return scale * double(sign(d) * kinematics(i, NodeKinematics<Dim>::velocity + d));
          };
          rates[axis] += v(0) * double(w) * hoop;
          for (int d = 0; d < Dim; ++d) {
            if (d == axis) continue;
            rates[axis] += v(d) * double(grad[d]);
            rates[d] -= v(axis) * double(grad[d]);
          }
        });
  }
};

/// Work of the loads of this rank at the nodes, with the mean of a node's velocity before and after the step.
template <class Space, class T, int Dim>
void add_load_work(const Core<Space, T, Dim>& s, const SurfaceLoads<Space, T, Dim>& loads,
                   const EnergyWorks<Space, T, Dim>& energy, double dt) {
  using S = SoilTerms<Dim>;
  const auto control = s.control;
  const auto load = s.nodes.load;
  const auto soil = s.nodes.soil;
  const auto kinematics = s.nodes.kinematics;
  const double mass_cut = s.scheme.mass_cut;
  const auto of_step = loads.of_step;
  Kokkos::parallel_reduce(
      "mpm::load_work", Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count()),
      KOKKOS_LAMBDA(int i, double& sum) {
        const double m_i = soil(i, S::mass);
        if (control().paused || !(m_i > mass_cut)) return;  // no force acts on a node of less mass
        for (int d = 0; d < Dim; ++d) {
          const double v = soil(i, S::momentum + d) / m_i + kinematics(i, NodeKinematics<Dim>::velocity + d);
          sum += double(load(i, d)) * v * (dt / 2);
        }
      },
      Kokkos::Sum<double, typename Space::memory_space>(of_step));
  const auto work = loads.work;
  const bool balance = energy.on;
  const auto works = energy.work;
  Kokkos::parallel_for(
      "mpm::add_load_work", Kokkos::RangePolicy<Space>(s.space, 0, 1), KOKKOS_LAMBDA(int) {
        work() += of_step();
        if (balance) works(Work::internal) -= of_step();  // which counts all forces at the nodes
      });
}

/// SurfaceSum of one load, for parallel_reduce.
struct AddedSurface {
  SurfaceSum of;
  KOKKOS_INLINE_FUNCTION AddedSurface& operator+=(const AddedSurface& other) {
    for (int d = 0; d < 3; ++d) of.vector[d] += other.of.vector[d];
    of.area += other.of.area, of.start_area += other.of.start_area;
    return *this;
  }
};

}  // namespace
}  // namespace mpm

namespace Kokkos {
template <>
struct reduction_identity<mpm::AddedSurface> {
  KOKKOS_FORCEINLINE_FUNCTION static mpm::AddedSurface sum() { return {}; }
};
}  // namespace Kokkos

namespace mpm {

template <class Space, class T, int Dim>
void list_loaded(const Core<Space, T, Dim>& s, SurfaceLoads<Space, T, Dim>& loads) {
  const int slots = s.patches.slots;
  ensure(loads.loaded, slots);
  const auto loaded = loads.loaded;
  const auto begin = s.soil.bins.begin;
  const LoadedParticles<Space, T, Dim> particles(s, loads);
  Kokkos::parallel_for(
      "mpm::mark_loaded", Kokkos::RangePolicy<Space>(s.space, 0, slots), KOKKOS_LAMBDA(int slot) {
        constexpr int cells = Patch<Dim>::cells;
        bool some = false;
        for (int p = begin(slot * cells); p < begin((slot + 1) * cells) && !some; ++p)
          for (int k = 0; k < particles.soil.face_count; ++k) some |= particles.load_of(p, k) >= 0;
        loaded(slot) = some;
      });
  Kokkos::parallel_scan(
      "mpm::list_loaded", Kokkos::RangePolicy<Space>(s.space, 0, slots),
      KOKKOS_LAMBDA(int slot, int& n, bool last) {
        if (loaded(slot) == 0) return;
        if (last) loaded(slot) = n + 1;
        ++n;
      },
      loads.loaded_count);
  loads.windows.place = loaded;
  if (has_windows(s.space))
    ensure(loads.windows.sums, window_bytes<VectorSource<Space, T, Dim>> * loads.loaded_count);
  const int count = s.soil.points.count;
  ensure(loads.coordinate, count), ensure(loads.force, count), ensure(loads.half_length, count);
  if (loads.on_pores) ensure(loads.pore_load, s.patches.node_count());
}

template <class Space, class T, int Dim>
VectorSource<Space, T, Dim> place_faces(const Core<Space, T, Dim>& s,
                                        const SurfaceLoads<Space, T, Dim>& loads, int axis, LoadsOn on) {
  Kokkos::parallel_for("mpm::place_faces", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                       PlaceFaces<Space, T, Dim>{LoadedParticles<Space, T, Dim>(s, loads), loads, axis, on});
  VectorSource<Space, T, Dim> source{s.soil.points, loads.force, loads.windows};
  source.points.coordinate = loads.coordinate, source.points.half_length = loads.half_length;
  source.points.has_domain = true;
  return source;
}

template <class Space, class T, int Dim>
void add_loads(const Core<Space, T, Dim>& s) {
  const auto soil = s.nodes.soil;
  const auto load = s.nodes.load;
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::add_loads", light(Kokkos::RangePolicy<Space>(s.space, 0, s.patches.node_count())),
      KOKKOS_LAMBDA(int i) {
        if (control().paused) return;
        for (int d = 0; d < Dim; ++d) soil(i, SoilTerms<Dim>::force + d) += load(i, d);
      });
}

template <class Space, class T, int Dim>
void follow_surfaces(const Core<Space, T, Dim>& s, const SurfaceLoads<Space, T, Dim>& loads,
                     const EnergyWorks<Space, T, Dim>& energy, double dt) {
  add_load_work(s, loads, energy, dt);
  Kokkos::parallel_for("mpm::follow_surfaces", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                       FollowSurfaces<Space, T, Dim>{LoadedParticles<Space, T, Dim>(s, loads),
                                                     {s.grid, s.patches},
                                                     s.nodes.kinematics,
                                                     s.control,
                                                     dt / 2});
}

template <class Space, class T, int Dim>
std::vector<SurfaceSum> sum_surfaces(const Core<Space, T, Dim>& s, const SurfaceLoads<Space, T, Dim>& loads) {
  using F = FaceTerms<Dim>;
  std::vector<SurfaceSum> sums;
  const LoadedParticles<Space, T, Dim> particles(s, loads);
  for (int n = 0; n < static_cast<int>(loads.now.extent(0)); ++n) {
    AddedSurface sum;
    Kokkos::parallel_reduce(
        "mpm::sum_surfaces", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
        KOKKOS_LAMBDA(int p, AddedSurface& own) {
          if (!particles.has_load(p)) return;
          for (int k = 0; k < particles.soil.face_count; ++k) {
            if (particles.load_of(p, k) != n) continue;
            const Face<Dim>& face = particles.soil.faces[k](p);
            double square = 0;
            for (int d = 0; d < Dim; ++d) {
              own.of.vector[d] += face[F::area + d];
              square += face[F::area + d] * face[F::area + d];
            }
            own.of.area += Kokkos::sqrt(square) / face[F::steps];
            own.of.start_area += face[F::start];
          }
        },
        Kokkos::Sum<AddedSurface>(sum));
    sums.push_back(sum.of);
  }
  return sums;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                \
  template void list_loaded(const Core<Space, T, Dim>&, SurfaceLoads<Space, T, Dim>&);                \
  template VectorSource<Space, T, Dim> place_faces(const Core<Space, T, Dim>&,                        \
                                                   const SurfaceLoads<Space, T, Dim>&, int, LoadsOn); \
  template void add_loads(const Core<Space, T, Dim>&);                                                \
  template void follow_surfaces(const Core<Space, T, Dim>&, const SurfaceLoads<Space, T, Dim>&,       \
                                const EnergyWorks<Space, T, Dim>&, double);                           \
  template std::vector<SurfaceSum> sum_surfaces(const Core<Space, T, Dim>&,                           \
                                                const SurfaceLoads<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
