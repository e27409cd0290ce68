// Whole steps: free flight, and the same step on every backend, strategy and real type.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_spacing = 0.1;

/// Positions [cells], velocities, stresses and volumes after n steps.
template <class B>
std::vector<Table> fields_after(const Cloud& cloud, P2G how, double dt, int n) {
  auto s = state_of<B>(cloud, how);
  run_steps(s, dt, n);
  if (read_control(s).fault_count > 0) throw std::runtime_error("a step failed");
  return soil_fields(s);
}

/// The law at a point, on the host.
template <int Dim>
void update_elastic(const MaterialInput& material, SymTensor<double, Dim>& stress,
                    const SymTensor<double, Dim>& strain, const Spin<double, Dim>& spin) {
  make_material<double>(material.model, material.parameters).visit([&](const auto& law) {
    LawState<double, state_size<std::decay_t<decltype(law)>>> state{};
    law.update(stress, state, Increment<double, double, Dim>{strain, spin, {}, 1, 0});
  });
}

/// Half a footing: a smooth plate pressed into clay between rollers, on a fixed base.
template <int Dim>
Cloud footing() {
  const int width = Dim == 2 ? 12 : 6, depth = Dim == 2 ? 9 : 5;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({width, depth + 4, 4}, k_spacing, Wall::roller);
  cloud.grid.walls[1] = {Wall::fixed, Wall::free};
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, {double(width), double(depth), 4}, 2, k_spacing), 2,
                               k_spacing, 1)};
  cloud.rigids = {
      rigid_of<Dim>(lattice<Dim>({0, double(depth), 0}, {3, depth + 1., 2}, 4, k_spacing), 4, k_spacing)};
  cloud.rigids[0].velocity = {0, -2, 0};
  cloud.p2g.margin = 0.2;  // rebuilds come sooner
  return cloud;
}
constexpr double k_footing_step = 2e-4;

}  // namespace

TEST_CASE("a body in free flight moves by v t, across rebuilds", "[step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const std::array<double, 3> v{20, -12.5, 5};
    Dice dice{std::mt19937_64(41)};
    Cloud cloud;
    cloud.grid = grid_of<Dim>({24, 20, 12}, k_spacing, Wall::free);
    cloud.materials = clays();
    cloud.bodies = {random_body<Dim>(dice, {6, 12, 5}, {10, 16, 7}, 0.8, 2, k_spacing),
                    random_body<Dim>(dice, {9, 10, 4}, {12, 14, 6}, 0.5, 3, k_spacing)};
    for (auto& body : cloud.bodies) body.common_velocity = v, body.velocity.clear(), body.stress.clear();
    const double dt = 1e-4;
    const int steps = 200;  // 4 cells
    for (P2G how : {P2G::tile, P2G::gather}) {
      auto s = state_of<B>(cloud, how);
      Table expected = soil_fields(s)[0];
      for (std::size_t n = 0; n < expected.value.size(); ++n)
        expected.value[n] += v[n % Dim] * dt * steps / k_spacing;
      const int rebuilds = run_steps(s, dt, steps);
      INFO(build.name() << ' ' << word_of(how));
      CHECK(rebuilds >= 7);
      CHECK(read_control(s).fault_count == 0);
      CHECK(largest_difference(soil_fields(s)[0], expected) < B::of(1e-12, 1e-5));
    }
  });
}

