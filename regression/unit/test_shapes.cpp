// Particle counts, positions and volumes of shapes. Counts of the benchmark cases are those of Dong, Wang &
// Randolph (Computers and Geotechnics 66, 2015, 31-38), Tables 1 and 3.

#include <algorithm>
#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <numbers>

#include "input/geometry/polygon.hpp"
#include "input/geometry/shapes.hpp"

using namespace mpm;
using Catch::Approx;

namespace {

MeshConfig mesh_of(Vec3 lower, Vec3 upper, double spacing) {
  MeshConfig mesh;
  mesh.lower = lower, mesh.upper = upper, mesh.spacing = spacing;
  return mesh;
}

Shape box(Vec3 lower, Vec3 upper, int particles_per_cell = 2) {
  Shape shape;
  shape.lower = lower, shape.upper = upper, shape.particles_per_cell = particles_per_cell;
  return shape;
}

Shape disc(Vec3 centre, double radius) {
  Shape shape;
  shape.kind = ShapeKind::disc, shape.centre = centre, shape.radius = radius;
  return shape;
}

Shape half_plane(Vec3 point, Vec3 normal) {
  Shape shape;
  const double length = std::hypot(normal[0], normal[1], normal[2]);
  for (double& component : normal) component /= length;
  shape.kind = ShapeKind::half_plane, shape.point = point, shape.normal = normal;
  return shape;
}

Shape polygon(Polygon vertices, Fill fill = Fill::centre) {
  Shape shape;
  shape.kind = ShapeKind::polygon, shape.polygon = vertices, shape.fill = fill;
  return shape;
}

Lattice filled(const Shape& shape, const MeshConfig& mesh, int dim = 2) {
  Lattice lattice;
  REQUIRE(fill(shape, mesh, dim, lattice) == PETSC_SUCCESS);
  CHECK(holds_particle(shape, mesh, dim) == !lattice.position.empty());
  return lattice;
}

long count(const Shape& shape, const MeshConfig& mesh, int dim = 2) {
  return static_cast<long>(filled(shape, mesh, dim).position.size()) / dim;
}

/// Ratio of the volume that the particles represent to the shape's own.
double share(const Shape& shape, const MeshConfig& mesh, int dim) {
  const Lattice lattice = filled(shape, mesh, dim);
  return lattice.position.size() / dim * lattice.particle_volume / lattice.shape_volume;
}

/// Base 40 + 5 sqrt 3, height 5, ends at 30 degrees, from the origin.
Polygon trapezoid(double base = 40 + 5 * std::sqrt(3.0)) {
  const double run = 5 * std::sqrt(3.0);
  return {{0, 0}, {base, 0}, {base - run, 5}, {run, 5}};
}

}  // namespace

TEST_CASE("a footing's soil has the particles of Table 1 at every size", "[shapes]") {
  const double lengths[] = {3, 4.5, 9.6, 28.8, 57.6, 115.2, 230.4};
  const long particles[] = {76800, 115200, 245760, 737280, 1474560, 2949120, 5898240};
  for (int k = 0; k < 7; ++k) {
    const auto mesh = mesh_of({0, 0}, {lengths[k], 4.45}, 0.025);
    CHECK(count(box({0, 0}, {lengths[k], 4}), mesh) == particles[k]);
  }
}

TEST_CASE("a slide's soil has the particles of Table 3 at every size", "[shapes]") {
  const double ratios[] = {7.5, 15, 30, 60, 120, 240, 360, 480};
  const long particles[] = {69120, 138240, 276480, 552960, 1105920, 2211840, 3317760, 4423680};
  for (int k = 0; k < 8; ++k) {
    const double length = 4.8 * ratios[k];
    CHECK(count(box({0, 0}, {length, 4.8}), mesh_of({0, 0}, {length, 5.1}, 0.1)) == particles[k]);
  }
}

