#include "transfer/upload_flow.hpp"

#include "transfer/fill_view.hpp"

namespace mpm {

template <class Space, class T, int Dim>
void upload_flow(Core<Space, T, Dim>& s, const FlowInput& in) {
  PoreFlow<Space, Dim>& to = s.flow;
  to = {};
  if (in.pores.empty()) return;
  to.water = in.water;
  fill_view(to.pores, "mpm::pores", static_cast<int>(in.pores.size()), [&](int m) { return in.pores[m]; });
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) to.sides[d][side] = in.sides[d][side];
}

#define MPM_INSTANTIATE(Space, T, Dim) template void upload_flow(Core<Space, T, Dim>&, const FlowInput&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
