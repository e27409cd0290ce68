#include "functions/node_impulses.hpp"

#include "base/copy.hpp"

namespace mpm {
namespace {

/// A view of the device with what the host holds.
template <class Space, class Value>
Kokkos::View<Value*, typename Space::memory_space> on_device(const std::string& label,
                                                             const std::vector<Value>& values) {
  Kokkos::View<Value*, typename Space::memory_space> view(label, values.size());
  copy(view,
       Kokkos::View<const Value*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(values.data(), values.size()));
  return view;
}

template <class Value, class View>
std::vector<Value> on_host(const View& view) {
  const auto host = mirror_of(view);
  return {host.data(), host.data() + host.extent(0)};
}

}  // namespace

template <class Space, class T, int Dim>
NodeImpulses<T> list_impulses(const ContactCore<Space, T, Dim>& s) {
  using Range = Kokkos::RangePolicy<Space>;
  const int rows = impulse_rows(s), numbers = impulse_numbers(s), stride = impulse_stride(s);
  const NearBodies<Space> near = s.contact.near;
  const int nodes = s.owned_nodes.extent(0) > 0 ? s.patches.node_count() : 0;
  const auto impulse = s.nodes.impulse;
  const auto owned_nodes = s.owned_nodes;
  const auto number = s.patches.number;
  const Kokkos::View<int*, typename Space::memory_space> which("mpm::nodes_with_impulse", nodes);
  int found = 0;
  Kokkos::parallel_scan(
      "mpm::find_impulses", Range(s.space, 0, nodes),
      KOKKOS_LAMBDA(int i, int& n, bool last) {
        if ((owned_nodes(i / Patch<Dim>::cells) >> (i % Patch<Dim>::cells) & 1) == 0) return;
        bool any = false;
        for (int k = 0; k < rows; ++k) any = any || impulse(k, i) != 0;
        if (!any) return;
        if (last) which(n) = i;
        ++n;
      },
      found);
  const Kokkos::View<long*, typename Space::memory_space> node("mpm::node", found);
  const Kokkos::View<T*, typename Space::memory_space> value("mpm::value", std::size_t(found) * numbers);
  Kokkos::parallel_for(
      "mpm::list_impulses", Range(s.space, 0, found), KOKKOS_LAMBDA(int n) {
        const int i = which(n);
        node(n) = address_of_node<Dim>(number, i);
        for (int m = 0; m < near.width; ++m) {
          const int body = near.body(i / Patch<Dim>::cells, m);
          for (int k = 0; k < stride && body >= 0; ++k)
            value(n * numbers + body * stride + k) = impulse(m * stride + k, i);
        }
      });
  s.space.fence("mpm::list_impulses");
  return {on_host<long>(node), on_host<T>(value)};
}

template <class Space, class T, int Dim>
void put_impulses(ContactCore<Space, T, Dim>& s, const NodeImpulses<T>& impulses) {
  const int numbers = impulse_numbers(s), stride = impulse_stride(s);
  const NearBodies<Space> near = s.contact.near;
  const auto node = on_device<Space>("mpm::node", impulses.node);
  const auto value = on_device<Space>("mpm::value", impulses.value);
  const auto impulse = s.nodes.impulse;
  const auto slot_of = s.patches.slot_of;
  Kokkos::deep_copy(s.space, impulse, T(0));
  Kokkos::parallel_for(
      "mpm::put_impulses", Kokkos::RangePolicy<Space>(s.space, 0, impulses.node.size()),
      KOKKOS_LAMBDA(int n) {
        const int slot = slot_of(node(n) / Patch<Dim>::cells);
        if (slot < 0) return;
        const int i = slot * Patch<Dim>::cells + static_cast<int>(node(n) % Patch<Dim>::cells);
        for (int m = 0; m < near.width; ++m) {
          const int body = near.body(slot, m);
          for (int k = 0; k < stride && body >= 0; ++k)
            impulse(m * stride + k, i) = value(n * numbers + body * stride + k);
        }
      });
  s.space.fence("mpm::put_impulses");
}

#define MPM_INSTANTIATE(Space, T, Dim)                                       \
  template NodeImpulses<T> list_impulses(const ContactCore<Space, T, Dim>&); \
  template void put_impulses(ContactCore<Space, T, Dim>&, const NodeImpulses<T>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
