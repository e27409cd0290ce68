#include "step_kernels.hpp"

namespace mpm {

/// Acceleration of a rigid [m/s2] under the force [N] of the soil on it (Eq. 7).
template <int Dim>
KOKKOS_INLINE_FUNCTION double acceleration(const Rigid<Dim>& rigid, int d, double contact) {
  return rigid.dynamic ? (rigid.force[d] + contact) / rigid.mass : 0;
}

/// What a rigid moves in a step [m]: exact where the force is constant.
template <int Dim>
KOKKOS_INLINE_FUNCTION double movement(const Rigid<Dim>& rigid, int d, double contact, double dt) {
  return dt * (rigid.velocity[d] + dt / 2 * acceleration(rigid, d, contact));
}

template <class Space, class T, int Dim>
void move_rigids(State<Space, T, Dim>& s, double dt) {
  const auto control = s.control;
  const auto sums = s.sums;
  const auto rigids = s.rigids;
  const auto origin = s.patches.origin;
  const double spacing = s.spacing, margin = s.p2g.margin;

  if (s.rigid_moves)
    for (std::size_t r = 0; r < s.rigid_points.size(); ++r) {
      const auto points = s.rigid_points[r].points;
      const auto home = points.home;
      Kokkos::parallel_for(
          "mpm::move_rigid_points", light(Kokkos::RangePolicy<Space>(s.space, 0, points.count)),
          KOKKOS_LAMBDA(int p) {
            if (control().paused) return;
            const Coord<Dim> from = origin(points.cell(p) / Patch<Dim>::cells),
                             cell = coord_of<Dim>(points.cell(p));
            for (int d = 0; d < Dim; ++d)
              points.coordinate(p)[d] = static_cast<T>(
                  home(p)[d] +
                  (rigids(r).displacement[d] + movement(rigids(r), d, sums(r * Dim + d), dt)) / spacing -
                  from[d] - cell[d]);
          });
    }

  Kokkos::parallel_for(
      "mpm::move_rigids", light(Kokkos::RangePolicy<Space>(s.space, 0, 1)), KOKKOS_LAMBDA(int) {
        Control& c = control();
        if (c.paused) return;
        double furthest = 0;  // m
        for (int r = 0; r < static_cast<int>(rigids.extent(0)); ++r) {
          Rigid<Dim>& rigid = rigids(r);
          for (int d = 0; d < Dim; ++d) {
            const double contact = sums(r * Dim + d);
            const double step = movement(rigid, d, contact, dt);
            furthest = Kokkos::fmax(furthest, Kokkos::fabs(step));
            rigid.displacement[d] += step;
            rigid.impulse[d] += dt * contact;
            rigid.velocity[d] += dt * acceleration(rigid, d, contact);
          }
        }
        // round-off of a coordinate's update
        constexpr double epsilon = Kokkos::Experimental::epsilon<T>::value;
        c.increment = Kokkos::fmax(c.moved, furthest / spacing) + epsilon;
        c.moved = 0;
        c.bound += c.increment;
        ++c.steps;
        if (!(c.bound <= margin) || c.fault_count > 0) c.paused = 1;
      });
}

template <class Space, class T, int Dim>
Control look(const State<Space, T, Dim>& s) {
  Control c;
  Kokkos::View<Control, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(&c);
  Kokkos::deep_copy(s.space, host, s.control);
  s.space.fence("mpm::look");
  return c;
}

template <class Space, class T, int Dim>
void restart_count(State<Space, T, Dim>& s) {
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::restart_count", Kokkos::RangePolicy<Space>(s.space, 0, 1),
      KOKKOS_LAMBDA(int) { control().steps = 0; });
}

#define MPM_INSTANTIATE(Space, T, Dim)                      \
  template void move_rigids(State<Space, T, Dim>&, double); \
  template Control look(const State<Space, T, Dim>&);       \
  template void restart_count(State<Space, T, Dim>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
