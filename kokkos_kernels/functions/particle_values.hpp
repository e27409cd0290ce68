#pragma once
// Numbers of the particles that function 3 interpolates by ValueSource. They are in Core::scratch until the
// next kernel that works there.

#include "data/contact_core.hpp"
#include "data/particle_values.hpp"

namespace mpm {

/// The mass of the water that each particle of a set displaces, by DisplacedTerms.
template <class Space, class T, int Dim>
ParticleValues<Space, T, DisplacedTerms::size> find_displaced(
    const Core<Space, T, Dim>& s, const ParticleSet<Space, Soil<Space, T, Dim>>& set);

/// The strengths of the particles of a set in the slots of contact, by StrengthTerms, on a stream. The others
/// have none.
template <class Space, class T, int Dim>
ParticleValues<Space, T, StrengthTerms::size> find_strengths(
    const ContactCore<Space, T, Dim>& s, const ParticleSet<Space, Soil<Space, T, Dim>>& set,
    const Space& stream);

}  // namespace mpm
