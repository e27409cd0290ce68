// Shapes of the ground: surfaces of triangles and layers, and the parts of cells that they cut.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "input/cut_cells.hpp"
#include "input/raster_file.hpp"
#include "input/region.hpp"
#include "input/shapes.hpp"
#include "input/stl_file.hpp"

using namespace mpm;
using Catch::Approx;

namespace {

using Corners = std::vector<Vec3>;

MeshConfig mesh_of(Vec3 lower, Vec3 upper, double spacing) {
  MeshConfig mesh;
  mesh.lower = lower, mesh.upper = upper, mesh.spacing = spacing;
  return mesh;
}

/// Corners of triangles that are 4^halvings as many as those of an octahedron, on a ball.
Corners ball(const Vec3& centre, double radius, int halvings) {
  Corners corners;
  for (int o = 0; o < 8; ++o) {
    const double x = o & 1 ? -1 : 1, y = o & 2 ? -1 : 1, z = o & 4 ? -1 : 1;
    const bool odd = (o & 1) ^ (o >> 1 & 1) ^ (o >> 2 & 1);
    Corners face{{x, 0, 0}, {0, y, 0}, {0, 0, z}};
    if (odd) std::swap(face[0], face[1]);
    corners.insert(corners.end(), face.begin(), face.end());
  }
  const auto middle = [](const Vec3& a, const Vec3& b) {
    Vec3 m{a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    const double length = std::hypot(m[0], m[1], m[2]);
    return Vec3{m[0] / length, m[1] / length, m[2] / length};
  };
  for (int h = 0; h < halvings; ++h) {
    Corners finer;
    for (std::size_t k = 0; k < corners.size(); k += 3) {
      const Vec3 &a = corners[k], &b = corners[k + 1], &c = corners[k + 2], p = middle(a, b), q = middle(b, c),
                 r = middle(c, a);
      for (const Vec3& x : {a, p, r, p, b, q, r, q, c, p, q, r}) finer.push_back(x);
    }
    corners = finer;
  }
  for (Vec3& x : corners)
    for (int d = 0; d < 3; ++d) x[d] = centre[d] + radius * x[d];
  return corners;
}

/// Two triangles a face.
Corners box(const Vec3& low, const Vec3& high) {
  Corners corners;
  for (int d = 0; d < 3; ++d)
    for (int side = 0; side < 2; ++side) {
      const int e = (d + 1) % 3, f = (d + 2) % 3;
      Vec3 x[4];
      for (int k = 0; k < 4; ++k) {
        x[k][d] = side ? high[d] : low[d];
        x[k][e] = k == 1 || k == 2 ? high[e] : low[e];
        x[k][f] = k >= 2 ? high[f] : low[f];
      }
      for (const int k : {0, 1, 2, 0, 2, 3}) corners.push_back(x[side ? k : (4 - k) % 4]);
    }
  return corners;
}

Corners turned_at_random(Corners corners, const Vec3& about, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi);
  for (int d = 0; d < 3; ++d) {
    const double c = std::cos(angle(random)), s = std::sqrt(1 - c * c);
    const int e = (d + 1) % 3, f = (d + 2) % 3;
    for (Vec3& x : corners) {
      const double a = x[e] - about[e], b = x[f] - about[f];
      x[e] = about[e] + c * a - s * b, x[f] = about[f] + s * a + c * b;
    }
  }
  return corners;
}

Shape stl(const Corners& corners) {
  Shape shape;
  shape.kind = ShapeKind::stl, shape.fill = Fill::cut;
  shape.triangles = std::make_shared<const TriangleSurface>(corners);
  return shape;
}

std::shared_ptr<const HeightSurface> level(double z) { return std::make_shared<const HeightSurface>(z); }
std::shared_ptr<const HeightSurface> polyline(std::vector<double> x, std::vector<double> z) {
  return std::make_shared<const HeightSurface>(std::move(x), std::vector<double>{}, std::move(z));
}
template <class Height>
std::shared_ptr<const HeightSurface> raster(double x, double y, double cell, long columns, long rows, Height&& f) {
  Raster raster{columns, rows, x, y, cell, {}};
  for (long j = 0; j < rows; ++j)
    for (long i = 0; i < columns; ++i) raster.values.push_back(f(x + (i + 0.5) * cell, y + (j + 0.5) * cell));
  return surface_of(raster);
}

Shape layer(std::shared_ptr<const HeightSurface> top, std::shared_ptr<const HeightSurface> base) {
  Shape shape;
  shape.kind = ShapeKind::layer, shape.fill = Fill::cut, shape.top = top, shape.base = base;
  return shape;
}

Lattice filled(const Shape& shape, const MeshConfig& mesh, int dim) {
  Lattice lattice;
  REQUIRE(fill(shape, mesh, dim, lattice) == PETSC_SUCCESS);
  CHECK(holds_particle(shape, mesh, dim) == !lattice.position.empty());
  return lattice;
}

/// Volume and centre of mass of particles.
struct Moments {
  double volume = 0;
  Vec3 centre{};
  explicit Moments(const Lattice& lattice) {
    for (std::size_t p = 0; p < lattice.volume.size(); ++p) {
      volume += lattice.volume[p];
      for (int d = 0; d < lattice.dim; ++d) centre[d] += lattice.volume[p] * lattice.position[p * lattice.dim + d];
    }
    for (double& x : centre) x /= volume;
  }
};

constexpr double k_ball = 4 * std::numbers::pi / 3;

}  // namespace

