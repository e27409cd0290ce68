#pragma once
// Contact between the velocity fields of deformable bodies in a step.

#include <array>
#include <vector>

#include "base/copy.hpp"
#include "data/state.hpp"

namespace mpm {

/// Part of 4, before update_nodes, where s.interfaces is in use: adds to the forces at the nodes that several
/// velocity fields share what the fields do to each other in a step of dt [s]. The sums at nodes are
/// complete. in_step: not while the steps are paused.
template <class Space, class T, int Dim>
void press_fields(State<Space, T, Dim>& s, double dt, bool in_step);

/// Adds what press_fields summed in a step to the totals of the interfaces, in an order that is always the
/// same, on a stream.
template <class Space, class T, int Dim>
void add_interface_totals(const State<Space, T, Dim>& s, const Space& stream);

/// Brings the soil's sums at the nodes back at its end where they are those of the next step already:
/// measurements have press_fields add to them.
template <class Space, class T, int Dim>
class KeptSums {
 public:
  explicit KeptSums(const State<Space, T, Dim>& s) : s_(s) {
    if (!s.summed.soil || !s.interfaces.in_use()) return;
    kept_ = decltype(kept_)(Kokkos::view_alloc(Kokkos::WithoutInitializing, "mpm::kept_sums"),
                            s.nodes.soil.extent(0));
    copy(s.space, kept_, s.nodes.soil);
  }
  ~KeptSums() {
    if (kept_.extent(0) > 0) copy(s_.space, s_.nodes.soil, kept_);
  }
  KeptSums(const KeptSums&) = delete;
  KeptSums& operator=(const KeptSums&) = delete;

 private:
  const State<Space, T, Dim>& s_;
  NodeField<Space, T, SoilTerms<Dim>::size> kept_;
};

/// Contact of a pair of bodies at a node of the mesh.
struct InterfaceNode {
  int row = 0;                                          // of the pair
  std::array<double, 3> position{}, force{}, normal{};  // m from the lower corner of the mesh; N, on the
                                                        // first body; of length 1, out of the first body
  double area = 0;                                      // m2
};

/// The nodes at which pairs of bodies act on each other in a step of dt [s] from the present state, those of
/// this rank. The sums at nodes are complete.
template <class Space, class T, int Dim>
std::vector<InterfaceNode> interface_nodes(State<Space, T, Dim>& s, double dt);

/// InterfaceTerms of the pairs of bodies since they were last taken (the work: since the start); impulses and
/// areas begin anew.
template <class Space, class T, int Dim>
std::vector<double> take_interface_totals(ContactCore<Space, T, Dim>& s);

/// The same as a checkpoint keeps them, and back from one.
template <class Space, class T, int Dim>
std::vector<double> save_interface_totals(const ContactCore<Space, T, Dim>& s);
template <class Space, class T, int Dim>
void restore_interface_totals(ContactCore<Space, T, Dim>& s, const std::vector<double>& saved);

}  // namespace mpm
