#pragma once
// A single material point, for code that does not see the laws: its law updates it as it updates a particle.

#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace mpm {

/// Stress and state of a material point. In single precision the values are those of float.
struct PointState {
  std::array<double, 6> stress{};  // Pa: xx yy zz xy yz zx, tension positive
  std::vector<double> state;       // all state variables of the law, in the order of its table
};

/// Increment of a point in one update. There is no spin.
struct PointIncrement {
  std::array<double, 6> strain{};  // -, tensor shear strains
  double dt = 1;                   // s
  double time = 0;                 // s, at its start
};

/// The law of a material, in one precision and dimension.
struct PointLaw {
  std::function<PointState(const PointState&, const PointIncrement&)> update;
  std::function<bool(const PointState&)> failed;          // the law does not hold there (its member `failed`)
  std::function<double(const PointState&)> wave_modulus;  // K + 4/3 G [Pa]
};

/// Which material a point is of.
struct PointMaterial {
  int which = -1;                        // index of its model in Materials
  std::vector<double> parameters{};      // in the order of the model's table
  std::shared_ptr<const void> object{};  // of make_object, where the model has one
  double height = 0;                     // m, of the point
};

/// The law of a material. In 2D the shear components yz and zx stay as they are. A law that asks for the
/// place of its particle gets the first particle, at the point's height.
PointLaw point_law(const PointMaterial& material, bool single, int dim);

/// A point that is created with a stress [Pa].
PointState point_start(const PointMaterial& material, int dim, const std::array<double, 6>& stress);

}  // namespace mpm
