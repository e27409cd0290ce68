#include "step_kernels.hpp"

namespace mpm {

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
                  home(p)[d] + (rigids(r).displacement[d] + dt * rigids(r).velocity[d]) / spacing - from[d] -
                  cell[d]);
          });
    }

  Kokkos::parallel_for(
      "mpm::move_rigids", light(Kokkos::RangePolicy<Space>(s.space, 0, 1)), KOKKOS_LAMBDA(int) {
        Control& c = control();
        if (c.paused) return;
        double speed = 0;
        for (int r = 0; r < static_cast<int>(rigids.extent(0)); ++r) {
          Rigid<Dim>& rigid = rigids(r);
          for (int d = 0; d < Dim; ++d) {
            const double contact = sums(r * Dim + d);
            speed = Kokkos::fmax(speed, Kokkos::fabs(rigid.velocity[d]));
            rigid.displacement[d] += dt * rigid.velocity[d];
            rigid.impulse[d] += dt * contact;
            if (rigid.dynamic) rigid.velocity[d] += dt * (rigid.force[d] + contact) / rigid.mass;  // Eq. (7)
          }
        }
        // round-off of a coordinate's update
        constexpr double epsilon = Kokkos::Experimental::epsilon<T>::value;
        c.increment = Kokkos::fmax(c.moved, speed * dt / spacing) + epsilon;
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
