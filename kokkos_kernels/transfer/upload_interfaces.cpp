#include "transfer/upload_interfaces.hpp"

#include <algorithm>

#include "transfer/fill_view.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void upload_interfaces(ContactCore<Space, T, Dim>& s, const InterfaceInput& in) {
  Interfaces<Space, Dim>& to = s.interfaces;
  to = {};
  if (in.laws.empty()) return;
  to.fields = in.fields, to.rows = in.rows;
  fill_view(to.laws, "mpm::interface_laws", static_cast<int>(in.laws.size()),
            [&](int n) { return in.laws[n]; });
  to.totals = decltype(to.totals)("mpm::interface_totals", std::size_t(in.rows) * InterfaceTerms<Dim>::size);
  s.soil_boundary = true;
  s.shear_fraction =
      s.shear_fraction || std::any_of(in.laws.begin(), in.laws.end(),
                                      [](const InterfaceLaw& law) { return law.shear_fraction >= 0; });
}

#define MPM_INSTANTIATE(Space, T, Dim) \
  template void upload_interfaces(ContactCore<Space, T, Dim>&, const InterfaceInput&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
