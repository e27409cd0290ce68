#pragma once
// Common part of all laws: tables of parameters and of state variables, the input of an update, and the
// rotation of stress. docs/CONTRIBUTING.md says how to write a law.

#include <array>
#include <string>
#include <vector>

#include "base/types.hpp"
#include "device/warp.hpp"
#include "physics/materials/tables.hpp"

namespace mpm {

/// A word that an option takes, and the value that a parameter then has.
struct ParameterWord {
  const char* word = nullptr;
  double value = 0;
};

/// One row of a model's table of parameters: everything that the option reader, -help and the checks need.
template <class Model>
struct Parameter {
  const char* key;  // option key: -NAME_key
  typename Model::real Model::*member;
  const char* unit;
  const char* meaning;
  double lowest, highest;                   // accepted range of numbers, inclusive; 0, -1: words alone
  double standard;                          // default; NaN where the parameter is required
  const char* instead_of = nullptr;         // key of the parameter whose place it takes where it is given
  std::array<ParameterWord, 3> words = {};  // words, beside or in lieu of numbers; a list may be shorter
};

/// One row of a model's table of options that are texts (its optional member `texts`).
struct TextOption {
  const char* key;  // option key: -NAME_key
  const char* meaning;
  const char* takes;             // "takes ..." of the option
  bool required = false;         // else it may be left out, and is empty
  bool list_of_numbers = false;  // numbers with commas between them, which the option reader checks
};

/// Input from which the object of a law is made (the optional members Object and make_object of a law). The
/// object holds data that do not fit into the law itself, which kernels copy.
struct LawSetup {
  std::string material;            // name
  std::vector<std::string> texts;  // values of the options of texts(), in its order
  int dim = 2;
  std::array<double, 3> lower{};  // m, lower corner of the mesh
  double spacing = 1;             // m, edge of the mesh's cells
};

/// Which particle a law updates, for laws that ask (k_takes_place).
struct ParticlePlace {
  int id = 0;                        // order of creation
  std::array<double, 3> position{};  // m, from the lower corner of the mesh
};

/// How a particle is when it is created: a law's initial_state() follows from it.
struct ParticleStart {
  std::array<double, 3> position{};  // m; along the vertical, the last axis of the mesh, in `height`
  double height = 0;                 // m, reference height
  std::array<double, 6> stress{};    // Pa: xx yy zz xy yz zx, tension positive
  OwnValues own{};                   // where a file gives the particle values of its own
  int up = 1;                        // component of the stress that is the vertical one: 2 in 3D

