// In the steps: the sums of nodes that several ranks reach.

#include <algorithm>

#include "parallel/ranks.hpp"
#include "particle_to_node.hpp"

namespace mpm {

template <class Space, class T, int Dim>
bool sends_ahead(const State<Space, T, Dim>& s, const PartitionConfig& config) {
  return backend_of<Space> != Backend::openmp && config.halo_overlap &&
         chosen(s.p2g.strategy, backend_of<Space>) == P2G::tile;
}

/// The shares of soil and of its boundary, which only the nodes near a rigid read.
template <class Space, class T, int Dim>
auto Ranks<Space, T, Dim>::soil_fields(const State_& s, bool soil, bool boundary) const -> Fields {
  Fields fields;
  if (soil) fields.add(s.nodes.soil.data(), SoilShare<Dim>::size);
  if (boundary) fields.add(s.nodes.boundary.data(), BoundaryShare<Dim>::size, s.near_rigid.data());
  return fields;
}

/// Packs the shares, and sends them behind that as far as the device can, or where nothing runs behind: all
/// the way.
template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::send(const Space& space, const Fields& fields) {
  PetscFunctionBeginUser;
  if (fields.count == 0) PetscFunctionReturn(PETSC_SUCCESS);
  const double start = WorkClock::wall();
  for (int f = 0; f < fields.count; ++f)
    pack_nodes(space, lists_, fields.of[f], fields.width, transport_.out());
  PetscCall(transport_.send(space, fields.width));
  if (!is_device<Space>) halo_ += WorkClock::wall() - start;
  if (!is_device<Space>) PetscCall(transport_.start(fields.width));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Once `space` has packed the shares: what comes in for them. The rest of the step waits for it, or a device
/// goes on `beside` it: the host then waits, and is no measure of the device's work.
template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::exchange(const Space& space, int width, bool with_bound, bool beside) {
  PetscFunctionBeginUser;
  space.fence("mpm::halo is packed");
  if (!beside) clock_.pause();
  if (width > 0 && is_device<Space>) PetscCall(transport_.start(width));
  if (with_bound) PetscCall(post_bound());
  if (width > 0) PetscCall(transport_.finish());
  if (!beside) clock_.go_on();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void Ranks<Space, T, Dim>::sum(const Space& space, const Fields& fields) {
  if (fields.count == 0) return;
  const double start = WorkClock::wall();
  const T* const in = transport_.deliver(space, fields.width);
  for (int f = 0; f < fields.count; ++f) sum_shares(space, lists_, fields.of[f], fields.width, in);
  if (!is_device<Space>) halo_ += WorkClock::wall() - start;
}

/// All of it at once.
template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add(const Space& space, const Fields& fields, bool with_bound) {
  PetscFunctionBeginUser;
  PetscCall(send(space, fields));
  PetscCall(exchange(space, fields.width, with_bound, false));
  sum(space, fields);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Starts the reduction of the bound that was noted last.
template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::post_bound() {
  PetscFunctionBeginUser;
  const Control& c = seen_();
  PetscCall(bound_.post(comm_, {c.bound, c.increment, c.paused != 0 ? 1.0 : 0.0}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void Ranks<Space, T, Dim>::note_bound(State_& s, bool wait) {
  Kokkos::deep_copy(s.space, seen_, s.control);
  if (wait) s.space.fence("mpm::note_bound");
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add_soil(State_& s) {
  PetscFunctionBeginUser;
  if (!is_device<Space>) note_bound(s, false);
  if (ahead_ == Ahead::under_way) {
    PetscCall(end_ahead(s, true));
  } else if (ahead_ == Ahead::added) {
    PetscCall(post_bound());
  } else {
    const bool added = s.summed.soil && present_added_;  // where they were measured before the step
    note_bound(s, false);
    PetscCall(add(s.space, soil_fields(s, !added, s.soil_boundary), true));
  }
  if (ahead_ != Ahead::nothing) note_bound(s, false);  // for the next step
  ahead_ = Ahead::nothing;
  present_added_ = false;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add_rest(State_& s) {
  PetscFunctionBeginUser;
  Fields fields;
  fields.add(s.nodes.rest.data(), Dim);
  PetscCall(add(s.space, fields, false));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::add_present_soil(State_& s) {
  PetscFunctionBeginUser;
  if (s.summed.soil && present_added_) PetscFunctionReturn(PETSC_SUCCESS);
  clock_.go_on();
  if (ahead_ == Ahead::under_way) {
    PetscCall(end_ahead(s, false));
    ahead_ = Ahead::added;
  } else if (ahead_ == Ahead::nothing) {
    PetscCall(add(s.space, soil_fields(s, true, false), false));
  }
  clock_.stop();
  present_added_ = true;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
Part<Space> Ranks<Space, T, Dim>::border(const State_& s) {
  nodes_there_.set(s.space);
  nodes_there_.hold(side_.space());
  return {side_.space(), 0, s.soil.bins.border};
}

template <class Space, class T, int Dim>
Part<Space> Ranks<Space, T, Dim>::inner(const State_& s) const {
  return {s.space, s.soil.bins.border, s.soil.bins.colour_begin[Patch<Dim>::colours]};
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::send_ahead(State_& s) {
  PetscFunctionBeginUser;
  border_there_.set(side_.space());
  on_their_way_ = soil_fields(s, true, s.soil_boundary);
  packing_.set(side_.space());
  PetscCall(send(side_.space(), on_their_way_));
  packed_.set(side_.space());
  ahead_ = Ahead::under_way;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Adds what was sent ahead, while the inner patches may still be computed; what s.space is given from now on
/// finds the sums.
template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::end_ahead(State_& s, bool with_bound) {
  PetscFunctionBeginUser;
  PetscCall(exchange(side_.space(), on_their_way_.width, with_bound, is_device<Space>));
  halo_ += seconds_between(packing_, packed_) + seconds_between(adding_, added_);  // these of the last time
  const double held = std::max(0.0, seconds_between(idle_, added_));
  held_ += held;
  clock_.idled(held);
  idle_.set(s.space);
  adding_.set(side_.space());
  sum(side_.space(), on_their_way_);
  added_.set(side_.space());
  added_.hold(s.space);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Ranks<Space, T, Dim>::forget() {
  PetscFunctionBeginUser;
  PetscCall(bound_.drain());
  bound_.set_sum(0);
  side_.space().fence("mpm::forget");
  ahead_ = Ahead::nothing;
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                   \
  template bool sends_ahead(const State<Space, T, Dim>&, const PartitionConfig&);        \
  template void Ranks<Space, T, Dim>::note_bound(State<Space, T, Dim>&, bool);           \
  template PetscErrorCode Ranks<Space, T, Dim>::add_soil(State<Space, T, Dim>&);         \
  template PetscErrorCode Ranks<Space, T, Dim>::add_rest(State<Space, T, Dim>&);         \
  template PetscErrorCode Ranks<Space, T, Dim>::add_present_soil(State<Space, T, Dim>&); \
  template Part<Space> Ranks<Space, T, Dim>::border(const State<Space, T, Dim>&);        \
  template Part<Space> Ranks<Space, T, Dim>::inner(const State<Space, T, Dim>&) const;   \
  template PetscErrorCode Ranks<Space, T, Dim>::send_ahead(State<Space, T, Dim>&);       \
  template PetscErrorCode Ranks<Space, T, Dim>::forget();
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