TEST_CASE("in a linear velocity field every particle strains and turns by its gradient", "[step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    const double A[3][3] = {{30, -80, 50}, {20, -70, 40}, {-60, 10, 90}}, dt = 1e-4;  // 1/s
    const std::array<double, 3> end{12, 10, 9};
    Cloud cloud;
    cloud.grid = grid_of<Dim>({12, 10, 9}, k_spacing, Wall::free);
    cloud.materials = clays();
    cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, end, 2, k_spacing), 2, k_spacing, 0)};
    BodyInput& body = cloud.bodies[0];
    SymTensor<double, Dim> expected{};
    for (int k = 0; k < sym_size<Dim>; ++k) expected[k] = 1000 * (k + 1);
    for (std::size_t p = 0; p < strength_of(body).size(); ++p) {
      for (int d = 0; d < Dim; ++d) {
        double v = 0;
        for (int e = 0; e < Dim; ++e) v += A[d][e] * body.position[p * Dim + e];
        body.velocity.push_back(v);
      }
      body.stress.insert(body.stress.end(), expected.c, expected.c + sym_size<Dim>);
    }
    SymTensor<double, Dim> strain{};
    Spin<double, Dim> spin{};
    double trace = 0;
    for (int i = 0; i < Dim; ++i) {
      trace += A[i][i] * dt;
      for (int j = i; j < Dim; ++j) strain[sym_index<Dim>(i, j)] = (A[i][j] + A[j][i]) * dt / 2;
    }
    spin.c[0] = (A[0][1] - A[1][0]) * dt / 2;
    if constexpr (Dim == 3)
      spin.c[1] = (A[1][2] - A[2][1]) * dt / 2, spin.c[2] = (A[2][0] - A[0][2]) * dt / 2;
    update_elastic(cloud.materials[0], expected, strain, spin);

    const auto got = fields_after<B>(cloud, P2G::tile, dt, 1);
    double stress = 0, volume = 0;
    int inner = 0;
    for (std::size_t p = 0; p < strength_of(body).size(); ++p) {
      bool inside = true;  // where every node has all of its particles
      for (int d = 0; d < Dim; ++d) {
        const double x = body.position[p * Dim + d] / k_spacing;
        inside = inside && x > 3 && x < end[d] - 3;
      }
      if (!inside) continue;
      ++inner;
      for (int k = 0; k < sym_size<Dim>; ++k)
        stress = std::max(stress, std::fabs(got[2].value[p * sym_size<Dim> + k] - expected[k]));
      volume = std::max(volume, std::fabs(got[3].value[p] / body.particle_volume - std::exp(trace)));
    }
    CHECK(inner > 50);
    CHECK(stress < B::of(1e-12, 1e-4) *
                       1e5);  // of the largest stress; in single, round-off of velocities gives strain
    CHECK(volume < B::of(std::fabs(trace * trace * trace), 1e-5));
  });
}

TEST_CASE("FLIP and PIC mix by their fraction, and PIC's velocity is the one that moved the particle",
          "[step]") {
  for_each_reference([](auto reference) {
    using B = decltype(reference);
    const double dt = 1e-5;
    Cloud cloud = random_cloud<B::dim>(4);
    const auto after_one = [&](double flip_fraction) {
      cloud.flip_fraction = flip_fraction;
      return fields_after<B>(cloud, P2G::sequential, dt, 1);
    };
    const auto start = fields_after<B>(cloud, P2G::sequential, dt, 0);
    const auto flip = after_one(1), pic = after_one(0), both = after_one(0.75);
    double mixed = 0, moved = 0;
    for (std::size_t n = 0; n < both[1].value.size(); ++n) {
      mixed = std::max(mixed, std::fabs(both[1].value[n] - 0.75 * flip[1].value[n] - 0.25 * pic[1].value[n]));
      moved = std::max(moved, std::fabs((pic[0].value[n] - start[0].value[n]) * cloud.grid.spacing / dt -
                                        pic[1].value[n]));
    }
    INFO(B::name());
    CHECK(mixed < 1e-13);
    CHECK(moved < 1e-9);  // a difference of positions, over dt
    CHECK(largest_difference(flip[1], pic[1]) > 1e-2);
    CHECK(flip[0] == pic[0]);
  });
}

