#pragma once
#include "physics/materials/friction.hpp"

namespace mpm {

/// Elastic, perfectly plastic soil with Drucker and Prager's cone, sqrt(J2) + eta p = xi c (p the mean
/// stress, tension positive), flow by the angle of dilation, and a cap of the mean stress. `match` chooses
/// where the cone meets Mohr and Coulomb's pyramid.
template <class T>
struct DruckerPrager : FrictionalSoil<T> {
  using Soil = FrictionalSoil<T>;
  static constexpr const char* k_name = "drucker_prager";
  using Soil::cohesion_of_particle;
  using Soil::parted;
  using Soil::plastic_strain;
  enum : int { compression, extension, plane_strain };
  T match;
  T slope, flow_slope;                           // eta, of friction and of dilation
  T strength_over_cohesion, apex_over_cohesion;  // xi, and xi / eta; the latter without friction is 0
  T bulk_modulus;                                // Pa, of reference_young()

  static constexpr auto parameters() {
    const std::array<Parameter<DruckerPrager>, 1> own = {
        {{"match",
          &DruckerPrager::match,
          "",
          "where the strength is that of mohr_coulomb",
          0,
          -1,
          std::numeric_limits<double>::quiet_NaN(),
          nullptr,
          {{{"compression", compression}, {"extension", extension}, {"plane_strain", plane_strain}}}}}};
    return joined(Soil::template friction_parameters<DruckerPrager>(
                      "largest mean stress, tension positive; none: that of the apex"),
                  own, Soil::template growth_rows<DruckerPrager>(), strength_factor_row<DruckerPrager>());
  }
  /// Called once the parameters are set. Constants of the three cones: de Souza Neto, Peric & Owen 2008, 6.4;
  /// plane strain at failure with any angle of dilation.
  void prepare() {
    Soil::prepare_elasticity();
    bulk_modulus = static_cast<T>(this->reference_young() / (3 * (1 - 2 * double(this->poisson))));
    const auto [phi, psi, cohesion_share, apex] = Soil::reduced();
    const double s = std::sin(phi), s_flow = std::sin(psi);
    double eta, eta_flow, xi;
    if (match == T(plane_strain)) {
      eta_flow = s_flow / std::sqrt(1 + s_flow * s_flow / 3);
      const double across = std::sqrt(1 - eta_flow * eta_flow / 3), divisor = across + s * eta_flow / 3;
      eta = s / divisor;
      xi = std::cos(phi) / divisor;
    } else {
      const double sign = match == T(compression) ? -1 : 1;
      eta = 6 * s / (std::sqrt(3.) * (3 + sign * s));
      eta_flow = 6 * s_flow / (std::sqrt(3.) * (3 + sign * s_flow));
      xi = 6 * std::cos(phi) / (std::sqrt(3.) * (3 + sign * s));
    }
    slope = static_cast<T>(eta);
    flow_slope = static_cast<T>(eta_flow);
    strength_over_cohesion = static_cast<T>(cohesion_share * xi);
    apex_over_cohesion = static_cast<T>(apex);
  }
  /// Lines for the log.
  std::string warning() const {
    constexpr double k_none = std::numeric_limits<double>::infinity();
    const bool rubs = this->friction_deg > 0;
    std::string lines = Soil::friction_warning(rubs ? double(this->cohesion) * apex_over_cohesion : k_none);
    if (match != T(compression) || !rubs) return lines;
    const double s = std::sin(Soil::radians(this->friction_deg)), extra = 100 * (2 * s / (3 - s));
    char line[256];
    std::snprintf(
        line, sizeof line,
        "-NAME_match: the cone of compression is %.0f %% stronger in triaxial extension than "
        "mohr_coulomb%s",
        extra,
        s >= 0.6 ? ", and soil with this angle of friction does not fail by a rising cell pressure" : "");
    if (!lines.empty()) lines += '\n';
    return lines += line;
  }

  /// Volume strain of a gap in all directions, across which the soil takes no pressure.
  KOKKOS_FUNCTION T free_gap(const typename Soil::State& state) const { return state[parted]; }

  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 4>& state,
                              const Increment<R, T, Dim>& by) const {
    const R shear_modulus = this->shear_modulus_of_particle(state),
            bulk = this->of_particle(bulk_modulus, state);
    const bool has_apex = apex_over_cohesion > 0, has_tension = this->tension >= 0;
    s = rotated(s, by.spin);
    this->add_elastic_to(s, by.strain, state);

    const R mean = mean_of(s);
    R p = mean;
    if (any_of(state[parted] > 0)) {
      close_by_mean(p, state[parted], bulk);
      for (int k = 0; k < 3; ++k) s[k] += p - mean;
    }
    R c = state[cohesion_of_particle], tension = this->tension;
    if (any_of(state[parted] > 0)) {
      const R left = share_across(state[parted]);
      c *= left, tension *= left;
    }
    const R strength = strength_over_cohesion * c, apex = has_apex ? apex_over_cohesion * c : tension;
    const R cap = has_tension ? Kokkos::fmin(tension, apex) : apex;
    const R r = Kokkos::sqrt(second_invariant(s, p)), f = r + slope * p - strength;
    const R beyond = has_apex || has_tension ? p - cap : R(-1);
    const auto yields = Kokkos::fmax(f, beyond) > 0;
    if (!any_of(yields)) return;
    // Soil that has parted has no contact, and its shear no dilatancy.
    const R flow_slope_now = select(state[parted] > 0, R(0), R(flow_slope));
    const R l = Kokkos::fmax(f, R(0)) / (shear_modulus + bulk * slope * flow_slope_now);
    R p_new = p - bulk * flow_slope_now * l, r_new = Kokkos::fmax(r - shear_modulus * l, R(0));
    if (has_apex || has_tension) {
      const auto below = (p_new <= cap) & (r - shear_modulus * l >= 0);
      p_new = select(below, p_new, cap);
      const R on_cone = Kokkos::fmax(strength - slope * cap, R(0));
      r_new = select(below, r_new, select(r < on_cone, r, on_cone));
    }
    const R strain = (r - r_new) / shear_modulus;
    if (has_apex || has_tension) {
      const R opening = Kokkos::fmax(R(0), (p - p_new) / bulk - flow_slope_now * strain);
      state[parted] += select(yields & !(p_new < cap), opening, R(0));
    }
    const R share = r_new / select(r > 0, r, R(1));
    for (int k = 0; k < sym_size<Dim>; ++k)
      s[k] = select(yields, k < 3 ? p_new + share * (s[k] - p) : share * s[k], s[k]);
    state[plastic_strain] += select(yields, strain, R(0));
  }
};

}  // namespace mpm
