// The stress of level ground.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "common/material_table.hpp"
#include "input/level_ground.hpp"

using namespace mpm;
using Catch::Approx;

namespace {

/// 0.5 m of 20 kN/m3 on 2 m of 18 kN/m3 on 3 m of 20 kN/m3; water up to the top of the lowest.
Config three_layers(int dim) {
  Config config;
  config.dim = dim, config.mesh.spacing = 0.5;
  config.gravity[dim - 1] = -10;
  config.water = {.level = 3.0, .density = 1000};
  const double levels[] = {0, 3, 5, 5.5}, densities[] = {2000, 1800, 2000};
  for (int k = 0; k < 3; ++k) {
    MaterialConfig& material = config.materials.emplace_back();
    material.model = "newtonian", material.density = densities[k], material.k0 = 0.5 + 0.1 * k;
    BodyConfig& body = config.bodies.emplace_back();
    body.material = k, body.k0 = true;
    body.shape.lower = {0, 0, 0}, body.shape.upper = {2, 2, 2};
    body.shape.lower[dim - 1] = levels[k], body.shape.upper[dim - 1] = levels[k + 1];
  }
  return config;
}

}  // namespace

TEST_CASE("level ground carries the weight of the layers above, less that of the water it displaces",
          "[level_ground]") {
  for (const int dim : {2, 3}) {
    Config config = three_layers(dim);
    const LevelGround ground(config);
    REQUIRE(ground.layers().size() == 3);
    CHECK((ground.layers()[0].body == 2 && ground.layers()[2].body == 0));
    CHECK((ground.vertical(5.5) == 0 && ground.vertical(9) == 0));
    CHECK(ground.vertical(5) == Approx(10e3));
    CHECK(ground.vertical(4) == Approx(28e3));
    CHECK(ground.vertical(1) == Approx(66e3));
    CHECK(ground.vertical(0) == Approx(76e3));
    const Sym6 stress = ground.stress(config.bodies[1], 4, 0.25);
    CHECK((stress[dim - 1] == Approx(-28e3) && stress[0] == Approx(-0.6 * 28e3)));
    CHECK((stress[dim == 2 ? 2 : 1] == Approx(-0.6 * 28e3) && stress[3] == 0));
  }
}

TEST_CASE("the mean of a particle's edges carries its weight where the level of water crosses it",
          "[level_ground]") {
  Config config = three_layers(2);
  config.water.level = 2.9;  // within the particle from 2.75 to 3
  const LevelGround ground(config);
  const double above = ground.stress(config.bodies[1], 3.125, 0.25)[1],
               at = ground.stress(config.bodies[0], 2.875, 0.25)[1],
               below = ground.stress(config.bodies[0], 2.625, 0.25)[1];
  const double upper = 1800 * 10 * 0.25, middle = 10 * (2000 * 0.25 - 1000 * 0.15), lower = 10 * 1000 * 0.25;
  CHECK(above - at == Approx((upper + middle) / 2));
  CHECK(at - below == Approx((middle + lower) / 2));
}

TEST_CASE("the ratio of horizontal stress follows the law where it is not given", "[level_ground]") {
  MaterialConfig material;
  material.model = "newtonian";
  CHECK(k0_of(material) == 1);
  material.k0 = 0.7;
  CHECK(k0_of(material) == 0.7);
  material.k0 = {}, material.model = "cam_clay";
  CHECK(std::isnan(k0_of(material)));
}
