#include "transfer/upload_loads.hpp"

#include <string>

#include "base/copy.hpp"
#include "data/state.hpp"

namespace mpm {
namespace {

template <class View, class Value>
void fill_view(View& view, const std::string& label, const std::vector<Value>& values) {
  view = View(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), values.size());
  const auto host = Kokkos::create_mirror_view(view);
  for (std::size_t n = 0; n < values.size(); ++n) host(n) = values[n];
  copy(view, host);
}

/// The place of a load's value on the device: in the views that the kernels of sides, of loads on surfaces
/// and of joints hold. Null for gravity and rigid bodies.
template <class Space, class T, int Dim>
double* place_of(const State<Space, T, Dim>& s, const LoadInput& in) {
  switch (in.target) {
    case LoadTarget::side: return &s.sides.all.data()[in.rigid].velocity[in.component];
    case LoadTarget::pressure: return &s.loads.now.data()[in.rigid].pressure;
    case LoadTarget::traction: return &s.loads.now.data()[in.rigid].traction[in.component];
    case LoadTarget::joint: return &s.links.joints.data()[in.rigid].velocity[in.component];
    default: return nullptr;
  }
}

}  // namespace

template <class Space, class T, int Dim>
void upload_loads(State<Space, T, Dim>& s, const std::vector<LoadInput>& loads) {
  s.timed = {};
  if (loads.empty()) return;
  std::vector<CurvePoint> points;
  const auto number = [&](const NumberInput& in) {
    const int first = static_cast<int>(points.size()), count = static_cast<int>(in.points.size());
    points.insert(points.end(), in.points.begin(), in.points.end());
    return TimedNumber{in.constant, first, count, -1, in.use, in.smooth};
  };
  std::vector<TimedLoad> timed;
  for (const LoadInput& in : loads) {
    s.timed.moves_gravity = s.timed.moves_gravity || in.target == LoadTarget::gravity;
    s.timed.moves_sides = s.timed.moves_sides || in.target == LoadTarget::side;
    timed.push_back(
        {in.target, in.rigid, in.component, number(in.own), number(in.gravity), in.factor, place_of(s, in)});
  }
  fill_view(s.timed.loads, "mpm::timed_loads", timed);
  fill_view(s.timed.points, "mpm::timed_points", points);
  s.timed.clock = decltype(s.timed.clock)("mpm::load_clock");
  s.timed.gravity = decltype(s.timed.gravity)("mpm::timed_gravity");
  const auto gravity = Kokkos::create_mirror_view(s.timed.gravity);
  for (int d = 0; d < Dim; ++d) gravity()[d] = static_cast<T>(s.gravity[d]);
  copy(s.timed.gravity, gravity);
}

template <class Space, class T, int Dim>
void upload_surface_loads(State<Space, T, Dim>& s, const std::vector<SurfaceLoad<Dim>>& loads) {
  if (loads.empty()) return;
  if (s.loads.in_use()) {  // into the same views, which kernels hold
    const auto host = Kokkos::create_mirror_view(s.loads.now);
    for (std::size_t n = 0; n < loads.size(); ++n) host(n) = loads[n];
    return copy(s.loads.now, host);
  }
  fill_view(s.loads.now, "mpm::surface_loads", loads);
  for (const SurfaceLoad<Dim>& load : loads) s.loads.on_pores = s.loads.on_pores || load.on_pores != 0;
  s.loads.work = decltype(s.loads.work)("mpm::loads.work");
  s.loads.of_step = decltype(s.loads.of_step)("mpm::loads.of_step");
}

#define MPM_INSTANTIATE(Space, T, Dim)                                              \
  template void upload_loads(State<Space, T, Dim>&, const std::vector<LoadInput>&); \
  template void upload_surface_loads(State<Space, T, Dim>&, const std::vector<SurfaceLoad<Dim>>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