TEST_CASE("with F-bar the particles of a cell and material dilate alike, and their pressures begin alike",
          "[step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = random_cloud<B::dim>(2);
    cloud.f_bar_fraction = 1;
    auto s = state_of<B>(cloud);
    const auto cell = on_host(s.soil.points.cell);
    const auto body = on_host(s.soil.points.body);
    const auto material = [&](int p) { return cloud.bodies[body(p)].material; };
    const auto start = on_host(s.soil.points.volume);
    const std::vector<double> before(start.data(), start.data() + start.extent(0));
    one_step(s, 1e-5);
    const auto after = on_host(s.soil.points.volume);
    const auto stress = on_host(s.soil.points.stress);
    double ratio = 0, pressure = 0, change = 0;
    int together = 0;
    for (int p = 1; p < s.soil.points.count; ++p) {
      change = std::max(change, std::fabs(after(p) / before[p] - 1));
      if (cell(p) != cell(p - 1) || material(p) != material(p - 1)) continue;
      ++together;
      ratio = std::max(ratio, std::fabs(after(p) / before[p] - after(p - 1) / before[p - 1]));
      pressure = std::max(pressure, std::fabs(double(mean_of(stress(p))) - mean_of(stress(p - 1))));
    }
    INFO(B::name());
    CHECK(together > 100);
    CHECK(change > 1e-6);
    CHECK(ratio < B::of(1e-14, 1e-6));
    CHECK(pressure < B::of(1e-7, 30));  // of some 10 kPa; both bodies have the same bulk modulus
  });
}

TEST_CASE("a rigid falls freely as it should, to round-off", "[step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = random_cloud<Dim>(2);
    cloud.bodies = {
        body_of<Dim>(lattice<Dim>({0, 0, 0}, {2, 2, 2}, 2, cloud.grid.spacing), 2, cloud.grid.spacing, 0)};
    cloud.rigids.resize(1);
    cloud.rigids[0].velocity = {0.3, 0.2, -0.1};
    cloud.rigids[0].dynamic = true;
    cloud.rigids[0].force = {0, -7, 3};
    auto s = state_of<B>(cloud);
    const double dt = 1e-3;
    const int steps = 100;
    run_steps(s, dt, steps);
    const auto rigid = on_host(s.rigids);
    const double t = steps * dt;
    INFO(B::name());
    for (int d = 0; d < Dim; ++d) {
      const double a = cloud.rigids[0].force[d] / rigid(0).inertia.mass, v = cloud.rigids[0].velocity[d];
      CHECK(std::fabs(rigid(0).motion.velocity[d] - v - a * t) < 1e-12);
      CHECK(std::fabs(rigid(0).motion.pose.displacement[d] - v * t - a * t * t / 2) < 1e-12);
    }
  });
}

TEST_CASE("one step of a random cloud is the plain loop's in double on one thread", "[step]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    for (int seed : {1, 2, 3}) {
      Cloud cloud = random_cloud<Dim>(seed, seed == 1 ? Wall::roller : Wall::fixed);
      cloud.gravity = {1, -9.81, 0.5};
      cloud.flip_fraction = seed == 2 ? 0.9 : 1;
      cloud.damping = seed == 3 ? 0.05 : 0;
      cloud.f_bar_fraction = seed == 3 ? 0.9 : 0;
      const auto expected = fields_after<Reference<Dim>>(cloud, P2G::sequential, 1e-5, 1);
      for_each_build([&](auto build) {
        using B = decltype(build);
        if constexpr (B::dim == Dim) {
          for (P2G how : k_strategies) {
            INFO(build.name() << ' ' << word_of(how) << " seed " << seed);
            CHECK(largest_difference(fields_after<B>(cloud, how, 1e-5, 1), expected) < B::of(1e-12, 1e-5));
          }
        }
      });
    }
  });
}

TEST_CASE("one step of a footing under way is the plain loop's in double on one thread", "[step]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    // The state after some steps, with stresses and velocities as they are then.
    Cloud cloud = footing<Dim>();
    const auto start = fields_after<Reference<Dim>>(cloud, P2G::sequential, k_footing_step, 40);
    BodyInput& soil = cloud.bodies[0];
    for (std::size_t n = 0; n < soil.position.size(); ++n) soil.position[n] = start[0].value[n] * k_spacing;
    soil.velocity = start[1].value;
    soil.stress = start[2].value;
    const auto expected = fields_after<Reference<Dim>>(cloud, P2G::sequential, k_footing_step, 1);
    for_each_build([&](auto build) {
      using B = decltype(build);
      if constexpr (B::dim == Dim) {
        for (P2G how : k_strategies) {
          INFO(build.name() << ' ' << word_of(how));
          CHECK(largest_difference(fields_after<B>(cloud, how, k_footing_step, 1), expected) <
                B::of(1e-12, 1e-5));
        }
      }
    });
  });
}

