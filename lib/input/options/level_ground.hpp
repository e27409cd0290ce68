#pragma once
// The stress of level ground under its own weight, with water at rest.

#include <array>
#include <map>
#include <vector>

#include "mpm/config.hpp"

namespace mpm {

/// Ratio of horizontal to vertical effective stress of a material: its -NAME_k0, or without it 1 - sin phi of
/// a law with an angle of friction, nu/(1 - nu) of another law with a Poisson's ratio, and 1 of a fluid. NaN
/// where the law has none of these, and of cam_clay, whose ratio depends on what the soil has been through.
double k0_of(const MaterialConfig& material);

/// The bodies of a configuration whose initial stress is k0. Together they are level ground, as it was before
/// parts of it are dug out: a body may be cut by others, which fill what they cut.
class LevelGround {
 public:
  explicit LevelGround(const Config& config) : config_(config) {}

  /// A part of a vertical line that is in one body.
  struct Layer {
    int body;          // index into Config::bodies
    double base, top;  // m
    double density;    // kg/m3
  };
  /// The layers on a vertical line at a place (of which the height does not count), from the highest to the
  /// lowest.
  const std::vector<Layer>& column(const Vec3& place) const;

  /// Effective vertical stress at a place [m], in Pa, compression positive.
  double vertical(const Vec3& place) const;
  /// Effective stress of a particle of a body, whose centre and width are given [m]: the mean of its upper
  /// and lower edge, so that its weight and the stress are in equilibrium wherever the level of water is.
  Sym6 stress(const BodyConfig& body, const Vec3& centre, double width) const;

 private:
  const Config& config_;
  mutable std::map<std::array<double, 2>, std::vector<Layer>> columns_;  // by x and, in 3D, y [m]
};

}  // namespace mpm
