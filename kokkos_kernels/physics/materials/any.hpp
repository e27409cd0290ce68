#pragma once
// One material of any model, for device tables: which model, and its parameters.

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "base/spaces.hpp"
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
  T pore_stiffness = 0;    // Pa, of water that does not flow (physics/pore_water.hpp); 0: there is none
  bool saturated = false;  // water flows in the pores (physics/pore_flow.hpp)
  alignas(16) unsigned char bytes[k_bytes];

  /// Whether the stress of its soil is total, by an excess pore pressure that the particles have.
  KOKKOS_FORCEINLINE_FUNCTION bool has_pore_pressure() const { return saturated || pore_stiffness > 0; }
  /// The model, where the caller has found it to be this one.
  template <template <class> class Model>
  KOKKOS_FORCEINLINE_FUNCTION const Model<T>& as() const {
    return *reinterpret_cast<const Model<T>*>(bytes);
  }
  template <class F>
  KOKKOS_INLINE_FUNCTION void visit(F&& f) const {
    visit_as(ModelList<Models...>{}, which, f);
  }
  /// Calls f with the model where the caller gives its index, which is in some list.
  template <template <class> class... Some, class F>
  KOKKOS_INLINE_FUNCTION void visit_as(ModelList<Some...>, int known, F&& f) const {
    (void)((known == model_index_in<Some>(Materials{}) ? (call(f, as<Some>()), true) : false) || ...);
  }

 private:
  /// Calls f(law), where code for the law is built at all.
  template <class F, class Law>
  static KOKKOS_INLINE_FUNCTION void call([[maybe_unused]] F&& f, [[maybe_unused]] const Law& law) {
    if constexpr (!on_host_in_double<Law>())
      f(law);
    else if constexpr (std::is_same_v<T, double>)
      KOKKOS_IF_ON_HOST((f(law);))
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
/// last ones may be left out where they have defaults. object: what make_object made, which must stay.
template <class T>
AnyMaterial<T> make_material(int which, const std::vector<double>& parameters, const void* object = nullptr);

/// The object of a material, where its law has one, else null. Where it cannot be made, `fault` gives the
/// reason.
std::shared_ptr<const void> make_object(int which, const LawSetup& setup, ParameterFault& fault);

/// The most state variables of any law; on a device those that run on processors alone do not count.
template <template <class> class... Models>
constexpr int most_state(ModelList<Models...>, bool device) {
  return Kokkos::max({1, device && on_host_in_double<Models<double>>() ? 0 : state_size<Models<double>>...});
}
static_assert(most_state(Materials{}, true) <= k_most_state_on_device &&
                  most_state(Materials{}, false) <= k_most_state_on_host,
              "a law has more state variables than there is room for");

/// Fault of the parameters of a material together.
ParameterFault parameter_fault(const AnyMaterial<double>& material);

/// Fault of a particle that is created so (the optional member start_fault of a law). The key "stress" is an
/// option of the particle's body, all others are options of the material.
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

/// Warnings for the log about the parameters of a material (the optional member `warning` of a law): lines,
/// in which -NAME_ stands for the prefix of the material's options; empty where there is nothing to say.
std::string warning_of(const AnyMaterial<double>& material);

/// Values of the state variables that a particle carries which is created now.
std::vector<double> initial_state(const AnyMaterial<double>& material, const ParticleStart& at);

/// lambda + 2 G [Pa] of a material that is created at a height [m] with a stress [Pa]. own: that of
/// ParticleStart.
double wave_modulus(const AnyMaterial<double>& material, double height = 0,
                    const std::array<double, 6>& stress = {}, const OwnValues& own = {});

/// Undrained shear strength [Pa] of a material that is created at a height [m] without stress.
double strength_at(const AnyMaterial<double>& material, double height);

}  // namespace mpm
