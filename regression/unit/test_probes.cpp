// Probes, sections and columns of soil: what the kernels collect is what the particles are, and what follows
// from it is exact for soil of known state.

#include <algorithm>
#include <catch2/catch_test_macros.hpp>
#include <numbers>

#include "compare.hpp"
#include "output/linear_fit.hpp"
#include "output/probes.hpp"
#include "output/rasters.hpp"
#include "rebuild/rebuild_state.hpp"
#include "transfer/column_sums.hpp"
#include "transfer/probe_particles.hpp"
#include "transfer/section_sums.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double h = 0.25, k_speed = 1.5;

/// A block of 4 x 2 (x 3) cells from (3, 1, 2) on, with 2 particles an edge, that moves along x. up: its axis
/// against the ground.
template <int Dim>
Cloud moving_block(bool rings = false) {
  Cloud cloud;
  cloud.grid = grid_of<Dim>({12, 9, 9}, h, Wall::roller);
  cloud.materials = clays();
  const std::array<double, 3> low =
      Dim == 2 ? std::array<double, 3>{3, 1, 0} : std::array<double, 3>{3, 2, 1};
  const std::array<double, 3> high =
      Dim == 2 ? std::array<double, 3>{7, 3, 0} : std::array<double, 3>{7, 5, 3};
  cloud.bodies = {body_of<Dim>(lattice<Dim>(low, high, 2, h), 2, h, 0)};
  BodyInput& body = cloud.bodies[0];
  body.common_velocity = {k_speed, 0, 0};
  if (rings) revolve(cloud);
  return cloud;
}

/// The mesh of the block, whose lower corner is not at zero.
Config config_of(int dim) {
  Config config;
  config.dim = dim;
  config.mesh.lower = {10, -5, 2};
  config.mesh.spacing = h;
  for (int d = 0; d < 3; ++d) config.mesh.upper[d] = config.mesh.lower[d] + (d == 0 ? 12 : 9) * h;
  return config;
}

ProbeConfig probe_of(ProbeKind kind, Vec3 at, const Config& config) {
  ProbeConfig probe{.name = "a", .kind = kind};
  for (int d = 0; d < 3; ++d) probe.at[d] = at[d] * h + config.mesh.lower[d];
  return probe;
}

/// The columns of one probe on the particles of a state.
template <class S>
std::vector<double> values_of(S& s, Config config, const ProbeConfig& probe) {
  config.probes = {probe};
  const ProbeState state{{0}, {0, 0, 0}, {0, 0}};
  const auto particles = particles_in(s, regions_of(config, state));
  std::vector<SectionSum> sections;
  for (const SectionPlane& plane : planes_of(config)) sections.push_back(section_sum(s, plane));
  return probe_values(config, state, particles, std::vector<double>(particles.size()), sections);
}

/// Moves all particles by a part of a cell.
template <class Space, class T, int Dim>
void push_along_x(const State<Space, T, Dim>& s, double cells) {
  const auto x = s.soil.points.coordinate;
  Kokkos::parallel_for(
      Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
      KOKKOS_LAMBDA(int p) { x(p)[0] += static_cast<T>(cells); });
}

double sum_of(const std::vector<double>& x) {
  double sum = 0;
  for (const double each : x) sum += each;
  return sum;
}

}  // namespace