TEST_CASE("the benchmark's plate and base have their particles", "[shapes]") {
  const auto mesh = mesh_of({0, 0}, {3, 4.45}, 0.025);
  CHECK(count(box({0, 4}, {0.5, 4.025}, 4), mesh) == 320);
  CHECK(count(box({0, -0.1}, {100, 0}), mesh_of({0, -0.1}, {100, 5.2}, 0.1)) == 4000);
}

TEST_CASE("the cells wholly in the slide's trapezoid are 19,864", "[shapes]") {
  const auto mesh = mesh_of({0, 0}, {100, 5.3}, 0.1);
  CHECK(count(polygon(trapezoid(), Fill::cell), mesh) == 4 * 19864);
  CHECK(count(polygon(trapezoid(48.66), Fill::cell), mesh) == 4 * 19863);
  Polygon shifted = trapezoid();
  for (auto& vertex : shifted) vertex[0] += 12;
  CHECK(count(polygon(shifted, Fill::cell), mesh) == 4 * 19864);
}

TEST_CASE("a box's lattice starts half a particle from its lower corner, x fastest", "[shapes]") {
  const Lattice lattice = filled(box({0.3, 0.1}, {1.3, 1.1}), mesh_of({0, 0}, {2, 2}, 1));
  const double expected[] = {0.55, 0.35, 1.05, 0.35, 0.55, 0.85, 1.05, 0.85};
  REQUIRE(lattice.position.size() == 8);
  for (int k = 0; k < 8; ++k) CHECK(lattice.position[k] == Approx(expected[k]).epsilon(1e-15));
  CHECK(lattice.spacing == 0.5);
  CHECK(lattice.particle_volume == 0.25);
  CHECK(lattice.shape_volume == Approx(1));
}

TEST_CASE("another shape's lattice is the mesh's", "[shapes]") {
  const Lattice lattice = filled(disc({1, 1}, 0.4), mesh_of({0.1, 0.1}, {2.1, 2.1}, 1));
  const double expected[] = {0.85, 0.85, 1.35, 0.85, 0.85, 1.35};  // 0.1 + (k + 1/2) / 2
  REQUIRE(lattice.position.size() == 6);
  for (int k = 0; k < 6; ++k) CHECK(lattice.position[k] == Approx(expected[k]));
}

TEST_CASE("round-off decides no particle: 0.1 steps from 0.1 fill all cells", "[shapes]") {
  for (int n = 1; n <= 60; ++n) {
    const double lower = 0.1, upper = 0.1 + 0.1 * n;
    const auto mesh = mesh_of({0, 0}, {7, 1}, 0.1);
    CHECK(count(box({lower, 0}, {upper, 0.1}), mesh) == 4 * n);
    Shape cells = polygon({{lower, 0}, {upper, 0}, {upper, 0.1}, {lower, 0.1}}, Fill::cell);
    CHECK(count(cells, mesh) == 4 * n);
    cells.fill = Fill::centre;
    CHECK(count(cells, mesh) == 4 * n);
  }
}

TEST_CASE("a fillet takes the particles of all four corners", "[shapes]") {
  const auto mesh = mesh_of({0, 0}, {4, 4}, 1);
  CHECK(count(box({0, 0}, {4, 4}, 4), mesh) == 256);
  Shape rounded = box({0, 0}, {4, 4}, 4);
  rounded.fillet = 1;  // as the footing's filleted corner: 3 of the 16 particles of a corner cell
  CHECK(count(rounded, mesh) == 256 - 4 * 3);
  rounded.fillet = 0.25;
  CHECK(count(rounded, mesh) == 256);
}

TEST_CASE("a cell that a notch of a polygon cuts is not wholly inside, though its corners are", "[shapes]") {
  const auto mesh = mesh_of({0, 0}, {4, 3}, 1);
  const Polygon notched = {{0, 0}, {4, 0}, {4, 3}, {1.6, 3}, {1.5, 0.5}, {1.4, 3}, {0, 3}};
  CHECK(count(polygon(notched, Fill::cell), mesh) == 4 * 9);
}

