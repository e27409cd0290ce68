#pragma once
// The stress of level ground in layers under its own weight, with water at rest.

#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Ratio of horizontal to vertical effective stress of a material: its -NAME_k0, or without it 1 - sin phi of
/// a law with an angle of friction, nu/(1 - nu) of another law with a Poisson's ratio, and 1 of a fluid. NaN
/// where the law has none of these, and of cam_clay, whose ratio depends on what the soil has been through.
double k0_of(const MaterialConfig& material);

/// The bodies of a configuration whose initial stress is k0, as layers.
class LevelGround {
 public:
  explicit LevelGround(const Config& config);

  /// A layer: a body between two levels.
  struct Layer {
    int body;          // index into Config::bodies
    double base, top;  // m
    double density;    // kg/m3
  };
  /// From the highest to the lowest.
  const std::vector<Layer>& layers() const { return layers_; }

  /// Effective vertical stress at a height [m], in Pa, compression positive.
  double vertical(double height) const;
  /// Effective stress of a particle of a body, of which the centre is at a height and the width is given [m]:
  /// the mean of its upper and lower edge, so that its weight and the stress are in equilibrium wherever the
  /// level of water is.
  Sym6 stress(const BodyConfig& body, double height, double width) const;

 private:
  const Config& config_;
  std::vector<Layer> layers_;
};

}  // namespace mpm
