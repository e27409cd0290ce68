#pragma once
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "physics/materials/material.hpp"
#include "physics/materials/umat_library.hpp"

namespace mpm {

/// Names of the state variables of a UMAT: state_1, state_2, ...
template <int Count>
struct StateNames {
  char text[Count][9]{};
  constexpr StateNames() {
    for (int k = 0; k < Count; ++k) {
      constexpr char k_begin[] = "state_";
      int at = 0;
      while (k_begin[at] != 0) text[k][at] = k_begin[at], ++at;
      if (k + 1 >= 10) text[k][at++] = static_cast<char>('0' + (k + 1) / 10);
      text[k][at] = static_cast<char>('0' + (k + 1) % 10);
    }
  }
};

/// A law that the user writes and compiles: a subroutine UMAT with the arguments and conventions of Abaqus
/// (docs/user_laws.md). It is called on processors, in double precision, for one particle at a time.
template <class T>
struct Umat {
  using real = T;
  using Object = UmatLibrary;
  static constexpr const char* k_name = "umat";
  static constexpr bool k_scalar_update = true, k_stiffness_changes = true, k_host_double = true,
                        k_takes_place = true;
  /// Message about a failed particle, the end of "a particle ..."; see failed().
  static constexpr const char* k_failure =
      "was given up by its UMAT, which set PNEWDT below 1 or called XIT (a smaller -time_courant "
      "takes smaller steps)";
  static constexpr int k_most_states = 64;

  T states, wave_modulus_given, thread_safe;
  const UmatLibrary* object;

  static constexpr auto parameters() {
    return std::to_array<Parameter<Umat>>(
        {{"states", &Umat::states, "-", "number of state variables of the UMAT (NSTATV, *DEPVAR)", 0,
          k_most_states, 0},
         {"wave_modulus",
          &Umat::wave_modulus_given,
          "Pa",
          "lambda + 2 G for the time step; auto: the largest normal stiffness in the DDSDDE "
          "that the UMAT has returned for the particle",
          1e-3,
          1e15,
          0,
          nullptr,
          {{{"auto", 0}}}},
         {"thread_safe",
          &Umat::thread_safe,
          "",
          "on: threads call the UMAT at the same time; off: one after the other",
          0,
          -1,
          0,
          nullptr,
          {{{"off", 0}, {"on", 1}}}}});
  }
  static constexpr std::array<TextOption, 3> texts() {
    return {{{.key = "library",
              .meaning = "shared library with the subroutine UMAT, compiled",
              .takes = "a shared library",
              .required = true},
             {.key = "properties",
              .meaning = "material properties of the UMAT (PROPS, *USER MATERIAL)",
              .takes = "numbers, as 1e7,0.3",
              .list_of_numbers = true},
             {.key = "state_start",
              .meaning = "state variables at the start; default 0, or what SDVINI of the library sets",
              .takes = "as many numbers as -NAME_states, as 0.8,0,0",
              .list_of_numbers = true}}};
  }
  static std::shared_ptr<const void> make_object(const LawSetup& setup, ParameterFault& fault) {
    return open_umat(setup.material, {setup.texts[0], setup.texts[1], setup.texts[2]}, setup.dim, setup.lower,
                     setup.spacing, fault.key, fault.takes);
  }
  /// Called once the parameters are set.
  void prepare() {}
  ParameterFault check() const {
    if (states != std::floor(states)) return {"states", "a whole number from 0 to 64"};
    if (object != nullptr && !object->state_start.empty() &&
        object->state_start.size() != std::size_t(states))
      return {"state_start", "as many numbers as -NAME_states, which is " + std::to_string(int(states))};
    return {};
  }

  /// State of a particle: the wave modulus, or a negative number where the UMAT has failed; total strain
  /// (tensor shear strains); specific energies; and the UMAT's own variables.
  enum : int { modulus, strain, energy = strain + 6, own = energy + 3 };
  static constexpr int k_size = own + k_most_states;
  using State = LawState<T, k_size>;
  static constexpr StateNames<k_most_states> k_state_names{};
  static constexpr std::array<StateVariable, k_size> state() {
    std::array<StateVariable, k_size> table{{{"wave_modulus", "Pa"},
                                             {"strain_xx", "-"},
                                             {"strain_yy", "-"},
                                             {"strain_zz", "-"},
                                             {"strain_xy", "-"},
                                             {"strain_yz", "-"},
                                             {"strain_zx", "-"},
                                             {"elastic_energy", "J/m3"},
                                             {"plastic_energy", "J/m3"},
                                             {"creep_energy", "J/m3"}}};
    for (int k = 0; k < k_most_states; ++k) table[own + k] = {.name = k_state_names.text[k], .unit = "-"};
    return table;
  }
  KOKKOS_FUNCTION bool carries(int k) const { return k < own + static_cast<int>(states); }

