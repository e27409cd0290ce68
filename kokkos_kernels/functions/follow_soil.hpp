#pragma once
// Domains follow the soil (-particle_domain stretch) between steps, at rebuilds and after so many steps
// without one, from where particles were the last time to where they are:
//   1. sum_drift        CentreSource, VectorSource: of the soil at each node the centre of mass, and its
//   way
//   2. stretch_domains  the deformation gradient of each particle by least squares over its nodes; its domain
//   3. begin_domains    once the lists are made: the places from which the next way counts
// The first two need the lists and nodes of before the rebuild.

#include "base/spaces.hpp"
#include "data/contact_core.hpp"

namespace mpm {

/// Sums of this rank's soil to s.nodes.centre and s.nodes.drift, by the run's strategy. Until
/// begin_domains() the field `begun` of the soil is the way of each particle [cells].
template <class Space, class T, int Dim>
void sum_drift(ContactCore<Space, T, Dim>& s);

/// Deforms the domain of each particle, M <- k F M F^T, F the deformation gradient since the last time.
/// The soil of node i now has its centre at x_i and came by u_i. With weights S_ip and their means x, u:
///   G = [sum S_ip (u_i - u) (x_i - x)^T] [sum S_ip (x_i - x) (x_i - x)^T]^-1,  F = (I - G)^-1
/// which is exact where the motion is linear, however particles lie. k makes the dilatation that of the
/// particle's volume. Where nodes have their soil too near to a line (plane), F = I. Particles that are alone
/// keep their domains. The half lengths become those of half of this way further on, so that they are neither
/// late nor early in the mean until the next time.
template <class Space, class T, int Dim>
void stretch_domains(ContactCore<Space, T, Dim>& s);

/// After the lists were made, and where particles are new.
template <class Space, class T, int Dim>
void begin_domains(ContactCore<Space, T, Dim>& s);

}  // namespace mpm
