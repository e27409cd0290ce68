#pragma once
// One material of any model, for device tables: which model, and its parameters.

#include <array>
#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include "physics/materials/list.hpp"
#include "physics/materials/stored.hpp"

namespace mpm {

template <class T, class List>
struct OneOf;

/// Holds one of the models of the list; `visit` calls f with it.
template <class T, template <class> class... Models>
struct OneOf<T, ModelList<Models...>> {
  static constexpr std::size_t k_bytes = Kokkos::max({sizeof(Models<T>)...});
  int which = -1;
  alignas(16) unsigned char bytes[k_bytes];

  template <class F>
  KOKKOS_INLINE_FUNCTION void visit(F&& f) const {
    visit_as(which, f);
  }
  /// The same where the caller knows which model it is.
  template <class F>
  KOKKOS_INLINE_FUNCTION void visit_as(int known, F&& f) const {
    int k = 0;
    (void)((known == k++ ? (f(*reinterpret_cast<const Models<T>*>(bytes)), true) : false) || ...);
  }
};

template <class T>
using AnyMaterial = OneOf<T, Materials>;

/// The material that a table of a device holds.
template <class T>
KOKKOS_INLINE_FUNCTION const AnyMaterial<T>& material_in(const StoredMaterial<T>& stored) {
  static_assert(sizeof(AnyMaterial<T>) <= sizeof(StoredMaterial<T>) &&
                    alignof(AnyMaterial<T>) <= alignof(StoredMaterial<T>) &&
                    std::is_trivially_copyable_v<AnyMaterial<T>>,
                "a law has more parameters than StoredMaterial has room for");
  return *reinterpret_cast<const AnyMaterial<T>*>(stored.bytes);
}

/// A material by its model's index in Materials and its parameters in the order of the model's table. The
/// last ones may be left out where they have defaults.
template <class T>
AnyMaterial<T> make_material(int which, const std::vector<double>& parameters);

/// The most state variables of any law.
template <template <class> class... Models>
constexpr int most_state(ModelList<Models...>) {
  return Kokkos::max({1, state_size<Models<double>>...});
}
static_assert(most_state(Materials{}) <= k_most_state, "a law has more state variables than k_most_state");

/// What is wrong with the parameters of a material together.
ParameterFault parameter_fault(const AnyMaterial<double>& material);

/// What is wrong with a particle that is created so (the optional member start_fault of a law). The key
/// "stress" is an option of the particle's body, all others are options of the material.
ParameterFault start_fault(const AnyMaterial<double>& material, const ParticleStart& at);

/// The parameters of a material for one run (the optional member prepare_for of a law). To do it again
/// changes nothing.
std::vector<double> parameters_for(int which, const std::vector<double>& parameters, const RunFigures& run);

/// The state variables that the particles of a material carry.
std::vector<StateVariable> state_variables(const AnyMaterial<double>& material);

/// Largest time step [s] that is stable for what the law of a material adds to the waves (its optional member
/// largest_time_step), as an explicit viscosity, with cells of an edge `spacing` [m] and a density [kg/m3];
/// infinite where the waves alone count.
double largest_time_step(const AnyMaterial<double>& material, double spacing, double density, int dim);

/// What the log says of the parameters of a material (the optional member `warning` of a law): lines, in
/// which -NAME_ stands for the prefix of the material's options; empty where there is nothing to say.
std::string warning_of(const AnyMaterial<double>& material);

/// Values of the state variables that a particle carries which is created now.
std::vector<double> initial_state(const AnyMaterial<double>& material, const ParticleStart& at);

/// lambda + 2 G [Pa] of a material that is created at a height [m] with a stress [Pa].
double wave_modulus(const AnyMaterial<double>& material, double height = 0,
                    const std::array<double, 6>& stress = {});

/// Undrained shear strength [Pa] of a material that is created at a height [m] without stress.
double strength_at(const AnyMaterial<double>& material, double height);

}  // namespace mpm
