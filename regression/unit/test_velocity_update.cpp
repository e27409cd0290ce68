// XPIC and APIC: what they keep exactly, what they damp, and the same on every backend, strategy and real
// type.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "transfer/velocity_gradients.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_spacing = 0.1, k_dt = 1e-4;

/// A block of which a fifth of the particles is missing, at an odd place: free surfaces everywhere. Its
/// material has no stiffness, so that nothing but the transfers changes a velocity.
template <int Dim>
Cloud holed_block() {
  Dice dice{std::mt19937_64(23)};
  std::vector<double> position;
  const auto full = lattice<Dim>({4.13, 5.37, 3.71}, {9.13, 9.37, 6.71}, 2, k_spacing);
  for (std::size_t p = 0; p < full.size() / Dim; ++p)
    if (dice.uniform(0, 1) < 0.8)
      position.insert(position.end(), full.begin() + p * Dim, full.begin() + (p + 1) * Dim);
  Cloud cloud;
  cloud.grid = grid_of<Dim>({16, 14, 11}, k_spacing, Wall::free);
  cloud.materials = {{0, {0, 0}}};
  cloud.bodies = {body_of<Dim>(std::move(position), 2, k_spacing, 0)};
  return cloud;
}

/// v_p = b + A x_p, with A [1/s] row by row.
template <int Dim>
void set_linear(BodyInput& body, const double (&A)[3][3], const std::array<double, 3>& b) {
  body.velocity.clear();
  for (std::size_t p = 0; p < strength_of(body).size(); ++p)
    for (int d = 0; d < Dim; ++d) {
      double v = b[d];
      for (int e = 0; e < Dim; ++e) v += A[d][e] * body.position[p * Dim + e];
      body.velocity.push_back(v);
    }
}
void set_random(BodyInput& body) {
  Dice dice{std::mt19937_64(29)};
  body.velocity.clear();
  for (std::size_t n = 0; n < body.position.size(); ++n) body.velocity.push_back(dice.uniform(-1, 1));
}

/// Velocities by particle after n steps, and where APIC is on, C_p.
template <class B>
std::vector<Table> velocities_after(const Cloud& cloud, P2G how, int n) {
  auto s = state_of<B>(cloud, how);
  run_steps(s, k_dt, n);
  if (read_control(s).fault_count > 0) throw std::runtime_error("a step failed");
  std::vector<Table> fields{by_id(s.soil.points, s.soil.points.velocity)};
  if (s.soil.points.has_affine) fields.push_back(by_id(s.soil.points, s.soil.points.affine));
  return fields;
}

/// The transfer from nodes to particles and back, S S+, as a full matrix over particles of one mass.
template <int Dim>
std::vector<double> transfer(const BodyInput& body) {
  const int count = static_cast<int>(strength_of(body).size()), edge = 18;
  int nodes = 1;
  for (int d = 0; d < Dim; ++d) nodes *= edge;
  std::vector<double> S(std::size_t(count) * nodes), P(std::size_t(count) * count), mass(nodes);
  for (int p = 0; p < count; ++p)
    for (int i = 0; i < nodes; ++i) {
      double w = 1;
      for (int d = 0, at = i; d < Dim; ++d, at /= edge) {
        double s, ds;
        node_weight(body.position[std::size_t(p) * Dim + d] / k_spacing - at % edge, body.half_length, s, ds);
        w *= s;
      }
      S[std::size_t(p) * nodes + i] = w;
      mass[i] += w;
    }
  for (int p = 0; p < count; ++p)
    for (int i = 0; i < nodes; ++i) {
      const double w = S[std::size_t(p) * nodes + i];
      if (w == 0) continue;
      for (int q = 0; q < count; ++q)
        P[std::size_t(p) * count + q] += w * S[std::size_t(q) * nodes + i] / mass[i];
    }
  return P;
}