TEST_CASE("particles of a ball of triangles have its volume and centre", "[ground]") {
  const auto mesh = mesh_of({-2, -2, -2}, {2, 2, 2}, 0.2);
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Vec3 centre{0.013 * seed, -0.02 * seed, 0.031};
    const Shape shape = stl(turned_at_random(ball(centre, 1.3, 6), centre, seed));
    const Lattice lattice = filled(shape, mesh, 3);
    const Moments held(lattice);
    CHECK(lattice.shape_volume == Approx(k_ball * std::pow(1.3, 3)).epsilon(1e-3));
    CHECK(held.volume == Approx(lattice.shape_volume).epsilon(1e-9));
    for (int d = 0; d < 3; ++d) CHECK(std::abs(held.centre[d] - centre[d]) < 1e-9);
  }
}

TEST_CASE("particles of cut round shapes and polygons have their volume", "[ground]") {
  const auto mesh = mesh_of({0, 0, 0}, {4, 4, 4}, 0.25);
  Shape shape;
  shape.fill = Fill::cut, shape.centre = {2.03, 1.98, 2.01}, shape.radius = 1.2;
  for (const int per_cell : {1, 2, 3}) {
    shape.particles_per_cell = per_cell;
    for (const ShapeKind kind : {ShapeKind::disc, ShapeKind::cylinder, ShapeKind::cone}) {
      shape.kind = kind, shape.height = 1.7, shape.tip_height = kind == ShapeKind::cylinder ? 0.6 : 0;
      const Lattice lattice = filled(shape, mesh, 3);
      CHECK(Moments(lattice).volume == Approx(lattice.shape_volume).epsilon(1e-9));
    }
    shape.kind = ShapeKind::disc;
    CHECK(Moments(filled(shape, mesh, 2)).volume == Approx(std::numbers::pi * 1.44).epsilon(1e-9));
    Shape wedge;
    wedge.kind = ShapeKind::polygon, wedge.fill = Fill::cut, wedge.particles_per_cell = per_cell;
    wedge.polygon = {{0.3, 0.1}, {3.7, 0.1}, {3.7, 1.33}}, wedge.width = {0.11, 2.9};
    const double area = 3.4 * 1.23 / 2;
    CHECK(Moments(filled(wedge, mesh, 2)).volume == Approx(area).epsilon(1e-9));
    const Moments prism(filled(wedge, mesh, 3));
    CHECK(prism.volume == Approx(2.79 * area).epsilon(1e-5));  // less what is thinner than a thousandth of a cell
    CHECK(prism.centre[0] == Approx(0.3 + 3.4 * 2 / 3));
    CHECK(prism.centre[2] == Approx(0.1 + 1.23 / 3));
  }
}

TEST_CASE("a half of a ball that a plane of symmetry cuts has half its volume", "[ground]") {
  Shape shape;
  shape.kind = ShapeKind::disc, shape.fill = Fill::cut, shape.centre = {0, 0, 0}, shape.radius = 1.13;
  const Lattice lattice = filled(shape, mesh_of({0, 0, 0}, {2, 2, 2}, 0.2), 3);
  CHECK(Moments(lattice).volume == Approx(k_ball * std::pow(1.13, 3) / 8).epsilon(1e-9));
  CHECK(lattice.shape_volume == Approx(k_ball * std::pow(1.13, 3) / 8).epsilon(1e-9));
}

