#pragma once
// Function 7: bins, patch table and lists anew, before a particle can have moved further than the margin.
// Here are the parts; rebuild/rebuild_state.hpp does them in turn.

#include <algorithm>

#include "base/ensure.hpp"
#include "base/spaces.hpp"
#include "data/contact_core.hpp"

namespace mpm {

/// Finds the cell of every point (ParticleSet::address) from where it is now, and brings the soil's
/// coordinates back to [0, 1). Soil outside the mesh: beyond a free side it leaves the run and gets no
/// address, as do strays that are to be removed; Control::lost is their number. Beyond a wall it is put back
/// on it, and what it had of velocity against the wall is gone. A rigid's point outside the mesh is a fault
/// in s.control.
template <class Space, class T, int Dim>
void locate(ContactCore<Space, T, Dim>& s);

/// The rigids' part of it.
template <class Space, class T, int Dim>
void locate_rigids(ContactCore<Space, T, Dim>& s);

/// Makes the patch table, the order of the points, their bins and the strategy's lists from the points'
/// addresses.
template <class Space, class T, int Dim>
void sort_points_and_list(ContactCore<Space, T, Dim>& s);

/// Lays out the nodal fields that the run uses anew; they hold nothing. After the plan of the steps is made.
template <class Space, class T, int Dim>
void make_room(ContactCore<Space, T, Dim>& s, const NodeUses& uses);

/// Begins the bound of the points' movements anew.
template <class Space, class T, int Dim>
void reset_bound(const Core<Space, T, Dim>& s);

/// Nodal impulses that outlive a rebuild, with the patches that they were of.
template <class Space, class T, int Dim>
struct KeptImpulse {
  Kokkos::View<T**, Kokkos::LayoutRight, typename Space::memory_space> impulse;
  Kokkos::View<int*, typename Space::memory_space> number;
  NearBodies<Space> near;  // whose rows they are
  int slots = 0;
};

// Parts of sort_points_and_list.
template <class Space, class T, int Dim>
KeptImpulse<Space, T, Dim> keep_impulse(const ContactCore<Space, T, Dim>& s);
template <class Space, class T, int Dim>
void restore_impulse(ContactCore<Space, T, Dim>& s, const KeptImpulse<Space, T, Dim>& kept);
template <class Space, class T, int Dim>
void activate_patches(ContactCore<Space, T, Dim>& s);
template <class Space, class T, int Dim>
void sort_points(ContactCore<Space, T, Dim>& s);
template <class Space, class T, int Dim>
void build_lists(ContactCore<Space, T, Dim>& s);
/// Lists the patches in which several velocity fields are active in s.interfaces.
template <class Space, class T, int Dim>
void list_interfaces(ContactCore<Space, T, Dim>& s);
/// Lists the slots where a contact may be: a node that soil and a rigid share is reached from no other slot.
template <class Space, class T, int Dim>
void list_contacts(ContactCore<Space, T, Dim>& s);
/// Lists the sites that may act until the next rebuild, where that is not done yet: when the impulses at the
/// nodes and the places of the rigids are those that the steps go on with.
template <class Space, class T, int Dim>
void list_sites(ContactCore<Space, T, Dim>& s);
/// Brings the mean stress of each particle towards that of its cell by the fraction of F-bar: the particles
/// of a cell dilate together until the next rebuild, so their pressures begin together.
template <class Space, class T, int Dim>
void average_pressure(ContactCore<Space, T, Dim>& s);

/// Part of a value that the sort moves at a time, so that its scratch memory stays small: a particle's
/// vector, or as much of a tensor.
template <class Value>
struct SortedPart {
  using type = Value;
};
template <class T, int Dim>
struct SortedPart<SymTensor<T, Dim>> {
  using type = Vector<T, 2>;
};
template <class T, int Dim>
struct SortedPart<Matrix<T, Dim>> {
  using type = Vector<T, Dim>;
};
template <class T, int Dim>
struct SortedPart<DomainMoments<T, Dim>> {
  using type = std::conditional_t<Dim == 2, T, Vector<T, Dim>>;
};
template <class T>
struct SortedPart<Vector<T, 5>> {  // Face
  using type = T;
};
template <class T>
struct SortedPart<Vector<T, 6>> {
  using type = Vector<T, 2>;
};
template <class Value>
using PartOf = typename SortedPart<Value>::type;

/// Bytes of scratch memory that sorting takes a point.
template <class Points_>
std::size_t scratch_of_point(Points_& points) {
  std::size_t widest = sizeof(int);
  for_each_field(points, [&](const auto& field) {
    widest = std::max(widest, sizeof(PartOf<typename std::decay_t<decltype(field)>::value_type>));
  });
  return widest;
}

}  // namespace mpm