/// Angular momentum over the mass of a particle, one value a pair of axes [m/s cells], with what C_p holds:
/// sum of x_p x v_p and of S (x_i - x_p) x C_p (x_i - x_p), the weights being those at x.
template <class B>
std::vector<double> angular_momentum(const StateOf<B>& s, const std::vector<double>& x) {
  constexpr int Dim = B::dim;
  const Table v = by_id(s.soil.points, s.soil.points.velocity);
  const Table C = by_id(s.soil.points, s.soil.points.affine);
  std::vector<double> total(Dim == 2 ? 1 : 3);
  for (std::size_t p = 0; p < x.size() / Dim; ++p) {
    double D[Dim];
    for (int d = 0; d < Dim; ++d) {
      const auto a = axis_weights(x[p * Dim + d], 0.25);
      D[d] = 0;
      for (int k = 0; k < 3; ++k) D[d] += a.w[k] * std::pow(a.first + k - x[p * Dim + d], 2);
    }
    for (std::size_t n = 0; n < total.size(); ++n) {
      const int a = static_cast<int>(n), b = (a + 1) % Dim;
      total[n] += x[p * Dim + a] * v.value[p * Dim + b] - x[p * Dim + b] * v.value[p * Dim + a] +
                  C.value[(p * Dim + b) * Dim + a] * D[a] - C.value[(p * Dim + a) * Dim + b] * D[b];
    }
  }
  return total;
}

}  // namespace

TEST_CASE("XPIC(m) is v - (I - S S+)^m v, by full matrices", "[velocity_update]") {
  for_each_reference([](auto reference) {
    using B = decltype(reference);
    Cloud cloud = holed_block<B::dim>();
    set_random(cloud.bodies[0]);
    const auto& v = cloud.bodies[0].velocity;
    const auto P = transfer<B::dim>(cloud.bodies[0]);
    const std::size_t count = v.size() / B::dim;
    std::vector<double> rest = v;
    for (int m = 1; m <= 5; ++m) {
      const std::vector<double> before = rest;
      for (std::size_t p = 0; p < count; ++p)
        for (std::size_t q = 0; q < count; ++q)
          for (int d = 0; d < B::dim; ++d) rest[p * B::dim + d] -= P[p * count + q] * before[q * B::dim + d];
      cloud.xpic_order = m;
      cloud.flip_fraction = 0;
      const Table got = velocities_after<B>(cloud, P2G::tile, 1)[0];
      double largest = 0;
      for (std::size_t n = 0; n < v.size(); ++n)
        largest = std::max(largest, std::fabs(got.value[n] - (v[n] - rest[n])));
      INFO(B::name() << " order " << m);
      CHECK(largest < 1e-13);
    }
  });
}

TEST_CASE("XPIC and FLIP mix by their fraction, and PIC is XPIC(1)", "[velocity_update]") {
  for_each_reference([](auto reference) {
    using B = decltype(reference);
    Cloud cloud = random_cloud<B::dim>(4, Wall::fixed);
    cloud.gravity = {1, -9.81, 0.5};
    const auto after = [&](double flip_fraction, int order) {
      cloud.flip_fraction = flip_fraction;
      cloud.xpic_order = order;
      return velocities_after<B>(cloud, P2G::sequential, 1)[0];
    };
    const Table flip = after(1, 0), xpic = after(0, 3), both = after(0.75, 3);
    double mixed = 0;
    for (std::size_t n = 0; n < both.value.size(); ++n)
      mixed = std::max(mixed, std::fabs(both.value[n] - 0.75 * flip.value[n] - 0.25 * xpic.value[n]));
    INFO(B::name());
    CHECK(mixed < 1e-13);
    CHECK(largest_difference(flip, xpic) > 1e-2);
    CHECK(largest_difference(after(0, 0), after(0, 1)) < 1e-13);
    CHECK(largest_difference(after(1, 4), flip) < 1e-13);
  });
}