  /// Vertical stress [Pa], compression positive; 0 in tension.
  double vertical() const { return stress[up] < 0 ? -stress[up] : 0.0; }
};

/// The row of the table of parameters by which a strength is reduced, as in a search for a factor of safety.
template <class Law>
constexpr std::array<Parameter<Law>, 1> strength_factor_row() {
  return {{{"strength_factor", &Law::strength_factor, "-",
            "what the strength is divided by: su, or cohesion and tan(friction)", 0.01, 100, 1}}};
}

/// Figures of the run for a law (its optional member prepare_for).
struct RunFigures {
  double spacing = 0;           // m, edge of the mesh's cells
  double largest_pressure = 0;  // Pa, largest initial mean stress in compression of its soil; 0: unknown
};

/// Fault of the parameters of a law together.
struct ParameterFault {
  std::string key;    // option key of the parameter to change; empty: nothing is wrong
  std::string takes;  // the end of "takes ..."; -NAME_ stands for the prefix of the material's options
};

/// The values of a law's state variables at a particle, in the order of its table. N may be 0.
template <class R, int N>
struct LawState {
  static constexpr int size = N;
  R c[N > 0 ? N : 1];
  KOKKOS_INLINE_FUNCTION R& operator[](int k) { return c[k]; }
  KOKKOS_INLINE_FUNCTION const R& operator[](int k) const { return c[k]; }
};

/// The time at the start of a step [s]: `start`, and the steps of dt that were done since.
struct LawClock {
  double start = 0, dt = 0;
  const int* steps = nullptr;  // in the memory of the execution space, where another team may count them
  KOKKOS_INLINE_FUNCTION double now() const { return start + dt * load_of_others(steps); }
};

/// Increment of a particle in a step, the input of its law. R: the real type T, or lanes of it.
template <class R, class T, int Dim>
struct Increment {
  SymTensor<R, Dim> strain;  // -, tensor shear strains, with the cell's fraction of dilatation (F-bar)
  Spin<R, Dim> spin;         // -
  R gradient[Dim][Dim];      // 1/s, L_ij = dv_i/dx_j
  T dt;                      // s
  LawClock clock;
  /// Time at the start of the step [s]; only laws that ask for it read it.
  KOKKOS_INLINE_FUNCTION T time() const { return static_cast<T>(clock.now()); }
};

/// Number of state variables of a law.
template <class Law>
inline constexpr int state_size = static_cast<int>(Law::state().size());

/// Whether the particles of a law carry its state variable k: all do, unless the law has a member `carries`
/// that decides it by the parameters. Only the last variables of a table may be missing.
template <class Law>
KOKKOS_INLINE_FUNCTION bool carries(const Law& law, int k) {
  if constexpr (requires { law.carries(k); }) return law.carries(k);
  return true;
}

/// Whether a law's update is written for one particle (k_scalar_update), as one with many branches is, and
/// not for lanes too.
template <class Law>
constexpr bool has_scalar_update() {
  if constexpr (requires { Law::k_scalar_update; }) return Law::k_scalar_update;
  return false;
}
/// Whether a GPU calls a law's update as a function (k_called_update), as one that takes many registers, so
/// that the kernel needs none for it.
template <class Law>
constexpr bool has_called_update() {
  if constexpr (requires { Law::k_called_update; }) return Law::k_called_update;
  return false;
}
/// Whether the stiffness of a law depends on stress or state (k_stiffness_changes), so that the time step has
/// to follow it.
template <class Law>
constexpr bool stiffness_changes() {
  if constexpr (requires { Law::k_stiffness_changes; }) return Law::k_stiffness_changes;
  return false;
}

/// Whether a law runs on processors in double precision alone (k_host_double): no kernel of a GPU and none in
/// single precision holds its code.
template <class Law>
constexpr bool on_host_in_double() {
  if constexpr (requires { Law::k_host_double; }) return Law::k_host_double;
  return false;
}

/// Whether the update of a law takes the particle's place too (k_takes_place).
template <class Law>
constexpr bool takes_place() {
  if constexpr (requires { Law::k_takes_place; }) return Law::k_takes_place;
  return false;
}

/// Whether the update of a law changes all of its state variables.
template <class Law>
constexpr bool changes_all() {
  for (const StateVariable& variable : Law::state())
    if (!variable.changes) return false;
  return true;
}

/// Whether a law has states that end the run (failed).
template <class Law>
constexpr bool can_fail() {
  return requires(const Law& law, const LawState<typename Law::real, state_size<Law>>& state) {
    law.failed(state);
  };
}

/// Particle after the update of its law.
template <class Law, int Dim>
struct Updated {
  SymTensor<typename Law::real, Dim> stress;
  LawState<typename Law::real, state_size<Law>> state;
};
/// A law's update of one particle, as a function that a GPU calls.
template <class Law, int Dim>
MPM_CALLED_FUNCTION Updated<Law, Dim> called_update(
    const Law& law, Updated<Law, Dim> particle, Increment<typename Law::real, typename Law::real, Dim> by) {
  law.update(particle.stress, particle.state, by);
  return particle;
}

/// Stress turned with the material by the spin times dt: Q s Q^T with Q = (I - w/2)^-1 (I + w/2), which is a
/// rotation for any w (Hughes & Winget 1980), so that the Jaumann rate keeps the invariants.
template <class T>
KOKKOS_FORCEINLINE_FUNCTION SymTensor<T, 2> rotated(const SymTensor<T, 2>& s, const Spin<T, 2>& w) {
  const T h = w.c[0] / 2, scale = 1 / (1 + h * h);
  const T cos_a = (1 - h * h) * scale, sin_a = 2 * h * scale;
  const T mean = (s[0] + s[1]) / 2, half = (s[0] - s[1]) / 2;
  const T cos_2a = cos_a * cos_a - sin_a * sin_a, sin_2a = 2 * sin_a * cos_a;
  const T half_new = cos_2a * half + sin_2a * s[3];
  return {mean + half_new, mean - half_new, s[2], cos_2a * s[3] - sin_2a * half};
}

/// The rotation Q itself: Cayley transform of the skew tensor W with axial vector a,
/// Q = I + (2/(1+|a|^2/4)) (W/2 + W^2/4).
template <class T>
KOKKOS_INLINE_FUNCTION void rotation_of(const Spin<T, 3>& w, T (&q)[3][3]) {
  const T half[3][3] = {
      {0, w.c[0] / 2, -w.c[2] / 2}, {-w.c[0] / 2, 0, w.c[1] / 2}, {w.c[2] / 2, -w.c[1] / 2, 0}};
  const T scale = 2 / (1 + (w.c[0] * w.c[0] + w.c[1] * w.c[1] + w.c[2] * w.c[2]) / 4);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      T square = 0;
      for (int k = 0; k < 3; ++k) square += half[i][k] * half[k][j];
      q[i][j] = (i == j) + scale * (half[i][j] + square);
    }
}

