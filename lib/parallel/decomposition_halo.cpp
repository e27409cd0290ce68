// In the steps: the sums of nodes that several ranks reach.

#include <algorithm>

#include "base/copy.hpp"
#include "data/features_of.hpp"
#include "loops/particle_to_node.hpp"
#include "parallel/decomposition.hpp"

namespace mpm {

template <class Space, class T, int Dim>
bool Decomposition<Space, T, Dim>::overlaps(const State_& s) const {
  return config_.halo_overlap && can(StepWay::overlapped, features_of(s));
}

/// The sums of soil and of its boundary, which only the nodes near a rigid read.
template <class Space, class T, int Dim>
auto Decomposition<Space, T, Dim>::soil_fields(const State_& s, bool soil, bool boundary) const -> Fields {
  Fields fields;
  if (soil) fields.add(s.nodes.soil.data(), SoilTerms<Dim>::size);
  if (boundary) fields.add(s.nodes.boundary.data(), BoundaryTerms<Dim>::size, s.contact.place.data());
  return fields;
}

/// Packs the sums, and sends them.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::send(const Space& space, const Fields& fields) {
  PetscFunctionBeginUser;
  if (fields.count == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(send(space, fields.width, [&](T* out) {
    for (int f = 0; f < fields.count; ++f) pack_nodes(space, lists_, fields.of[f], fields.width, out);
  }));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Once the sums are packed: what comes in for them.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::exchange(int width, bool with_bound) {
  PetscFunctionBeginUser;
  if (width > 0 && is_device<Space>) PetscCall(transport_.start(width));
  if (with_bound) PetscCall(post_bound());
  if (width > 0) PetscCall(transport_.finish());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void Decomposition<Space, T, Dim>::sum(const Space& space, const Fields& fields) {
  if (fields.count == 0) return;
  const double start = WorkClock::wall();
  const T* const in = transport_.deliver(space, fields.width);
  for (int f = 0; f < fields.count; ++f) sum_ghosts(space, lists_, fields.of[f], fields.width, in);
  if (!is_device<Space>) halo_ += WorkClock::wall() - start;
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::receive(const Space& space, int width, bool with_bound) {
  PetscFunctionBeginUser;
  space.fence("mpm::halo is packed");
  clock_.pause();
  PetscCall(exchange(width, with_bound));
  clock_.go_on();
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// All of it at once.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::add(const Space& space, const Fields& fields, bool with_bound) {
  PetscFunctionBeginUser;
  PetscCall(send(space, fields));
  PetscCall(receive(space, fields.width, with_bound));
  sum(space, fields);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Starts the reduction of the bound that was noted last.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::post_bound() {
  PetscFunctionBeginUser;
  const Control& c = seen_();
  PetscCall(bound_.post(comm_, {c.bound, c.increment, c.paused != 0 ? 1.0 : 0.0}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void Decomposition<Space, T, Dim>::note_bound(const State_& s, const Space& stream) {
  copy(stream, seen_, s.control);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::add_soil(State_& s, const Space& stream) {
  PetscFunctionBeginUser;
  if (ahead_ == Ahead::under_way) {
    PetscCall(end_ahead(s, stream, true));
  } else if (ahead_ == Ahead::added) {
    PetscCall(post_bound());
  } else {
    const bool added = s.summed.soil && present_added_;  // where they were measured before the step
    PetscCall(add(s.space, soil_fields(s, !added, !added && s.soil_boundary), true));
  }
  note_bound(s, stream);  // for the next step
  ahead_ = Ahead::nothing;
  present_added_ = false;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::add_values(const State_& s, T* values, int size, When when,
                                                        const int* read) {
  PetscFunctionBeginUser;
  Fields fields;
  fields.add(values, size, read);
  if (when == When::between_steps) clock_.go_on();
  PetscCall(add(s.space, fields, false));
  if (when == When::between_steps) clock_.stop();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::add_present_soil(State_& s) {
  PetscFunctionBeginUser;
  if (s.summed.soil && present_added_) PetscFunctionReturn(PETSC_SUCCESS);
  clock_.go_on();
  if (ahead_ == Ahead::under_way) {
    PetscCall(end_ahead(s, s.space, false));
    ahead_ = Ahead::added;
  } else if (ahead_ == Ahead::nothing) {
    PetscCall(add(s.space, soil_fields(s, true, s.soil_boundary), false));
  }
  clock_.stop();
  present_added_ = true;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
Part<Space> Decomposition<Space, T, Dim>::border(const State_& s) {
  nodes_there_.record(s.space);
  nodes_there_.wait(side_.space());
  return {side_.space(), 0, s.soil.bins.border};
}

template <class Space, class T, int Dim>
Part<Space> Decomposition<Space, T, Dim>::inner(const State_& s) const {
  return {s.space, s.soil.bins.border, s.soil.bins.last_active};
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::send_ahead(State_& s) {
  PetscFunctionBeginUser;
  border_there_.record(side_.space());
  on_their_way_ = soil_fields(s, true, s.soil_boundary);
  if (measures()) packing_.record(side_.space());
  PetscCall(send(side_.space(), on_their_way_));
  if (measures()) packed_.record(side_.space());
  ahead_ = Ahead::under_way;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Estimates the cost of all exchanges from the events of the last one that was measured. A device was held
/// up from when it had nothing left but to wait for the ghost sums until they were added; the host, which
/// waits beside it, is no measure of that.
template <class Space, class T, int Dim>
void Decomposition<Space, T, Dim>::measure_ahead() {
  const double held = k_measured_each * std::max(0.0, seconds_between(idle_, over_));
  halo_ += k_measured_each * (seconds_between(packing_, packed_) + seconds_between(adding_, over_));
  held_ += held;
  clock_.idled(held);
}

/// Adds what was sent ahead, while the inner patches may still be computed.
template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::end_ahead(const State_& s, const Space& stream,
                                                       bool with_bound) {
  PetscFunctionBeginUser;
  const Space& side = side_.space();
  side.fence("mpm::halo is packed");
  if (!is_device<Space>) clock_.pause();
  if (measures()) idle_.record(s.space);
  PetscCall(exchange(on_their_way_.width, with_bound));
  if (!is_device<Space>) clock_.go_on();
  if (measures()) adding_.record(side);
  sum(side, on_their_way_);
  if (measures()) over_.record(side);
  added_.record(side);
  added_.wait(s.space);
  added_.wait(stream);
  if (exchanges_++ % k_measured_each == 1 && is_device<Space>) measure_ahead();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode Decomposition<Space, T, Dim>::forget() {
  PetscFunctionBeginUser;
  PetscCall(bound_.drain());
  bound_.set_sum(0);
  bound_.set_due_in(0);
  drop_ahead();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void Decomposition<Space, T, Dim>::drop_ahead() {
  side_.space().fence("mpm::drop_ahead");
  ahead_ = Ahead::nothing;
  present_added_ = false;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                   \
  template bool Decomposition<Space, T, Dim>::overlaps(const State<Space, T, Dim>&) const;               \
  template void Decomposition<Space, T, Dim>::note_bound(const State<Space, T, Dim>&, const Space&);     \
  template PetscErrorCode Decomposition<Space, T, Dim>::add_soil(State<Space, T, Dim>&, const Space&);   \
  template PetscErrorCode Decomposition<Space, T, Dim>::add_values(const State<Space, T, Dim>&, T*, int, \
                                                                   When, const int*);                    \
  template PetscErrorCode Decomposition<Space, T, Dim>::receive(const Space&, int, bool);                \
  template PetscErrorCode Decomposition<Space, T, Dim>::add_present_soil(State<Space, T, Dim>&);         \
  template Part<Space> Decomposition<Space, T, Dim>::border(const State<Space, T, Dim>&);                \
  template Part<Space> Decomposition<Space, T, Dim>::inner(const State<Space, T, Dim>&) const;           \
  template PetscErrorCode Decomposition<Space, T, Dim>::send_ahead(State<Space, T, Dim>&);               \
  template PetscErrorCode Decomposition<Space, T, Dim>::forget();                                        \
  template void Decomposition<Space, T, Dim>::drop_ahead();
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
