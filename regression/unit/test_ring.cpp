// Particles that are rings: their weights, and what steps make of them.

#include <catch2/catch_test_macros.hpp>
#include <numbers>

#include "compare.hpp"
#include "physics/ring_domain.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Means of N, dN/dr and N/r of a node at `node` over [low, high] with the measure r dr, by Gauss quadrature
/// of three points on each side of the nodes [cells].
struct Means {
  double s = 0, g = 0, t = 0;
};
Means quadrature(double low, double high, double node) {
  constexpr double k_place[] = {-0.7745966692414834, 0, 0.7745966692414834},
                   k_weight[] = {5. / 9, 8. / 9, 5. / 9};
  Means sum;
  double measure = 0;
  for (double from = low; from < high;) {
    const double to = std::min(high, std::floor(from) + 1), half = (to - from) / 2;
    for (int q = 0; q < 3; ++q) {
      const double r = from + half * (1 + k_place[q]), n = std::max(0.0, 1 - std::fabs(r - node));
      const double slope = n == 0 ? 0 : r < node ? 1 : -1, w = half * k_weight[q];
      sum.s += w * n * r, sum.g += w * slope * r, sum.t += w * n, measure += w * r;
    }
    from = to;
  }
  return {sum.s / measure, sum.g / measure, sum.t / measure};
}

/// Radii of particles [cells]: next to the axis, so that their domain is cut there, and anywhere.
std::vector<double> radii(double l) {
  std::vector<double> r{l, l / 2, l / 100, 1 - l, 1, 1 + l, 2 - l, 1.5};
  Dice dice{std::mt19937_64(5)};
  for (int n = 0; n < 500; ++n) r.push_back(dice.uniform(0.001, n % 2 ? 1.5 : 30));
  return r;
}

Cloud ring_cloud(int seed) {
  Cloud cloud = random_cloud<2>(seed, Wall::roller);
  cloud.rigids.resize(1);
  revolve(cloud);
  return cloud;
}

/// A cylinder of clay that fills the cells below radius 6 and height 4, of n particles an edge.
Cloud cylinder(int n) {
  constexpr double spacing = 0.25;
  Cloud cloud;
  cloud.grid = grid_of<2>({16, 12, 1}, spacing, Wall::free);
  cloud.materials = clays();
  cloud.bodies = {body_of<2>(lattice<2>({0, 2, 0}, {6, 6, 1}, n, spacing), n, spacing, 0)};
  revolve(cloud);
  return cloud;
}

constexpr double k_dt = 1e-4;

template <class F>
void for_each_plane_build(F&& f) {
  for_each_build([&](auto build) {
    if constexpr (decltype(build)::dim == 2) f(build);
  });
}

}  // namespace

TEST_CASE("weights of a ring are the means over it with the measure r dr, to the axis", "[ring]") {
  for (const double l : {0.5, 0.25, 1. / 6, 0.125})
    for (const double r : radii(l)) {
      const double cell = std::floor(r), low = std::max(0.0, r - l), high = r + l;
      const RingDomain<double> ring{l, -cell};
      const RadialWeights<double> a = radial_weights(r - cell, ring);
      INFO("r " << r << " l " << l);
      double w = 0, g = 0, t = 0, linear = 0, slope = 0, hoop = 0;
      for (int k = 0; k < 3; ++k) {
        const double node = cell + a.first + k;
        const Means exact = quadrature(low, high, node);
        CHECK(std::fabs(a.w[k] - exact.s) < 1e-13);
        CHECK(std::fabs(a.g[k] - exact.g) < 1e-12);
        CHECK(std::fabs(a.t[k] - exact.t) < 1e-12 * (1 + 1 / r));
        CHECK(a.w[k] >= -1e-15);
        w += a.w[k], g += a.g[k], t += a.t[k];
        linear += a.w[k] * node, slope += a.g[k] * node, hoop += a.t[k] * node;
      }
      CHECK(std::fabs(w - 1) < 1e-14);
      CHECK(std::fabs(g) < 1e-13);
      CHECK(std::fabs(slope - 1) < 1e-12);
      CHECK(std::fabs(hoop - 1) < 1e-12);
      CHECK(std::fabs(linear - (cell + a.centroid)) < 1e-12);
    }
}