TEST_CASE("particles of tilted layers have the volumes between planes, in 2D and 3D", "[ground]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> slope(-0.3, 0.3);
  for (int trial = 0; trial < 10; ++trial) {
    const double a = slope(random), b = slope(random), c = slope(random), d = slope(random);
    const auto mesh = mesh_of({0, 0, 0}, {5, 3, 6}, 0.5);
    const auto upper = [&](double x, double y) { return 4 + a * (x - 2.5) + b * (y - 1.5); };
    const auto lower = [&](double x, double y) { return 2 + c * (x - 2.5) + d * (y - 1.5); };
    const Shape slab = layer(raster(-1, -1, 0.37, 22, 16, upper), raster(-2, -2, 1.3, 9, 8, lower));
    const Lattice lattice = filled(slab, mesh, 3);
    const Moments held(lattice);
    CHECK(held.volume == Approx(30).epsilon(1e-9));
    CHECK(lattice.shape_volume == Approx(30).epsilon(1e-12));
    CHECK(held.centre[0] == Approx(2.5 + (a - c) * 25 / 12 / 2).epsilon(1e-9));
    const auto plane = mesh_of({0, 0}, {5, 6}, 0.5);
    const Shape strip = layer(polyline({0, 5}, {4 - 2.5 * a, 4 + 2.5 * a}),
                              polyline({-1, 2, 7}, {lower(-1, 1.5), lower(2, 1.5), lower(7, 1.5)}));
    CHECK(Moments(filled(strip, plane, 2)).volume == Approx(10).epsilon(1e-9));
    CHECK(Moments(filled(strip, mesh, 3)).volume == Approx(30).epsilon(1e-9));
  }
}

TEST_CASE("a raster's surface has the volume of the bilinear one", "[ground]") {
  const auto hills = [](double x, double y) { return 2 + std::sin(1.7 * x) * std::cos(2.3 * y); };
  const auto surface = raster(0, 0, 0.5, 8, 6, hills);
  double volume = 0;  // of the bilinear surface, by its quarters: cells and their halves at the rim
  const auto &x = surface->lines(0), &y = surface->lines(1);
  for (std::size_t j = 0; j + 1 < y.size(); ++j)
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
      volume += (x[i + 1] - x[i]) * (y[j + 1] - y[j]) / 4 *
                (surface->node(i, j) + surface->node(i + 1, j) + surface->node(i, j + 1) + surface->node(i + 1, j + 1));
  const Lattice lattice = filled(layer(surface, level(0.13)), mesh_of({0, 0, 0}, {4, 3, 4}, 0.25), 3);
  CHECK(Moments(lattice).volume == Approx(volume - 12 * 0.13).epsilon(1e-9));
  CHECK(surface->at(0.1, 0.1) == surface->node(1, 1));  // level in the outer half of the rim
}

TEST_CASE("the bounds of a layer are those of the part where its surfaces are apart", "[ground]") {
  const auto mesh = mesh_of({0, 0, 0}, {20, 20, 20}, 0.5);
  const auto slope = [](double x, double y) { return 3 + 0.5 * x + 0.1 * y; };
  const auto hollow = [&](double x, double y) {
    return slope(x, y) - std::max(0.0, 2 * (1 - std::pow((x - 12.2) / 3, 2) - std::pow((y - 7.3) / 2, 2)));
  };
  const Shape scoop = layer(raster(-1, -1, 0.4, 56, 57, slope), raster(-1, -1, 0.4, 56, 57, hollow));
  const Bounds bounds = bounds_of(scoop, mesh, 3);
  CHECK((bounds.lower[0] > 8 && bounds.upper[0] < 16.1 && bounds.lower[1] > 4.4 && bounds.upper[1] < 10.2));
  CHECK((bounds.lower[2] > 6 && bounds.upper[2] < 12.2));
  const Lattice lattice = filled(scoop, mesh, 3);
  CHECK(Moments(lattice).volume == Approx(lattice.shape_volume).epsilon(1e-4));
  CHECK(lattice.shape_volume == Approx(std::numbers::pi * 6).epsilon(0.02));
}

