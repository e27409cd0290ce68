// The stress of level ground.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "common/material_table.hpp"
#include "input/options/level_ground.hpp"

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

Vec3 place_at(int dim, double x, double height) {
  Vec3 place{x, 1, 0};
  place[dim - 1] = height;
  return place;
}

}  // namespace

TEST_CASE("level ground carries the weight of the layers above, less that of the water it displaces",
          "[level_ground]") {
  for (const int dim : {2, 3}) {
    Config config = three_layers(dim);
    const LevelGround ground(config);
    const auto at = [&](double height) { return place_at(dim, 1, height); };
    const auto& column = ground.column(at(0));
    REQUIRE(column.size() == 3);
    CHECK((column[0].body == 2 && column[2].body == 0));
    CHECK((ground.vertical(at(5.5)) == 0 && ground.vertical(at(9)) == 0));
    CHECK(ground.vertical(at(5)) == Approx(10e3));
    CHECK(ground.vertical(at(4)) == Approx(28e3));
    CHECK(ground.vertical(at(1)) == Approx(66e3));
    CHECK(ground.vertical(at(0)) == Approx(76e3));
    const Sym6 stress = ground.stress(config.bodies[1], at(4), 0.25);
    CHECK((stress[dim - 1] == Approx(-28e3) && stress[0] == Approx(-0.6 * 28e3)));
    CHECK((stress[dim == 2 ? 2 : 1] == Approx(-0.6 * 28e3) && stress[3] == 0));
  }
}

TEST_CASE("the mean of a particle's edges carries its weight where the level of water crosses it",
          "[level_ground]") {
  Config config = three_layers(2);
  config.water.level = 2.9;  // within the particle from 2.75 to 3
  const LevelGround ground(config);
  const double above = ground.stress(config.bodies[1], place_at(2, 1, 3.125), 0.25)[1],
               at = ground.stress(config.bodies[0], place_at(2, 1, 2.875), 0.25)[1],
               below = ground.stress(config.bodies[0], place_at(2, 1, 2.625), 0.25)[1];
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

TEST_CASE("a pit that fills what it cuts out of layers counts with its own weight", "[level_ground]") {
  for (const int dim : {2, 3}) {
    Config config = three_layers(dim);
    config.water.level = {};
    config.materials.push_back(config.materials[0]);
    config.materials[3].density = 1500;
    BodyConfig& pit = config.bodies.emplace_back();
    pit.name = "pit", pit.material = 3, pit.k0 = true;
    // 4.5 to 1 m at x = 0, and 4.5 to 4 m at x = 1.5: its floor is a slope.
    pit.shape.kind = ShapeKind::polygon;
    pit.shape.polygon = {{0, 1}, {1.5, 4}, {1.5, 4.5}, {0, 4.5}}, pit.shape.width = {0, 2};
    config.bodies[0].cut_out_bodies = config.bodies[1].cut_out_bodies = {3};
    const LevelGround ground(config);
    CHECK(ground.vertical(place_at(dim, 0.5, 1)) ==
          Approx(10 * (0.5 * 2000 + 0.5 * 1800 + 2.5 * 1500 + 1 * 2000)));
    CHECK(ground.vertical(place_at(dim, 1.75, 1)) == Approx(10 * (0.5 * 2000 + 2 * 1800 + 2 * 2000)));
    REQUIRE(ground.column(place_at(dim, 0.5, 0)).size() == 4);
    CHECK(ground.column(place_at(dim, 0.5, 0))[2].base == Approx(2));
    config.bodies[3].removed = true;  // it was dug out
    CHECK(LevelGround(config).column(place_at(dim, 0.5, 0)).size() == 3);
  }
}
