// Faults of surfaces of the ground, and of their files.

#include <hdf5.h>
#include <unistd.h>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "ground_shapes.hpp"
#include "input/files/field_file.hpp"
#include "input/files/stl_file.hpp"
#include "input/geometry/cut_cells.hpp"

using namespace mpm;
using namespace mpm::test;
using Catch::Approx;

namespace {

/// A folder of this test alone.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("mpm_ground_" + std::to_string(getpid()));
  Folder() { std::filesystem::create_directory(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

/// Writes a dataset of doubles with the attributes lower and spacing, where they have numbers.
void write_field(const std::string& path, const char* name, const std::vector<hsize_t>& sizes,
                 const std::vector<double>& values, const std::vector<double>& lower,
                 const std::vector<double>& spacing) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr);
  const hid_t data = H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  const auto attribute = [&](const char* key, const std::vector<double>& numbers) {
    if (numbers.empty()) return;
    const hsize_t count = numbers.size();
    const hid_t row = H5Screate_simple(1, &count, nullptr);
    const hid_t item = H5Acreate2(data, key, H5T_NATIVE_DOUBLE, row, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(item, H5T_NATIVE_DOUBLE, numbers.data());
    H5Aclose(item), H5Sclose(row);
  };
  attribute("lower", lower), attribute("spacing", spacing);
  H5Dclose(data), H5Sclose(space), H5Fclose(file);
}

}  // namespace

TEST_CASE("surfaces that are not closed, face inwards or cross themselves are refused", "[ground]") {
  const auto fault = [](Corners corners) { return fault_of(TriangleSurface(corners)); };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
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
  const Folder folder;
  const std::string path = folder.path / "ball.stl";
  const Corners corners = ball({0, 0, 0}, 1, 3);
  std::shared_ptr<const TriangleSurface> surface;
  {
    std::ofstream file(path);
    file << "solid facet vertex of a name\n";
    file.precision(17);
    for (std::size_t k = 0; k < corners.size(); k += 3) {
      file << "  facet normal 0 0 0\n outer loop\n";
      for (int c = 0; c < 3; ++c)
        file << "  vertex " << corners[k + c][0] << ' ' << corners[k + c][1] << ' ' << corners[k + c][2]
             << '\n';
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
}

TEST_CASE("OBJ files are read: faces of more corners, numbers of textures, vertices from the last one back",
          "[ground]") {
  const Folder folder;
  const std::string path = folder.path / "cube.OBJ";
  const auto read = [&](const std::string& faces, std::shared_ptr<const TriangleSurface>& surface) {
    std::ofstream(path) << "# a cube\no cube\nv 0 0 0\nv 2 0 0 1.0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 "
                           "2 2\nv 0 2 2\nvn 0 0 1\n"
                        << faces;
    return read_stl(path, 0.5, surface);
  };
  std::shared_ptr<const TriangleSurface> cube;
  const std::string five =
      "f 1/1 4/2 3/3 2/4\r\nf 5//1 6//1 7//1 8//1\nf 1/1/1 2/2/1 6/3/1 5/4/1\nf 2 3 7 6\nf 3 4 8 7\n";
  CHECK(read(five + "f -5 -8 -4 -1\n", cube).empty());
  REQUIRE(cube);
  CHECK(cube->size() == 12);
  CHECK(cube->vertices() == 8);
  CHECK(cube->volume() == Approx(1));
  CHECK(read(five, cube).find("4 of its edges") != std::string::npos);  // open
  CHECK(read("f 1 2 9\n", cube).find("line 12 takes numbers of the 8 vertices before it") !=
        std::string::npos);
  CHECK(read("f 1 2\n", cube).find("line 12 takes 3 numbers or more") != std::string::npos);
  CHECK(read("", cube).find("faces (f)") != std::string::npos);
}

TEST_CASE("ESRI ASCII grids are read, and faults of one are reported", "[ground]") {
  const Folder folder;
  const std::string path = folder.path / "grid.asc";
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
  CHECK(
      read("NCOLS 3\r\nNROWS 2\r\nXLLCENTER 10\r\nYLLCENTER 20\r\nCELLSIZE 2\r\n1 2 3\r\n4 5e0 +6").empty());
  CHECK((raster.x == 9 && raster.y == 19 && raster.values[2] == 6));
  wrong("", "header has ncols");
  wrong("ncols 3\nnrows 2\ncellsize 1\n1 2 3 4 5 6", "xllcorner or xllcenter");
  wrong("ncols 3\nncols 2\n", "line 2 takes ncols and a number, once");
  wrong("ncols x\n", "line 1 takes ncols and a number");
  wrong("ncols 2.5\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4 5", "whole numbers");
  wrong("ncols 1000000000\nnrows 1000000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1",
        "as many values as its header says");
  wrong("ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0\n1 2 3 4 5 6", "cellsize is greater than 0");
  wrong(head + "1 2 3\n4 5\n   ", "number 3 of row 2");
  wrong(head + "1 2 3\n4 x 6\n", "number 2 of row 2, line 7, is none");
  wrong(head + "1 2 3\n4 nan 6\n", "number 2 of row 2");
  wrong(head + "1 2 3\n4 5 6 7\n", "line 7 has more");
}

TEST_CASE("surfaces that do not cover the mesh, have holes, or cross are found", "[ground]") {
  const auto mesh = mesh_of({0, 0, 0}, {4, 4, 4}, 0.5);
  const auto flat = [](double, double) { return 1.0; };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  CHECK(fault_of(*raster(0, 0, 1, 4, 4, flat), mesh, 3).empty());
  CHECK(has(fault_of(*raster(0, 0, 1, 4, 3, flat), mesh, 3),
            "covers the mesh, in y from 0 to 4; it has 0 to 3"));
  CHECK(has(fault_of(*raster(1, 0, 1, 4, 4, flat), mesh, 3), "in x from 0 to 4; it has 1 to 5"));
  CHECK(has(fault_of(*polyline({0, 3}, {1, 1}), mesh_of({0, 0}, {4, 4}, 0.5), 2), "in x from 0 to 4"));
  const auto hole = [](double x, double y) { return x < 1 && y < 1 ? NAN : 1.0; };
  CHECK(has(fault_of(*raster(0, 0, 1, 4, 4, hole), mesh, 3), "no-data in the mesh; there is some at 0,0"));
  CHECK(fault_of(*raster(-2, -2, 1, 6, 6, [](double x, double y) { return x < -1 && y < -1 ? NAN : 1.0; }),
                 mesh, 3)
            .empty());
  CHECK(has(fault_of(*level(5), mesh, 3), "in the mesh, from 0 to 4; it is at 5"));
  const auto slope = raster(0, 0, 1, 4, 4, [](double x, double) { return x / 2; });
  const auto crossing = crossing_of(*slope, *level(1), mesh, 3);
  REQUIRE(crossing);
  CHECK((crossing->x <= 0.5 && crossing->height == Approx(0.75)));
  CHECK_FALSE(crossing_of(*slope, *slope, mesh, 3));
  CHECK_FALSE(crossing_of(*slope, *level(0.25), mesh, 3));
}

TEST_CASE("a field on a grid is linear between its points, and faults of one are reported", "[ground]") {
  const Folder folder;
  const std::string path = folder.path / "f.h5";
  const auto value = [](double x, double y, double z) { return 3 + x - 2 * y + 0.5 * z; };
  std::vector<double> numbers, plane;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i) numbers.push_back(value(1 + 0.5 * i, 2 + j, 2.0 * k));
  write_field(path, "su", {3, 4, 5}, numbers, {1, 2, 0}, {0.5, 1, 2});
  GridField field;
  REQUIRE(read_field(path, "su", 3, field).empty());
  CHECK((field.upper(0) == 3 && field.upper(1) == 5 && field.upper(2) == 4));
  for (const Vec3& x : {Vec3{1, 2, 0}, {3, 5, 4}, {1.7, 3.3, 2.9}, {2.25, 4.5, 0.1}})
    CHECK(field.at(x) == Approx(value(x[0], x[1], x[2])));
  CHECK(field.at({0, 0, -1}) == Approx(value(1, 2, 0)));  // the nearest point beyond the grid
  CHECK(uncovered(field, {{1, 2, 0}, {3, 5, 4}}, 1e-9).empty());
  CHECK(uncovered(field, {{1, 2, 0}, {3, 5, 4.5}}, 1e-9).find("in z from 0 to 4.5; it has 0 to 4") !=
        std::string::npos);
  const auto wrong = [&](const char* key, int dim, const char* part) {
    const std::string fault = read_field(path, key, dim, field);
    CAPTURE(fault);
    CHECK(fault.find(part) != std::string::npos);
  };
  wrong("cohesion", 3, "a file with the dataset cohesion");
  wrong("su", 2, "a grid of numbers with 2 axes");
  write_field(path, "su", {3, 4, 5}, numbers, {1, 2, 0}, {});
  wrong("su", 3, "the attributes lower and spacing, 3 numbers in m each");
  write_field(path, "su", {3, 4, 5}, numbers, {1, 2, 0}, {0.5, 0, 1});
  wrong("su", 3, "the spacing greater than 0");
  numbers[7] = NAN;
  write_field(path, "su", {3, 4, 5}, numbers, {1, 2, 0}, {0.5, 1, 2});
  wrong("su", 3, "finite; value 8 is not");
  std::ofstream(path) << "no HDF5";
  wrong("su", 3, "an HDF5 file that can be read");
}
