// Domains of particles that follow the soil.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "physics/advance.hpp"
#include "physics/stretch_domain.hpp"
#include "rebuild/batches.hpp"
#include "transfer/measure.hpp"
#include "transfer/save_state.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_dt = 1e-4;      // s
constexpr double k_least = 0.1;    // cells, of half lengths
constexpr double k_single = 6e-8;  // share of a half length: its root is of single precision

template <int Dim>
using Square = std::array<std::array<double, Dim>, Dim>;

template <int Dim>
Square<Dim> unit() {
  Square<Dim> a{};
  for (int d = 0; d < Dim; ++d) a[d][d] = 1;
  return a;
}
template <int Dim>
Square<Dim> product(const Square<Dim>& a, const Square<Dim>& b) {
  Square<Dim> c{};
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      for (int k = 0; k < Dim; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

/// The increment of a velocity gradient L [1/s] over dt [s]; `more` is added to its dilatation (F-bar).
template <class R, int Dim>
Increment<R, double, Dim> increment(const Square<Dim>& L, double dt, double more = 0) {
  R gradient[Dim][Dim];
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) gradient[i][j] = L[i][j];
  auto by = increment_of<R, double, Dim>(gradient, dt, Clock{});
  for (int d = 0; d < 3; ++d) by.strain[d] += more / 3;
  return by;
}

/// The square of half length l after `steps` steps under L, up to the time `end` [s].
template <int Dim>
DomainMoments<double, Dim> stretched(DomainMoments<double, Dim> m, const Square<Dim>& L, double end,
                                     int steps) {
  for (int n = 0; n < steps; ++n) stretch_domain(m, increment<double, Dim>(L, end / steps));
  return m;
}

/// F M F^T.
template <int Dim>
DomainMoments<double, Dim> deformed(const DomainMoments<double, Dim>& m, const Square<Dim>& F) {
  Square<Dim> whole, transposed;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) whole[i][j] = m[moment_index<Dim>(i, j)], transposed[i][j] = F[j][i];
  const Square<Dim> after = product<Dim>(product<Dim>(F, whole), transposed);
  DomainMoments<double, Dim> out;
  for (int i = 0; i < Dim; ++i)
    for (int j = i; j < Dim; ++j) out[moment_index<Dim>(i, j)] = after[i][j];
  return out;
}

template <int Dim>
double largest_apart(const DomainMoments<double, Dim>& a, const DomainMoments<double, Dim>& b) {
  double largest = 0;
  for (int k = 0; k < Dim * (Dim + 1) / 2; ++k) largest = std::max(largest, std::fabs(a[k] - b[k]));
  return largest;
}

/// A velocity gradient that turns the plane of the first two axes by `angle` in 1 s.
template <int Dim>
Square<Dim> spin(double angle) {
  Square<Dim> L{};
  L[0][1] = -angle, L[1][0] = angle;
  return L;
}

/// Two bodies that move, strain and have domains of their own.
template <int Dim>
Cloud cloud_with_domains(int seed) {
  constexpr double k_spacing = 0.1;  // m
  Dice dice{std::mt19937_64(seed)};
  Cloud cloud;
  cloud.grid = grid_of<Dim>({18, 12, 9}, k_spacing, Wall::roller);
  cloud.materials = clays();
  cloud.gravity = {0, -10, -5};
  cloud.f_bar_fraction = 0.9;
  for (const int n : {2, 3}) {
    const double from = n == 2 ? 2 : 8;
    cloud.bodies.push_back(
        body_of<Dim>(lattice<Dim>({from, 2, 2}, {from + 6, 10, 6}, n, k_spacing), n, k_spacing, n - 2));
    BodyInput& body = cloud.bodies.back();
    for (std::size_t k = 0; k < body.position.size(); ++k)
      body.particle_velocity.push_back(dice.uniform(-1, 1));
    for (std::size_t k = 0; k < strength_of(body).size() * sym_size<Dim>; ++k)
      body.stress.push_back(dice.uniform(-300, 300));
  }
  give_own_domains<Dim>(cloud, seed);
  return cloud;
}

void choose_update(Cloud& cloud, int kind) {
  if (kind == 1) cloud.xpic_order = 3, cloud.flip_fraction = 0;
  if (kind == 2) cloud.affine = true, cloud.flip_fraction = 0;
}

/// The moments of all particles, by id.
template <class S>
Table domains_of_soil(const S& s) {
  return by_id(s.soil.points, s.soil.points.domain);
}

}  // namespace

