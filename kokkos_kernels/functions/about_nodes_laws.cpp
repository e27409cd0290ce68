#include "functions/launch_about_nodes.hpp"

namespace mpm {
namespace {

/// Launches the kernel of the one law that all soil has, if it has one of its own.
template <template <class> class... Models, class Space, class T, class... Arguments>
bool launch_one_of(ModelList<Models...>, const ContactCore<Space, T, 3>& s, const Arguments&... arguments) {
  return ((s.law == model_index_in<Models>(Materials{}) &&
           (launch_about_nodes<ModelList<Models>, true>(s, arguments...), true)) ||
          ...);
}

}  // namespace

template <class Space, class T, int Dim>
void launch_laws_about_nodes([[maybe_unused]] const ContactCore<Space, T, Dim>& s, [[maybe_unused]] double dt,
                             [[maybe_unused]] const Kokkos::View<int*, typename Space::memory_space>& slots,
                             [[maybe_unused]] const Part<Space>& part) {
  if constexpr (is_device<Space> && Dim == 3) {
    if (launch_one_of(SingleMaterials{}, s, dt, slots, part)) return;
    launch_about_nodes<Materials, true>(s, dt, slots, part);
  }
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                           \
  template void launch_laws_about_nodes(const ContactCore<Space, T, Dim>&, double,               \
                                        const Kokkos::View<int*, typename Space::memory_space>&, \
                                        const Part<Space>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
