#pragma once
// Soil for splitting and merging, and sums over all particles that these keep.

#include <vector>

#include "clouds.hpp"
#include "physics/materials/von_mises.hpp"
#include "transfer/download.hpp"

namespace mpm::test {

/// Two clays under gravity, by APIC where the seed is odd, else by FLIP.
inline Cloud with_two_updates(int seed) {
  Cloud cloud;
  cloud.materials = clays();
  cloud.gravity = {0, -10, -5};
  cloud.affine = seed % 2 == 1;
  cloud.flip_fraction = cloud.affine ? 0 : 1;
  return cloud;
}

/// Gives each particle of a body a velocity, a stress and a strength of its own.
template <int Dim>
void give_own_state(BodyInput& body, Dice& dice) {
  for (std::size_t k = 0; k < body.position.size(); ++k) body.velocity.push_back(dice.uniform(-1, 1));
  for (std::size_t k = 0; k < strength_of(body).size() * sym_size<Dim>; ++k)
    body.stress.push_back(dice.uniform(-300, 300));
  for (double& strength : strength_of(body)) strength = dice.uniform(1000, 3000);
}

/// Mass, volume, momentum, first moments of the mass, volume times stress, mass times strength: 3 + 2 Dim +
/// sym_size<Dim> numbers; then angular momentum and kinetic energy, which merging changes.
template <int Dim>
std::vector<double> sums_of(const SoilFields& soil) {
  constexpr int kept = 3 + 2 * Dim + sym_size<Dim>;
  std::vector<double> sums(kept + 2);
  for (std::size_t p = 0; p < soil.id.size(); ++p) {
    const double m = soil.mass[p], *x = &soil.position[p * Dim], *v = &soil.velocity[p * Dim];
    std::size_t n = 0;
    sums[n++] += m, sums[n++] += soil.volume[p];
    for (int d = 0; d < Dim; ++d) sums[n++] += m * v[d];
    for (int d = 0; d < Dim; ++d) sums[n++] += m * x[d];
    for (int k = 0; k < sym_size<Dim>; ++k) sums[n++] += soil.volume[p] * soil.stress[p * sym_size<Dim> + k];
    sums[n++] += soil.volume[p] * soil.history[VonMises<double>::strength][p];
    sums[n++] += m * (x[0] * v[1] - x[1] * v[0]);
    for (int d = 0; d < Dim; ++d) sums[n] += m * v[d] * v[d] / 2;
  }
  return sums;
}

}  // namespace mpm::test