TEST_CASE("XPIC takes out what no node sees, and lets a smooth field be the more the higher its order",
          "[velocity_update]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    const int edge = Dim == 2 ? 24 : 14, layer = 5;
    Cloud cloud;
    cloud.grid = grid_of<Dim>({edge, edge, edge}, k_spacing, Wall::free);
    cloud.materials = {{0, {0, 0}}};
    cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, {edge * 1., edge * 1., edge * 1.}, 2, k_spacing), 2,
                                 k_spacing, 0)};
    BodyInput& body = cloud.bodies[0];
    /// Largest change of the velocity far from the surface in a step by XPIC(m), and largest velocity after
    /// it.
    const auto change = [&](int m) {
      cloud.flip_fraction = 0;
      cloud.xpic_order = m;
      const Table got = velocities_after<B>(cloud, P2G::tile, 1)[0];
      std::array<double, 2> largest{};
      for (std::size_t p = 0; p < strength_of(body).size(); ++p) {
        bool inside = true;
        for (int d = 0; d < Dim; ++d) {
          const double x = body.position[p * Dim + d] / k_spacing;
          inside = inside && x > layer && x < edge - layer;
        }
        for (int d = 0; inside && d < Dim; ++d) {
          const double v = got.value[p * Dim + d];
          largest[0] = std::max(largest[0], std::fabs(v - body.velocity[p * Dim + d]));
          largest[1] = std::max(largest[1], std::fabs(v));
        }
      }
      return largest;
    };
    for (const double x : body.position)  // + and - in turn along each axis
      body.velocity.push_back(std::lround(x / k_spacing * 2 - 0.5) % 2 == 0 ? 1 : -1);
    for (int m : {1, 2, 3}) CHECK(change(m)[1] < B::of(1e-14, 1e-6));

    for (double& v : body.velocity) v = 0;
    for (std::size_t p = 0; p < strength_of(body).size(); ++p)  // a shear wave of 12 cells
      body.velocity[p * Dim] = std::sin(2 * M_PI * body.position[p * Dim + 1] / (12 * k_spacing));
    const double first = change(1)[0];
    CHECK(first > 0.02);
    const double second = change(2)[0];
    CHECK(second < first / 10);
    CHECK(change(4)[0] < second);  // what remains is the part of a sampled wave that no node sees
    CHECK(change(4)[0] < first / 20);
  });
}

TEST_CASE("APIC keeps a linear field of velocity at free surfaces, from the first step on",
          "[velocity_update]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const double A[3][3] = {{3, -8, 5}, {2, -7, 4}, {-6, 1, 9}}, shear[3][3] = {{0, 3, -2}, {}, {}};
    const std::array<double, 3> b{2, -1, 0.5};
    Cloud cloud = holed_block<Dim>();
    BodyInput& body = cloud.bodies[0];
    for (P2G how : k_strategies) {
      INFO(build.name() << ' ' << word_of(how));
      const auto error = [&](const double(&field)[3][3], int steps) {
        set_linear<Dim>(body, field, b);
        std::vector<Table> expected{{Dim, body.velocity}};
        if (cloud.affine) {
          expected.push_back({Dim * Dim, {}});
          for (std::size_t n = 0; n < strength_of(body).size() * Dim * Dim; ++n)
            expected[1].value.push_back(field[n / Dim % Dim][n % Dim] * k_spacing);
        }
        const auto got = velocities_after<B>(cloud, how, steps);
        double largest = 0;
        for (std::size_t f = 0; f < got.size(); ++f)
          for (std::size_t n = 0; n < got[f].value.size(); ++n)
            largest = std::max(largest, std::fabs(got[f].value[n] - expected[f].value[n]));
        return largest;
      };
      cloud.affine = true;
      cloud.flip_fraction = 0;
      CHECK(error(A, 1) < B::of(1e-13, 1e-5));
      // In steady shear no particle changes its velocity, however far it goes; in others x + v dt bends the
      // field.
      if (how == P2G::tile) CHECK(error(shear, 500) < B::of(1e-12, 1e-3));
      cloud.affine = false;
      CHECK(error(A, 1) > 1e-2);  // PIC
    }
  });
}

TEST_CASE("XPIC and APIC keep momentum, and APIC angular momentum", "[velocity_update]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    Cloud cloud = holed_block<Dim>();
    BodyInput& body = cloud.bodies[0];
    set_random(body);
    Dice dice{std::mt19937_64(31)};
    for (std::size_t n = 0; n < strength_of(body).size() * sym_size<Dim>; ++n)
      body.stress.push_back(dice.uniform(-3000, 3000));
    cloud.flip_fraction = 0;
    for (int order : {0, 2, 5}) {
      cloud.xpic_order = order;
      cloud.affine = order == 0;
      auto s = state_of<B>(cloud, P2G::tile);
      const auto total = [&](int d) {
        const Table v = by_id(s.soil.points, s.soil.points.velocity);
        double sum = 0;
        for (std::size_t n = d; n < v.value.size(); n += Dim) sum += v.value[n];
        return sum;
      };
      const double before[] = {total(0), total(1), total(Dim - 1)};
      const double tolerance = B::of(1e-13, 1e-5) * static_cast<double>(strength_of(body).size());
      const std::vector<double> x = soil_fields(s)[0].value;
      const auto turning = s.soil.points.has_affine ? angular_momentum<B>(s, x) : std::vector<double>{};
      one_step(s, k_dt);
      for (int d = 0; d < Dim; ++d) CHECK(std::fabs(total(d) - before[d]) < tolerance);
      for (std::size_t n = 0; n < turning.size(); ++n)
        CHECK(std::fabs(angular_momentum<B>(s, x)[n] - turning[n]) < 10 * tolerance);
    }
  });
}

