#pragma once
#include "physics/materials/friction.hpp"

namespace mpm {

/// Elastic, perfectly plastic soil with Mohr and Coulomb's yield surface, k s1 - s3 = 2 c cos / (1 - sin),
/// flow by the angle of dilation, and a cut-off of the largest principal stress.
template <class T>
struct MohrCoulomb : FrictionalSoil<T> {
  using Soil = FrictionalSoil<T>;
  static constexpr const char* k_name = "mohr_coulomb";
  using Soil::cohesion_of_particle;
  using Soil::parted;
  using Soil::plastic_strain;
  PyramidShape<T> shape;
  T sc_over_cohesion, apex_over_cohesion;  // -; the latter without friction is 0

  static constexpr auto parameters() {
    return joined(Soil::template friction_parameters<MohrCoulomb>(
                      "largest principal stress, tension positive; none: that of the apex, cohesion * "
                      "cot(friction)"),
                  Soil::template growth_rows<MohrCoulomb>(), strength_factor_row<MohrCoulomb>());
  }
  /// Called once the parameters are set.
  void prepare() {
    Soil::prepare_elasticity();
    const auto [phi, psi, cohesion_share, apex] = Soil::reduced();
    shape = PyramidShape<T>::of(std::sin(phi), std::sin(psi), this->poisson);
    sc_over_cohesion = static_cast<T>(cohesion_share * (2 * std::cos(phi) / (1 - std::sin(phi))));
    apex_over_cohesion = static_cast<T>(apex);
  }
  /// Lines for the log.
  std::string warning() const {
    constexpr double k_none = std::numeric_limits<double>::infinity();
    return Soil::friction_warning(this->friction_deg > 0 ? double(this->cohesion) * apex_over_cohesion
                                                         : k_none);
  }

  /// The yield surface of a particle with this cohesion [Pa].
  template <class R>
  KOKKOS_FUNCTION PyramidSize<R> size_of(const R& c) const {
    const bool has_apex = apex_over_cohesion > 0, has_tension = this->tension >= 0;
    const R sc = sc_over_cohesion * c, apex = apex_over_cohesion * c;
    const R wanted = has_apex ? (has_tension ? R(this->tension) : apex) : R(k_no_tension);
    const Truth<R> at_apex = wanted >= apex;
    const R cut_off = select(at_apex, apex, R(this->tension));
    return {.sc = sc,
            .cut_off = cut_off,
            .low = select(at_apex, apex, shape.k * cut_off - sc),
            .cuts = has_apex || has_tension,
            .apex = at_apex};
  }

  /// Volume strain of a gap in all directions, across which the soil takes no pressure.
  KOKKOS_FUNCTION T free_gap(const typename Soil::State& state) const {
    return size_of(state[cohesion_of_particle]).apex ? state[parted] : T(0);
  }

  template <class R, int Dim>
  KOKKOS_FUNCTION void update(SymTensor<R, Dim>& s, LawState<R, 4>& state,
                              const Increment<R, T, Dim>& by) const {
    const SymTensor<R, Dim> before = rotated(s, by.spin);
    const R shear_modulus = this->shear_modulus_of_particle(state);
    PyramidSize<R> size = size_of(state[cohesion_of_particle]);
    s = before;
    this->add_elastic_to(s, by.strain, state);
    Truth<R> loose = size.apex & (state[parted] > 0);
    if (any_of(state[parted] > 0)) {
      const ClosedGap<R, Dim> closed = closed_gap(shape, size.apex, shear_modulus, before, s, state[parted]);
      s = closed.stress, state[parted] = closed.parted;
      loose = loose & (state[parted] > 0);
      const R left = share_across(state[parted]);
      size = size_of(select(loose, left * state[cohesion_of_particle], state[cohesion_of_particle]));
    }
    const PlasticFlow<R> flow = return_stress(shape, size, shear_modulus, loose, s);
    state[plastic_strain] += flow.strain;
    state[parted] += flow.opening;
  }
};

}  // namespace mpm
