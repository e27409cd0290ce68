// cam_clay and softening_clay on every back end, and a law that calls the state of a particle a failure.

#include <algorithm>
#include <catch2/catch_test_macros.hpp>
#include <string>

#include "compare.hpp"
#include "element.hpp"
#include "physics/materials/cam_clay.hpp"
#include "physics/materials/softening_clay.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const Values k_cam_clay{{"critical_state_ratio", 1}, {"lambda", 0.2}, {"kappa", 0.04},      {"poisson", 0.25},
                        {"specific_volume", 2},      {"ocr", 1.2},    {"pressure_min", 100}};
const Values k_softening{{"young", 5e5},           {"poisson", 0.45}, {"su", 1000},
                         {"remoulded_ratio", 0.2}, {"xi95", 10},      {"rate_factor", 0.1},
                         {"rate_reference", 1e-3}};

/// A particle's stress [Pa] and state.
template <class Law, int Dim>
struct Particle {
  SymTensor<typename Law::real, Dim> stress, strain;
  LawState<typename Law::real, state_size<Law>> state;
};

/// Particles after ten steps on Space: those of `start`, strained by `by` in each.
template <class Space, class Law, int Dim>
std::vector<Particle<Law, Dim>> after_steps(const Law& law, const std::vector<Sym>& start,
                                            const std::vector<Sym>& by) {
  using T = typename Law::real;
  const int n = static_cast<int>(start.size());
  const Kokkos::View<Particle<Law, Dim>*, typename Space::memory_space> particles("test", n);
  const auto host = Kokkos::create_mirror_view(particles);
  for (int p = 0; p < n; ++p) {
    const Point<Law, Dim> point(law, start[p]);
    host(p).stress = point.stress, host(p).state = point.state;
    for (int k = 0; k < sym_size<Dim>; ++k) host(p).strain[k] = static_cast<T>(by[p][k]);
  }
  Kokkos::deep_copy(particles, host);
  Kokkos::parallel_for(
      "test::laws", Kokkos::RangePolicy<Space>(0, n), KOKKOS_LAMBDA(int p) {
        Increment<T, T, Dim> increment{};
        increment.strain = particles(p).strain;
        increment.dt = T(1e-3);
        for (int step = 0; step < 10; ++step) law.update(particles(p).stress, particles(p).state, increment);
      });
  Kokkos::deep_copy(host, particles);
  return {host.data(), host.data() + n};
}

/// Checks stresses and states against the reference (a processor, double precision, 3D).
template <class B, template <class> class Law>
void check_on(const Values& values, double pressure) {
  using T = typename B::real;
  Dice dice{std::mt19937_64(9)};
  std::vector<Sym> start, by;
  for (int p = 0; p < 5000; ++p) {
    start.push_back(random_sym(dice, 1000, B::dim == 2));
    for (int k = 0; k < 3; ++k) start.back()[k] -= pressure;
    by.push_back(random_sym(dice, 4e-4, B::dim == 2));
    if (B::dim == 2) by.back()[2] = 0;
  }
  const auto right = after_steps<Processor, Law<double>, 3>(law_of<Law<double>>(values), start, by);
  const auto got = after_steps<typename B::Space, Law<T>, B::dim>(law_of<Law<T>>(values), start, by);
  double apart = 0;
  for (std::size_t p = 0; p < got.size(); ++p) {
    for (int k = 0; k < sym_size<B::dim>; ++k)
      apart = std::fmax(apart, std::fabs(double(got[p].stress[k]) - right[p].stress[k]) / 3000);
    apart =
        std::fmax(apart, std::fabs(got[p].state[0] - right[p].state[0]) / std::fmax(1, right[p].state[0]));
  }
  INFO(B::name() << " " << Law<T>::k_name);
  CHECK(apart < B::of(1e-10, 2e-4));
}

int index_of(const std::string& model) {
  const auto models = material_models();
  const auto found = std::find_if(models.begin(), models.end(), [&](const char* m) { return model == m; });
  REQUIRE(found != models.end());
  return static_cast<int>(found - models.begin());
}

/// Control block after steps of two particles of cam_clay apart from each other, the second with this
/// specific volume.
template <class B>
Control control_with(double specific_volume) {
  constexpr int Dim = B::dim;
  constexpr double k_spacing = 0.1;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({24, 20, 16}, k_spacing, Wall::free);
  cloud.materials = {{0, {1e5, 0.3}}, {index_of("cam_clay"), {1, 0.2, 0.04, 0.3, 0, 2, 1.5}}};
  cloud.bodies = {body_of<Dim>(lattice<Dim>({8, 8, 8}, {10, 10, 10}, 2, k_spacing), 2, k_spacing, 0)};
  for (const double v : {2.0, specific_volume}) {
    auto body = body_of<Dim>(
        lattice<Dim>({v == 2 ? 2. : 15., 12, 8}, {v == 2 ? 4. : 17., 14, 10}, 2, k_spacing), 2, k_spacing, 1);
    const std::size_t count = body.position.size() / Dim;
    body.stress.assign(count * sym_size<Dim>, 0.0);
    for (std::size_t p = 0; p < count; ++p)
      for (int k = 0; k < 3; ++k) body.stress[p * sym_size<Dim> + k] = -1e4;
    body.state = {{"", std::vector<double>(count, 2e4)},
                  {"", std::vector<double>(count, v)},
                  {"", std::vector<double>(count)},
                  {"", std::vector<double>(count)}};
    cloud.bodies.push_back(body);
  }
  auto s = state_of<B>(cloud);
  one_step(s, 1e-6);
  one_step(s, 1e-6);
  return read_control(s);
}

}  // namespace

TEST_CASE("every back end strains the clays to the same state", "[clay_laws]") {
  for_each_build([](auto build) {
    check_on<decltype(build), CamClay>(k_cam_clay, 3000);
    check_on<decltype(build), SofteningClay>(k_softening, 0);
    Values hexagon = k_softening;
    hexagon.push_back({"surface", SofteningClay<double>::tresca});
    check_on<decltype(build), SofteningClay>(hexagon, 0);
  });
}

TEST_CASE("a particle whose law calls its state a failure stops the run", "[clay_laws]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    CHECK(control_with<B>(1.5).fault_count == 0);
    const Control control = control_with<B>(1.01);
    const int each = B::dim == 2 ? 16 : 64;
    CHECK(control.fault_count == each);
    CHECK(control.fault.kind == FaultKind::law);
    CHECK(control.fault.particle >= 2 * each);
    CHECK(control.fault.particle < 3 * each);
    CHECK(control.steps == 1);
    CHECK(std::fabs(control.fault.position[0] - 1.6) < 0.11);
  });
  CHECK(std::string(failure_of(index_of("cam_clay"))).find("specific volume") != std::string::npos);
  CHECK(std::string(failure_of(index_of("softening_clay"))).empty());
}