TEST_CASE("particles represent the volume of every shape as the lattice is refined", "[shapes]") {
  const auto mesh2 = mesh_of({0, 0}, {2, 2}, 0.02);
  const auto mesh3 = mesh_of({0, 0, 0}, {2, 2, 2}, 0.05);
  Shape rounded = box({0.2, 0.2, 0.2}, {1.8, 1.6, 1.2});
  rounded.fillet = 0.3;
  CHECK(share(disc({1, 1}, 0.9), mesh2, 2) == Approx(1).epsilon(1e-3));
  CHECK(share(disc({1, 1, 1}, 0.9), mesh3, 3) == Approx(1).epsilon(3e-3));
  CHECK(share(rounded, mesh2, 2) == Approx(1).epsilon(1e-3));
  CHECK(share(rounded, mesh3, 3) == Approx(1).epsilon(5e-3));
  CHECK(share(polygon({{0.1, 0.1}, {1.9, 0.3}, {1.2, 1.8}, {1, 0.9}}), mesh2, 2) == Approx(1).epsilon(1e-2));
}

TEST_CASE("volumes are exact", "[shapes]") {
  Shape rounded = box({0, 0, 0}, {2, 2, 2});
  rounded.fillet = 1;  // a disc, a ball
  const MeshConfig any = mesh_of({-100, -100, -100}, {100, 100, 100}, 1);
  CHECK(shape_volume(rounded, any, 2) == Approx(std::numbers::pi));
  CHECK(shape_volume(rounded, any, 3) == Approx(4 * std::numbers::pi / 3));
  CHECK(shape_volume(box({0, 0, 0}, {2, 3, 4}), any, 3) == Approx(24));
  CHECK(shape_volume(polygon(trapezoid()), any, 2) == Approx(200));
}

TEST_CASE("a polygon that crosses or touches itself is found", "[shapes]") {
  CHECK_FALSE(first_crossing(trapezoid()));
  CHECK_FALSE(first_crossing({{0, 0}, {2, 0}, {4, 0}, {4, 1}, {0, 1}}));       // a vertex in a straight edge
  CHECK(first_crossing({{0, 0}, {1, 1}, {1, 0}, {0, 1}}) == std::pair(0, 2));  // bow tie
  CHECK(first_crossing({{0, 0}, {1, 0}, {2, 0}}));                             // no area
  CHECK(first_crossing({{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}}));             // touches with a vertex
  CHECK(first_crossing({{0, 0}, {1, 0}, {1, 0}, {0, 1}}));                     // a vertex twice
}

TEST_CASE("a list of particles has no lattice", "[shapes]") {
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
  Lattice lattice;
  Shape listed;
  listed.kind = ShapeKind::particles;
  CHECK(fill(listed, mesh_of({0, 0, 0}, {50, 6, 1}, 1), 3, lattice) == PETSC_ERR_SUP);
  PetscPopErrorHandler();
}

TEST_CASE("a prism has the particles of its polygon in every layer of its width", "[shapes]") {
  const auto plane = mesh_of({0, 0}, {50, 6}, 0.5), space = mesh_of({0, -1, 0}, {50, 2, 6}, 0.5);
  for (Fill how : {Fill::centre, Fill::cell}) {
    Shape prism = polygon(trapezoid(), how);
    prism.width = {-0.5, 1};
    CHECK(count(prism, space, 3) == 6 * count(polygon(trapezoid(), how), plane));
  }
  Shape narrow = polygon({{0.5, 0}, {2, 0.5}, {1, 3}});
  narrow.width = {-0.5, 1};
  CHECK(shape_volume(narrow, space, 3) == Approx(1.5 * shape_volume(narrow, plane, 2)));
  const Bounds bounds = bounds_of(narrow, space, 3);
  CHECK(bounds.lower == Vec3{0.5, -0.5, 0});
  CHECK(bounds.upper == Vec3{2, 1, 3});
  narrow.width = {-0.5, 0.49};  // cells of the second layer are not wholly in it
  narrow.fill = Fill::cell;
  const long wide = count(narrow, space, 3);
  narrow.width = {-0.5, 0.5};
  CHECK(count(narrow, space, 3) == 2 * wide);
}