TEST_CASE("regions hold the particles that are near them, and the nearest particle is the nearest",
          "[probes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(B::name());
    const Cloud cloud = random_cloud<Dim>(8);
    auto s = state_of<B>(cloud);
    drift_within_margin(s);
    const SoilFields soil = download_soil(s);
    const std::array<double, 3> centre{0.7, 0.6, 0.4};
    const std::vector<ProbeRegion> regions{{centre, {0.3, 0.2, 0.2}, false, -1, {}},
                                           {centre, {0.3, 0.2, 0.2}, false, -1, {2}}};
    std::vector<long> expected, of_body;
    double least = HUGE_VAL;
    for (std::size_t p = 0; p < soil.id.size(); ++p) {
      bool in = true;
      double square = 0;
      for (int d = 0; d < Dim; ++d) {
        const double r = soil.position[p * Dim + d] - centre[d];
        in = in && std::fabs(r) <= regions[0].reach[d], square += r * r;
      }
      if (in) expected.push_back(soil.id[p]);
      const bool third =
          p >= static_cast<std::size_t>(soil.first[2]) && p < static_cast<std::size_t>(soil.first[3]);
      if (in && third) of_body.push_back(soil.id[p]);
      if (third) least = std::min(least, square);
    }
    std::sort(expected.begin(), expected.end()), std::sort(of_body.begin(), of_body.end());
    REQUIRE(of_body.size() > 3);
    REQUIRE(expected.size() > of_body.size());
    std::vector<long> found[2];
    for (const ProbeParticle& p : particles_in(s, regions)) found[p.region].push_back(p.id);
    CHECK(found[0] == expected);
    CHECK(found[1] == of_body);
    CHECK(std::fabs(nearest_particle(s, centre, {2}).square - least) < 1e-12);
    const ProbeRegion followed{centre, {}, false, static_cast<int>(of_body[2]), {}};
    const auto alone = particles_in(s, {followed});
    REQUIRE(alone.size() == 1);
    CHECK(alone[0].id == of_body[2]);
  });
}

TEST_CASE("a gauge in a block has its depth and speed", "[probes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(B::name());
    const double depth = 2 * h, near = B::of(1e-13, 1e-5);
    for (const bool rings : {false, Dim == 2})
      for (const double width : {0.0, 0.3 * h, h}) {
        auto s = state_of<B>(moving_block<Dim>(rings));
        Config config = config_of(Dim);
        if (rings) config.geometry = Geometry::axisymmetric;
        ProbeConfig probe = probe_of(ProbeKind::gauge, {5.1, 3.6, 0}, config);
        probe.width = width;
        const auto in = values_of(s, config, probe);
        const double base = config.mesh.lower[Dim - 1] + h;
        REQUIRE(in.size() == 4 + Dim);
        CHECK(std::fabs(in[0] / depth - 1) < near);
        CHECK(std::fabs(in[1] - base - depth) < near);
        CHECK(std::fabs(in[2] - base) < near);
        CHECK(std::fabs(in[3] / k_speed - 1) < near);
        CHECK(std::fabs(in[4] / k_speed - 1) < near);
        CHECK(std::fabs(in[5]) < near);
        probe.at[0] = config.mesh.lower[0] + 9 * h;
        const auto out = values_of(s, config, probe);
        CHECK(out[0] == 0);
        CHECK(std::isnan(out[1]));
        CHECK(out[3] == 0);
        if (width > 0) {  // a strip that is half in the block
          probe.at[0] = config.mesh.lower[0] + 7 * h;
          const double inner = rings ? 0.5 * (7 - width / h / 4) / 7 : 0.5;
          CHECK(std::fabs(values_of(s, config, probe)[0] / depth - inner) < near);
        }
      }
  });
}

TEST_CASE("a section has the mass of a block beyond it, and the mass that passes", "[probes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(B::name());
    const double near = B::of(1e-13, 1e-5), pi = std::numbers::pi;
    for (const bool rings : {false, Dim == 2}) {
      auto s = state_of<B>(moving_block<Dim>(rings));
      const double side = (Dim == 3 ? 3 * h : 1) * 2 * h;  // m2, of a plane block normal to x
      for (const double place : {3.0, 4.37, 5.0, 6.9, 7.0}) {
        const SectionSum sum = section_sum(s, {0, place * h, {}});
        const double beyond = rings ? pi * (49 - place * place) * h * h * 2 * h : (7 - place) * h * side;
        const double low = std::max(place - 0.5, 3.0), high = std::min(place + 0.5, 7.0);  // of the strip
        const double area = rings ? pi * (high * high - low * low) * h * 2 * h : (high - low) * side;
        const double flux = k_density * area * k_speed;
        CHECK(std::fabs(sum.initial_volume - beyond) < near);
        CHECK(std::fabs(sum.mass - k_density * beyond) < k_density * near);
        CHECK(std::fabs(sum.mass_flux - flux) < k_density * near);
        CHECK(std::fabs(sum.volume_flux - flux / k_density) < near);
        CHECK(std::fabs(sum.momentum_flux[0] - flux * k_speed) < k_density * near);
        CHECK(sum.momentum_flux[1] == 0);
      }
      CHECK(section_sum(s, {1, 5 * h, {}}).mass_flux == 0);
      CHECK(section_sum(s, {0, 2 * h, {}}).mass > 0);
    }
  });
}

