// The utility routines that UMATs call, against the tensors of the program.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include <catch2/catch_test_macros.hpp>

#include "element.hpp"
#include "physics/materials/principal.hpp"
#include "physics/materials/umat.hpp"
#include "physics/materials/von_mises.hpp"

extern "C" {
void sinv_(const double*, double*, double*, const int*, const int*);
void sprinc_(const double*, double*, const int*, const int*, const int*);
void sprind_(const double*, double*, double*, const int*, const int*, const int*);
void rotsig_(const double*, const double*, double*, const int*, const int*, const int*);
void xit_();
void getjobname_(char*, int*, std::size_t);
}

namespace mpm::test {
namespace {

constexpr int k_normal = 3, k_stress = 1, k_strain = 2;
constexpr int k_from[6] = {0, 1, 2, 3, 5, 4};  // place in xx yy zz xy yz zx of 11 22 33 12 13 23

/// Components in Abaqus' order; engineering shear strains where it is a strain.
std::array<double, 6> in_abaqus_order(const SymTensor<double, 3>& s, int kind) {
  std::array<double, 6> out{};
  for (int k = 0; k < 6; ++k) out[k] = (k > 2 && kind == k_strain ? 2 : 1) * s[k_from[k]];
  return out;
}

double matrix(const SymTensor<double, 3>& s, int i, int j) { return s[sym_index<3>(i, j)]; }

/// A random tensor; without the components 13 and 23 in 2D.
SymTensor<double, 3> random_tensor(Dice& dice, int shears) {
  SymTensor<double, 3> s;
  const Sym values = random_sym(dice, 1, shears == 1);
  for (int k = 0; k < 6; ++k) s[k] = values[k];
  return s;
}

/// A UMAT that the build has compiled: mpm_umat is inputs/umat/von_mises.c, mpm_umat_probe umat/probe.c. The
/// environment's MPM_UMATS names the folder where the program no longer lies by it
/// (scripts/site/bundle_launch).
std::shared_ptr<const UmatLibrary> library_of(const std::string& name, const std::string& properties, int dim,
                                              const std::array<double, 3>& lower = {}) {
  const char* elsewhere = std::getenv("MPM_UMATS");
  const std::string path = std::string(elsewhere != nullptr ? elsewhere : MPM_UMATS) + "/lib" + name + ".so";
  std::string key, takes;
  const auto library = open_umat("clay", {path, properties, ""}, dim, lower, 0.25, key, takes);
  if (library == nullptr) throw std::runtime_error(key + " takes " + takes);
  return library;
}

/// Largest difference of stress and plastic strain, each over its largest, of a path of random increments of
/// strain and spin from a random stress; `grown` adds the plastic strain.
template <int Dim>
double largest_misfit(const VonMises<double>& law, const Umat<double>& umat, Dice& dice, double& grown) {
  constexpr double k_size = 2000, k_strain_size = 2e-3;  // Pa, -
  const Sym start = random_sym(dice, k_size, Dim == 2);
  Point<VonMises<double>, Dim> own(law, start);
  Point<Umat<double>, Dim> user(umat, start);
  double worst = 0;
  for (int n = 0; n < 20; ++n) {
    Increment<double, double, Dim> by{};
    const Sym strain = random_sym(dice, k_strain_size, Dim == 2);
    for (int k = 0; k < sym_size<Dim>; ++k) by.strain[k] = strain[k];
    for (double& w : by.spin.c) w = dice.uniform(-0.1, 0.1);
    by.dt = 1e-3;
    int none = 0;
    by.clock = {0, by.dt, &none};
    own.law.update(own.stress, own.state, by);
    user.law.update(user.stress, user.state, by);
    for (int k = 0; k < sym_size<Dim>; ++k)
      worst = std::max(worst, std::fabs(own.stress[k] - user.stress[k]) / k_size);
    const double plastic = own.state[VonMises<double>::plastic_strain];
    worst = std::max(worst, std::fabs(plastic - user.state[Umat<double>::own]) / k_strain_size);
  }
  grown += own.state[VonMises<double>::plastic_strain];
  return worst;
}

}  // namespace

TEST_CASE("a UMAT of von Mises' clay follows random paths as the law does", "[umat]") {
  const auto law = law_of<VonMises<double>>({{"young", 1e6}, {"poisson", 0.4}, {"su", 1000}});
  Dice dice{std::mt19937_64(23)};
  double worst = 0, grown = 0;
  auto umat = law_of<Umat<double>>({{"states", 1}});
  const auto plane = library_of("mpm_umat", "1e6,0.4,1000", 2),
             space = library_of("mpm_umat", "1e6,0.4,1000", 3);
  for (int n = 0; n < 500; ++n) {
    umat.object = plane.get();
    worst = std::max(worst, largest_misfit<2>(law, umat, dice, grown));
    umat.object = space.get();
    worst = std::max(worst, largest_misfit<3>(law, umat, dice, grown));
  }
  CHECK(worst < 1e-12);
  CHECK(grown > 1);
}

TEST_CASE("a UMAT is given strains, rotation and place of a particle in Abaqus' conventions", "[umat]") {
  Dice dice{std::mt19937_64(24)};
  const auto library = library_of("mpm_umat_probe", "1e6,0.3", 3, {10, 20, 30});
  auto umat = law_of<Umat<double>>({{"states", 38}});
  umat.object = library.get();
  for (int n = 0; n < 200; ++n) {
    Point<Umat<double>, 3> point(umat, random_sym(dice, 1000, false));
    Increment<double, double, 3> by{};
    int none = 0;
    by.dt = 0.5, by.clock = {3, by.dt, &none};
    for (auto& row : by.gradient)
      for (double& g : row) g = dice.uniform(-0.1, 0.1);
    for (int k = 0; k < 6; ++k) by.strain[k] = dice.uniform(-1e-2, 1e-2);
    for (double& w : by.spin.c) w = dice.uniform(-0.5, 0.5);
    const auto before = point.stress;
    umat.update(point.stress, point.state, by, {.id = 6, .position = {1, 2, 3}});
    const auto given = [&](int k) { return point.state[Umat<double>::own + k]; };
    double q[3][3], worst = 0;
    rotation_of(by.spin, q);
    const auto strain = in_abaqus_order(by.strain, k_strain);
    for (int k = 0; k < 6; ++k) worst = std::max(worst, std::fabs(given(15 + k) - strain[k]));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        worst = std::max(worst, std::fabs(given(6 + i + 3 * j) - q[i][j]));
        worst = std::max(worst, std::fabs(given(26 + i + 3 * j) - (i == j) - by.dt * by.gradient[i][j]));
      }
    CHECK(worst < 1e-15);
    auto wanted = rotated(before, by.spin);
    add_elastic(wanted, by.strain, lame_of(1e6, 0.3), shear_modulus_of(1e6, 0.3));
    for (int k = 0; k < 6; ++k) CHECK(std::fabs(point.stress[k] - wanted[k]) < 1e-9);
    const double numbers[] = {7, 3, 0.5, 11, 22, 33};
    for (int k = 0; k < 6; ++k) CHECK(given(k) == numbers[k]);
    CHECK(given(21) == 6);
    CHECK(given(22) == 0.25);
    CHECK(given(23) == 7);  // KINC
    CHECK(given(24) == 'C');
    const double modulus = lame_of(1e6, 0.3) + 2 * shear_modulus_of(1e6, 0.3);
    CHECK(std::fabs(umat.wave_modulus(point.stress, point.state) / modulus - 1) < 1e-15);
  }
}

