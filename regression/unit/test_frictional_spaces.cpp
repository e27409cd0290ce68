// tresca, mohr_coulomb and drucker_prager on every back end, and in lanes of a processor.

#include <catch2/catch_test_macros.hpp>

#include "clouds.hpp"
#include "element.hpp"
#include "law_lanes.hpp"
#include "loops/cpu/host_particles.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

const Values k_clay_values{{"young", 5e5}, {"poisson", 0.45}, {"su", 1000}, {"tension", 300}};
const Values k_sand_values{{"young", 1e6},       {"poisson", 0.3},    {"cohesion", 1000},
                           {"friction_deg", 35}, {"dilation_deg", 8}, {"tension", 700}};

/// Stresses after a step on Space: those of `start`, strained by `by`.
template <class Space, class Law, int Dim>
std::vector<SymTensor<typename Law::real, Dim>> after_step(const Law& law, const std::vector<Sym>& start,
                                                           const std::vector<Sym>& by) {
  using T = typename Law::real;
  using Stress = SymTensor<T, Dim>;
  const int n = static_cast<int>(start.size());
  const Kokkos::View<Stress*, typename Space::memory_space> stress("test", n), strain("test", n);
  const auto host_stress = Kokkos::create_mirror_view(stress),
             host_strain = Kokkos::create_mirror_view(strain);
  for (int p = 0; p < n; ++p)
    for (int k = 0; k < sym_size<Dim>; ++k) {
      host_stress(p)[k] = static_cast<T>(start[p][k]);
      host_strain(p)[k] = static_cast<T>(by[p][k]);
    }
  Kokkos::deep_copy(stress, host_stress);
  Kokkos::deep_copy(strain, host_strain);
  const T second = static_cast<T>(law.initial_state({})[1]);
  Kokkos::parallel_for(
      "test::laws", Kokkos::RangePolicy<Space>(0, n), KOKKOS_LAMBDA(int p) {
        LawState<T, state_size<Law>> state{{0, second}};
        Increment<T, T, Dim> increment{};
        increment.strain = strain(p);
        law.update(stress(p), state, increment);
      });
  Kokkos::deep_copy(host_stress, stress);
  return {host_stress.data(), host_stress.data() + n};
}

/// Checks stresses on a back end against the reference (a processor, double precision, 3D).
template <class B, template <class> class Law>
void check_on(const Values& values) {
  using T = typename B::real;
  Dice dice{std::mt19937_64(7)};
  std::vector<Sym> start, by;
  for (int p = 0; p < 20000; ++p) {
    start.push_back(random_sym(dice, 3000, B::dim == 2));
    by.push_back(random_sym(dice, 5e-3, B::dim == 2));
    if (B::dim == 2) by.back()[2] = 0;
  }
  const auto right = after_step<Processor, Law<double>, 3>(law_of<Law<double>>(values), start, by);
  const auto got = after_step<typename B::Space, Law<T>, B::dim>(law_of<Law<T>>(values), start, by);
  double apart = 0;
  for (std::size_t p = 0; p < got.size(); ++p)
    for (int k = 0; k < sym_size<B::dim>; ++k)
      apart = std::fmax(apart, std::fabs(double(got[p][k]) - right[p][k]));
  INFO(B::name() << " " << Law<T>::k_name);
  CHECK(apart < B::of(1e-9, 0.05));
}

/// Random stresses after a step in lanes, where all yield or only some, are those of the particles one by
/// one.
template <template <class> class Law>
void check_all_lanes(const Values& values) {
  for_each_lanes([&](auto real, auto dimension) {
    using T = decltype(real);
    using Particle = Point<Law<T>, dimension.value>;
    const auto law = law_of<Law<T>>(values);
    const LanesApart apart = lanes_apart<T, dimension.value>(
        law, 8, 2000, 0, [&](Dice&, const Sym& start) { return Particle(law, start); },
        [](const Particle& after) { return after.state[0] > 0; });
    INFO(Law<T>::k_name << " " << dimension.value << "D, lanes " << native_lanes<T>);
    CHECK(apart.stress < (sizeof(T) == sizeof(double) ? 1e-10 : 0.05));
    CHECK(1e6 * apart.state < (sizeof(T) == sizeof(double) ? 1e-10 : 0.05));
    CHECK(apart.counted > apart.particles / 5);
    CHECK(apart.counted < apart.particles * 9 / 10);
  });
}

/// The parameters of sand, with a cone.
Values cone_values() {
  Values cone = k_sand_values;
  cone.push_back({"match", DruckerPrager<double>::compression});
  return cone;
}

}  // namespace

TEST_CASE("every back end returns random stresses to the same point", "[frictional_laws]") {
  for_each_build([](auto build) {
    check_on<decltype(build), Tresca>(k_clay_values);
    check_on<decltype(build), MohrCoulomb>(k_sand_values);
    check_on<decltype(build), DruckerPrager>(cone_values());
  });
}

TEST_CASE("particles many at once yield as one by one", "[frictional_laws]") {
  check_all_lanes<Tresca>(k_clay_values);
  check_all_lanes<MohrCoulomb>(k_sand_values);
  check_all_lanes<DruckerPrager>(cone_values());
}
