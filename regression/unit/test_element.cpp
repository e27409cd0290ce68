// A single material point: the file of its path, and the solver that finds strains for stresses.

#include <unistd.h>

#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/material_table.hpp"
#include "element/drive.hpp"
#include "element/least_squares.hpp"
#include "element/path_file.hpp"
#include "element/sum.hpp"
#include "element/table.hpp"

using namespace mpm;

namespace {

/// A path file with this text; it goes with the object.
struct File {
  std::string path =
      std::filesystem::temp_directory_path() / ("mpm_path_" + std::to_string(::getpid()) + ".csv");
  explicit File(const std::string& text) { std::ofstream(path) << text; }
  ~File() { std::filesystem::remove(path); }
};

/// Elastic in bulk; the shear stress xy is a saturating function of its strain, sxy = limit tanh(G e /
/// limit).
PointLaw saturating(double bulk, double shear, double limit) {
  return {[=](const PointState& point, const PointIncrement& by) {
            PointState next = point;
            const double dilatation = by.strain[0] + by.strain[1] + by.strain[2];
            for (int k = 0; k < 3; ++k)
              next.stress[k] += bulk * dilatation + 2 * shear * (by.strain[k] - dilatation / 3);
            next.state[0] += by.strain[3];
            next.stress[3] = limit * std::tanh(shear * next.state[0] / limit);
            return next;
          },
          [](const PointState& point) { return point.state[0] > 1; },
          [=](const PointState&) { return bulk + 4 * shear / 3; }};
}

ElementRow row_of(std::array<Drive, 6> drive, Sym6 value, double dt = 1) {
  return {.line = 2, .dt = dt, .drive = drive, .value = value};
}

constexpr Drive k_e = Drive::strain, k_t = Drive::total_strain, k_s = Drive::stress;

}  // namespace

TEST_CASE("a path has total strains, increments of strain and of stress", "[element]") {
  const File file(
      "\xef\xbb\xbf# a comment\n time , exx,deyy,dezz,dszz,sxx,xi\r\n\n1,0.5,,0,,-1e3,0.25\r\n"
      "3,0.6,1e-3,,-7,nonsense,\n");
  ElementConfig path;
  CHECK(read_path(file.path, state_variables("von_mises"), path).find("finite numbers; in line 5 sxx") == 0);
  const File right(
      "time,exx,deyy,dezz,dszz,sxx,xi\n1,0.5,,0,,-1e3,0.25\n3,0.6,1e-3,,-7,9,\n4,0.4,-1e-3,2e-3,,9,\n");
  path = {};
  REQUIRE(read_path(right.path, state_variables("von_mises"), path).empty());
  CHECK(path.time == 1);
  CHECK(path.timed);
  CHECK(path.stress == Sym6{-1e3, 0, 0, 0, 0, 0});
  REQUIRE(path.state.size() == 1);
  CHECK(path.state[0] == std::pair{0, 0.25});
  REQUIRE(path.rows.size() == 2);
  CHECK(path.rows[0].dt == 2);
  CHECK(path.rows[0].drive == std::array{k_t, k_e, k_s, k_e, k_e, k_e});
  CHECK(std::fabs(path.rows[0].value[0] - 0.1) < 1e-15);  // since the start
  CHECK(path.rows[0].value[2] == -7);
  CHECK(path.rows[1].drive[2] == k_e);
  CHECK(path.rows[1].line == 4);
}

TEST_CASE("the least squares of a step", "[element]") {
  const std::vector<double> a{4, 1, 0, 1, 3, 1, 0, 1, 2}, b{1, 2, 3};
  const auto x = damped_least_squares(a, b, 0);
  for (int i = 0; i < 3; ++i)
    CHECK(std::fabs(a[3 * i] * x[0] + a[3 * i + 1] * x[1] + a[3 * i + 2] * x[2] - b[i]) < 1e-14);
  const auto shorter = damped_least_squares(a, b, 1), none = damped_least_squares(a, b, 1e12);
  CHECK(std::hypot(shorter[0], shorter[1], shorter[2]) < std::hypot(x[0], x[1], x[2]));
  CHECK(std::hypot(none[0], none[1], none[2]) < 1e-10);
  const auto flat = damped_least_squares({1, 0, 0, 0}, {2, 5}, 0);  // a column of zeros
  CHECK(flat[0] == 2);
  CHECK(flat[1] == 0);
  // damping of one unknown: x = a b / (a^2 + damping a^2)
  CHECK(std::fabs(damped_least_squares({2}, {6}, 0.5)[0] - 2) < 1e-14);
}