  /// The state at the start, with the modulus that follows from a call without strain.
  std::array<double, k_size> initial_state(const ParticleStart& at) const {
    std::array<double, k_size> start{};
    if (object == nullptr) return start;
    UmatCall call;
    start_call(at, start.data() + own, call);
    start[modulus] = modulus_of(call);
    return start;
  }
  ParameterFault start_fault(const ParticleStart& at) const {
    std::array<double, k_most_states> own_states{};
    UmatCall call;
    start_call(at, own_states.data(), call);
    for (int k = 0; k < static_cast<int>(states); ++k)
      if (!std::isfinite(own_states[k]))
        return {"library", "a UMAT whose SDVINI sets finite state variables; state " + std::to_string(k + 1) +
                               " is not finite at the start"};
    if (call.gave_up)
      return {"library",
              "a UMAT that can be called without strain at the start; it set PNEWDT below 1 or called XIT"};
    if (!(modulus_of(call) > 0) || !std::isfinite(modulus_of(call)))
      return {"wave_modulus",
              "a modulus in Pa here: the DDSDDE of the UMAT at the start has no finite normal stiffness "
              "greater than 0"};
    return {};
  }

  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>&, const State& state) const {
    return state[modulus];
  }
  /// 0: only the UMAT has it.
  KOKKOS_FUNCTION T shear_strength(const State&) const { return 0; }
  /// Energy that the soil can give back [J/m3], at most: SSE, which few UMATs compute, or that of an elastic
  /// material of this wave modulus whose Poisson's ratio is 0.495, if that is more. A run whose kinetic
  /// energy grows beyond it ends (EnergyWatch), so it must not be too small.
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State& state) const {
    constexpr double k_poisson = 0.495, k_lame = k_poisson / (1 - k_poisson),
                     k_shear = (1 - k_lame) / 2;  // over lambda + 2 G
    return Kokkos::fmax(state[energy],
                        elastic_energy(stress, k_lame * state[modulus], k_shear * state[modulus]));
  }
  /// Whether the UMAT has given up a particle, or returned a variable that is not finite; the run then ends.
  KOKKOS_FUNCTION bool failed(const State& state) const { return state[modulus] < 0; }

  template <int Dim>
  KOKKOS_FUNCTION void update(SymTensor<T, Dim>& s, State& state, const Increment<T, T, Dim>& by,
                              const ParticlePlace& place = {}) const {
    s = rotated(s, by.spin);
    UmatCall call;
    give_motion(by, call);
    SymTensor<T, Dim> total;
    for (int k = 0; k < sym_size<Dim>; ++k) total[k] = state[strain + k];
    total = rotated(total, by.spin);
    for (int k = 0; k < sym_size<Dim>; ++k) {
      const int to = place_of<Dim>(k), shear = k < 3 ? 1 : 2;
      call.stress[to] = s[k];
      call.strain[to] = shear * total[k], call.strain_increment[to] = shear * by.strain[k];
    }
    for (int k = 0; k < 3; ++k) call.energy[k] = state[energy + k];
    call.time = by.clock.now(), call.dt = by.dt;
    call.id = place.id;
    for (int d = 0; d < 3; ++d) call.position[d] = object->lower[d] + place.position[d];
    object->call(call, &state[own], static_cast<int>(states), thread_safe != 0);
    for (int k = 0; k < sym_size<Dim>; ++k) {
      s[k] = call.stress[place_of<Dim>(k)];
      state[strain + k] = total[k] + by.strain[k];
    }
    for (int k = 0; k < 3; ++k) state[energy + k] = call.energy[k];
    // It never falls: unloading is stiffer than the tangent of a particle that yields.
    const T now = modulus_of(call);
    const bool failed = call.gave_up || !has_finite_state(state);
    state[modulus] = failed ? T(-1) : now > state[modulus] ? now : state[modulus];
  }

 private:
  /// Whether what the UMAT returned beside the stress is finite. A variable that is not may leave the stress
  /// as it is for many steps, and a checkpoint that holds it cannot be read.
  bool has_finite_state(const State& state) const {
    bool finite = true;
    for (int k = energy; k < own + static_cast<int>(states); ++k) finite = finite && std::isfinite(state[k]);
    return finite;
  }
  /// Place in Abaqus' order 11 22 33 12 13 23 of component k of a SymTensor.
  template <int Dim>
  static constexpr int place_of(int k) {
    return k < 4 ? k : 9 - k;
  }
  T modulus_of(const UmatCall& call) const {
    return wave_modulus_given > 0 ? wave_modulus_given : call.modulus;
  }

  /// DROT and the gradient of the step's displacement.
  template <int Dim>
  static void give_motion(const Increment<T, T, Dim>& by, UmatCall& call) {
    Spin<T, 3> spin{};
    for (int k = 0; k < (Dim == 2 ? 1 : 3); ++k) spin.c[k] = by.spin.c[k];
    rotation_of(spin, call.rotation);
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) call.gradient[i][j] = by.dt * by.gradient[i][j];
  }

  /// A call without strain for a particle that is created, whose state variables become those at the start.
  void start_call(const ParticleStart& at, double* own_states, UmatCall& call) const {
    const int count = static_cast<int>(states);
    for (int k = 0; k < 6; ++k) call.stress[place_of<3>(k)] = at.stress[k];
    for (int d = 0; d < 3; ++d) call.position[d] = at.position[d];
    call.at_start = true;
    object->start(call, own_states, count, thread_safe != 0);
    std::array<double, k_most_states> copy{};  // of which the call keeps nothing
    for (int k = 0; k < count; ++k) copy[k] = own_states[k];
    object->call(call, copy.data(), count, thread_safe != 0);
  }
};

}  // namespace mpm
