#include "base/copy.hpp"
#include "functions/interfaces.hpp"

namespace mpm {

template <class Space, class T, int Dim>
std::vector<double> save_interface_totals(const ContactCore<Space, T, Dim>& s) {
  const auto host = mirror_of(s.interfaces.totals);
  return std::vector<double>(host.data(), host.data() + host.extent(0));
}

template <class Space, class T, int Dim>
std::vector<double> take_interface_totals(ContactCore<Space, T, Dim>& s) {
  using Terms = InterfaceTerms<Dim>;
  const std::vector<double> totals = save_interface_totals(s);
  std::vector<double> left = totals;
  for (std::size_t n = 0; n < left.size(); ++n)
    if (static_cast<int>(n % Terms::size) != Terms::work) left[n] = 0;
  restore_interface_totals(s, left);
  return totals;
}

template <class Space, class T, int Dim>
void restore_interface_totals(ContactCore<Space, T, Dim>& s, const std::vector<double>& saved) {
  const auto host = Kokkos::create_mirror_view(s.interfaces.totals);
  if (host.extent(0) == 0 || saved.size() != host.extent(0)) return;
  for (std::size_t n = 0; n < saved.size(); ++n) host(n) = saved[n];
  copy(s.interfaces.totals, host);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                   \
  template std::vector<double> take_interface_totals(ContactCore<Space, T, Dim>&);       \
  template std::vector<double> save_interface_totals(const ContactCore<Space, T, Dim>&); \
  template void restore_interface_totals(ContactCore<Space, T, Dim>&, const std::vector<double>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
