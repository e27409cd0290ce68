#include "parallel/decomposition.hpp"

#include <algorithm>

#include "base/copy.hpp"
#include "common/collectives.hpp"
#include "data/light_rigids.hpp"
#include "functions/follow_soil.hpp"
#include "functions/step_kernels.hpp"
#include "rebuild/rebuild_state.hpp"

namespace mpm {
namespace {

/// The first n entries of a view.
template <class View>
auto head(const View& view, std::size_t n) {
  return Kokkos::subview(view, Kokkos::make_pair(std::size_t(0), n));
}

}  // namespace

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::start(MPI_Comm comm, const PartitionConfig& config,
                                                   const Owners& owners, State_& s) {
  PetscFunctionBeginUser;
  comm_ = comm;
  rank_ = s.at_sites.rank = rank_of(comm);
  size_ = size_of(comm);
  config_ = config;
  // Ranks may have different numbers of threads, and all overlap or none does.
  config_.halo_overlap = config.halo_overlap && !has_threads(s.space);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &config_.halo_overlap, 1, MPI_C_BOOL, MPI_LAND, comm));
  owners_ = owners;
  clock_ = WorkClock(is_device<Space>);
  grid_.dim = Dim;
  for (int d = 0; d < Dim; ++d)
    grid_.patches[d] = s.grid.patches[d], grid_.periodic[d] = s.grid.period[d] > 0;
  grid_.fields = s.grid.fields;
  seen_ = decltype(seen_)("mpm::seen");
  PetscCall(transport_.start(comm, config.halo_path));
  if (overlaps(s)) side_.open(s.space);
  const auto rigids = mirror_of(s.rigids);
  forces_shared_ = s.part_forces.count > 0;
  for (std::size_t r = 0; r < rigids.extent(0); ++r)
    forces_shared_ = forces_shared_ || rigids(r).inertia.dynamic;
  reserve_particles(s, k_least_room);
  send_owners_to_device();
  locate(s);
  clock_.go_on();
  long moved = 0;
  PetscCall(migrate(s, &moved));
  sort_and_list(s);
  begin_domains(s);
  PetscCall(make_lists(s));
  note_bound(s, s.space);
  s.space.fence("mpm::note_bound");
  clock_.stop();
  clock_ = WorkClock(is_device<Space>);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void Decomposition<Space, T, Dim>::send_owners_to_device() {
  ensure(owner_, owners_.size());
  const Kokkos::View<const int*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(owners_.data(),
                                                                                  owners_.size());
  copy(head(owner_, owners_.size()), host);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::add_forces(State_& s) {
  PetscFunctionBeginUser;
  if (!forces_shared_) PetscFunctionReturn(PETSC_SUCCESS);
  // The forces are complete when the nodes are updated. Where ghost sums were sent ahead, the side stream
  // sums the forces without waiting for the inner patches.
  const Space& space = sent_ahead() ? side_.space() : s.space;
  sum_forces(s, space);
  PetscCall(add_numbers(s.rigid_force, space, s.space));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::add_light_sums(State_& s, const Space& stream, bool* open) {
  PetscFunctionBeginUser;
  double count = 0;
  const int numbers = light_numbers<Dim>(static_cast<int>(s.rigid_points.size()));
  PetscCall(add_numbers(head(s.light_rigids.sums, numbers), stream, stream, &count));
  *open = count > 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::add_numbers(const Kokkos::View<double*, Memory>& numbers,
                                                         const Space& from, const Space& to, double* last) {
  PetscFunctionBeginUser;
  const auto sums = Kokkos::create_mirror_view(numbers);
  copy(from, sums, numbers);
  from.fence("mpm::add_numbers");
  clock_.pause();
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.extent(0)), MPI_DOUBLE, MPI_SUM, comm_));
  clock_.go_on();
  copy(to, numbers, sums);
  if (last != nullptr) *last = sums(sums.extent(0) - 1);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
RankReport Decomposition<Space, T, Dim>::report(const State_& s) const {
  RankReport report;
  report.work = clock_.work();
  report.wait = clock_.wait();
  report.halo = halo_;
  report.held = held_;
  report.particles = s.soil.points.count;
  report.neighbours = neighbours_;
  report.shared_nodes = lists_.shared;
  const int width = SoilTerms<Dim>::size + (s.soil_boundary ? BoundaryTerms<Dim>::size : 0);
  report.sent = double(lists_.sent) * width * sizeof(T);
  return report;
}

template <class Space, class T, int Dim>
std::string Decomposition<Space, T, Dim>::halo_words(const State_& s) const {
  return std::string(transport_.words()) + (overlaps(s) ? ", while inner patches are computed" : "");
}

template <class Space, class T, int Dim>
std::size_t Decomposition<Space, T, Dim>::memory() const {
  const auto bytes = [](const auto& view) { return view.span() * sizeof(*view.data()); };
  return transport_.memory() + bytes(owner_) + bytes(lists_.node) + bytes(lists_.shared_node) +
         bytes(lists_.begin) + bytes(lists_.source);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                      \
  template PetscErrorCode Decomposition<Space, T, Dim>::start(MPI_Comm, const PartitionConfig&,             \
                                                              const Owners&, State<Space, T, Dim>&);        \
  template void Decomposition<Space, T, Dim>::send_owners_to_device();                                      \
  template PetscErrorCode Decomposition<Space, T, Dim>::add_forces(State<Space, T, Dim>&);                  \
  template PetscErrorCode Decomposition<Space, T, Dim>::add_light_sums(State<Space, T, Dim>&, const Space&, \
                                                                       bool*);                              \
  template RankReport Decomposition<Space, T, Dim>::report(const State<Space, T, Dim>&) const;              \
  template std::string Decomposition<Space, T, Dim>::halo_words(const State<Space, T, Dim>&) const;         \
  template std::size_t Decomposition<Space, T, Dim>::memory() const;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
