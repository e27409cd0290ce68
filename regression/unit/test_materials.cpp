// The constitutive laws at a point, on paths of strain with a known end, and the table of materials.

#include <array>
#include <catch2/catch_test_macros.hpp>

#include "clouds.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_young = 1.5e6, k_poisson = 0.49, k_su = 3000, k_pi = 3.14159265358979323846;
const double k_shear = shear_modulus_of(k_young, k_poisson);

AnyMaterial<double> elastic() { return make_material<double>(0, {k_young, k_poisson}); }
AnyMaterial<double> clay() { return make_material<double>(1, {k_young, k_poisson, k_su, 0, 0}); }

/// One step of a path of strain.
template <class T, int Dim>
struct PathStep {
  SymTensor<T, Dim> strain;
  Spin<T, Dim> spin;
};

/// Stress and state at a point; the state is that of clay.
template <class T, int Dim>
struct PointState {
  SymTensor<T, Dim> stress;
  T plastic_strain, strength;
};

/// Calls f(law, state) with the law of a material and its state at a point.
template <class T, int Dim, class F>
KOKKOS_INLINE_FUNCTION void with_state(const AnyMaterial<T>& material, PointState<T, Dim>& point,
                                       const F& f) {
  material.visit([&](const auto& law) {
    LawState<T, state_size<std::decay_t<decltype(law)>>> state{};
    constexpr int k_values = 2;  // none has its own Young's modulus
    T* const values[k_values] = {&point.plastic_strain, &point.strength};
    for (int k = 0; k < state.size && k < k_values; ++k) state[k] = *values[k];
    f(law, state);
    for (int k = 0; k < state.size && k < k_values; ++k) *values[k] = state[k];
  });
}

template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void follow_step(const AnyMaterial<T>& material, PointState<T, Dim>& point,
                                        const PathStep<T, Dim>& step) {
  const Increment<T, T, Dim> by{step.strain, step.spin, {}, T(1), T(0)};
  with_state(material, point, [&](const auto& law, auto& state) { law.update(point.stress, state, by); });
}

/// From a velocity gradient times dt.
template <int Dim>
PathStep<double, Dim> increment_of(const double (&L)[Dim][Dim]) {
  PathStep<double, Dim> step{};
  for (int i = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) step.strain[sym_index<Dim>(i, j)] = (L[i][j] + L[j][i]) / 2;
  step.spin.c[0] = (L[0][1] - L[1][0]) / 2;
  if constexpr (Dim == 3) step.spin.c[1] = (L[1][2] - L[2][1]) / 2, step.spin.c[2] = (L[2][0] - L[0][2]) / 2;
  return step;
}

/// States after each step of a path.
template <class T, int Dim>
std::vector<PointState<T, Dim>> follow(const AnyMaterial<T>& material, PointState<T, Dim> state,
                                       const std::vector<PathStep<T, Dim>>& path) {
  std::vector<PointState<T, Dim>> states;
  for (const auto& step : path) {
    follow_step(material, state, step);
    states.push_back(state);
  }
  return states;
}

/// n equal steps of one velocity gradient; the last state.
template <int Dim>
PointState<double, Dim> after(const AnyMaterial<double>& material, const SymTensor<double, Dim>& stress,
                              const double (&total)[Dim][Dim], int n) {
  double L[Dim][Dim];
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) L[i][j] = total[i][j] / n;
  const std::vector<PathStep<double, Dim>> path(n, increment_of<Dim>(L));
  return follow<double, Dim>(material, {stress, 0, k_su}, path).back();
}

template <class T, int Dim>
double second_invariant(const SymTensor<T, Dim>& s) {
  const double mean = (double(s[0]) + s[1] + s[2]) / 3;
  double j2 = 0;
  for (int k = 0; k < sym_size<Dim>; ++k)
    j2 += k < 3 ? (s[k] - mean) * (s[k] - mean) / 2 : double(s[k]) * s[k];
  return j2;
}

/// The last state of a path that is followed on Space.
template <class Space, class T, int Dim>
PointState<T, Dim> last_on(const AnyMaterial<T>& material, const std::vector<PathStep<T, Dim>>& path,
                           T strength) {
  using Memory = typename Space::memory_space;
  const Kokkos::View<PathStep<T, Dim>*, Memory> steps("test", path.size());
  const Kokkos::View<const PathStep<T, Dim>*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged> host(path.data(),
                                                                                               path.size());
  Kokkos::deep_copy(steps, host);
  const Kokkos::View<PointState<T, Dim>, Memory> out("test");
  Kokkos::parallel_for(
      "test::path", Kokkos::RangePolicy<Space>(0, 1), KOKKOS_LAMBDA(int) {
        PointState<T, Dim> state{{}, 0, strength};
        for (std::size_t n = 0; n < steps.extent(0); ++n) follow_step(material, state, steps(n));
        out() = state;
      });
  return Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), out)();
}