TEST_CASE("100 steps of a small footing are the plain loop's in double on one thread", "[step]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    const Cloud cloud = footing<Dim>();
    const int steps = 100;
    const auto expected = fields_after<Reference<Dim>>(cloud, P2G::sequential, k_footing_step, steps);
    for_each_build([&](auto build) {
      using B = decltype(build);
      if constexpr (B::dim == Dim && B::is_double) {
        for (P2G how : k_strategies) {
          INFO(build.name() << ' ' << word_of(how));
          CHECK(largest_difference(fields_after<B>(cloud, how, k_footing_step, steps), expected) < 1e-9);
        }
      }
    });
  });
}

TEST_CASE("a margin or an interval of rebuilds does not change the solution", "[step]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    Cloud cloud = footing<Dim>();
    const auto expected = fields_after<Reference<Dim>>(cloud, P2G::gather, k_footing_step, 50);
    for (double margin : {0.05, 0.5}) {
      cloud.p2g.margin = margin;
      for (P2G how : {P2G::gather, P2G::mosaic, P2G::tile}) {
        INFO(Dim << "D " << word_of(how) << " margin " << margin);
        CHECK(largest_difference(fields_after<Reference<Dim>>(cloud, how, k_footing_step, 50), expected) <
              1e-9);
      }
    }
  });
}

TEST_CASE("a rigid that moves with a set velocity gathers no round-off", "[step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    Cloud cloud;
    cloud.grid = grid_of<Dim>({40, 32, 16}, k_spacing, Wall::free);
    cloud.materials = clays();
    cloud.rigids = {rigid_of<Dim>(lattice<Dim>({20, 20, 5}, {22, 21, 7}, 4, k_spacing), 4, k_spacing)};
    cloud.rigids[0].velocity = {0.3, -0.7, 0.1};
    auto s = state_of<B>(cloud);
    const auto start = download_rigid_positions(s, 0);
    run_steps(s, 4e-3, 250);
    const auto end = download_rigid_positions(s, 0);
    double largest = 0;
    for (std::size_t n = 0; n < end.size(); ++n)
      largest =
          std::max(largest, std::fabs(end[n] - start[n] - cloud.rigids[0].velocity[n % Dim]) / k_spacing);
    CHECK(largest < B::of(1e-11, 2e-7));
  });
}

TEST_CASE("gravity alone gives free fall", "[step]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    Cloud cloud;
    cloud.grid = grid_of<Dim>({16, 32, 12}, k_spacing, Wall::free);
    cloud.materials = clays();
    cloud.bodies = {body_of<Dim>(lattice<Dim>({4, 24, 4}, {8, 28, 7}, 2, k_spacing), 2, k_spacing, 1)};
    cloud.gravity = {0, -10, 0};
    auto s = state_of<B>(cloud);
    const auto start = soil_fields(s)[0].value;
    const double dt = 2e-4;
    const int steps = 300;
    run_steps(s, dt, steps);
    const auto end = soil_fields(s);
    const double fall = -10 * dt * dt * steps * (steps + 1) / 2 / k_spacing;  // of the symplectic Euler step
    double position = 0, velocity = 0;
    for (std::size_t n = 0; n < start.size(); ++n) {
      position = std::max(position, std::fabs(end[0].value[n] - start[n] - (n % Dim == 1 ? fall : 0)));
      velocity = std::max(velocity, std::fabs(end[1].value[n] - (n % Dim == 1 ? -10 * dt * steps : 0)));
    }
    CHECK(position < B::of(1e-11, 1e-5));
    CHECK(velocity < B::of(1e-11, 1e-5));
  });
}