TEST_CASE("a half plane fills the part of the mesh behind it", "[shapes]") {
  const auto plane = mesh_of({-1, 0}, {3, 2}, 0.25), space = mesh_of({-1, 0, 0}, {3, 2, 1}, 0.25);
  CHECK(count(half_plane({7, 1}, {0, 1}), plane) == 16 * 4 * 4);   // a level floor, 1 m high
  CHECK(count(half_plane({7, 1}, {0, -1}), plane) == 16 * 4 * 4);  // and what is above it
  CHECK(count(half_plane({0, 3, 0.5}, {0, 0, 1}), space, 3) == 16 * 8 * 2 * 8);
  CHECK(count(half_plane({0, -1}, {0, 1}), plane) == 0);
  const Lattice lattice = filled(half_plane({1, 1}, {1, 1}), plane);
  for (std::size_t k = 0; k < lattice.position.size(); k += 2)
    CHECK(lattice.position[k] + lattice.position[k + 1] < 2 + 1e-8);
}

TEST_CASE("the volume behind a half plane is that of the polygon or prism that it cuts off", "[shapes]") {
  const auto plane = mesh_of({-1, 0}, {3, 2}, 0.25), space = mesh_of({-1, 0, 0}, {3, 2, 1}, 0.25);
  const auto behind = [&](Vec3 point, Vec3 normal) {
    return shape_volume(half_plane(point, normal), plane, 2);
  };
  CHECK(behind({0, 0.5}, {0, 1}) == Approx(2));
  CHECK(behind({0, 0.5}, {0, -1}) == Approx(6));
  CHECK(behind({0, 2}, {1, 1}) == Approx(area_of({{-1, 0}, {2, 0}, {0, 2}, {-1, 2}})));
  CHECK(behind({0, 2}, {-1, -1}) == Approx(8 - 4));
  CHECK(behind({-1, 0.5}, {-0.1, 1}) == Approx(4 * 0.7));  // 0.5 to 0.9 high
  CHECK(behind({-1, 0.5}, {-1e-6, 1}) == Approx(4 * (0.5 + 2e-6)).epsilon(1e-12));
  CHECK(behind({-1, 0.5}, {-2e-4, 1}) == Approx(4 * (0.5 + 4e-4)).epsilon(1e-9));
  CHECK(behind({9, 9}, {1, 1}) == Approx(8));
  CHECK(behind({-9, -9}, {1, 1}) == 0);
  // Planes that no row of the lattice lies in: centres on the face count as inside.
  const auto corner = half_plane({0, 0, 0.5}, {1.03, 0.87, 1.91});
  CHECK(shape_volume(half_plane({-0.5, 0, 0}, {1, 1, 1}), space, 3) == Approx(0.125 / 6));  // a corner
  CHECK(share(corner, mesh_of({-1, 0, 0}, {3, 2, 1}, 0.05), 3) == Approx(1).epsilon(5e-3));
  CHECK(share(half_plane({0.3, 1}, {0.2137, 1}), mesh_of({-1, 0}, {3, 2}, 0.02), 2) ==
        Approx(1).epsilon(1e-3));
}

