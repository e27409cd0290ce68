// Domains of particles that follow the soil.

#include <catch2/catch_test_macros.hpp>

#include "base/small_matrix.hpp"
#include "compare.hpp"
#include "physics/stretch_domain.hpp"
#include "rebuild/batches.hpp"
#include "transfer/measure.hpp"
#include "transfer/restore_state.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_dt = 1e-4;    // s
constexpr double k_least = 0.1;  // cells, of half lengths

template <int Dim>
using Square = double[Dim][Dim];

/// The half lengths [cells] that shape functions take.
template <int Dim>
HalfLengths<double, Dim> half_lengths(const DomainMoments<double, Dim>& m) {
  return with_inverses<double>(bounded_half_lengths(m, k_least));
}

/// Half a unit in the last place of a half length [cells], which is kept in single precision.
constexpr double k_kept = 0.5 / (1 << 24);

/// A deformation gradient with components of up to `by` beside the unit tensor.
template <int Dim>
void random_gradient(Dice& dice, double by, Square<Dim>& f) {
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) f[i][j] = (i == j) + dice.uniform(-by, by);
}

/// A turn of the plane of the first two axes.
template <int Dim>
void turn(double angle, Square<Dim>& f) {
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) f[i][j] = i == j;
  f[0][0] = f[1][1] = std::cos(angle), f[1][0] = std::sin(angle), f[0][1] = -f[1][0];
}

/// F M F^T.
template <int Dim>
DomainMoments<double, Dim> deformed(DomainMoments<double, Dim> m, const Square<Dim>& f) {
  stretch_domain(m, f, 1);
  return m;
}

template <int Dim>
double largest_apart(const DomainMoments<double, Dim>& a, const DomainMoments<double, Dim>& b) {
  double largest = 0;
  for (int k = 0; k < Dim * (Dim + 1) / 2; ++k) largest = std::max(largest, std::fabs(a[k] - b[k]));
  return largest;
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
    for (std::size_t k = 0; k < body.position.size(); ++k) body.velocity.push_back(dice.uniform(-1, 1));
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
      Square<Dim> f;
      random_gradient<Dim>(dice, 0.4, f);
      const auto m = deformed<Dim>(square_domain<double, Dim>(0.25), f);
      for (int i = 0; i < Dim; ++i)
        for (int j = i; j < Dim; ++j) {
          double sum = 0;  // of r_k = F r_k0
          for (int k = 0; k < Dim; ++k) sum += 0.25 * f[i][k] * 0.25 * f[j][k];
          CHECK(std::fabs(m[moment_index<Dim>(i, j)] - sum) < 1e-15);
        }
    }
  });
}

TEST_CASE("a domain turns with the soil: stretched, it lies along its soil", "[domain]") {
  for_each_reference([](auto build) {
    constexpr int Dim = decltype(build)::dim;
    const double pi = std::acos(-1.0);
    const auto square = square_domain<double, Dim>(0.25);
    Square<Dim> f;
    turn<Dim>(0.7, f);
    CHECK(largest_apart(deformed<Dim>(square, f), square) < 1e-15);
    auto longer = square;
    longer[0] = 0.4 * 0.4, longer[1] = 0.2 * 0.2;
    turn<Dim>(pi / 2, f);
    const auto quarter = half_lengths(deformed<Dim>(longer, f));
    CHECK(std::fabs(quarter[0] - 0.2) < 1e-15);
    CHECK(std::fabs(quarter[1] - 0.4) < 1e-15);
    turn<Dim>(pi / 4, f);
    const auto eighth = half_lengths(deformed<Dim>(longer, f));
    CHECK(std::fabs(eighth[0] - eighth[1]) < 1e-15);
    CHECK(std::fabs(eighth[0] - std::sqrt((0.16 + 0.04) / 2)) < 1e-15);
    if (Dim == 3) CHECK(std::fabs(quarter[Dim - 1] - 0.25) < 1e-15);
    // Sheared along an axis, rows keep their distance, and the domain its height.
    turn<Dim>(0, f);
    f[0][1] = 1.5;
    const auto sheared = half_lengths(deformed<Dim>(square, f));
    CHECK(std::fabs(sheared[1] - 0.25) < 1e-15);
    CHECK(std::fabs(sheared[0] - 0.25 * std::sqrt(1 + 1.5 * 1.5)) < 1e-15);
    CHECK(std::fabs(2 * sheared[0].l * sheared[0].inverse - 1) < 1e-13);
  });
}

