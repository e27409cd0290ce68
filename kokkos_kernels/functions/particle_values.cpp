#include "functions/particle_values.hpp"

#include "physics/displaced_mass.hpp"
#include "physics/materials/any.hpp"

namespace mpm {
namespace {

/// Calls f(p) for the particles of some slots of bins, or of all.
template <class Space, int Dim, class F>
struct ForEachInSlots {
  static constexpr int cells = Patch<Dim>::cells;
  decltype(Bins<Space>::begin) begin;
  int first_slot, last_slot;                              // of the bins
  Kokkos::View<int*, typename Space::memory_space> some;  // slots; empty: all
  ControlView<Space> control;
  F f;

  KOKKOS_INLINE_FUNCTION void operator()(int n) const {
    if (control().paused) return;
    int slot = n / cells;
    if (some.extent(0) > 0) slot = some(slot);
    if (slot < first_slot || slot >= last_slot) return;
    const int cell = slot * cells + n % cells;
    for (int p = begin(cell); p < begin(cell + 1); ++p) f(p);
  }
};
template <class F, class Space, class T, int Dim>
void for_each_in_slots(const char* label, const Core<Space, T, Dim>& s, const Bins<Space>& bins, const F& f) {
  constexpr int cells = Patch<Dim>::cells;
  Kokkos::parallel_for(
      label, light(Kokkos::RangePolicy<Space>(s.space, bins.first_slot * cells, bins.last_slot * cells)),
      ForEachInSlots<Space, Dim, F>{bins.begin, bins.first_slot, bins.last_slot, {}, s.control, f});
}

template <class Space, class T, int Dim>
struct FindDisplaced {
  DisplacedMass<Space, T, Dim> mass;
  ParticleValues<Space, T, DisplacedTerms::size> values;

  KOKKOS_INLINE_FUNCTION void operator()(int p) const { values(p)[DisplacedTerms::mass] = mass(p); }
};

template <class Space, class T, int Dim>
struct FindStrength {
  Soil<Space, T, Dim> soil;
  ParticleValues<Space, T, StrengthTerms::size> values;

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    const T volume = soil.volume(p);
    T strength = 0;
    material_in(soil.materials(soil.material_of(p))).visit([&](const auto& law) {
      strength = law.shear_strength(soil.state_of(law, p));
    });
    values(p)[StrengthTerms::strength] = volume * strength, values(p)[StrengthTerms::volume] = volume;
  }
};

}  // namespace

template <class Space, class T, int Dim>
ParticleValues<Space, T, DisplacedTerms::size> find_displaced(
    const Core<Space, T, Dim>& s, const ParticleSet<Space, Soil<Space, T, Dim>>& set) {
  const auto values = values_in_scratch<DisplacedTerms::size>(s);
  for_each_in_slots(
      "mpm::find_displaced", s, set.bins,
      FindDisplaced<Space, T, Dim>{{set.points, s.water, s.density, s.patches.origin, s.spacing}, values});
  return values;
}

template <class Space, class T, int Dim>
ParticleValues<Space, T, StrengthTerms::size> find_strengths(
    const ContactCore<Space, T, Dim>& s, const ParticleSet<Space, Soil<Space, T, Dim>>& set,
    const Space& stream) {
  using Find = FindStrength<Space, T, Dim>;
  const auto values = values_in_scratch<StrengthTerms::size>(s);
  const Bins<Space>& bins = set.bins;
  Kokkos::parallel_for(
      "mpm::find_strengths",
      light(Kokkos::RangePolicy<Space>(stream, 0, s.contact.count * Patch<Dim>::cells)),
      ForEachInSlots<Space, Dim, Find>{
          bins.begin, bins.first_slot, bins.last_slot, s.contact.slots, s.control, {set.points, values}});
  return values;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                             \
  template ParticleValues<Space, T, DisplacedTerms::size> find_displaced(          \
      const Core<Space, T, Dim>&, const ParticleSet<Space, Soil<Space, T, Dim>>&); \
  template ParticleValues<Space, T, StrengthTerms::size> find_strengths(           \
      const ContactCore<Space, T, Dim>&, const ParticleSet<Space, Soil<Space, T, Dim>>&, const Space&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
