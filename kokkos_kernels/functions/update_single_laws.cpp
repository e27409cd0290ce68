#include "functions/launch_update.hpp"

namespace mpm {
namespace {

template <bool Sums, template <class> class... Models, class Space, class T, int Dim, class... Arguments>
bool launch_one_of(ModelList<Models...>, const ContactCore<Space, T, Dim>& s, const Arguments&... arguments) {
  return ((s.law == model_index_in<Models>(Materials{}) &&
           (launch_update<Sums, PatchKind::common, ModelList<Models>, ParticleDomain::fixed>(s, arguments...),
            true)) ||
          ...);
}

}  // namespace

template <class Space, class T, int Dim>
bool launch_single_law([[maybe_unused]] const ContactCore<Space, T, Dim>& s, [[maybe_unused]] double dt,
                       [[maybe_unused]] bool sums,
                       [[maybe_unused]] const Kokkos::View<int*, typename Space::memory_space>& slots,
                       [[maybe_unused]] const Part<Space>& part) {
  if constexpr (is_device<Space>) {
    if constexpr (sums_fit<Space, T, Dim>)
      if (sums) return launch_one_of<true>(SingleMaterials{}, s, dt, slots, part);
    return launch_one_of<false>(HeavyMaterials{}, s, dt, slots, part);
  }
  return false;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                     \
  template bool launch_single_law(const ContactCore<Space, T, Dim>&, double, bool,         \
                                  const Kokkos::View<int*, typename Space::memory_space>&, \
                                  const Part<Space>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