TEST_CASE("a box of triangles has the particles of the box", "[ground]") {
  const auto mesh = mesh_of({0, 0, 0}, {4, 4, 4}, 0.5);
  Shape same;
  same.lower = {0.5, 1, 0.25}, same.upper = {3, 2.5, 3.5};
  const Lattice expected = filled(same, mesh, 3), got = filled(stl(box(same.lower, same.upper)), mesh, 3);
  REQUIRE(got.position.size() == expected.position.size());
  for (std::size_t k = 0; k < got.position.size(); ++k)
    CHECK(got.position[k] == Approx(expected.position[k]).epsilon(1e-14));
  for (const double volume : got.volume) CHECK(volume == got.particle_volume);
  Shape centres = stl(box(same.lower, same.upper));
  centres.fill = Fill::centre;
  CHECK(filled(centres, mesh, 3).position == got.position);
}

TEST_CASE("parts of a cut lattice are the whole to the bit, and none of its particles is small", "[ground]") {
  const auto mesh = mesh_of({-2, -2, -2}, {2, 2, 2}, 0.25);
  const Shape shape = stl(turned_at_random(ball({0.1, 0, 0}, 1.37, 4), {0.1, 0, 0}, 3));
  const Lattice whole = filled(shape, mesh, 3);
  for (const double volume : whole.volume) CHECK(volume >= k_least_part * whole.particle_volume);
  for (const int parts : {2, 3, 7, 40}) {
    std::vector<double> position, volume;
    for (int k = 0; k < parts; ++k) {
      Lattice part;
      REQUIRE(fill(shape, mesh, 3, part, {}, {k, parts}) == PETSC_SUCCESS);
      position.insert(position.end(), part.position.begin(), part.position.end());
      volume.insert(volume.end(), part.volume.begin(), part.volume.end());
    }
    CHECK(position == whole.position);
    CHECK(volume == whole.volume);
  }
}

TEST_CASE("a point is in a surface of triangles where it is in the solid", "[ground]") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> at(-1.5, 1.5);
  const Shape round = stl(ball({0, 0, 0}, 1, 6)), square = stl(box({-1, -1, -1}, {1, 1, 1}));
  Region in_round(round, 3, 0), in_square(square, 3, 0);
  for (int k = 0; k < 20000; ++k) {
    const Vec3 x{at(random), at(random), at(random)};
    const double r = std::hypot(x[0], x[1], x[2]);
    if (std::abs(r - 1) > 1e-3) CHECK(in_round.holds(x) == (r < 1));
    CHECK(in_square.holds(x) == (std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])}) < 1));
  }
  // Below vertices and edges, where a line upwards meets several triangles.
  for (const double x : {-1.0, -0.5, 0.0, 0.5})
    for (const double y : {-1.0, -0.5, 0.0, 0.5}) CHECK(in_square.holds({x, y, 0}));
  CHECK(in_round.holds({0, 0, 0}));
  CHECK(in_round.holds({0, 0, -0.999}));
  CHECK_FALSE(in_round.holds({0, 0, -1.001}));
}

TEST_CASE("surfaces that are not closed, face inwards or cross themselves are refused", "[ground]") {
  const auto fault = [](Corners corners) { return fault_of(TriangleSurface(corners)); };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  Corners good = box({0, 0, 0}, {1, 1, 1});
  CHECK(fault(good).empty());
  CHECK(fault(ball({1, 2, 3}, 2, 4)).empty());
  Corners open(good.begin(), good.end() - 3);
  CHECK(has(fault(open), "3 of its edges are open"));
  Corners inward = good;
  for (std::size_t k = 0; k < inward.size(); k += 3) std::swap(inward[k], inward[k + 1]);
  CHECK(has(fault(inward), "face inwards"));
  Corners mixed = good;
  std::swap(mixed[0], mixed[1]);
  CHECK(has(fault(mixed), "one of the two faces inwards"));
  Corners doubled = good;
  doubled.insert(doubled.end(), good.begin(), good.end());
  CHECK(has(fault(doubled), "are of more"));
  for (const Vec3& shift : {Vec3{0.5, 0.5, 0.5}, {0.25, 0.5, 0.125}, {0.3, 0.2, 0.6}}) {
    Corners two = good;
    for (Vec3 x : good) {
      for (int d = 0; d < 3; ++d) x[d] += shift[d];
      two.push_back(x);
    }
    CHECK(has(fault(two), "neither crosses nor touches itself"));
  }
  Corners bent = ball({0, 0, 0}, 1, 3);  // a vertex pulled through the far side
  const Vec3 from = bent[0];
  for (Vec3& x : bent)
    if (x == from) x = {-3 * from[0], -3 * from[1] + 0.01, -3 * from[2] + 0.02};
  CHECK(has(fault(bent), "crosses"));
  CHECK(has(fault({}), "has triangles"));
  CHECK(has(fault({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}}), "encloses a volume"));
}

