#pragma once
// Views of the device from numbers on the host.

#include <string>

#include "base/copy.hpp"
#include "base/number_of.hpp"

namespace mpm {

/// A view filled from the host. It is made anew unless it has its memory already.
template <class View, class Get>
void fill_view(View& view, const std::string& label, int count, Get&& get) {
  if (static_cast<int>(view.extent(0)) != count)
    view = View(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), count);
  auto host = Kokkos::create_mirror_view(view);
  for (int p = 0; p < count; ++p) host(p) = get(p);
  copy(view, host);
}

}  // namespace mpm
