#pragma once
#include "physics/materials/clay.hpp"
#include "physics/materials/deviator.hpp"
#include "physics/materials/friction.hpp"
#include "physics/materials/mohr_coulomb_return.hpp"

namespace mpm {

/// Clay in undrained loading whose strength falls with the plastic shear strain xi and grows with the rate of
/// shear strain g (Einav & Randolph 2005): su = su0 S(xi) R(g), S = d + (1-d) exp(-3 xi/xi95), R = 1 + mu
/// log10(max(g, g_ref)/g_ref). Yield at sqrt(J2) = su, or Tresca's hexagon. Jaumann rate of the Cauchy
/// stress.
template <class T>
struct SofteningClay : Clay<T> {
  static constexpr const char* k_name = "softening_clay";
  static constexpr bool k_called_update = true;
  static constexpr double k_most_decades = 9;  // that R takes of the rate: beyond is the noise of waves
  enum Surface : int { von_mises, tresca };
  T remoulded_ratio, xi95, xi95_cell, rate_factor, rate_reference, rate_time, surface;
  T fall;  // -, what is left of the strength falls by exp(-fall xi); 0 where it does not
  PyramidShape<T> hexagon;

  static constexpr auto parameters() {
    constexpr double required = std::numeric_limits<double>::quiet_NaN();
    const auto own = std::to_array<Parameter<SofteningClay>>(
        {{"remoulded_ratio", &SofteningClay::remoulded_ratio, "-", "remoulded over intact strength", 1e-6, 1,
          required},
         {"xi95",
          &SofteningClay::xi95,
          "-",
          "plastic shear strain at which 95 % of the strength that can be lost is lost; needed where "
          "remoulded_ratio "
          "is less than 1",
          1e-6,
          1e6,
          0,
          nullptr,
          {{{"none", 0}}}},
         {"xi95_cell",
          &SofteningClay::xi95_cell,
          "m",
          "edge of the cells to which xi95 refers: xi95 is multiplied by it over the mesh's own",
          1e-9,
          1e9,
          0,
          nullptr,
          {{{"none", 0}}}},
         {"rate_factor", &SofteningClay::rate_factor, "-",
          "growth of the strength with each decade of the rate", 0, 10, 0},
         {"rate_reference",
          &SofteningClay::rate_reference,
          "1/s",
          "rate of shear strain up to which the strength is su; needed where rate_factor is greater than 0",
          1e-12,
          1e6,
          0,
          nullptr,
          {{{"none", 0}}}},
         {"rate_time", &SofteningClay::rate_time, "s", "time over which the rate is smoothed", 0, 1e6, 0},
         {"surface",
          &SofteningClay::surface,
          "",
          "yield surface",
          0,
          -1,
          von_mises,
          nullptr,
          {{{"von_mises", von_mises}, {"tresca", tresca}}}}});
    return joined(Clay<T>::template clay_parameters<SofteningClay>(), own,
                  YoungsModulus<T>::template growth_rows<SofteningClay>(),
                  Clay<T>::template strength_rows<SofteningClay>());
  }
  /// Called once the parameters are set.
  void prepare() {
    Clay<T>::prepare();
    hexagon = PyramidShape<T>::of(0, 0, this->poisson);
    fall = remoulded_ratio < 1 ? 3 / xi95 : T(0);
  }
  /// Softening localises in bands as wide as a cell, so xi95 follows the cells where xi95_cell is given.
  void prepare_for(const RunFigures& run) {
    if (!(xi95_cell > 0)) return;
    xi95 *= static_cast<T>(xi95_cell / run.spacing);
    xi95_cell = static_cast<T>(run.spacing);
    prepare();
  }

  enum : int { plastic_strain, strength, plastic_strain_rest, shear_rate, young_of_particle };
  using State = LawState<T, 5>;
  static constexpr std::array<StateVariable, 5> state() {
    return {{{"plastic_strain", "-"},  // xi, accumulated engineering plastic shear strain
             {.name = "strength", .unit = "Pa", .changes = false, .output = false, .parameter = "su"},  // su0
             rest_variable<T>("plastic_strain_rest", "-"),
             {.name = "shear_rate", .unit = "1/s"},  // smoothed
             YoungsModulus<T>::young_variable()}};
  }
  /// Only the last variables may be missing: soil whose Young's modulus varies has the shear rate too.
  KOKKOS_FUNCTION bool carries(int k) const {
    const bool own_young = this->varies();
    return k < shear_rate || own_young || (k == shear_rate && rate_time > 0);
  }