TEST_CASE("SINV, SPRINC and SPRIND give invariants, principal values and directions", "[umat]") {
  Dice dice{std::mt19937_64(21)};
  for (int n = 0; n < 2000; ++n) {
    const int shears = n % 2 ? 3 : 1, kind = n % 4 < 2 ? k_stress : k_strain;
    const auto s = random_tensor(dice, shears);
    const auto given = in_abaqus_order(s, kind);
    double values[3], same[3], axes[3][3];  // axes[i][k]: component i of direction k
    sprinc_(given.data(), values, &kind, &k_normal, &shears);
    sprind_(given.data(), same, &axes[0][0], &kind, &k_normal, &shears);
    CHECK(values[0] >= values[1]);
    CHECK(values[1] >= values[2]);
    double worst = 0;
    for (int k = 0; k < 3; ++k) {
      CHECK(values[k] == same[k]);
      for (int l = 0; l < 3; ++l) {
        double product = 0, residual = -values[k] * axes[l][k];
        for (int i = 0; i < 3; ++i)
          product += axes[i][k] * axes[i][l], residual += matrix(s, l, i) * axes[i][k];
        worst = std::max({worst, std::fabs(product - (k == l)), std::fabs(residual)});
      }
    }
    CHECK(worst < 1e-14);
    if (kind == k_strain) continue;
    double mean = 0, mises = 0;
    sinv_(given.data(), &mean, &mises, &k_normal, &shears);
    CHECK(std::fabs(mean - mean_of(s)) < 1e-15);
    CHECK(std::fabs(mises - std::sqrt(3 * second_invariant(s, mean_of(s)))) < 1e-14);
  }
}