TEST_CASE("a domain deforms to the parallelogram of its deformation gradient", "[domain]") {
  for_each_reference([](auto build) {
    constexpr int Dim = decltype(build)::dim;
    Dice dice{std::mt19937_64(4)};
    for (int path = 0; path < 20; ++path) {
      Square<Dim> L;
      for (auto& row : L)
        for (double& value : row) value = dice.uniform(-0.5, 0.5);
      Square<Dim> F = unit<Dim>(), term = unit<Dim>();  // exp(L)
      for (int n = 1; n < 30; ++n) {
        term = product<Dim>(term, L);
        for (int i = 0; i < Dim; ++i)
          for (int j = 0; j < Dim; ++j) F[i][j] += (term[i][j] /= n);
      }
      const auto square = square_domain<double, Dim>(0.25);
      const double coarse = largest_apart(stretched<Dim>(square, L, 1, 50), deformed<Dim>(square, F)),
                   fine = largest_apart(stretched<Dim>(square, L, 1, 100), deformed<Dim>(square, F));
      CHECK(fine < 1e-5);
      CHECK(fine < coarse / 3.5);  // of second order
    }
  });
}

TEST_CASE("a domain turns with the soil: stretched, it lies along its soil", "[domain]") {
  for_each_reference([](auto build) {
    constexpr int Dim = decltype(build)::dim;
    const double pi = std::acos(-1.0);
    const auto square = square_domain<double, Dim>(0.25);
    CHECK(largest_apart(stretched<Dim>(square, spin<Dim>(2 * pi), 1, 1000), square) < 1e-6);
    Square<Dim> stretch = unit<Dim>();
    stretch[0][0] = 1.6, stretch[1][1] = 0.8;
    const auto longer = deformed<Dim>(square, stretch);
    const auto quarter = half_lengths_of(stretched<Dim>(longer, spin<Dim>(pi / 2), 1, 1000), k_least);
    CHECK(std::fabs(quarter[0] - 0.2) < 1e-6);
    CHECK(std::fabs(quarter[1] - 0.4) < 1e-6);
    const auto eighth = half_lengths_of(stretched<Dim>(longer, spin<Dim>(pi / 4), 1, 1000), k_least);
    CHECK(std::fabs(eighth[0] - eighth[1]) < 1e-6);
    CHECK(std::fabs(eighth[0] - std::sqrt((0.16 + 0.04) / 2)) < 1e-6);
    if (Dim == 3) CHECK(std::fabs(quarter[Dim - 1] - 0.25) < 1e-12);
    // Sheared along an axis, rows keep their distance, and the domain its height.
    Square<Dim> shear{};
    shear[0][1] = 1;
    const auto moments = stretched<Dim>(square, shear, 1.5, 1000);
    const auto sheared = half_lengths_of(moments, k_least);
    const double exact = 0.25 * std::sqrt(1 + 1.5 * 1.5);
    CHECK(std::fabs(sheared[1] - 0.25) < 1e-12);
    CHECK(std::fabs(std::sqrt(moments[0]) - exact) < 1e-9);
    CHECK(std::fabs(sheared[0] - exact) < k_single * exact);
    CHECK(std::fabs(2 * sheared[0].l * sheared[0].inverse - 1) < 1e-13);
  });
}

TEST_CASE("the dilatation of a domain is that of the particle's volume", "[domain]") {
  for_each_reference([](auto build) {
    constexpr int Dim = decltype(build)::dim;
    auto m = square_domain<double, Dim>(0.25);
    Square<Dim> L{};
    L[0][0] = 0.3, L[1][1] = -0.1;
    constexpr int k_steps = 200;
    constexpr double k_more = 2e-4;  // a step
    for (int n = 0; n < k_steps; ++n) stretch_domain(m, increment<double, Dim>(L, 1.0 / k_steps, k_more));
    double area = 1;
    const auto half = half_lengths_of(m, k_least);
    for (int d = 0; d < Dim; ++d) area *= half[d] / 0.25;
    CHECK(std::fabs(std::log(area) - (0.2 + k_steps * k_more)) < 1e-6);
  });
}

TEST_CASE("half lengths stay within their bounds, and moments those of a parallelogram, however soil flows",
          "[domain]") {
  for_each_reference([](auto build) {
    constexpr int Dim = decltype(build)::dim;
    Dice dice{std::mt19937_64(6)};
    auto m = square_domain<double, Dim>(0.25);
    for (int n = 0; n < 5000; ++n) {
      Square<Dim> L;
      for (auto& row : L)
        for (double& value : row) value = dice.uniform(-1, 1);
      stretch_domain(m, increment<double, Dim>(L, 0.1));
      const auto half = half_lengths_of(m, k_least);
      for (int i = 0; i < Dim; ++i) {
        REQUIRE((half[i] >= k_least && half[i] <= 0.5));
        REQUIRE((m[i] >= 1e-4 && m[i] <= 16));
        for (int j = i + 1; j < Dim; ++j)
          REQUIRE(std::fabs(m[moment_index<Dim>(i, j)]) <= std::sqrt(m[i] * m[j]) * (1 + 1e-12));
      }
    }
  });
}

