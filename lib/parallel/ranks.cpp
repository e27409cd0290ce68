#include "parallel/ranks.hpp"

#include <algorithm>

#include "output/log.hpp"
#include "parallel/together.hpp"
#include "rebuild.hpp"
#include "step_kernels.hpp"

namespace mpm {
namespace {

template <class T>
MPI_Datatype mpi_type() {
  return sizeof(T) == sizeof(double) ? MPI_DOUBLE : MPI_FLOAT;
}

/// The values of a nodal field.
template <class View>
auto field_of(const View& view, int offset) {
  using T = typename View::value_type;
  return HaloField<T>{view.data(), static_cast<int>(view.extent(1)), offset};
}

/// The first n entries of a view.
template <class View>
auto head(const View& view, std::size_t n) {
  return Kokkos::subview(view, Kokkos::make_pair(std::size_t(0), n));
}

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::start(MPI_Comm comm, const PartitionConfig& config, const Owners& owners,
                                           State_& s) {
  PetscFunctionBeginUser;
  comm_ = comm;
  rank_ = rank_of(comm);
  size_ = size_of(comm);
  config_ = config;
  owners_ = owners;
  clock_ = WorkClock(is_device<Space>);
  grid_.dim = Dim;
  for (int d = 0; d < Dim; ++d) grid_.patches[d] = s.grid.patches[d];
  seen_ = decltype(seen_)("mpm::seen");
  const auto rigids = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), s.rigids);
  for (std::size_t r = 0; r < rigids.extent(0); ++r) forces_shared_ = forces_shared_ || rigids(r).dynamic;
  reserve_particles(s, k_least_room);
  send_owners_to_device();
  locate(s);
  clock_.go_on();
  long moved = 0;
  PetscCall(migrate(s, &moved));
  sort_and_list(s);
  PetscCall(make_lists(s));
  clock_.stop();
  clock_ = WorkClock(is_device<Space>);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void Ranks<Space, T, Dim>::send_owners_to_device() {
  ensure(owner_, owners_.size());
  const Kokkos::View<const int*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(owners_.data(),
                                                                                  owners_.size());
  Kokkos::deep_copy(head(owner_, owners_.size()), host);
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add(State_& s, std::initializer_list<HaloField<T>> fields, int width,
                                         bool with_bound) {
  PetscFunctionBeginUser;
  const std::size_t values = std::size_t(lists_.sent) * width;
  const double start = WorkClock::wall();
  for (const HaloField<T>& field : fields) pack_nodes(s, lists_, field, width, out_.data());
  if (values > 0 && is_device<Space>) Kokkos::deep_copy(s.space, head(host_out_, values), head(out_, values));
  if (with_bound) Kokkos::deep_copy(s.space, seen_, s.control);
  s.space.fence("mpm::halo");
  const double packed = WorkClock::wall();
  clock_.pause();
  if (width > 0) PetscCall(exchange_.start(mpi_type<T>(), width, host_out_.data(), host_in_.data()));
  if (with_bound) {
    const Control& c = seen_();
    PetscCall(bound_.post(comm_, {c.bound, c.increment, c.paused != 0 ? 1.0 : 0.0}));
  }
  if (width > 0) PetscCall(exchange_.finish());
  clock_.go_on();
  const double received = WorkClock::wall();
  if (values > 0 && is_device<Space>) Kokkos::deep_copy(s.space, head(in_, values), head(host_in_, values));
  for (const HaloField<T>& field : fields) sum_shares(s, lists_, field, width, in_.data());
  if (!is_device<Space>) halo_ += packed - start + WorkClock::wall() - received;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add_soil(State_& s) {
  constexpr int soil = SoilShare<Dim>::size, boundary = BoundaryShare<Dim>::size;
  PetscFunctionBeginUser;
  const bool summed = s.soil_summed && present_added_;  // already, where they were measured before the step
  present_added_ = false;
  if (summed && s.soil_boundary)
    PetscCall(add(s, {field_of(s.nodes.boundary, 0)}, boundary, true));
  else if (summed)
    PetscCall(add(s, {}, 0, true));
  else if (s.soil_boundary)
    PetscCall(add(s, {field_of(s.nodes.soil, 0), field_of(s.nodes.boundary, soil)}, soil + boundary, true));
  else
    PetscCall(add(s, {field_of(s.nodes.soil, 0)}, soil, true));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add_rest(State_& s) {
  PetscFunctionBeginUser;
  PetscCall(add(s, {field_of(s.nodes.rest, 0)}, Dim, false));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add_present_soil(State_& s) {
  PetscFunctionBeginUser;
  if (s.soil_summed && present_added_) PetscFunctionReturn(PETSC_SUCCESS);
  clock_.go_on();
  PetscCall(add(s, {field_of(s.nodes.soil, 0)}, SoilShare<Dim>::size, false));
  clock_.stop();
  present_added_ = true;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add_forces(State_& s) {
  PetscFunctionBeginUser;
  if (!forces_shared_) PetscFunctionReturn(PETSC_SUCCESS);
  sum_rigid_forces(s);
  const auto sums = Kokkos::create_mirror_view(s.sums);
  Kokkos::deep_copy(s.space, sums, s.sums);
  s.space.fence("mpm::add_forces");
  clock_.pause();
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.extent(0)), MPI_DOUBLE, MPI_SUM, comm_));
  clock_.go_on();
  Kokkos::deep_copy(s.space, s.sums, sums);
  put_rigid_forces(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
RankReport Ranks<Space, T, Dim>::report(const State_& s) const {
  RankReport report;
  report.work = clock_.work();
  report.wait = clock_.wait();
  report.halo = halo_;
  report.particles = s.soil.points.count;
  report.neighbours = neighbours_;
  report.shared_nodes = lists_.shared;
  const int width = SoilShare<Dim>::size + (s.soil_boundary ? BoundaryShare<Dim>::size : 0);
  report.sent = double(lists_.sent) * width * sizeof(T);
  return report;
}

template <class Space, class T, int Dim>
std::size_t Ranks<Space, T, Dim>::memory() const {
  const auto bytes = [](const auto& view) { return view.span() * sizeof(*view.data()); };
  return bytes(out_) + bytes(in_) + bytes(owner_) + bytes(lists_.node) + bytes(lists_.shared_node) +
         bytes(lists_.begin) + bytes(lists_.source);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                 \
  template PetscErrorCode Ranks<Space, T, Dim>::start(MPI_Comm, const PartitionConfig&, const Owners&, \
                                                      State<Space, T, Dim>&);                          \
  template void Ranks<Space, T, Dim>::send_owners_to_device();                                         \
  template PetscErrorCode Ranks<Space, T, Dim>::add_soil(State<Space, T, Dim>&);                       \
  template PetscErrorCode Ranks<Space, T, Dim>::add_rest(State<Space, T, Dim>&);                       \
  template PetscErrorCode Ranks<Space, T, Dim>::add_present_soil(State<Space, T, Dim>&);               \
  template PetscErrorCode Ranks<Space, T, Dim>::add_forces(State<Space, T, Dim>&);                     \
  template RankReport Ranks<Space, T, Dim>::report(const State<Space, T, Dim>&) const;                 \
  template std::size_t Ranks<Space, T, Dim>::memory() const;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