TEST_CASE("half lengths stay within their bounds, and moments those of a parallelogram, however soil flows",
          "[domain]") {
  for_each_reference([](auto build) {
    constexpr int Dim = decltype(build)::dim;
    Dice dice{std::mt19937_64(6)};
    auto m = square_domain<double, Dim>(0.25);
    for (int n = 0; n < 5000; ++n) {
      Square<Dim> f;
      random_gradient<Dim>(dice, 0.1, f);
      stretch_domain(m, f, dice.uniform(0.95, 1.05));
      const auto half = half_lengths(m);
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
    Square<Dim> f;
    turn<Dim>(0, f);
    f[1][1] = 0.2;
    const auto pressed = deformed<Dim>(square, f);
    CHECK(half_lengths(pressed)[1].l == k_least);
    f[1][1] = 5;
    CHECK(largest_apart(deformed<Dim>(pressed, f), square) < 1e-15);
  });
}

namespace {

/// Soil in the middle of a mesh, or from its lower corner on, at places that no lattice has.
template <int Dim>
Cloud scattered_soil(int seed, bool at_walls) {
  constexpr double k_spacing = 0.1;  // m
  Dice dice{std::mt19937_64(seed)};
  Cloud cloud;
  cloud.grid = grid_of<Dim>({14, 12, 9}, k_spacing, Wall::free);
  for (int d = 0; d < Dim; ++d)
    if (at_walls) cloud.grid.walls[d][0] = d == 1 ? Wall::fixed : Wall::roller;
  cloud.materials = clays();
  const double from = at_walls ? 0 : 2;
  BodyInput body = body_of<Dim>(
      lattice<Dim>({from, from, from}, {from + 7, from + 6, from + 5}, 2, k_spacing), 2, k_spacing, 0);
  for (double& x : body.position) x += dice.uniform(-0.2, 0.2) * k_spacing;
  cloud.bodies = {body};
  give_own_domains<Dim>(cloud, seed);
  return cloud;
}

/// Moves the soil by F from a fixed point [cells], with its volume.
template <class Space, class T, int Dim>
void move_by(State<Space, T, Dim>& s, const Square<Dim>& f, double fixed) {
  const auto& soil = s.soil.points;
  const auto x = on_host(soil.coordinate);
  const auto volume = on_host(soil.volume);
  const auto cell = on_host(soil.cell);
  const auto origin = on_host(s.patches.origin);
  for (int p = 0; p < soil.count; ++p) {
    double at[Dim];
    for (int d = 0; d < Dim; ++d)
      at[d] = double(x(p)[d]) + origin(cell(p) / Patch<Dim>::cells)[d] + coord_of<Dim>(cell(p))[d] - fixed;
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) x(p)[i] += T((f[i][j] - (i == j)) * at[j]);
    volume(p) *= T(determinant(f));
  }
  Kokkos::deep_copy(soil.coordinate, x), Kokkos::deep_copy(soil.volume, volume);
}

/// Largest difference of the domains from F M F^T, M those of before.
template <class S, int Dim>
double off(const S& s, const Table& before, const Square<Dim>& f) {
  constexpr int n = Dim * (Dim + 1) / 2;
  const Table after = domains_of_soil(s);
  double largest = 0;
  for (std::size_t p = 0; p < before.value.size() / n; ++p) {
    DomainMoments<double, Dim> m, now;
    for (int k = 0; k < n; ++k) m[k] = before.value[p * n + k], now[k] = after.value[p * n + k];
    largest = std::max(largest, largest_apart(now, deformed<Dim>(m, f)));
  }
  return largest;
}

}  // namespace

TEST_CASE("domains follow a linear motion exactly, however particles lie, by every strategy", "[domain]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Dice dice{std::mt19937_64(9)};
    for (const P2G how : k_strategies) {
      auto s = state_of<B>(scattered_soil<Dim>(5, false), how);
      const Table before = domains_of_soil(s);
      Square<Dim> f;
      random_gradient<Dim>(dice, 0.03, f);
      move_by(s, f, 6);
      sum_drift(s), stretch_domains(s);
      INFO(B::name() << " " << word_of(how));
      CHECK(off<decltype(s), Dim>(s, before, f) < B::of(1e-12, 2e-5));
      Square<Dim> still;
      turn<Dim>(0, still);
      CHECK(off<decltype(s), Dim>(s, before, still) > 1e-3);
    }
  });
}