TEST_CASE("what leaves beyond a section counts there", "[probes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(B::name());
    Cloud cloud = moving_block<Dim>();
    cloud.grid = grid_of<Dim>({7, 9, 9}, h, Wall::free);
    auto s = state_of<B>(cloud);
    const std::vector<SectionPlane> planes{
        {0, 6.6 * h, {}}, {0, 6.6 * h, {0}}, {1, 0.5 * h, {}}, {1, 8 * h, {}}};
    std::vector<SectionSum> lost(planes.size());
    const double mass = k_density * std::pow(h / 2, Dim), column = mass * (Dim == 2 ? 4 : 6 * 4);
    push_along_x(s, 0.3);
    const auto beyond = beyond_mask(s, planes);
    locate(s);
    REQUIRE(read_control(s).lost == std::lround(column / mass));
    add_lost_beyond(s, planes, beyond, lost);
    CHECK(std::fabs(lost[0].mass / column - 1) < 1e-6);
    CHECK(std::fabs(lost[1].initial_volume * k_density / column - 1) < 1e-6);
    CHECK(std::fabs(lost[2].mass / column - 1) < 1e-6);
    CHECK(lost[3].mass == 0);
  });
}

TEST_CASE("columns hold the volume of the particles, and a block has its depth", "[probes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(B::name());
    for (const bool rings : {false, Dim == 2})
      for (const double cell : {h, 0.4 * h, 2.5 * h}) {
        auto s = state_of<B>(moving_block<Dim>(rings));
        Config config = config_of(Dim);
        config.rasters = {.on = true, .spacing = cell, .threshold_depth = 1e-3};
        const ColumnGrid grid = column_grid(config);
        Rasters rasters;
        rasters.begin(config);
        rasters.update(config, 2.5, column_sums(s, grid));
        double volume = 0, exact = sum_of(download_soil(s).volume);
        for (int j = 0; j < grid.cells[1]; ++j)
          for (int i = 0; i < grid.cells[0]; ++i) {
            const double depth = rasters.depth[std::size_t(j) * grid.cells[0] + i];
            const double area = rings      ? std::numbers::pi * cell * cell * (2 * i + 1)
                                : Dim == 3 ? cell * cell
                                           : cell;
            volume += depth * area;
            const double low = i * cell / h, high = (i + 1) * cell / h;
            const double low_y = j * cell / h, high_y = (j + 1) * cell / h;
            const bool inside = low >= 3 && high <= 7 && (Dim == 2 || (low_y >= 2 && high_y <= 5));
            const bool outside = high <= 3 || low >= 7 || (Dim == 3 && (high_y <= 2 || low_y >= 5));
            if (inside) CHECK(std::fabs(depth / (2 * h) - 1) < B::of(1e-10, 1e-5));
            if (outside) CHECK(depth < B::of(1e-12, 1e-6));
            if (inside)
              CHECK(std::fabs(rasters.most_speed[std::size_t(j) * grid.cells[0] + i] / k_speed - 1) < 1e-6);
            if (inside) CHECK(rasters.arrival[std::size_t(j) * grid.cells[0] + i] == 2.5);
          }
        CHECK(std::fabs(volume / exact - 1) < B::of(1e-10, 1e-5));
      }
  });
}