  ParameterFault check() const {
    if (this->su == 0 && this->su_gradient == 0 && this->su_ratio == 0)
      return {"su", "a strength in Pa greater than 0 where -NAME_su_gradient is 0"};
    if (remoulded_ratio < 1 && !(xi95 > 0))
      return {"xi95", "a plastic shear strain greater than 0 where -NAME_remoulded_ratio is less than 1"};
    if (rate_factor > 0 && !(rate_reference > 0))
      return {"rate_reference", "a rate in 1/s greater than 0 where -NAME_rate_factor is greater than 0"};
    if (const ParameterFault fault = Clay<T>::check(); !fault.key.empty()) return fault;
    return xi95_cell > 0 ? ParameterFault{} : brittleness_fault(this->strength_share * this->su, this->young);
  }
  std::string warning() const {
    if (!(xi95_cell > 0)) return "";
    return "-NAME_xi95_cell: xi95 is " + std::to_string(xi95) + " for the mesh's cells of " +
           std::to_string(xi95_cell) + " m";
  }
  ParameterFault start_fault(const ParticleStart& at) const {
    if (const ParameterFault fault = Clay<T>::start_fault(at); !fault.key.empty()) return fault;
    const auto [xi, su0, own_young] = Clay<T>::initial_state(at);
    return brittleness_fault(this->strength_share * su0, own_young);
  }
  std::array<double, 5> initial_state(const ParticleStart& at) const {
    const auto [xi, su0, own_young] = Clay<T>::initial_state(at);
    return {xi, su0, 0, 0, own_young};
  }

  /// lambda + 2 G [Pa], which gives the speed of the fastest wave (Eq. 14).
  template <int Dim>
  KOKKOS_FUNCTION T wave_modulus(const SymTensor<T, Dim>& stress, const State& state) const {
    return Clay<T>::wave_modulus(stress, of_clay(state));
  }
  /// Undrained shear strength [Pa] as softened, at a rate up to the reference.
  KOKKOS_FUNCTION T shear_strength(const State& state) const {
    return this->strength_share * state[strength] * (remoulded_ratio + what_is_left(state[plastic_strain]));
  }
  /// Energy that the soil can give back [J/m3].
  template <int Dim>
  KOKKOS_FUNCTION T stored_energy(const SymTensor<T, Dim>& stress, const State& state) const {
    return Clay<T>::stored_energy(stress, of_clay(state));
  }

  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 5>& state,
                              const Increment<R, T, Dim>& by) const {
    const auto& e = this->stiffness;
    const R su_p = state[strength], basis = this->basis_of(su_p, state[young_of_particle]);  // Pa
    const R shear_modulus = e.shear_modulus + e.shear_modulus_over_basis * basis;            // Pa
    const R rapid = this->strength_share * su_p * rate_effect(state, by);
    s = rotated(s, by.spin);
    add_elastic(s, by.strain, R(e.lambda + e.lambda_over_basis * basis), shear_modulus);
    const R more = surface == T(tresca) ? return_to_hexagon(s, state, shear_modulus, rapid)
                                        : return_to_circle(s, state, shear_modulus, rapid);
    const auto yields = more > 0;
    if (any_of(yields)) add_with_rest_if(yields, state[plastic_strain], state[plastic_strain_rest], more);
  }

 private:
  KOKKOS_INLINE_FUNCTION static typename Clay<T>::State of_clay(const State& state) {
    return {{state[plastic_strain], state[strength], state[young_of_particle]}};
  }
  /// S(xi) - d.
  template <class R>
  KOKKOS_INLINE_FUNCTION R what_is_left(const R& xi) const {
    return remoulded_ratio < 1 ? (1 - remoulded_ratio) * Kokkos::exp(-fall * xi) : R(0);
  }

