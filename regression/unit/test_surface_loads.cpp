// Loads on surfaces: their sums at the nodes by every strategy, and how the areas of faces follow the soil.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "functions/surface_loads.hpp"
#include "loops/cpu/host_particles.hpp"
#include "physics/materials/any.hpp"
#include "step/step.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_pressure = 3e3;

/// Two loads, of which every particle of some bodies has one, both, or none, with areas along any direction.
template <int Dim>
void give_random_faces(Cloud& cloud, int seed) {
  Dice dice{std::mt19937_64(seed)};
  for (BodyInput& body : cloud.bodies)
    for (std::size_t p = 0; p < body.position.size() / Dim; ++p)
      for (int load = 1; load <= 2; ++load) {
        const bool has = dice.below(3) == 0;
        for (int d = 0; d < Dim; ++d)
          body.faces.push_back(has ? dice.below(3) == 0 ? 0.01 : dice.uniform(-0.02, 0.02) : 0);
        const double area = has ? dice.uniform(0.005, 0.02) : 0;
        body.faces.insert(body.faces.end(), {area, 1.0, has ? double(load) : 0.0});
      }
}

const std::vector<std::array<double, 4>> k_two_loads = {{k_pressure, -30, 70, 170}, {-500, 200, 130, 60}};

/// The forces of the loads on all particles [N].
template <int Dim>
std::array<double, Dim> total_force(const std::vector<SurfaceSum>& sums) {
  std::array<double, Dim> force{};
  for (std::size_t n = 0; n < sums.size(); ++n)
    for (int d = 0; d < Dim; ++d)
      force[d] += k_two_loads[n][1 + d] * sums[n].start_area - k_two_loads[n][0] * sums[n].vector[d];
  return force;
}

/// Faces of the particles of a lattice that no other covers, all of one load.
template <int Dim>
void close_surface(BodyInput& body, double width) {
  const auto at = [&](std::size_t p, int d) { return body.position[p * Dim + d]; };
  const std::size_t count = body.position.size() / Dim;
  for (std::size_t p = 0; p < count; ++p) {
    double area[Dim] = {}, size = 0;
    for (int n = 0; n < 2 * Dim; ++n) {
      bool covered = false;
      for (std::size_t q = 0; q < count; ++q) {
        double apart = 0;
        for (int d = 0; d < Dim; ++d)
          apart =
              std::max(apart, std::fabs(at(q, d) - at(p, d) - (d == n / 2 ? (n % 2 ? width : -width) : 0)));
        covered = covered || apart < width / 10;
      }
      if (!covered) area[n / 2] += (n % 2 ? 1 : -1) * std::pow(width, Dim - 1), size = 1;
    }
    body.faces.insert(body.faces.end(), area, area + Dim);
    body.faces.insert(body.faces.end(), {std::pow(width, Dim - 1), 1.0, size});
  }
}

/// A block of soil under a pressure all round, in a step of dt behind function 4.
template <class B>
auto block_in_step(double spacing, double dt) {
  constexpr int Dim = B::dim;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({8, 8, 6}, spacing, Wall::free);
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>(lattice<Dim>({2, 2, 1}, {5, 5, 4}, 2, spacing), 2, spacing, 0)};
  close_surface<Dim>(cloud.bodies[0], spacing / 2);
  cloud.face_count = 1, cloud.surface_loads = {{k_pressure, 0, 0, 0}};
  auto s = state_of<B>(cloud, P2G::tile);
  test::interpolate(s), loads_to_nodes(s), update_nodes(s, dt);
  return s;
}
/// Gives the nodes velocities in the plane of x and y, by f(place, velocity).
template <class B, class S, class F>
void set_velocities(S& s, double spacing, F&& f) {
  constexpr int Dim = B::dim;
  const auto kinematics = on_host(s.nodes.kinematics);
  const auto origin = on_host(s.patches.origin);
  for (int i = 0; i < s.patches.node_count(); ++i) {
    const auto at = coord_of<Dim>(i);
    double x[2], v[2];
    for (int d = 0; d < 2; ++d) x[d] = (origin(i / Patch<Dim>::cells)[d] + at[d]) * spacing;
    for (int d = 0; d < 2 * Dim; ++d) kinematics(i, d) = 0;
    f(x, v);
    for (int d = 0; d < 2; ++d) kinematics(i, d) = v[d];
  }
  Kokkos::deep_copy(s.nodes.kinematics, kinematics);
}

}  // namespace