TEST_CASE("ROTSIG with DROT turns as the stress of a law turns", "[umat]") {
  Dice dice{std::mt19937_64(22)};
  for (int n = 0; n < 1000; ++n) {
    const int shears = n % 2 ? 3 : 1, kind = n % 4 < 2 ? k_stress : k_strain;
    Spin<double, 3> spin{};
    for (int k = 0; k < (shears == 1 ? 1 : 3); ++k) spin.c[k] = dice.uniform(-1, 1);
    double q[3][3], columns[9], turned[6];
    rotation_of(spin, q);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) columns[i + 3 * j] = q[i][j];
    const auto s = random_tensor(dice, shears);
    rotsig_(in_abaqus_order(s, kind).data(), columns, turned, &kind, &k_normal, &shears);
    const auto wanted = in_abaqus_order(rotated(s, spin), kind);
    for (int k = 0; k < k_normal + shears; ++k) CHECK(std::fabs(turned[k] - wanted[k]) < 1e-14);
    if (shears > 1) continue;
    const auto plane = rotated(SymTensor<double, 2>{s[0], s[1], s[2], s[3]}, Spin<double, 2>{spin.c[0]});
    for (int k = 0; k < 4; ++k)
      CHECK(std::fabs(turned[k] - (k == 3 && kind == k_strain ? 2 : 1) * plane[k]) < 1e-14);
  }
}

TEST_CASE("XIT leaves a UMAT by an exception, and texts of Fortran are filled with blanks", "[umat]") {
  CHECK_THROWS_AS(xit_(), UmatExit);
  char name[8];
  int length = 0;
  getjobname_(name, &length, sizeof name);
  CHECK(length == 3);
  CHECK(std::string(name, sizeof name) == "mpm     ");
}

TEST_CASE("the state variables of a UMAT are numbered, and as many are carried as it has", "[umat]") {
  const auto table = Umat<double>::state();
  CHECK(std::string(table[Umat<double>::own].name) == "state_1");
  CHECK(std::string(table[Umat<double>::own + 9].name) == "state_10");
  CHECK(std::string(table.back().name) == "state_64");
  const auto models = material_models();
  const auto place = std::find(models.begin(), models.end(), std::string("umat")) - models.begin();
  for (const int states : {0, 1, 64})
    CHECK(state_variables(static_cast<int>(place), {double(states), 0, 0}).size() ==
          std::size_t(Umat<double>::own + states));
}

}  // namespace mpm::test