TEST_CASE("a spinning elastic block keeps its spin with APIC", "[velocity_update]") {
  for_each_reference([](auto reference) {
    using B = decltype(reference);
    const double omega = 5, turn[3][3] = {{0, -omega, 0}, {omega, 0, 0}, {}};  // rad/s
    Cloud cloud;
    cloud.grid = grid_of<B::dim>({12, 12, 9}, k_spacing, Wall::free);
    cloud.materials = clays();
    cloud.bodies = {body_of<B::dim>(lattice<B::dim>({4, 4, 3}, {8, 8, 5}, 2, k_spacing), 2, k_spacing, 0)};
    set_linear<B::dim>(cloud.bodies[0], turn, {6 * omega * k_spacing, -6 * omega * k_spacing, 0});
    cloud.affine = true;
    cloud.flip_fraction = 0;
    auto s = state_of<B>(cloud, P2G::tile);
    const auto spin = [&] { return angular_momentum<B>(s, soil_fields(s)[0].value)[0]; };
    const double before = spin(), dt = 2e-4;
    run_steps(s, dt, 1000);  // a turn of 57 degrees
    const Table C = by_id(s.soil.points, s.soil.points.affine);
    double mean = 0;
    for (int p = 0; p < s.soil.points.count; ++p)
      mean += (C.value[(p * B::dim + 1) * B::dim] - C.value[p * B::dim * B::dim + 1]) / 2 / k_spacing;
    INFO(B::name());
    CHECK(read_control(s).fault_count == 0);
    CHECK(std::fabs(spin() / before - 1) < 0.01);
    CHECK(std::fabs(mean / s.soil.points.count / omega - 1) < 0.02);
  });
}

TEST_CASE("a step with XPIC or APIC is the plain loop's in double on one thread", "[velocity_update]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    Cloud cloud = random_cloud<Dim>(2, Wall::roller);
    cloud.gravity = {1, -9.81, 0.5};
    for (int order : {0, 2, 4}) {
      cloud.xpic_order = order;
      cloud.flip_fraction = order == 4 ? 0.9 : 0;
      cloud.affine = order == 0;
      const auto expected = velocities_after<Reference<Dim>>(cloud, P2G::sequential, 1);
      for_each_build([&](auto build) {
        using B = decltype(build);
        if constexpr (B::dim == Dim) {
          for (P2G how : k_strategies) {
            INFO(build.name() << ' ' << word_of(how) << " order " << order);
            CHECK(largest_difference(velocities_after<B>(cloud, how, 1), expected) < B::of(1e-11, 1e-4));
          }
        }
      });
    }
  });
}

TEST_CASE("the gradient of velocities is exact for a linear field, and zero where it cannot be known",
          "[velocity_update]") {
  const std::vector<double> apart{0.2, 0.3, 0.7, 0.4, 1.1, 1.6};
  std::vector<double> v;
  for (std::size_t p = 0; p < 3; ++p) {
    v.push_back(1 + 2 * apart[2 * p] - 3 * apart[2 * p + 1]);
    v.push_back(-4 * apart[2 * p] + 5 * apart[2 * p + 1]);
  }
  const auto got = velocity_gradients(apart, v, 2);
  for (std::size_t p = 0; p < 3; ++p) {
    const double expected[] = {2, -3, -4, 5};
    for (int k = 0; k < 4; ++k) CHECK(std::fabs(got[4 * p + k] - expected[k]) < 1e-12);
  }
  const auto row = velocity_gradients({0.2, 0.3, 0.7, 0.3}, {0, 0, 1, 2}, 2);
  CHECK(std::fabs(row[0] - 2) < 1e-12);
  CHECK(std::fabs(row[2] - 4) < 1e-12);
  CHECK(row[1] == 0);
  CHECK(row[3] == 0);
  const auto uneven = velocity_gradients({0.2, 0.3, 0.7, 0.302, 1.2, 0.299}, {0, 0, 1, 2, 2, 5}, 2);
  for (std::size_t p = 0; p < 3; ++p) CHECK((uneven[4 * p + 1] == 0 && uneven[4 * p + 3] == 0));
  CHECK(velocity_gradients({5.5, 0.5, 1.5}, {1, 2, 3}, 3) == std::vector<double>(9, 0.0));
}