template <class T>
KOKKOS_INLINE_FUNCTION SymTensor<T, 3> rotated(const SymTensor<T, 3>& s, const Spin<T, 3>& w) {
  T q[3][3];
  rotation_of(w, q);
  SymTensor<T, 3> r;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      T sum = 0;
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) sum += q[i][k] * s[sym_index<3>(k, l)] * q[j][l];
      r[sym_index<3>(i, j)] = sum;
    }
  return r;
}

/// The state variable that is a rest; see add_with_rest.
template <class T>
constexpr StateVariable rest_variable(const char* name, const char* unit) {
  constexpr bool single = sizeof(T) == sizeof(float);
  return {.name = name, .unit = unit, .changes = single, .output = false, .used = single};
}
/// Adds to a sum. In single precision `rest` keeps what the sum has rounded off (Kahan 1965), so that a sum
/// of many small increments does not stand still. Double precision needs no rests.
template <class R>
KOKKOS_INLINE_FUNCTION void add_with_rest(R& sum, R& rest, const R& increment) {
  if constexpr (sizeof(RealOf<R>) > sizeof(float)) {
    sum += increment;
  } else {
    const R whole = increment + rest, next = sum + whole;
    rest = whole - (next - sum);
    sum = next;
  }
}
/// Adds the increment where a condition holds.
template <class R>
KOKKOS_INLINE_FUNCTION void add_with_rest_if(const Truth<R>& condition, R& sum, R& rest, const R& increment) {
  R next = sum, next_rest = rest;
  add_with_rest(next, next_rest, increment);
  sum = select(condition, next, sum);
  if constexpr (sizeof(RealOf<R>) == sizeof(float)) rest = select(condition, next_rest, rest);
}

/// exp(x) - 1. Steps of a run are small, and there a few terms of the series have all digits.
template <class R>
KOKKOS_FORCEINLINE_FUNCTION R growth_of(const R& x) {
  using T = RealOf<R>;
  const auto small = Kokkos::fabs(x) < T(0.01);  // the first term left out is x^6/5040 of the sum
  const R series =
      x *
      (1 + x * (T(1.0 / 2) + x * (T(1.0 / 6) + x * (T(1.0 / 24) + x * (T(1.0 / 120) + x * T(1.0 / 720))))));
  if (!any_of(!small)) return series;
  return select(small, series, Kokkos::expm1(x));
}

/// Mean stress (s_xx + s_yy + s_zz) / 3.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T mean_of(const SymTensor<T, Dim>& s) {
  return (s[0] + s[1] + s[2]) * T(1.0 / 3);
}

/// J2 = s : s / 2 [Pa2] of the deviator s of a stress with this mean.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T second_invariant(const SymTensor<T, Dim>& s, T mean) {
  T j2 = 0;
  for (int k = 0; k < sym_size<Dim>; ++k) {
    const T deviator = k < 3 ? s[k] - mean : s[k];
    j2 += k < 3 ? deviator * deviator / 2 : deviator * deviator;
  }
  return j2;
}

/// Adds the isotropic elastic stress increment lambda tr(e) I + 2 G e to s. Shear strains are tensor
/// components.
template <class R, class T, int Dim>
KOKKOS_INLINE_FUNCTION void add_elastic(SymTensor<R, Dim>& s, const SymTensor<R, Dim>& e, T lambda,
                                        T shear_modulus) {
  const R mean = lambda * (e[0] + e[1] + e[2]);
  for (int k = 0; k < sym_size<Dim>; ++k) s[k] += 2 * shear_modulus * e[k] + (k < 3 ? mean : R(0));
}

/// Elastic energy of a volume under an isotropic stress-strain law [J/m3].
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T elastic_energy(const SymTensor<T, Dim>& s, T lambda, T shear_modulus) {
  const T mean = mean_of(s), bulk_modulus = lambda + shear_modulus * T(2.0 / 3);
  return mean * mean / (2 * bulk_modulus) + second_invariant(s, mean) / (2 * shear_modulus);
}

/// Elastic constants of Young's modulus and Poisson's ratio.
template <class T>
KOKKOS_INLINE_FUNCTION T shear_modulus_of(T young, T poisson) {
  return young / (2 * (1 + poisson));
}
template <class T>
KOKKOS_INLINE_FUNCTION T lame_of(T young, T poisson) {
  return young * poisson / ((1 + poisson) * (1 - 2 * poisson));
}

}  // namespace mpm