TEST_CASE("a part within another part encloses space twice", "[ground]") {
  const CellGrid grid{.origin = {-2, -2, -2}, .edge = 0.5, .dim = 3, .first = {0, 0, 0}, .last = {8, 8, 8}};
  const auto mesh = mesh_of({-2, -2, -2}, {2, 2, 2}, 0.5);
  const Corners outer = ball({0, 0, 0}, 1.5, 3);
  Corners inner = ball({0.1, 0, 0}, 0.6, 3);
  const auto overfull = [&](const Corners& corners) {
    return overfull_cell(Facets(stl(corners), mesh, 3, 0.5), grid).has_value();
  };
  CHECK_FALSE(overfull(outer));
  Corners twice = outer, hollow = outer, apart = outer;
  twice.insert(twice.end(), inner.begin(), inner.end());
  CHECK(overfull(twice));
  for (std::size_t k = 0; k < inner.size(); k += 3) std::swap(inner[k], inner[k + 1]);
  hollow.insert(hollow.end(), inner.begin(), inner.end());
  CHECK_FALSE(overfull(hollow));
  for (Vec3& x : inner) x[0] += 0.2, x[2] += 1.9;
  apart.insert(apart.end(), inner.begin(), inner.end());
  CHECK(overfull(apart));
}

TEST_CASE("STL files are read, ASCII and binary", "[ground]") {
  const auto folder = std::filesystem::temp_directory_path() / ("mpm_stl_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const std::string path = folder / "ball.stl";
  const Corners corners = ball({0, 0, 0}, 1, 3);
  std::shared_ptr<const TriangleSurface> surface;
  {
    std::ofstream file(path);
    file << "solid facet vertex of a name\n";
    file.precision(17);
    for (std::size_t k = 0; k < corners.size(); k += 3) {
      file << "  facet normal 0 0 0\n outer loop\n";
      for (int c = 0; c < 3; ++c)
        file << "  vertex " << corners[k + c][0] << ' ' << corners[k + c][1] << ' ' << corners[k + c][2] << '\n';
      file << " endloop\n endfacet\n";
    }
    file << "endsolid facet vertex of a name\n";
  }
  CHECK(read_stl(path, 0.5, surface).empty());
  REQUIRE(surface);
  CHECK(surface->size() == 512);
  CHECK(surface->volume() == Approx(k_ball / 8).epsilon(0.03));
  const double ascii = surface->volume();
  {
    std::ofstream file(path, std::ios::binary);
    char header[80] = "solid, but binary";
    const auto count = static_cast<std::uint32_t>(corners.size() / 3);
    file.write(header, 80).write(reinterpret_cast<const char*>(&count), 4);
    for (std::size_t k = 0; k < corners.size(); k += 3) {
      float numbers[12] = {};
      for (int c = 0; c < 3; ++c)
        for (int d = 0; d < 3; ++d) numbers[3 + 3 * c + d] = static_cast<float>(corners[k + c][d]);
      file.write(reinterpret_cast<const char*>(numbers), 48).write("\0", 2);
    }
  }
  CHECK(read_stl(path, 0.5, surface).empty());
  CHECK(surface->volume() == Approx(ascii).epsilon(1e-6));
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 7);
  CHECK(read_stl(path, 1, surface).find("its header says 512 triangles") != std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST_CASE("ESRI ASCII grids are read, and what is wrong with one is told", "[ground]") {
  const auto folder = std::filesystem::temp_directory_path() / ("mpm_grid_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const std::string path = folder / "grid.asc";
  Raster raster;
  const auto read = [&](const std::string& text) {
    std::ofstream(path) << text;
    return read_raster(path, raster);
  };
  const auto wrong = [&](const std::string& text, const char* part) {
    const std::string fault = read(text);
    CAPTURE(text, fault);
    CHECK(fault.find(part) != std::string::npos);
  };
  const std::string head = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\n";
  CHECK(read(head + "NODATA_value -1\n1 2 3\n4 -1 6\n").empty());
  CHECK((raster.columns == 3 && raster.rows == 2 && raster.x == 10 && raster.y == 20 && raster.cell == 2));
  CHECK((raster.values[0] == 4 && raster.values[5] == 3 && std::isnan(raster.values[1])));
  CHECK(read("NCOLS 3\r\nNROWS 2\r\nXLLCENTER 10\r\nYLLCENTER 20\r\nCELLSIZE 2\r\n1 2 3\r\n4 5e0 +6").empty());
  CHECK((raster.x == 9 && raster.y == 19 && raster.values[2] == 6));
  wrong("", "header has ncols");
  wrong("ncols 3\nnrows 2\ncellsize 1\n1 2 3 4 5 6", "xllcorner or xllcenter");
  wrong("ncols 3\nncols 2\n", "line 2 takes ncols and a number, once");
  wrong("ncols x\n", "line 1 takes ncols and a number");
  wrong("ncols 2.5\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4 5", "whole numbers");
  wrong("ncols 1000000000\nnrows 1000000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1", "as many values as its header says");
  wrong("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0\n1 2 3 4 5 6", "cellsize is greater than 0");
  wrong(head + "1 2 3\n4 5\n   ", "number 3 of row 2");
  wrong(head + "1 2 3\n4 x 6\n", "number 2 of row 2, line 7, is none");
  wrong(head + "1 2 3\n4 nan 6\n", "number 2 of row 2");
  wrong(head + "1 2 3\n4 5 6 7\n", "line 7 has more");
  std::filesystem::remove_all(folder);
}

TEST_CASE("surfaces that do not cover the mesh, have holes, or cross are found", "[ground]") {
  const auto mesh = mesh_of({0, 0, 0}, {4, 4, 4}, 0.5);
  const auto flat = [](double, double) { return 1.0; };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  CHECK(fault_of(*raster(0, 0, 1, 4, 4, flat), mesh, 3).empty());
  CHECK(has(fault_of(*raster(0, 0, 1, 4, 3, flat), mesh, 3), "covers the mesh, in y from 0 to 4; it has 0 to 3"));
  CHECK(has(fault_of(*raster(1, 0, 1, 4, 4, flat), mesh, 3), "in x from 0 to 4; it has 1 to 5"));
  CHECK(has(fault_of(*polyline({0, 3}, {1, 1}), mesh_of({0, 0}, {4, 4}, 0.5), 2), "in x from 0 to 4"));
  const auto hole = [](double x, double y) { return x < 1 && y < 1 ? NAN : 1.0; };
  CHECK(has(fault_of(*raster(0, 0, 1, 4, 4, hole), mesh, 3), "no-data in the mesh; there is some at 0,0"));
  CHECK(fault_of(*raster(-2, -2, 1, 6, 6, [](double x, double y) { return x < -1 && y < -1 ? NAN : 1.0; }), mesh, 3)
            .empty());
  CHECK(has(fault_of(*level(5), mesh, 3), "in the mesh, from 0 to 4; it is at 5"));
  const auto slope = raster(0, 0, 1, 4, 4, [](double x, double) { return x / 2; });
  const auto crossing = crossing_of(*slope, *level(1), mesh, 3);
  REQUIRE(crossing);
  CHECK((crossing->x <= 0.5 && crossing->height == Approx(0.75)));
  CHECK_FALSE(crossing_of(*slope, *slope, mesh, 3));
  CHECK_FALSE(crossing_of(*slope, *level(0.25), mesh, 3));
}

TEST_CASE("two million triangles are checked and cut", "[ground][.long]") {
  const auto mesh = mesh_of({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 0.05);
  const Shape shape = stl(ball({0, 0, 0}, 1.3, 9));
  REQUIRE(shape.triangles->size() == 2097152);
  CHECK(fault_of(*shape.triangles).empty());
  CHECK(Moments(filled(shape, mesh, 3)).volume == Approx(k_ball * std::pow(1.3, 3)).epsilon(1e-5));
}