TEST_CASE("soil that is pressed beyond the least half length and springs back has the domain that it had",
          "[domain]") {
  for_each_reference([](auto build) {
    constexpr int Dim = decltype(build)::dim;
    const auto square = square_domain<double, Dim>(0.25);
    Square<Dim> press{}, release{};
    press[1][1] = -1.5, release[1][1] = 1.5;
    const auto pressed = stretched<Dim>(square, press, 1, 500);
    CHECK(half_lengths_of(pressed, k_least)[1].l == double(float(k_least)));
    CHECK(largest_apart(stretched<Dim>(pressed, release, 1, 500), square) < 1e-6);
  });
}

TEST_CASE("lanes stretch domains as plain numbers do", "[domain]") {
  for_each_reference([](auto build) {
    constexpr int Dim = decltype(build)::dim;
    using R = Lanes<double, 4>;
    Square<Dim> L;
    Dice dice{std::mt19937_64(8)};
    for (auto& row : L)
      for (double& value : row) value = dice.uniform(-1, 1);
    DomainMoments<R, Dim> lanes{};
    DomainMoments<double, Dim> plain[4];
    for (int l = 0; l < 4; ++l) {
      plain[l] = square_domain<double, Dim>(0.1 + 0.1 * l);
      for (int k = 0; k < Dim * (Dim + 1) / 2; ++k) lanes[k].set(l, plain[l][k]);
    }
    for (int n = 0; n < 40; ++n) {
      stretch_domain(lanes, increment<R, Dim>(L, 0.02, 1e-3));
      for (auto& m : plain) stretch_domain(m, increment<double, Dim>(L, 0.02, 1e-3));
    }
    for (int l = 0; l < 4; ++l)
      for (int k = 0; k < Dim * (Dim + 1) / 2; ++k) CHECK(std::fabs(lanes[k][l] - plain[l][k]) < 1e-14);
  });
}

TEST_CASE("every strategy gives the nodal fields of the plain loop, whatever the domains", "[domain]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    for (const double margin : {0.5, 0.2}) {
      Cloud cloud = random_cloud<Dim>(2);
      cloud.p2g.margin = margin;
      give_own_domains<Dim>(cloud, 2);
      const auto fields = [&](auto s) {
        drift_within_margin(s);
        interpolate(s);
        return nodal_fields(s);
      };
      const auto expected = fields(state_of<Reference<Dim>>(cloud));
      double mass = 0, all = 0;
      for (const BodyInput& body : cloud.bodies)
        all += body.density * body.particle_volume * strength_of(body).size();
      for (std::size_t n = 0; n < expected[0].value.size(); n += expected[0].width)
        mass += expected[0].value[n];
      CHECK(std::fabs(mass / all - 1) < 1e-12);
      Cloud fixed = cloud;
      fixed.stretch = false;
      CHECK(largest_difference(fields(state_of<Reference<Dim>>(fixed)), expected) > 1e-3);  // they matter
      for_each_build([&](auto build) {
        using B = decltype(build);
        if constexpr (B::dim == Dim) {
          for (P2G how : k_strategies) {
            INFO(build.name() << ' ' << word_of(how) << " margin " << margin);
            CHECK(largest_difference(fields(state_of<B>(cloud, how)), expected) < B::of(1e-12, 1e-5));
          }
        }
      });
    }
  });
}

TEST_CASE("steps with stretching domains are those of the plain loop, by every strategy and velocity update",
          "[domain]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const int kind : {0, 1, 2}) {
      Cloud cloud = cloud_with_domains<B::dim>(6);
      choose_update(cloud, kind);
      auto plain = state_of<Reference<B::dim>>(cloud);
      const Table before = domains_of_soil(plain);
      run_steps(plain, k_dt, 6);
      CHECK(largest_difference(domains_of_soil(plain), before) > 1e-3);
      for (const P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        run_steps(s, k_dt, 6);
        INFO(B::name() << " " << word_of(how) << ", velocity update " << kind);
        CHECK(largest_difference(soil_fields(s), soil_fields(plain)) < B::of(1e-10, 2e-2));
        CHECK(largest_difference(domains_of_soil(s), domains_of_soil(plain)) < B::of(1e-10, 2e-2));
      }
    }
  });
}