/// A random path of strain and spin, well beyond yield.
template <class T, int Dim>
std::vector<PathStep<T, Dim>> random_path(int seed, int n, double size) {
  Dice dice{std::mt19937_64(seed)};
  std::vector<PathStep<T, Dim>> path(n);
  for (auto& step : path) {
    for (auto& e : step.strain.c) e = static_cast<T>(dice.uniform(-size, size));
    if (Dim == 2) step.strain[2] = 0;
    for (auto& w : step.spin.c) w = static_cast<T>(dice.uniform(-size, size));
  }
  return path;
}

}  // namespace

TEST_CASE("a material keeps every parameter of its model's table, in its order", "[materials]") {
  const auto elastic_law = make_material<double>(0, {1e6, 0.3});
  REQUIRE(elastic_law.which == 0);
  const auto& e = *reinterpret_cast<const LinearElastic<double>*>(elastic_law.bytes);
  CHECK(std::array{e.young, e.poisson} == std::array{1e6, 0.3});
  const auto clay_law = make_material<float>(1, {2e6, 0.4, 3000, 1500, -2});
  REQUIRE(clay_law.which == 1);
  const auto& c = *reinterpret_cast<const VonMises<float>*>(clay_law.bytes);
  CHECK(std::array{c.young, c.poisson, c.su, c.su_gradient, c.su_datum} ==
        std::array{2e6f, 0.4f, 3000.f, 1500.f, -2.f});
  const auto names = material_models();
  REQUIRE(names.size() == static_cast<std::size_t>(Materials::k_size));
  CHECK(std::string(names[0]) == "linear_elastic");
  CHECK(std::string(names[1]) == "von_mises");
  CHECK_THROWS(make_material<double>(1, {2e6, 0.4}));
}

TEST_CASE("the wave modulus is lambda + 2 G", "[materials]") {
  // The footing's clay: 25.67 MPa, which gives its time step.
  CHECK(std::fabs(wave_modulus(clay()) / 25.67e6 - 1) < 1e-3);
  CHECK(std::fabs(wave_modulus(elastic()) /
                      (k_young * (1 - k_poisson) / ((1 + k_poisson) * (1 - 2 * k_poisson))) -
                  1) < 1e-14);
}

TEST_CASE("stiffness in proportion to strength: both grow with depth, their ratio stays", "[materials]") {
  constexpr double k_rigidity = 500;
  const auto law = make_material<double>(1, {0, k_poisson, 2000, 500, 4, k_rigidity});
  for (const double height : {10., 4., 1., -2.}) {
    const double strength = strength_at(law, height), young = k_rigidity * strength;
    const auto same = make_material<double>(1, {young, k_poisson, strength});
    CHECK(std::fabs(wave_modulus(law, height) / wave_modulus(same) - 1) < 1e-14);
    const auto energy = [&](const AnyMaterial<double>& material) {
      double stored = 0;
      PointState<double, 2> point{{-1000, 300, -200, 500}, 0, strength};
      with_state(material, point,
                 [&](const auto& model, auto& state) { stored = model.stored_energy(point.stress, state); });
      return stored;
    };
    CHECK(std::fabs(energy(law) / energy(same) - 1) < 1e-14);
    for_each_build([&](auto build) {
      using B = decltype(build);
      using T = typename B::real;
      const auto path = random_path<T, B::dim>(17, 200, 1e-3);
      const auto grown = make_material<T>(1, {0, k_poisson, 2000, 500, 4, k_rigidity});
      const auto plain = make_material<T>(1, {young, k_poisson, strength});
      const auto ours = follow<T, B::dim>(grown, {{}, 0, T(strength)}, path).back(),
                 theirs = follow<T, B::dim>(plain, {{}, 0, T(strength)}, path).back();
      CHECK(theirs.plastic_strain > 0.01);
      CHECK(std::fabs(double(ours.plastic_strain) / theirs.plastic_strain - 1) < B::of(1e-12, 1e-4));
      for (int k = 0; k < sym_size<B::dim>; ++k)
        CHECK(std::fabs(double(ours.stress[k]) - theirs.stress[k]) < B::of(1e-9, 0.1) * strength);
    });
  }
}

TEST_CASE("strength grows with depth below its datum only", "[materials]") {
  const auto law = make_material<double>(1, {k_young, k_poisson, 2000, 500, 4});
  CHECK(strength_at(law, 10) == 2000);
  CHECK(strength_at(law, 4) == 2000);
  CHECK(strength_at(law, 1) == 3500);
  CHECK(strength_at(law, -2) == 5000);
  CHECK(strength_at(elastic(), -2) == 0);
}