TEST_CASE("a box that is turned has its own lattice, turned about its lower corner", "[shapes]") {
  const auto plane = mesh_of({0, 0}, {10, 10}, 0.5), space = mesh_of({0, 0, 0}, {10, 10, 10}, 0.5);
  for (double degrees : {5., 45., 90., 210., -30.}) {
    Shape straight = box({4, 5, 5}, {6, 6, 6.5}), turned = straight;
    turned.angle = degrees / 180 * std::numbers::pi;
    const double c = std::cos(turned.angle), s = std::sin(turned.angle);
    for (int dim : {2, 3}) {
      const auto& mesh = dim == 2 ? plane : space;
      const Lattice expected = filled(straight, mesh, dim), got = filled(turned, mesh, dim);
      REQUIRE(got.position.size() == expected.position.size());
      CHECK(got.shape_volume == expected.shape_volume);
      double largest = 0;
      for (std::size_t k = 0; k < got.position.size(); k += dim) {
        const double along = expected.position[k] - 4, up = expected.position[k + dim - 1] - 5;
        largest = std::max({largest, std::abs(got.position[k] - 4 - (c * along - s * up)),
                            std::abs(got.position[k + dim - 1] - 5 - (s * along + c * up))});
        if (dim == 3) largest = std::max(largest, std::abs(got.position[k + 1] - expected.position[k + 1]));
      }
      CHECK(largest < 1e-14);
    }
  }
}

TEST_CASE("the bounds of a turned box are its corners', or where its fillet is widest", "[shapes]") {
  const auto mesh = mesh_of({0, 0}, {10, 10}, 0.5);
  Shape square = box({4, 5}, {6, 7});
  square.angle = std::numbers::pi / 4;
  const Bounds sharp = bounds_of(square, mesh, 2);
  CHECK(sharp.lower[0] == Approx(4 - std::sqrt(2)));
  CHECK(sharp.lower[1] == Approx(5));
  CHECK(sharp.upper[0] == Approx(4 + std::sqrt(2)));
  CHECK(sharp.upper[1] == Approx(5 + 2 * std::sqrt(2)));
  square.fillet = 1;  // a disc about (4, 5 + sqrt 2)
  const Bounds round = bounds_of(square, mesh, 2);
  CHECK(round.lower[0] == Approx(3));
  CHECK(round.upper[1] == Approx(6 + std::sqrt(2)));
}

TEST_CASE("particles whose centre is in a shape that is cut out are left out, and only those", "[shapes]") {
  const auto mesh = mesh_of({0, 0}, {8, 6}, 0.25);
  Shape turned = box({5, 1}, {7, 2});
  turned.angle = 0.4;
  const std::vector<Shape> holes = {disc({2, 2}, 0.8), turned, polygon({{0, 4}, {2, 4}, {0, 5.5}}),
                                    half_plane({8, 5}, {-1, -1})};
  for (Fill how : {Fill::centre, Fill::cell}) {
    Shape ground = box({0, 0}, {8, 6});
    ground.fill = how;
    Lattice whole, rest;
    REQUIRE(fill(ground, mesh, 2, whole) == PETSC_SUCCESS);
    REQUIRE(fill(ground, mesh, 2, rest, holes) == PETSC_SUCCESS);
    CHECK(whole.cut_out == 0);
    CHECK(2 * rest.cut_out == long(whole.position.size() - rest.position.size()));
    double expected = 0;  // the holes neither overlap nor leave the body
    for (const Shape& hole : holes) expected += shape_volume(hole, mesh, 2);
    CHECK(rest.cut_out * rest.particle_volume == Approx(expected).epsilon(0.01));
    bool in_hole = false;
    for (std::size_t k = 0; k < rest.position.size(); k += 2)
      in_hole = in_hole || std::hypot(rest.position[k] - 2, rest.position[k + 1] - 2) < 0.8;
    CHECK_FALSE(in_hole);
  }
  CHECK_FALSE(holds_particle(disc({2, 2}, 0.8), mesh, 2, {box({1, 1}, {3, 3})}));
  CHECK(holds_particle(disc({2, 2}, 0.8), mesh, 2, {box({1, 1}, {2, 3})}));
}
