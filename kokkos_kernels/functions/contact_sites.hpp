#pragma once
// Passes of contact at sites in a step: over the sites of a list (list_sites) and the particles near them,
// and over nodes.

#include "data/state.hpp"
#include "functions/halo.hpp"

namespace mpm {

/// Values of the sites that ranks share: the gaps, the number of sites that serve a node, the momentum that
/// they have for it, and the numbers that they keep for the next step.
enum class SiteField { gaps, counts, momentum, kept };

/// Passes over the sites of a state, each a kernel that does nothing while `control` is paused. dt: s
template <class Space, class T, int Dim>
struct SitePasses {
  const State<Space, T, Dim>& s;
  double dt;
  ControlView<Space> control;

  /// Finds the sites, and the gaps to the soil there.
  void find() const;
  /// Brings the gaps of the sites down to those to the particles near them.
  void meet() const;
  /// Couples the sites that are in touch to the nodes round them.
  void couple() const;
  /// Begins their impulses with those of the step before.
  void begin() const;
  /// Brings the impulses of all sites at once (Jacobi) towards contact without interpenetration.
  void sweep() const;
  /// Gives the nodes what the sites have for them.
  void take() const;
  /// Brakes the nodes by local damping.
  void brake() const;
  /// Ends the nodes and the sites, and leaves the forces on the rigid bodies.
  void end() const;

  /// Numbers of a node in a halo message.
  int width(SiteField field) const;
  void pack(SiteField field, const HaloLists<Space>& lists, T* out) const;
  void combine(SiteField field, const HaloLists<Space>& lists, const T* in) const;
};

}  // namespace mpm