TEST_CASE("one full rigid turn about any axis gives the stress back", "[materials]") {
  const double L2[2][2] = {{0, -2 * k_pi}, {2 * k_pi, 0}};
  for (const auto& law : {elastic(), clay()}) {
    const auto turned = after<2>(law, {1000, 0, 300, 0}, L2, 10000).stress;
    CHECK(std::fabs(turned[0] / 1000 - 1) < 1e-6);
    CHECK(std::fabs(turned[1]) < 1e-3);
    CHECK(std::fabs(turned[2] - 300) < 1e-9);
    CHECK(std::fabs(turned[3]) < 1e-3);
    for (int axis = 0; axis < 3; ++axis) {
      const int i = (axis + 1) % 3, j = (axis + 2) % 3;
      double L3[3][3] = {};
      L3[i][j] = -2 * k_pi, L3[j][i] = 2 * k_pi;
      SymTensor<double, 3> start{};
      start[i] = 1000, start[axis] = 300;
      const auto end = after<3>(law, start, L3, 10000).stress;
      INFO("about axis " << axis);
      for (int k = 0; k < 6; ++k) CHECK(std::fabs(end[k] - start[k]) < 1e-3);
    }
  }
}

TEST_CASE("a quarter turn moves sxx to syy", "[materials]") {
  const double L2[2][2] = {{0, -k_pi / 2}, {k_pi / 2, 0}};
  const auto turned = after<2>(elastic(), {1000, 0, 0, 0}, L2, 1000).stress;
  CHECK(std::fabs(turned[1] - 1000) < 1e-2);
  CHECK(std::fabs(turned[0]) < 1e-2);
  const double L3[3][3] = {
      {0, 0, 0}, {0, 0, -k_pi / 4}, {0, k_pi / 4, 0}};  // an eighth, about x: y to between y and z
  const auto eighth = after<3>(elastic(), {0, 1000, 0, 0, 0, 0}, L3, 1000).stress;
  CHECK(std::fabs(eighth[1] - 500) < 1e-2);
  CHECK(std::fabs(eighth[2] - 500) < 1e-2);
  CHECK(std::fabs(eighth[4] - 500) < 1e-2);
}

TEST_CASE("elastic simple shear follows sin and 1 - cos of the Jaumann rate", "[materials]") {
  const double L2[2][2] = {{0, 2}, {0, 0}};
  const auto sheared = after<2>(elastic(), {}, L2, 10000).stress;
  CHECK(std::fabs(sheared[3] / k_shear - std::sin(2.)) < 1e-3);
  CHECK(std::fabs(sheared[0] / k_shear - (1 - std::cos(2.))) < 1e-3);
  CHECK(std::fabs(sheared[1] / k_shear + (1 - std::cos(2.))) < 1e-3);
  const double L3[3][3] = {{0, 0, 0}, {0, 0, 2}, {0, 0, 0}};  // in the yz plane
  const auto in_3d = after<3>(elastic(), {}, L3, 10000).stress;
  CHECK(std::fabs(in_3d[4] / k_shear - std::sin(2.)) < 1e-3);
  CHECK(std::fabs(in_3d[1] / k_shear - (1 - std::cos(2.))) < 1e-3);
}

TEST_CASE("von Mises yields in simple shear at su, and its plastic shear strain is the rest", "[materials]") {
  const double L2[2][2] = {{0, 0.1}, {0, 0}};
  const auto state = after<2>(clay(), {}, L2, 10000);
  CHECK(std::fabs(state.stress[3] / k_su - 1) < 1e-4);
  CHECK(std::fabs(state.plastic_strain / (0.1 - k_su / k_shear) - 1) < 1e-3);
}

TEST_CASE("von Mises yields in plane-strain compression at su, with szz between the others", "[materials]") {
  const double L2[2][2] = {{-0.05, 0}, {0, 0.05}};
  const auto s = after<2>(clay(), {}, L2, 10000).stress;
  CHECK(std::fabs((s[1] - s[0]) / 2 / k_su - 1) < 1e-4);
  CHECK(std::fabs(s[2] - (s[0] + s[1]) / 2) < 1e-4 * k_su);
}

TEST_CASE("confined compression gives the wave modulus times the strain", "[materials]") {
  const double L2[2][2] = {{0, 0}, {0, -0.01}};
  const auto s = after<2>(elastic(), {}, L2, 100).stress;
  CHECK(std::fabs(s[1] / (-0.01 * wave_modulus(elastic())) - 1) < 1e-12);
  CHECK(std::fabs(s[0] / s[1] - k_poisson / (1 - k_poisson)) < 1e-12);
}