TEST_CASE("a ring that drifts has the same weights, and so has each node alone", "[ring]") {
  constexpr double l = 0.25;
  Dice dice{std::mt19937_64(8)};
  for (int n = 0; n < 1000; ++n) {
    const int cell = dice.below(3);
    const double x = dice.uniform(cell == 0 ? 0.01 : -0.5, 1.5), z = dice.uniform(-0.5, 1.5);
    const RingDomain<double> ring{l, double(-cell)};
    double any[4][4][4] = {}, near[4][4][4] = {};
    const auto put = [](double(&to)[4][4][4]) {
      return [&](const auto& a) {
        for_each_weight(a, [&](const Vector<int, 2>& k, double w, const Vector<double, 3>& grad) {
          if (w == 0 && grad[0] == 0 && grad[1] == 0) return;
          auto& node = to[a[0].first + k[0] + 1][a[1].first + k[1] + 1];
          node[0] += w;
          for (int d = 0; d < 3; ++d) node[1 + d] += grad[d];
        });
      };
    };
    with_weights(Vector<double, 2>{x, z}, ring, put(any));
    with_weights_near(Vector<double, 2>{x, z}, ring, put(near));
    double apart = 0, alone = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        Vector<double, 3> grad;
        const int at = cell + i - 1;
        const double w = single_node_weight(Vector<double, 2>{x - (i - 1), z - (j - 1)},
                                            RingDomain<double>{l, double(-at)}, grad);
        const double node[] = {w, grad[0], grad[1], grad[2]};
        for (int k = 0; k < 4; ++k) {
          apart = std::max(apart, std::fabs(any[i][j][k] - near[i][j][k]));
          alone = std::max(alone, std::fabs(any[i][j][k] - node[k]) * (w > 0 || any[i][j][0] > 0));
        }
      }
    INFO("x " << x << " z " << z << " cell " << cell);
    CHECK(apart < 1e-13);
    CHECK(alone < 1e-12);
  }
}

TEST_CASE("nodal sums of rings are those of the plain loop, by every strategy", "[ring]") {
  for (const double margin : {0.0, 0.5}) {
    Cloud cloud = ring_cloud(3);
    cloud.p2g.margin = margin > 0 ? margin : 0.25;
    const auto fields = [&](auto&& s) {
      interpolate(s);
      return nodal_fields(s);
    };
    const auto expected = fields(state_of<Reference<2>>(cloud));
    Cloud plane = cloud;
    plane.rings = false;
    CHECK(largest_difference(fields(state_of<Reference<2>>(plane)), expected) > 1e-3);
    for_each_plane_build([&](auto build) {
      using B = decltype(build);
      for (const P2G how : k_strategies) {
        INFO(build.name() << ' ' << word_of(how) << " margin " << margin);
        CHECK(largest_difference(fields(state_of<B>(cloud, how)), expected) < B::of(1e-12, 1e-5));
      }
    });
  }
}

TEST_CASE("steps of rings are those of the plain loop, by every strategy and velocity update", "[ring]") {
  for_each_plane_build([](auto build) {
    using B = decltype(build);
    for (const int kind : {0, 1, 2}) {
      Cloud cloud = ring_cloud(6);
      cloud.gravity = {0, -9.81, 0};
      cloud.f_bar_fraction = kind == 1 ? 0.9 : 0;
      cloud.flip_fraction = kind == 0 ? 1 : kind == 1 ? 0.5 : 0;
      if (kind == 1) cloud.xpic_order = 2;
      cloud.affine = kind == 2;
      auto plain = state_of<Reference<2>>(cloud);
      run_steps(plain, k_dt, 6);
      for (const P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        run_steps(s, k_dt, 6);
        INFO(B::name() << " " << word_of(how) << ", velocity update " << kind);
        CHECK(largest_difference(soil_fields(s), soil_fields(plain)) < B::of(1e-10, 2e-2));
      }
    }
  });
}

TEST_CASE("an even stress in a cylinder loads its surface alone, by the surface's area", "[ring]") {
  for (const int n : {1, 2, 3}) {
    Cloud cloud = cylinder(n);
    constexpr double pressure = 1000, spacing = 0.25;
    for (std::size_t p = 0; p < cloud.bodies[0].position.size() / 2; ++p)
      for (const double s : {-pressure, -pressure, -pressure, 0.0}) cloud.bodies[0].stress.push_back(s);
    auto s = state_of<Reference<2>>(cloud);
    interpolate(s);
    const Table table = nodes_of(s, s.nodes.soil);
    const auto number = on_host(s.patches.number);
    using S = SoilTerms<2>;
    double inner = 0, outer = 0, top = 0;
    for (int i = 0; i < s.patches.node_count(); ++i) {
      const long patch = number(i / Patch<2>::cells);
      const Coord<2> from = s.grid.origin_of(patch), in = coord_of<2>(i);
      const int r = from[0] + in[0], z = from[1] + in[1];
      const double* const node = &table.value[(patch * Patch<2>::cells + i % Patch<2>::cells) * table.width];
      if (r > 0 && r < 5 && z > 2 && z < 6)
        inner = std::max({inner, std::fabs(node[S::force]), std::fabs(node[S::force + 1])});
      if (r >= 5) outer += node[S::force];
      if (z >= 5) top += node[S::force + 1];
    }
    constexpr double radius = 6 * spacing, height = 4 * spacing;
    INFO(n << " particles along an edge");
    CHECK(inner < 1e-11 * pressure);
    CHECK(std::fabs(outer - pressure * 2 * std::numbers::pi * radius * height) < 1e-9 * pressure);
    CHECK(std::fabs(top - pressure * std::numbers::pi * radius * radius) < 1e-9 * pressure);
  }
}

