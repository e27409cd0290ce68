#include "functions/link_rigids.hpp"

#include <string>

#include "base/copy.hpp"
#include "functions/step_kernels.hpp"
#include "physics/linked_step.hpp"

namespace mpm {
namespace {

template <class View, class Value>
void fill(View& view, const std::string& label, const std::vector<Value>& values) {
  view = View(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), values.size());
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t n = 0; n < values.size(); ++n) host(n) = values[n];
  copy(view, host);
}

/// The step of all rigids on raw memory, for one thread of a kernel.
template <class Space, class T, int Dim>
LinkedStep<T, Dim> linked_step(const ContactCore<Space, T, Dim>& s, double dt) {
  const RigidLinks<Space, Dim>& links = s.links;
  const int rows = links.row_count();
  double* const numbers = links.numbers.data();
  const JointSystem<Dim> system{links.rows.data(), rows, links.matrix.data(), links.first.data()};
  const JointSolver<Dim> solver{s.rigids.data(),
                                links.starts.data(),
                                links.joints.data(),
                                links.rows.data(),
                                links.rows.data() + rows,
                                system,
                                numbers,
                                numbers + rows,
                                numbers + 2 * rows,
                                static_cast<int>(links.supports.extent(0)),
                                static_cast<int>(links.joints.extent(0)),
                                links.size,
                                dt};
  return {solver,
          links.supports.data(),
          links.starts.data(),
          s.rigid_force.data(),
          wrench_size<Dim>(s.rigid_turns),
          s.pairs.in_use() ? s.pairs.actions.data() : nullptr,
          s.scheme.damping};
}

}  // namespace

template <class Space, class T, int Dim>
void upload_links(ContactCore<Space, T, Dim>& s, const std::vector<Joint<Dim>>& joints,
                  const std::vector<RigidSupport<Dim>>& supports, double size) {
  RigidLinks<Space, Dim>& links = s.links;
  links = {};
  if (supports.empty()) return;
  links.size = size;
  fill(links.joints, "mpm::joints", joints);
  fill(links.supports, "mpm::rigid_supports", supports);
  std::size_t rows = 0;
  for (const Joint<Dim>& joint : joints) rows += static_cast<std::size_t>(joint.rows());
  fill(links.rows, "mpm::joint_rows", std::vector<JointRow<Dim>>(2 * rows));
  fill(links.starts, "mpm::linked_starts", std::vector<LinkedStart<Dim>>(supports.size()));
  links.matrix = decltype(links.matrix)("mpm::joint_matrix", rows * rows);
  links.numbers = decltype(links.numbers)("mpm::joint_numbers", links.k_numbers * rows);
  links.first = decltype(links.first)("mpm::joint_first", rows);
  s.rigid_moved = decltype(s.rigid_moved)("mpm::rigid_moved", supports.size());
}

template <class Space, class T, int Dim>
void link_rigids(ContactCore<Space, T, Dim>& s, double dt, const Space& stream) {
  if (!s.forces_summed) sum_forces(s, stream);
  const LinkedStep<T, Dim> step = linked_step(s, dt);
  const auto control = s.control;
  const auto moved = s.rigid_moved;
  const int count = static_cast<int>(moved.extent(0));
  const double spacing = s.spacing;
  Kokkos::parallel_for(
      "mpm::link_rigids", Kokkos::RangePolicy<Space>(stream, 0, 1), KOKKOS_LAMBDA(int) {
        if (control().paused) return;
        const int open = step();
        for (int r = 0; r < count; ++r) moved(r) = step.moved(r) / spacing;
        if (open < 0) return;
        const int r = step.solver.joints[open].body[0];
        const RigidPose<Dim>& pose = step.solver.rigids[r].motion.pose;
        const Vector<double, Dim> place = pose.to_world(step.solver.joints[open].end[0]);
        report(control, FaultKind::law, -1 - r, place.c, Dim);
        moved(r) = Kokkos::Experimental::infinity_v<double>;
      });
}

template <class Space, class T, int Dim>
std::vector<Joint<Dim>> joints_of(const ContactCore<Space, T, Dim>& s) {
  const auto host = mirror_of(s.links.joints);
  return {host.data(), host.data() + host.extent(0)};
}

template <class Space, class T, int Dim>
std::vector<RigidSupport<Dim>> supports_of(const ContactCore<Space, T, Dim>& s) {
  const auto host = mirror_of(s.links.supports);
  return {host.data(), host.data() + host.extent(0)};
}

template <class Space, class T, int Dim>
void put_links(ContactCore<Space, T, Dim>& s, const std::vector<Joint<Dim>>& joints,
               const std::vector<RigidSupport<Dim>>& supports) {
  const auto put = [](const auto& view, const auto& values) {
    const auto host = Kokkos::create_mirror_view(view);
    for (std::size_t n = 0; n < values.size(); ++n) host(n) = values[n];
    copy(view, host);
  };
  put(s.links.joints, joints), put(s.links.supports, supports);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                    \
  template void upload_links(ContactCore<Space, T, Dim>&, const std::vector<Joint<Dim>>&, \
                             const std::vector<RigidSupport<Dim>>&, double);              \
  template void link_rigids(ContactCore<Space, T, Dim>&, double, const Space&);           \
  template std::vector<Joint<Dim>> joints_of(const ContactCore<Space, T, Dim>&);          \
  template std::vector<RigidSupport<Dim>> supports_of(const ContactCore<Space, T, Dim>&); \
  template void put_links(ContactCore<Space, T, Dim>&, const std::vector<Joint<Dim>>&,    \
                          const std::vector<RigidSupport<Dim>>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