TEST_CASE("no path of strain leaves the yield surface, and plastic strain never falls", "[materials]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    using T = typename B::real;
    const auto law = make_material<T>(1, {k_young, k_poisson, k_su, 0, 0});
    const auto path = random_path<T, B::dim>(31, 5000, 2e-3);
    double largest = 0, plastic = 0;
    int fell = 0;
    for (const auto& state : follow<T, B::dim>(law, {{}, 0, T(k_su)}, path)) {
      largest = std::max(largest, std::sqrt(second_invariant<T, B::dim>(state.stress)));
      fell += state.plastic_strain < plastic;
      plastic = state.plastic_strain;
    }
    INFO(build.name());
    CHECK(largest / k_su <
          1 + B::of(1e-12, 1e-4));  // in single the pressure, 100 su here, hides some of the shear
    CHECK(largest / k_su > 0.99);
    CHECK(fell == 0);
    CHECK(plastic > 0);
  });
}

TEST_CASE("a particle's own strength decides, not the model's", "[materials]") {
  const double L2[2][2] = {{0, 0.1}, {0, 0}};
  const std::vector<PathStep<double, 2>> path(1000, increment_of<2>({{0, L2[0][1] / 1000}, {0, 0}}));
  for (double strength : {500., 9000.})
    CHECK(std::fabs(follow<double, 2>(clay(), {{}, 0, strength}, path).back().stress[3] / strength - 1) <
          1e-3);
}

TEST_CASE("3D equals 2D plane strain for the same increments", "[materials]") {
  for (const auto& law : {elastic(), clay()}) {
    const auto path_2d = random_path<double, 2>(32, 2000, 1e-3);
    std::vector<PathStep<double, 3>> path_3d;
    for (const auto& step : path_2d)
      path_3d.push_back({{step.strain[0], step.strain[1], 0, step.strain[3], 0, 0}, {step.spin.c[0], 0, 0}});
    const auto flat = follow<double, 2>(law, {{}, 0, k_su}, path_2d).back();
    const auto deep = follow<double, 3>(law, {{}, 0, k_su}, path_3d).back();
    for (int k = 0; k < 4; ++k) CHECK(std::fabs(flat.stress[k] - deep.stress[k]) < 1e-9 * k_su);
    CHECK(std::fabs(deep.stress[4]) + std::fabs(deep.stress[5]) < 1e-12 * k_su);
    CHECK(std::fabs(flat.plastic_strain - deep.plastic_strain) < 1e-12);
  }
}

TEST_CASE("3D treats its axes alike", "[materials]") {
  const auto path = random_path<double, 3>(33, 500, 1e-3);
  std::vector<PathStep<double, 3>> turned;  // x to y, y to z, z to x
  for (const auto& s : path)
    turned.push_back({{s.strain[2], s.strain[0], s.strain[1], s.strain[5], s.strain[3], s.strain[4]},
                      {s.spin.c[2], s.spin.c[0], s.spin.c[1]}});
  const auto a = follow<double, 3>(clay(), {{}, 0, k_su}, path).back().stress;
  const auto b = follow<double, 3>(clay(), {{}, 0, k_su}, turned).back().stress;
  const int to[] = {1, 2, 0, 4, 5, 3};
  for (int k = 0; k < 6; ++k) CHECK(std::fabs(a[k] - b[to[k]]) < 1e-8 * k_su);
}

TEST_CASE("every backend and real type follows a path of strain to the same stress", "[materials]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    using T = typename B::real;
    constexpr int Dim = B::dim;
    for (int model : {0, 1}) {
      const std::vector<double> parameters =
          model == 0 ? std::vector<double>{k_young, 0.3} : std::vector<double>{k_young, 0.3, k_su, 0, 0};
      const auto path = random_path<double, Dim>(34, 100, 1e-3);
      std::vector<PathStep<T, Dim>> own(path.size());
      for (std::size_t n = 0; n < path.size(); ++n) {
        for (int k = 0; k < sym_size<Dim>; ++k) own[n].strain[k] = static_cast<T>(path[n].strain[k]);
        for (std::size_t k = 0; k < std::size(path[n].spin.c); ++k)
          own[n].spin.c[k] = static_cast<T>(path[n].spin.c[k]);
      }
      const auto expected =
          follow<double, Dim>(make_material<double>(model, parameters), {{}, 0, k_su}, path).back().stress;
      const auto got =
          last_on<typename B::Space, T, Dim>(make_material<T>(model, parameters), own, T(k_su)).stress;
      double scale = 0, difference = 0;
      for (int k = 0; k < sym_size<Dim>; ++k) {
        scale = std::max(scale, std::fabs(expected[k]));
        difference = std::max(difference, std::fabs(got[k] - expected[k]));
      }
      INFO(build.name() << " model " << model);
      CHECK(difference < B::of(1e-12, 1e-5) * scale);
    }
  });
}
