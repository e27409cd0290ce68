#pragma once
// Memory of a view that grows.

#include <cstddef>
#include <string>

#include <Kokkos_Core.hpp>

namespace mpm {

/// Makes a view hold at least n entries; its content is lost when it grows. A view that has grown once may
/// grow again, and gets some room for it.
template <class View>
void ensure(View& view, std::size_t n) {
  if (view.extent(0) >= n) return;
  const std::string label = view.label();
  const bool grows = view.extent(0) > 0;
  view = View();  // the old memory goes before the new one comes
  view = View(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), grows ? n + n / 16 : n);
}

}  // namespace mpm