TEST_CASE("velocities c r and c' z strain all rings alike, to the axis", "[ring]") {
  constexpr double spacing = 0.25, across = 0.3, along = -0.2, dt = 1e-4;
  for_each_plane_build([&](auto build) {
    using B = decltype(build);
    for (const int n : {1, 2, 3}) {
      Cloud cloud = cylinder(n);
      cloud.affine = true, cloud.flip_fraction = 0;
      BodyInput& body = cloud.bodies[0];
      const double half = spacing / n / 2;
      for (std::size_t p = 0; p < body.position.size(); p += 2) {
        const double r = body.position[p], centroid = r + half * half / (3 * r);
        for (const double v : {across * centroid, along * body.position[p + 1]}) body.velocity.push_back(v);
        for (const double g : {across, 0.0, 0.0, along}) body.velocity_gradient.push_back(g * spacing);
      }
      const double lame = 1.5e6 * 0.49 / (1.49 * 0.02), shear = 1.5e6 / (2 * 1.49),
                   trace = 2 * across + along;
      const double in_plane = dt * (lame * trace + 2 * shear * across),
                   up = dt * (lame * trace + 2 * shear * along);
      for (const P2G how : k_strategies) {
        auto s = state_of<B>(cloud, how);
        one_step(s, dt);
        const SoilFields after = download_soil(s);
        double apart = 0;
        for (std::size_t k = 0; k < after.stress.size(); ++k) {
          const double exact = k % 4 == 3 ? 0 : k % 4 == 1 ? up : in_plane;
          apart = std::max(apart, std::fabs(after.stress[k] - exact));
        }
        INFO(B::name() << " " << word_of(how) << ", " << n << " particles along an edge");
        CHECK(apart < B::of(1e-11, 1e-4) * std::fabs(in_plane));
      }
    }
  });
}

TEST_CASE("a cylinder that moves along its axis keeps its shape, its momentum and its stress", "[ring]") {
  for_each_plane_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = cylinder(2);
    cloud.bodies[0].common_velocity = {0, 5, 0};
    for (const P2G how : k_strategies) {
      auto s = state_of<B>(cloud, how);
      const std::vector<double> before = download_soil(s).position;
      constexpr int steps = 500;
      run_steps(s, 2e-4, steps);
      const SoilFields after = download_soil(s);
      double drift = 0, stress = 0;
      for (std::size_t k = 0; k < before.size(); ++k)
        drift = std::max(drift, std::fabs(after.position[k] - before[k] - (k % 2) * 5 * 2e-4 * steps));
      for (const double value : after.stress) stress = std::max(stress, std::fabs(value));
      INFO(B::name() << " " << word_of(how));
      CHECK(drift < B::of(1e-12, 1e-4));
      CHECK(stress < B::of(1e-6, 50));
    }
  });
}

TEST_CASE("particles do not pass the axis, however fast they come", "[ring]") {
  for_each_plane_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = cylinder(3);
    auto& body = cloud.bodies[0];
    for (std::size_t p = 0; p < body.position.size(); p += 2)
      body.velocity.push_back(-20 * body.position[p]), body.velocity.push_back(0);
    for (const P2G how : k_strategies) {
      auto s = state_of<B>(cloud, how);
      run_steps(s, 1e-4, 100);
      const SoilFields after = download_soil(s);
      double least = 1;
      for (std::size_t p = 0; p < after.position.size(); p += 2) least = std::min(least, after.position[p]);
      INFO(B::name() << " " << word_of(how));
      CHECK(least > 0);
      CHECK(read_control(s).fault_count == 0);
      CHECK(on_host(s.strays.put_back)(0) == 0);
    }
  });
}
