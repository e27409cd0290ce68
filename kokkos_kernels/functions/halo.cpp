#include "functions/halo.hpp"
#include "device/warp.hpp"
#include "loops/window.hpp"

namespace mpm {

constexpr int k_patch_nodes = Patch<2>::cells;
static_assert(k_patch_nodes == Patch<3>::cells);

template <class Space, class T>
void pack_nodes(const Space& space, const HaloLists<Space>& lists, const HaloField<T>& field, int width,
                T* out) {
  const auto node = lists.node;
  Kokkos::parallel_for(
      "mpm::pack_nodes", light(Kokkos::RangePolicy<Space>(space, 0, lists.sent * field.size)),
      KOKKOS_LAMBDA(int m) {
        const int n = m / field.size, k = m % field.size;
        out[std::size_t(n) * width + field.offset + k] = field.values[std::size_t(node(n)) * field.size + k];
      });
}

template <class Space, class T>
void sum_ghosts(const Space& space, const HaloLists<Space>& lists, const HaloField<T>& field, int width,
                const T* in) {
  const auto node = lists.shared_node, begin = lists.begin, source = lists.source;
  Kokkos::parallel_for(
      "mpm::sum_ghosts", light(Kokkos::RangePolicy<Space>(space, 0, lists.shared * field.size)),
      KOKKOS_LAMBDA(int m) {
        const int n = m / field.size, k = m % field.size;
        T& value = field.values[std::size_t(node(n)) * field.size + k];
        const bool read = field.read == nullptr || field.read[node(n) / k_patch_nodes] != 0;
        const T own = value;
        T sum = 0;
        for (int e = begin(n); e < begin(n + 1) && read; ++e)
          sum += source(e) < 0 ? own : in[std::size_t(source(e)) * width + field.offset + k];
        value = sum;
      });
}

// Once for both dimensions.
#define MPM_HALO_2(Space, T)                                                                     \
  template void pack_nodes(const Space&, const HaloLists<Space>&, const HaloField<T>&, int, T*); \
  template void sum_ghosts(const Space&, const HaloLists<Space>&, const HaloField<T>&, int, const T*);
#define MPM_HALO_3(Space, T)
#define MPM_INSTANTIATE(Space, T, Dim) MPM_HALO_##Dim(Space, T)
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