TEST_CASE("strains are found for stresses, over many orders of the stiffness", "[element]") {
  const double bulk = 1e7, shear = 3e6, limit = 1e4;
  const PointLaw law = saturating(bulk, shear, limit);
  DrivenPoint point{.now = {.stress = {-5e4, -5e4, -5e4}, .state = {0}}};
  // uniaxial strain of yy, the sides at constant stress, and the shear stress near its limit
  const auto row = row_of({k_s, k_e, k_s, k_s, k_e, k_e}, {0, -1e-3, 0, 0.999 * limit, 0, 0});
  REQUIRE(drive_row(law, row, 10, 1e-10, point).empty());
  CHECK(std::fabs(point.now.stress[0] + 5e4) < 1e-4);
  CHECK(std::fabs(point.now.stress[2] + 5e4) < 1e-4);
  CHECK(std::fabs(point.now.stress[3] - 0.999 * limit) < 1e-4);
  CHECK(std::fabs(point.strain[3] * shear / limit - std::atanh(0.999)) < 1e-3);
  const double young = 9 * bulk * shear / (3 * bulk + shear),
               poisson = (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear);
  CHECK(std::fabs((point.now.stress[1] + 5e4) / (-1e-3 * young) - 1) < 1e-8);
  CHECK(std::fabs(point.strain[0] / (1e-3 * poisson) - 1) < 1e-6);
  CHECK(std::fabs(point.strain[1] + 1e-3) < 1e-15);
  CHECK(point.time == 1);
}

TEST_CASE("a stress that the law does not bear is reported with its residual", "[element]") {
  const double limit = 1e4;
  const PointLaw law = saturating(1e7, 3e6, limit);
  DrivenPoint point{.now = {.state = {0}}};
  const std::string why =
      drive_row(law, row_of({k_e, k_e, k_e, k_s, k_e, k_e}, {0, 0, 0, 1.5 * limit, 0, 0}), 10, 1e-9, point);
  CHECK(why.find("no strain increment was found that brings sxy to") == 0);
  CHECK(why.find("residual") != std::string::npos);
  CHECK(std::fabs(point.now.stress[3]) <= limit);
}

TEST_CASE("a law that fails is reported", "[element]") {
  const PointLaw law = saturating(1e7, 3e6, 1e4);
  DrivenPoint point{.now = {.state = {0}}};
  const auto row = row_of({k_e, k_e, k_e, k_e, k_e, k_e}, {0, 0, 0, 1.5, 0, 0});
  CHECK(drive_row(law, row, 40, 1e-9, point).find("the law fails") == 0);
}

TEST_CASE("rows of stress do not drift, and a total strain is reached whatever came before", "[element]") {
  const PointLaw law = saturating(1e7, 3e6, 1e4);
  DrivenPoint point{.now = {.stress = {-1e5, -1e5, -1e5}, .state = {0}}};
  const auto back_and_forth = [&](double by) {
    REQUIRE(drive_row(law, row_of({k_s, k_s, k_s, k_e, k_e, k_e}, {by, by / 2, 0, 0, 0, 0}), 3, 1e-3, point)
                .empty());
  };
  for (int n = 0; n < 200; ++n) back_and_forth(n % 2 == 0 ? -3e3 : 3e3);
  for (int k = 0; k < 3; ++k)
    CHECK(std::fabs(point.now.stress[k] + 1e5) < 250);  // one tolerance, not two hundred
  REQUIRE(
      drive_row(law, row_of({k_t, k_t, k_t, k_t, k_e, k_e}, {1e-3, 0, 0, 0, 0, 0}), 3, 1e-9, point).empty());
  CHECK(point.strain == Sym6{1e-3, 0, 0, 0, 0, 0});
}

TEST_CASE("sums of stresses and of strains are governed", "[element]") {
  const double bulk = 1e7, shear = 3e6;
  const PointLaw law = saturating(bulk, shear, 1e4);
  constexpr Drive k_f = Drive::free;
  const std::vector<ElementSum> sums = {*parse_sum("dsxx+dsyy+dszz"), *parse_sum("dsxx - dszz"),
                                        *parse_sum("2*deyy-4*dexx")};
  DrivenPoint point{.now = {.stress = {-4e4, -7e4, -4e4}, .state = {0}}};
  // yy strained at a constant mean stress: no volume, and the sides alike
  ElementRow row = row_of({k_f, k_e, k_f, k_e, k_e, k_e}, {0, -1e-3, 0, 0, 0, 0});
  row.sums = {0.0, 0.0, std::nullopt};
  REQUIRE(drive_row(law, row, 3, 1e-10, point, sums).empty());
  CHECK(std::fabs(point.strain[0] - 5e-4) < 1e-10);
  CHECK(std::fabs(point.strain[2] - 5e-4) < 1e-10);
  CHECK(std::fabs(point.now.stress[1] + 7e4 + 2 * shear * 1e-3) < 1e-4);
  CHECK(std::fabs(point.now.stress[0] + point.now.stress[1] + point.now.stress[2] + 15e4) < 1e-4);
  // a stress, a sum of stresses and a sum of strains together
  const Sym6 before = point.strain;
  row = row_of({k_f, k_s, k_f, k_e, k_e, k_e}, {0, -500, 0, 0, 0, 0});
  row.sums = {-1500.0, std::nullopt, 1e-4};
  REQUIRE(drive_row(law, row, 3, 1e-10, point, sums).empty());
  CHECK(std::fabs(point.now.stress[0] + point.now.stress[1] + point.now.stress[2] + 15e4 + 1500) < 1e-3);
  CHECK(std::fabs(2 * (point.strain[1] - before[1]) - 4 * (point.strain[0] - before[0]) - 1e-4) < 1e-10);
  const double volume = -500 / bulk;  // yy takes a third of the change of the sum: no deviator of yy
  CHECK(std::fabs(point.strain[1] - before[1] - volume / 3) < 1e-10);
  // back and forth without drift
  for (int n = 0; n < 200; ++n) {
    row.sums = {n % 2 == 0 ? 3000.0 : -3000.0, std::nullopt, 0.0};
    row.value[1] = n % 2 == 0 ? 1000 : -1000;
    REQUIRE(drive_row(law, row, 2, 1e-3, point, sums).empty());
  }
  CHECK(std::fabs(point.now.stress[0] + point.now.stress[1] + point.now.stress[2] + 15e4 + 1500) < 500);
}