TEST_CASE("half lengths are those of half of the last deformation further on", "[domain]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    auto s = state_of<B>(scattered_soil<Dim>(7, false));
    Square<Dim> f;
    turn<Dim>(0, f);
    f[0][0] = 1.04, f[1][1] = 0.97;
    move_by(s, f, 6);
    sum_drift(s), stretch_domains(s);
    const Table domains = domains_of_soil(s), lengths = by_id(s.soil.points, s.soil.points.half_length);
    const double half[3] = {1.02, 0.985, 1};
    double off = 0;
    for (std::size_t p = 0; p < lengths.value.size() / Dim; ++p)
      for (int d = 0; d < Dim; ++d) {
        const double l = std::sqrt(domains.value[p * Dim * (Dim + 1) / 2 + d]) * half[d];
        off = std::max(off, std::fabs(lengths.value[p * Dim + d] - std::clamp(l, k_least, 0.5)));
      }
    INFO(B::name());
    CHECK(off < B::of(k_kept + 1e-12, 2e-5));
  });
}

TEST_CASE("domains follow a linear motion exactly at smooth walls and a fixed one", "[domain]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    auto s = state_of<B>(scattered_soil<Dim>(6, true));
    const Table before = domains_of_soil(s);
    Square<Dim> f;  // no motion at the fixed wall, none across the smooth ones
    turn<Dim>(0, f);
    f[1][1] = 0.95;
    move_by(s, f, 0);
    sum_drift(s), stretch_domains(s);
    INFO(B::name());
    CHECK(off<decltype(s), Dim>(s, before, f) < B::of(1e-12, 2e-5));
  });
}

TEST_CASE("soil of which each node has as little as a line keeps the shape of its domains", "[domain]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    constexpr double h = 0.1;  // m
    Cloud cloud;
    cloud.grid = grid_of<Dim>({12, 12, 12}, h, Wall::free);
    cloud.materials = clays();
    std::vector<double> places;
    for (int n = 0; n < 8; ++n)
      for (int d = 0; d < Dim; ++d) places.push_back((d == 0 ? 2.25 + 0.5 * n : 5.3) * h);
    cloud.bodies = {body_of<Dim>(places, 2, h, 0)};
    cloud.stretch = true;
    auto s = state_of<B>(cloud);
    const Table before = domains_of_soil(s);
    Square<Dim> f;
    turn<Dim>(0, f);
    f[0][0] = 1.1, f[1][0] = 0.05;
    move_by(s, f, 5);
    sum_drift(s), stretch_domains(s);
    INFO(B::name());
    const Table after = domains_of_soil(s);
    const double grown = std::pow(1.1, 2.0 / Dim);  // as the volume
    for (std::size_t k = 0; k < before.value.size(); ++k)
      CHECK(std::fabs(after.value[k] - grown * before.value[k]) < B::of(1e-14, 1e-6));
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
      const auto go = [](auto& t) {
        for (int n = 0; n < 2; ++n) run_steps(t, k_dt, 3), rebuild(t);
      };
      go(plain);
      CHECK(largest_difference(domains_of_soil(plain), before) > 1e-4);
      for (const P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        go(s);
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
      body.velocity.clear(), body.stress.clear(), body.domain.clear();
      body.common_velocity = {0.7, -0.4, 0.2};
    }
    Cloud fixed = cloud;
    fixed.stretch = false;
    for (const P2G how : k_strategies) {
      auto s = state_of<B>(cloud, how), same = state_of<B>(fixed, how);
      const Table before = domains_of_soil(s);
      for (int n = 0; n < 5; ++n) {
        run_steps(s, k_dt, 10), run_steps(same, k_dt, 10);
        rebuild(s), rebuild(same);
      }
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
    cloud.bodies[0].common_velocity = {0, -1, 0};
    cloud.gravity = {0, -10, 0};
    give_own_domains<Dim>(cloud, 1);
    for (const P2G how : k_strategies) {
      auto s = state_of<B>(cloud, how);
      const Table before = domains_of_soil(s);
      run_steps(s, k_dt, 20), rebuild(s);
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
      s.scheme.rim_scale = 1.0 / (4 * Dim);  // what squares of a quarter of a cell allow
      return fastest_wave(s);
    };
    const double square = wave_at(0.25, 0.25);
    CHECK(std::fabs(wave_at(0.1, 0.25) / square - std::sqrt((10.0 + 4 * (Dim - 1)) / (4 * Dim))) < 1e-12);
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
    rebuild(whole), rebuild(parts);
    run_steps(whole, k_dt, 5), run_steps(parts, k_dt, 5);
    collect_soil(parts);
    CHECK(largest_difference(soil_fields(parts), soil_fields(whole)) == 0);
    CHECK(domains_of_soil(parts) == domains_of_soil(whole));
  });
}