TEST_CASE("soil that moves as one body keeps its domains, and steps as with fixed ones", "[domain]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = cloud_with_domains<B::dim>(7);
    cloud.gravity = {};
    for (BodyInput& body : cloud.bodies) {
      body.particle_velocity.clear(), body.stress.clear(), body.domain.clear();
      body.velocity = {0.7, -0.4, 0.2};
    }
    Cloud fixed = cloud;
    fixed.stretch = false;
    for (const P2G how : k_strategies) {
      auto s = state_of<B>(cloud, how), same = state_of<B>(fixed, how);
      const Table before = domains_of_soil(s);
      run_steps(s, k_dt, 50), run_steps(same, k_dt, 50);
      INFO(B::name() << " " << word_of(how));
      const Table after = domains_of_soil(s);
      double change = 0;  // cells2
      for (std::size_t n = 0; n < before.value.size(); ++n)
        change = std::max(change, std::fabs(after.value[n] - before.value[n]));
      CHECK(change < B::of(1e-12, 1e-4));
      CHECK(largest_difference(soil_fields(s)[0], soil_fields(same)[0]) < B::of(1e-12, 1e-5));
    }
  });
}

TEST_CASE("a stray that flies keeps its domain", "[domain]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud;
    cloud.grid = grid_of<Dim>({12, 12, 12}, 0.1, Wall::free);
    cloud.materials = clays();
    std::vector<double> place = {0.51, 0.52, 0.53};  // m
    place.resize(Dim);
    cloud.bodies = {body_of<Dim>(place, 2, 0.1, 0)};
    cloud.bodies[0].velocity = {0, -1, 0};
    cloud.gravity = {0, -10, 0};
    give_own_domains<Dim>(cloud, 1);
    for (const P2G how : k_strategies) {
      auto s = state_of<B>(cloud, how);
      const Table before = domains_of_soil(s);
      run_steps(s, k_dt, 20);
      INFO(B::name() << " " << word_of(how));
      CHECK(domains_of_soil(s) == before);
    }
  });
}

TEST_CASE("short domains slow the time step, and long ones no more than a lone particle", "[domain]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = cloud_with_domains<Dim>(3);
    const auto wave_at = [&](double along, double across) {
      for (BodyInput& body : cloud.bodies) {
        body.domain.clear();
        for (std::size_t p = 0; p < strength_of(body).size(); ++p) {
          DomainMoments<double, Dim> m = square_domain<double, Dim>(across);
          m[0] = along * along;
          body.domain.insert(body.domain.end(), m.c, m.c + Dim * (Dim + 1) / 2);
        }
      }
      auto s = state_of<B>(cloud);
      s.rim_scale = 1.0 / (4 * Dim);  // what squares of a quarter of a cell allow
      return fastest_wave(s);
    };
    const double square = wave_at(0.25, 0.25);
    CHECK(std::fabs(wave_at(0.1, 0.25) / square - std::sqrt((10.0 + 4 * (Dim - 1)) / (4 * Dim))) <
          2 * k_single);
    CHECK(std::fabs(wave_at(0.5, 0.25) / square - std::sqrt((6.0 + 4 * (Dim - 1)) / (4 * Dim))) < 1e-12);
    cloud.stretch = false;
    CHECK(wave_at(0.1, 0.1) == square);
  });
}

TEST_CASE("batches carry domains", "[domain]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    Cloud cloud = cloud_with_domains<B::dim>(8);
    const double spacing = cloud.grid.spacing;
    const auto& cells = cloud.grid.cells;
    cloud.bodies = {body_of<B::dim>(
        lattice<B::dim>({1, 1, 1}, {cells[0] - 1.0, cells[1] - 1.0, cells[2] - 1.0}, 2, spacing), 2, spacing,
        0)};
    give_own_domains<B::dim>(cloud, 8);
    auto whole = state_of<B>(cloud, P2G::tile);
    cloud.memory_limit = 1;
    cloud.memory_limit = state_of<B>(cloud, P2G::tile).batches.least;
    auto parts = state_of<B>(cloud, P2G::tile);
    REQUIRE(parts.batches.all.size() > 3);
    run_steps(whole, k_dt, 5), run_steps(parts, k_dt, 5);
    collect_soil(parts);
    CHECK(largest_difference(soil_fields(parts), soil_fields(whole)) == 0);
    CHECK(domains_of_soil(parts) == domains_of_soil(whole));
  });
}
