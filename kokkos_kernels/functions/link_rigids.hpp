#pragma once
// Joints, springs and dashpots of rigid bodies, from the host to a State and back, and their step.

#include <vector>

#include "data/contact_core.hpp"

namespace mpm {

/// Puts joints, and the supports of all rigids, on the device. size [m]: of the mesh. Before upload, which
/// plans the steps. No joints and no supports: nothing links the bodies.
template <class Space, class T, int Dim>
void upload_links(ContactCore<Space, T, Dim>& s, const std::vector<Joint<Dim>>& joints,
                  const std::vector<RigidSupport<Dim>>& supports, double size);

/// Moves the rigids of a run where s.links is in use, by a step of dt [s], under the forces on them; leaves
/// their movements in s.rigid_moved [cells] for move_rigids.
template <class Space, class T, int Dim>
void link_rigids(ContactCore<Space, T, Dim>& s, double dt, const Space& stream);

/// Joints and supports as they are.
template <class Space, class T, int Dim>
std::vector<Joint<Dim>> joints_of(const ContactCore<Space, T, Dim>& s);
template <class Space, class T, int Dim>
std::vector<RigidSupport<Dim>> supports_of(const ContactCore<Space, T, Dim>& s);
/// Joints and supports on the device become these, of which there are as many.
template <class Space, class T, int Dim>
void put_links(ContactCore<Space, T, Dim>& s, const std::vector<Joint<Dim>>& joints,
               const std::vector<RigidSupport<Dim>>& supports);

}  // namespace mpm