TEST_CASE("a point in soil with a linear velocity and stress has their values there", "[probes]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = moving_block<Dim>();
    BodyInput& body = cloud.bodies[0];
    const auto linear = [](const double* x, int k) { return (k + 1) * (1 + 2 * x[0] - 3 * x[Dim - 1]); };
    for (std::size_t p = 0; p < body.position.size() / Dim; ++p) {
      for (int d = 0; d < Dim; ++d) body.velocity.push_back(linear(&body.position[p * Dim], d));
      for (int k = 0; k < sym_size<Dim>; ++k) body.stress.push_back(linear(&body.position[p * Dim], 10 + k));
    }
    auto s = state_of<B>(cloud);
    const Config config = config_of(Dim);
    for (const double x : {3.1, 4.13, 5.5, 6.99}) {
      const ProbeConfig probe = probe_of(ProbeKind::point, {x, Dim == 2 ? 1.7 : 3.3, 1.7}, config);
      double place[3];
      for (int d = 0; d < 3; ++d) place[d] = probe.at[d] - config.mesh.lower[d];
      const auto values = values_of(s, config, probe);
      REQUIRE(values.size() == columns_of(probe, config).size());
      for (int d = 0; d < Dim; ++d) CHECK(std::fabs(values[d] - linear(place, d)) < 1e-10);
      for (int k = 0; k < sym_size<Dim>; ++k)
        CHECK(std::fabs(values[Dim + k] - linear(place, 10 + k)) < 1e-9);
    }
    const auto none = values_of(s, config, probe_of(ProbeKind::point, {1, 5, 1.7}, config));
    for (const double value : none) CHECK(std::isnan(value));
  });
}

TEST_CASE("a linear fit is exact for linear functions, and a mean where the points lie on a line",
          "[probes]") {
  LinearFit plane(2, 1), line(2, 1);
  const double points[][2] = {{0.3, 0.9}, {-0.7, 0.2}, {0.5, -0.4}, {1.0, 0.1}};
  for (const auto& r : points) {
    const double value = 3 - 2 * r[0] + 5 * r[1];
    plane.add(1 + r[0] * r[0], r, &value);
    const double on_line[2] = {r[0], 0};
    line.add(1, on_line, &value);
  }
  CHECK(std::fabs(plane.value()[0] - 3) < 1e-12);
  CHECK(std::fabs(line.value()[0] - (12 - 2 * 1.1 + 5 * 0.8) / 4) < 1e-12);
  CHECK(LinearFit(3, 2).value() == std::vector<double>{0, 0});
}

TEST_CASE("rasters keep what was greatest and when soil came first", "[probes]") {
  Config config = config_of(2);
  config.rasters = {.on = true, .spacing = h, .threshold_depth = 0.5, .threshold_speed = 1};
  const auto sums = [&](double depth, double speed) {
    std::vector<long> all(static_cast<std::size_t>(column_grid(config).count()) * 3);
    all[3] = std::lround(depth / h / k_depth_quantum);
    all[4] = -std::lround(depth / h / k_depth_quantum * speed);
    return all;
  };
  Rasters rasters;
  rasters.begin(config);
  const double steps[][5] = {// time, depth, speed; greatest speed and arrival then
                             {1, 0.4, 9, 0, k_never},
                             {2, 2, 0.5, 0.5, k_never},
                             {3, 1, 3, 3, 3},
                             {4, 0.7, 2, 3, 3}};
  double most = 0;
  for (const auto& [time, depth, speed, most_speed, arrival] : steps) {
    rasters.update(config, time, sums(depth, speed));
    most = std::max(most, depth);
    CHECK(std::fabs(rasters.most_depth[1] - most) < 1e-11);
    CHECK(std::fabs(rasters.most_speed[1] - most_speed) < 1e-11);
    CHECK(rasters.arrival[1] == arrival);
    CHECK(std::fabs(rasters.depth[1] - depth) < 1e-11);
    CHECK(rasters.most_depth[2] == 0);
    CHECK(are_sound(rasters, config));
  }
  rasters.arrival.pop_back();
  CHECK_FALSE(are_sound(rasters, config));
}
