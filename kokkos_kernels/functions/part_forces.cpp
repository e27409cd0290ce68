#include "functions/part_forces.hpp"

#include "base/copy.hpp"
#include "data/motion_terms.hpp"
#include "functions/step_kernels.hpp"
#include "physics/rigid_motion.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void add_part_impulses(ContactCore<Space, T, Dim>& s, double dt, const Space& stream) {
  if (!s.forces_summed) sum_forces(s, stream);
  const int size = wrench_size<Dim>(s.rigid_turns), before = size * static_cast<int>(s.rigid_points.size());
  const auto control = s.control;
  const auto of = s.part_forces;
  const auto rigids = s.rigids;
  const auto supports = s.links.supports;
  const auto forces = s.rigid_force;
  Kokkos::parallel_for(
      "mpm::add_part_impulses", light(Kokkos::RangePolicy<Space>(stream, 0, of.count)),
      KOKKOS_LAMBDA(int part) {
        if (control().paused) return;
        const int r = of.rigid(part);
        Wrench<Dim> soil{};
        for (int k = 0; k < size; ++k) soil[k] = forces(before + part * size + k);
        const bool about_point = supports.extent(0) > 0 && supports(r).has_point;
        add_impulse(rigids(r).motion.pose, soil, dt, about_point ? &supports(r).point : nullptr,
                    of.impulse(part));
      });
}

template <class Space, class T, int Dim>
std::vector<Wrench<Dim>> take_part_impulses(ContactCore<Space, T, Dim>& s) {
  const auto host = mirror_of(s.part_forces.impulse);
  std::vector<Wrench<Dim>> impulses(host.data(), host.data() + host.extent(0));
  Kokkos::deep_copy(s.space, s.part_forces.impulse, Wrench<Dim>{});
  return impulses;
}

namespace {

/// Number of a part among those of its body. rigid: of each part.
template <class View>
int number_in_body(const View& rigid, std::size_t part) {
  std::size_t first = part;
  while (first > 0 && rigid(first - 1) == rigid(part)) --first;
  return static_cast<int>(part - first);
}

}  // namespace

template <class Space, class T, int Dim>
std::vector<double> save_part_impulses(const ContactCore<Space, T, Dim>& s) {
  const auto rigid = mirror_of(s.part_forces.rigid);
  const auto impulse = mirror_of(s.part_forces.impulse);
  std::vector<double> saved;
  for (std::size_t n = 0; n < rigid.extent(0); ++n) {
    double row[PartTerms::size] = {};
    row[PartTerms::rigid] = rigid(n), row[PartTerms::part] = number_in_body(rigid, n);
    for (int d = 0; d < Dim; ++d) row[PartTerms::impulse + d] = impulse(n)[Wrench<Dim>::force + d];
    for (int k = 0; k < k_turning_axes<Dim>; ++k)
      row[PartTerms::moment + k] = impulse(n)[Wrench<Dim>::moment + k];
    saved.insert(saved.end(), row, row + PartTerms::size);
  }
  return saved;
}

template <class Space, class T, int Dim>
void restore_part_impulses(ContactCore<Space, T, Dim>& s, const std::vector<double>& saved) {
  const auto rigid = mirror_of(s.part_forces.rigid);
  const auto impulse = mirror_of(s.part_forces.impulse);
  for (std::size_t n = 0; n < rigid.extent(0); ++n)
    for (std::size_t at = 0; at + PartTerms::size <= saved.size(); at += PartTerms::size) {
      const double* const row = &saved[at];
      if (row[PartTerms::rigid] != rigid(n) || row[PartTerms::part] != number_in_body(rigid, n)) continue;
      for (int d = 0; d < Dim; ++d) impulse(n)[Wrench<Dim>::force + d] = row[PartTerms::impulse + d];
      for (int k = 0; k < k_turning_axes<Dim>; ++k)
        impulse(n)[Wrench<Dim>::moment + k] = row[PartTerms::moment + k];
    }
  copy(s.part_forces.impulse, impulse);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                \
  template void add_part_impulses(ContactCore<Space, T, Dim>&, double, const Space&); \
  template std::vector<Wrench<Dim>> take_part_impulses(ContactCore<Space, T, Dim>&);  \
  template std::vector<double> save_part_impulses(const ContactCore<Space, T, Dim>&); \
  template void restore_part_impulses(ContactCore<Space, T, Dim>&, const std::vector<double>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
