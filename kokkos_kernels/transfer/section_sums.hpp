#pragma once
// Mass and volume of soil beyond planes, and their fluxes through the planes.

#include "data/core.hpp"
#include "data/probe_data.hpp"

namespace mpm {

/// Sums over the particles of this rank. The part of a particle's domain that is beyond the plane counts. The
/// flux is a mean over a strip of one cell around the plane.
template <class Space, class T, int Dim>
SectionSum section_sum(const Core<Space, T, Dim>& s, const SectionPlane& plane);

/// Which particles are beyond planes (at most 64): a bit a plane, by particle.
template <class Space>
using BeyondMask = Kokkos::View<std::uint64_t*, typename Space::memory_space>;
template <class Space, class T, int Dim>
BeyondMask<Space> beyond_mask(const Core<Space, T, Dim>& s, const std::vector<SectionPlane>& planes);

/// Adds to `lost`, by plane, mass and initial volume of the particles that locate() has found to leave the
/// run, as `beyond` had them before it.
template <class Space, class T, int Dim>
void add_lost_beyond(const Core<Space, T, Dim>& s, const std::vector<SectionPlane>& planes,
                     const BeyondMask<Space>& beyond, std::vector<SectionSum>& lost);

}  // namespace mpm