TEST_CASE("nodes get the forces of loads on faces, by every strategy", "[surface_loads]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (const bool stretch : {false, true}) {
      Cloud cloud = random_cloud<Dim>(73, Wall::free);
      if (stretch) give_own_domains<Dim>(cloud, 5);
      give_random_faces<Dim>(cloud, 74);
      cloud.face_count = 2, cloud.surface_loads = k_two_loads;
      Table first;
      for (P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        drift_within_margin(s);
        Kokkos::deep_copy(s.nodes.soil, 0);
        loads_to_nodes(s);
        const Table load = nodes_of(s, s.nodes.load), soil = nodes_of(s, s.nodes.soil);
        const auto total = total_force<Dim>(sum_surfaces(s, s.loads));
        std::array<double, Dim> sum{};
        double wrong = 0, size = 0;
        for (std::size_t i = 0; i < load.value.size() / Dim; ++i)
          for (int d = 0; d < Dim; ++d) {
            sum[d] += load.value[i * Dim + d], size += std::fabs(load.value[i * Dim + d]);
            wrong = std::max(wrong, std::fabs(load.value[i * Dim + d] -
                                              soil.value[i * soil.width + SoilTerms<Dim>::force + d]));
          }
        if (how == P2G::sequential) first = load;
        INFO(build.name() << ' ' << word_of(how) << (stretch ? " stretched" : ""));
        CHECK(size > 0);
        for (int d = 0; d < Dim; ++d) CHECK(std::fabs(sum[d] - total[d]) < B::of(1e-12, 1e-5) * size);
        CHECK(wrong == 0);
        CHECK(largest_difference(load, first) < B::of(1e-11, 1e-4));
      }
    }
  });
}

TEST_CASE("a pressure all round a lattice is what its stress holds, at every node", "[surface_loads]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    constexpr double spacing = 0.1;
    for (const Wall wall : {Wall::free, Wall::roller}) {
      Cloud cloud;
      cloud.grid = grid_of<Dim>({8, 8, 6}, spacing, wall);
      cloud.materials = clays();
      std::vector<double> steps;  // a lattice whose surface goes in steps
      const auto all = lattice<Dim>({2, 2, 1}, {6, 5, 4}, 2, spacing);
      for (std::size_t p = 0; p < all.size(); p += Dim)
        if (all[p] + all[p + 1] < 0.95) steps.insert(steps.end(), all.begin() + p, all.begin() + p + Dim);
      cloud.bodies = {body_of<Dim>(steps, 2, spacing, 0)};
      for (std::size_t p = 0; p < steps.size() / Dim; ++p)
        for (int k = 0; k < sym_size<Dim>; ++k) cloud.bodies[0].stress.push_back(k < 3 ? -k_pressure : 0);
      close_surface<Dim>(cloud.bodies[0], spacing / 2);
      cloud.face_count = 1, cloud.surface_loads = {{k_pressure, 0, 0, 0}};
      for (P2G how : {P2G::sequential, P2G::gather, P2G::tile}) {
        auto s = state_of<B>(cloud, how);
        test::interpolate(s);
        loads_to_nodes(s);
        const Table soil = nodes_of(s, s.nodes.soil), load = nodes_of(s, s.nodes.load);
        double most = 0, left = 0;
        for (std::size_t i = 0; i < load.value.size() / Dim; ++i)
          for (int d = 0; d < Dim; ++d) {
            most = std::max(most, std::fabs(load.value[i * Dim + d]));
            left = std::max(left, std::fabs(soil.value[i * soil.width + SoilTerms<Dim>::force + d]));
          }
        INFO(build.name() << ' ' << word_of(how));
        CHECK(most > 0);
        CHECK(left < B::of(1e-11, 1e-4) * most);
      }
    }
  });
}