  /// Soil of strength su0 [Pa] and one or its own Young's modulus [Pa] must not soften faster than it
  /// unloads: 3 su0 R (1-d)/xi95 < G. Less than 0: the modulus is unknown as yet.
  ParameterFault brittleness_fault(double su0, double young) const {
    if (young < 0) return {};
    const double ratio = rigidity_of_shear(su0, young), largest = 1 + k_most_decades * rate_factor;
    const double least = 3 * largest * (1 - remoulded_ratio) / ratio;
    if (!(su0 > 0) || remoulded_ratio == 1 || xi95 > least) return {};
    return {"xi95", "more than " + std::to_string(least) +
                        " for the cells of the mesh, or the soil softens faster than it unloads"};
  }
  /// G over su0.
  double rigidity_of_shear(double su0, double young) const {
    return shear_modulus_of<double>(young, this->poisson) / su0 +
           shear_modulus_of<double>(this->rigidity, this->poisson);
  }

  /// R of the step's rate of shear strain, sqrt(2 e' : e')/dt, which is smoothed where rate_time is given.
  template <class R, int Dim>
  KOKKOS_INLINE_FUNCTION R rate_effect(LawState<R, 5>& state, const Increment<R, T, Dim>& by) const {
    if (!(rate_factor > 0)) return 1;
    R rate = 2 * Kokkos::sqrt(second_invariant(by.strain, mean_of(by.strain))) / by.dt;
    if (rate_time > 0)
      rate = state[shear_rate] -= Kokkos::expm1(-by.dt / rate_time) * (rate - state[shear_rate]);
    const R decades = Kokkos::log10(Kokkos::fmax(rate, R(rate_reference)) / rate_reference);
    return 1 + rate_factor * Kokkos::fmin(R(k_most_decades), decades);
  }

  /// Returns a trial stress to sqrt(J2) = rapid S(xi + g), with the plastic shear strain g of the step: r - G
  /// g = rapid S(xi + g). Newton's method from g = 0 is monotone, since the soil softens less than it
  /// unloads.
  template <class R, int Dim>
  KOKKOS_INLINE_FUNCTION R return_to_circle(SymTensor<R, Dim>& s, const LawState<R, 5>& state,
                                            const R& shear_modulus, const R& rapid) const {
    constexpr int k_iterations = 5;
    // Relative change of g after which the iterations end: what is left is about its square.
    constexpr T k_last = sizeof(T) == sizeof(double) ? T(1e-7) : T(1e-3);
    const R mean = mean_of(s), r = shear_stress_of(s, mean),
            left = rapid * what_is_left(state[plastic_strain]);
    const R over = r - rapid * remoulded_ratio - left;
    const Truth<R> yields = !(over <= 0);
    if (!any_of(yields)) return 0;
    R g = over / (shear_modulus - fall * left);
    Truth<R> goes_on = yields;
    for (int k = 1; k < k_iterations; ++k) {
      const R softer = left * growth_of(-fall * g);  // less than 0
      const R more = (over - shear_modulus * g - softer) / (shear_modulus - fall * (left + softer));
      g = select(goes_on, g + more, g);
      goes_on = goes_on & !(more <= k_last * g);
      if (!any_of(goes_on)) break;
    }
    const R share = select(yields, Kokkos::fmin(R(1), shear_modulus * g / r), R(0));
    for (int k = 0; k < sym_size<Dim>; ++k) s[k] -= share * (k < 3 ? s[k] - mean : s[k]);
    return select(yields, g, R(0));
  }

  /// Returns a trial stress to Tresca's hexagon with the strength at the start of the step, an error of the
  /// order of the step.
  template <class R, int Dim>
  KOKKOS_INLINE_FUNCTION R return_to_hexagon(SymTensor<R, Dim>& s, const LawState<R, 5>& state,
                                             const R& shear_modulus, const R& rapid) const {
    const R su_now = rapid * (remoulded_ratio + what_is_left(state[plastic_strain]));
    const PyramidSize<R> size{
        .sc = 2 * su_now, .cut_off = T(k_no_tension), .low = T(0), .cuts = false, .apex = {}};
    return return_stress(hexagon, size, shear_modulus, Truth<R>{}, s).strain;
  }
};

}  // namespace mpm