TEST_CASE("a sum that the law does not bear is reported by its name", "[element]") {
  const PointLaw law = saturating(1e7, 3e6, 1e4);
  DrivenPoint point{.now = {.state = {0}}};
  ElementRow row = row_of({k_e, k_e, k_e, Drive::free, k_e, k_e}, {});
  row.sums = {3e4};
  const std::string why = drive_row(law, row, 10, 1e-9, point, {*parse_sum("2*dsxy")});
  CHECK(why.find("no strain increment was found that brings 2*sxy to") == 0);
}

TEST_CASE("the names of sums", "[element]") {
  const auto sum = parse_sum("-dsyy + 1e-3*dsxx-0.5*dszz");
  REQUIRE(sum);
  CHECK(sum->weight == Sym6{1e-3, -1, -0.5, 0, 0, 0});
  CHECK(!sum->of_strain);
  CHECK(sum->name == "-dsyy+1e-3*dsxx-0.5*dszz");
  CHECK(parse_sum("dexx+deyy+dezz")->of_strain);
  for (const char* name : {"", "dsxx+deyy", "dsxx+", "dsxxdsyy", "0*dsxx", "dsxx-dsxx", "sxx+syy",
                           "dsxx+2dsyy", "*dsxx", "x*dsxx", "dsab", "dsxx*2", "1e9*dsxx", "+", "time"})
    CHECK(!parse_sum(name));
}

TEST_CASE("rows govern as many sums as they leave components free", "[element]") {
  const auto fault_of = [](const std::string& text) {
    const File file(text);
    ElementConfig path;
    const std::string fault = read_path(file.path, state_variables("von_mises"), path);
    return fault.empty() && path.rows.back().drive[0] != Drive::free ? "xx is not free" : fault;
  };
  CHECK(fault_of("deyy,dsxx+dsyy+dszz,dsxx-dszz\n,,\n1e-3,5,0\n").empty());
  CHECK(fault_of("deyy,dexx,dsxx+dsyy\n,,\n1e-3,,0\n").empty());
  CHECK(fault_of("deyy,dsxx+dsyy+dszz\n,\n1e-3,5\n").find("as many numbers of sums as components") == 0);
  CHECK(fault_of("dexx,dsxx+dsyy\n,\n1e-3,\n").find("xx is not free") == 0);
  CHECK(fault_of("dexx,deyy,dsxx+dsyy\n,,\n1e-3,0,5\n").find("as many numbers of sums") == 0);
  CHECK(fault_of("dsxx+dszz,2*dsxx+2*dszz\n,\n1,2\n").find("stresses and sums of which none follows") == 0);
  CHECK(fault_of("dsyy,dsyy+dsxx,dsyy-dszz,dsxx+dszz\n,,,\n1,2,3,\n").empty());
  CHECK(fault_of("dsyy,dsyy+dsxx,dsyy-dszz\n,,\n1,2,\n").empty());
  CHECK(fault_of("deyy,dsxx+dsyy\n,3\n1e-3,5\n").find("row 0 without increments") == 0);
}

TEST_CASE("the table of a point", "[element]") {
  const auto state = state_variables("softening_clay");
  CHECK(element_header(state).find("time,sxx,syy,szz,sxy,syz,szx,plastic_strain,") == 0);
  DrivenPoint point{
      .now = {.stress = {1, 2, 3, 4, 5, 6}, .state = {0.5, 7, 8, 9}}, .strain = {0.1}, .time = 2};
  CHECK(element_line(state, point) == "2,1,2,3,4,5,6,0.5,9,0.1,0,0,0,0,0\n");
}