TEST_CASE("areas of faces turn with soil that spins, and grow with soil that stretches", "[surface_loads]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    constexpr double spacing = 0.1, rate = 3, dt = 1e-3;
    for (const bool spins : {true, false}) {
      auto s = block_in_step<B>(spacing, dt);
      // A linear field at the nodes: a spin in the plane of x and y, or a stretch along x.
      set_velocities<B>(s, spacing, [&](const double(&x)[2], double(&v)[2]) {
        v[0] = spins ? -rate * x[1] : rate * x[0];
        v[1] = spins ? rate * x[0] : 0;
      });
      const auto first = on_host(s.soil.points.faces[0]);
      const std::vector<Face<Dim>> before(first.data(), first.data() + s.soil.points.count);
      follow_surfaces(s, s.loads, s.energy, dt);
      const auto after = on_host(s.soil.points.faces[0]);
      const double half = rate * dt / 2, turn = 2 * std::atan(half), stretch = (1 + half) / (1 - half);
      double wrong = 0;
      for (int p = 0; p < s.soil.points.count; ++p)
        for (int d = 0; d < Dim; ++d) {
          const auto& a = before[p];
          double exact = (d == 0 || spins ? 1 : stretch) * a[d];
          if (spins && d == 0) exact = std::cos(turn) * a[0] - std::sin(turn) * a[1];
          if (spins && d == 1) exact = std::sin(turn) * a[0] + std::cos(turn) * a[1];
          wrong = std::max(wrong, std::fabs(after(p)[d] - exact));
        }
      INFO(build.name() << (spins ? " spin" : " stretch"));
      CHECK(wrong < B::of(1e-13, 1e-6) * std::pow(spacing, Dim - 1));
    }
  });
}

TEST_CASE("areas of faces grow as the soil along them, not as that at the centres of particles",
          "[surface_loads]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    constexpr double spacing = 0.1, rate = 30, dt = 1e-3;
    auto s = block_in_step<B>(spacing, dt);
    set_velocities<B>(s, spacing, [&](const double(&x)[2], double(&v)[2]) {
      v[0] = 0, v[1] = rate * x[0] * x[1];  // the stretch along y grows with x
    });
    const auto origin = on_host(s.patches.origin);
    const auto first = on_host(s.soil.points.faces[0]);
    const std::vector<Face<Dim>> before(first.data(), first.data() + s.soil.points.count);
    const auto coordinate = on_host(s.soil.points.coordinate);
    const auto cell = on_host(s.soil.points.cell);
    follow_surfaces(s, s.loads, s.energy, dt);
    const auto after = on_host(s.soil.points.faces[0]);
    double wrong = 0;
    int looked_at = 0;
    for (int p = 0; p < s.soil.points.count; ++p) {
      const auto& a = before[p];
      if (!(std::fabs(a[0]) > 0) || a[1] != 0 || a[Dim - 1] != (Dim == 3 ? 0 : a[1])) continue;
      ++looked_at;
      const double in_cells =
          origin(cell(p) / Patch<Dim>::cells)[0] + coord_of<Dim>(cell(p))[0] + coordinate(p)[0];
      const double side = (in_cells + std::copysign(0.25, a[0])) * spacing, half = rate * side * dt / 2;
      wrong = std::max(wrong, std::fabs(after(p)[0] - a[0] * (1 + half) / (1 - half)));
    }
    INFO(build.name());
    CHECK(looked_at > 0);
    CHECK(wrong < B::of(1e-13, 1e-6) * std::pow(spacing, Dim - 1));
  });
}
