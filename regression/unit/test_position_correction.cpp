// The correction of positions towards an even density.

#include <catch2/catch_test_macros.hpp>
#include <cmath>

#include "compare.hpp"
#include "rebuild/rebuild_state.hpp"
#include "step/correct_positions.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double h = 0.1;         // m
constexpr double k_shear = 2;     // 1/s, of the motion
constexpr double k_elapsed = 10;  // s, so that the diffusion number is at its bound

/// Material that moves: fluid, or elastic soil.
enum class Stuff { fluid, elastic };

/// Velocity at a place [m]: a shear, and a translation.
template <int Dim>
std::array<double, 3> motion_at(const double* x) {
  return {0.3 + k_shear * x[1], Dim == 3 ? k_shear * x[2] : -0.2, 0.1};
}

/// Soil in a lattice whose places are moved by up to `scatter` cells; it fills cells up to `height` of a mesh
/// of 12 x 10 x 6 between walls. moves: as motion_at, else as one body.
template <int Dim>
Cloud soil_of(Stuff stuff, double scatter, double height, bool moves = true) {
  Cloud cloud;
  Dice dice{std::mt19937_64(7)};
  cloud.grid = grid_of<Dim>({12, 10, 6}, h, Wall::roller);
  cloud.materials = clays();
  cloud.materials.push_back({model_index_in<Newtonian>(Materials{}), {1e5, 1}});
  BodyInput body =
      body_of<Dim>(lattice<Dim>({0, 0, 0}, {12, height, 6}, 2, h), 2, h, stuff == Stuff::fluid ? 2 : 0);
  if (stuff == Stuff::fluid) body.state.clear();
  const int cells[3] = {12, 10, 6};
  for (std::size_t n = 0; n < body.position.size(); ++n) {
    const double most = cells[n % Dim] * h, moved = body.position[n] + scatter * h * dice.uniform(-1, 1);
    body.position[n] = std::min(most - h / 4, std::max(h / 4, moved));
  }
  for (std::size_t p = 0; p < body.position.size() / Dim; ++p) {
    const auto v = motion_at<Dim>(&body.position[p * Dim]);
    for (int d = 0; d < Dim; ++d) body.velocity.push_back(moves ? v[d] : 0.3);
  }
  cloud.bodies = {body};
  return cloud;
}

template <class S>
void turn_on(S& s, const Cloud& cloud) {
  s.correction.on = true, s.correction.rate = 20;
  s.p2g.margin = 0.5 - k_most_shift, s.p2g.reserve = k_most_shift;
  s.correction.flow_column = decltype(s.correction.flow_column)("flow_column", cloud.materials.size());
  const auto host = Kokkos::create_mirror_view(s.correction.flow_column);
  host(0) = Flow::never, host(1) = 0, host(2) = Flow::always;
  Kokkos::deep_copy(s.correction.flow_column, host);
  rebuild(s);
}

template <class B>
StateOf<B> corrected(const Cloud& cloud, int times, P2G how = P2G::tile, double elapsed = k_elapsed) {
  auto s = state_of<B>(cloud, how);
  turn_on(s, cloud);
  for (int n = 0; n < times; ++n) {
    if (n > 0) rebuild(s);
    REQUIRE(correct_positions(s, elapsed) == PETSC_SUCCESS);
    begin_domains(s);
  }
  return s;
}

/// Weight of a node at a distance r [cells] along an axis, for a particle of half length l.
double weight_at(double r, double l) {
  const double a = std::fabs(r);
  if (a < l) return 1 - (r * r + l * l) / (2 * l);
  if (a < 1 - l) return 1 - a;
  return a < 1 + l ? (1 + l - a) * (1 + l - a) / (4 * l) : 0;
}

/// Standard deviation of the volume at the nodes of a mesh that is full of soil, over the full volume.
template <int Dim>
double scatter_of(const SoilFields& soil) {
  std::array<int, 3> nodes{13, 11, Dim == 3 ? 7 : 1};
  std::vector<double> volume(nodes[0] * nodes[1] * nodes[2]);
  const double l = 0.25;
  for (std::size_t p = 0; p < soil.id.size(); ++p)
    for (int n = 0; n < static_cast<int>(volume.size()); ++n) {
      const int at[3] = {n % nodes[0], n / nodes[0] % nodes[1], n / (nodes[0] * nodes[1])};
      double weight = 1;
      for (int d = 0; d < Dim && weight > 0; ++d)
        weight *= weight_at(soil.position[p * Dim + d] / h - at[d], l);
      volume[n] += soil.volume[p] / std::pow(h, Dim) * weight;
    }
  double square = 0;
  int count = 0;
  for (int n = 0; n < static_cast<int>(volume.size()); ++n) {
    const int at[3] = {n % nodes[0], n / nodes[0] % nodes[1], n / (nodes[0] * nodes[1])};
    bool inside = true;
    for (int d = 0; d < Dim; ++d) inside = inside && at[d] > 0 && at[d] < nodes[d] - 1;
    if (inside) square += (volume[n] - 1) * (volume[n] - 1), ++count;
  }
  return std::sqrt(square / count);
}

/// Mass times velocity, summed.
template <int Dim>
std::array<double, 3> momentum_of(const SoilFields& soil) {
  std::array<double, 3> sum{};
  for (std::size_t p = 0; p < soil.id.size(); ++p)
    for (int d = 0; d < Dim; ++d) sum[d] += soil.mass[p] * soil.velocity[p * Dim + d];
  return sum;
}

}  // namespace

TEST_CASE("the correction evens the density of a fluid that is sheared, and keeps its momentum",
          "[position_correction]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (const bool stretch : {false, true}) {
      Cloud cloud = soil_of<Dim>(Stuff::fluid, 0.3, 10);
      cloud.stretch = stretch;
      const SoilFields before = download_soil(corrected<B>(cloud, 0));
      const auto once = corrected<B>(cloud, 1), often = corrected<B>(cloud, 10);
      const SoilFields after = download_soil(once), at_last = download_soil(often);
      INFO(B::name() << (stretch ? " stretch" : " fixed"));
      CHECK(scatter_of<Dim>(after) < 0.85 * scatter_of<Dim>(before));
      CHECK(scatter_of<Dim>(at_last) < 0.4 * scatter_of<Dim>(before));
      const auto p = momentum_of<Dim>(before), q = momentum_of<Dim>(at_last);
      for (int d = 0; d < Dim; ++d)
        CHECK(std::fabs(q[d] - p[d]) < B::of(1e-12, 1e-5) * (std::fabs(p[0]) + std::fabs(p[1])));
      double moved = 0;
      for (std::size_t n = 0; n < before.position.size(); ++n)
        moved = std::max(moved, std::fabs(after.position[n] - before.position[n]) / h);
      CHECK(moved > 0.01);
      CHECK(moved <= k_most_shift * (1 + 1e-5));
      const int cells[3] = {12, 10, 6};
      for (std::size_t n = 0; n < at_last.position.size(); ++n) {
        const double from_wall = std::min(at_last.position[n], cells[n % Dim] * h - at_last.position[n]);
        CHECK(from_wall > (0.25 - B::of(1e-12, 1e-5)) * h);
      }
    }
  });
}

TEST_CASE("a particle that is moved gets the velocity of its new place", "[position_correction]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const Cloud cloud = soil_of<Dim>(Stuff::fluid, 0.3, 10);
    const SoilFields before = download_soil(corrected<B>(cloud, 0)),
                     after = download_soil(corrected<B>(cloud, 1));
    // FLIP: a velocity that stays with its particle is wrong by the shift times the shear.
    double kept = 0, now = 0;
    for (std::size_t p = 0; p < before.id.size(); ++p) {
      const int cells[3] = {12, 10, 6};
      bool inside = true;  // far from the walls, which the motion ignores
      for (int d = 0; d < Dim; ++d)
        inside = inside && std::fabs(after.position[p * Dim + d] / h - cells[d] / 2.0) < cells[d] / 2.0 - 2.2;
      if (!inside) continue;
      const auto exact = motion_at<Dim>(&after.position[p * Dim]);
      kept += std::pow(before.velocity[p * Dim] - exact[0], 2),
          now += std::pow(after.velocity[p * Dim] - exact[0], 2);
    }
    CHECK(now < 0.25 * kept);
  });
}

TEST_CASE("soil that does not flow stays as it is", "[position_correction]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(B::name());
    for (const bool moves : {false, true}) {
      const Cloud elastic = soil_of<B::dim>(Stuff::elastic, 0.3, 7, moves);
      CHECK(soil_fields(corrected<B>(elastic, 3)) == soil_fields(corrected<B>(elastic, 0)));
    }
    // A fluid that moves as a whole, but at the walls, where its nodes are at rest.
    Cloud fluid = soil_of<B::dim>(Stuff::fluid, 0.3, 7, false);
    for (auto& walls : fluid.grid.walls) walls = {Wall::free, Wall::free};
    CHECK(largest_difference(soil_fields(corrected<B>(fluid, 3)), soil_fields(corrected<B>(fluid, 0))) <
          B::of(1e-10, 1e-4));
  });
}

TEST_CASE("a level free surface and the lattice below it stay, wherever it is in a cell",
          "[position_correction]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(B::name());
    for (const double lift : {0.0, 0.1, 0.25, 0.4}) {  // cells
      Cloud cloud = soil_of<Dim>(Stuff::fluid, 0, 6);
      for (std::size_t p = 0; p < cloud.bodies[0].position.size() / Dim; ++p)
        cloud.bodies[0].position[p * Dim + 1] += lift * h;
      cloud.grid.walls[1] = {Wall::free, Wall::free};
      const auto before = soil_fields(corrected<B>(cloud, 0)), after = soil_fields(corrected<B>(cloud, 5));
      CHECK(largest_difference(after[0], before[0]) < B::of(1e-11, 1e-4));
    }
  });
}

TEST_CASE("every strategy corrects alike", "[position_correction]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const bool stretch : {false, true}) {
      Cloud cloud = soil_of<B::dim>(Stuff::fluid, 0.3, 7.3);
      cloud.stretch = stretch;
      const auto expected = soil_fields(corrected<B>(cloud, 3, P2G::sequential));
      for (const P2G how : k_strategies) {
        INFO(B::name() << " " << word_of(how));
        CHECK(largest_difference(soil_fields(corrected<B>(cloud, 3, how)), expected) < B::of(1e-10, 1e-3));
      }
      for (const P2G how : {P2G::sequential, P2G::gather})
        if (B::is_double || !is_device<typename B::Space>)
          CHECK(soil_fields(corrected<B>(cloud, 3, how)) == soil_fields(corrected<B>(cloud, 3, how)));
    }
  });
}

TEST_CASE("no particle moves towards a rigid body", "[position_correction]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = soil_of<Dim>(Stuff::fluid, 0.3, 6);
    RigidInput plate = rigid_of<Dim>(lattice<Dim>({4, 7, 0}, {8, 8, 6}, 2, h), 2, h);
    plate.surface.centre = {6 * h, 7.5 * h, 3 * h}, plate.surface.half = {2 * h, 0.5 * h, 3 * h};
    plate.surface_normal = true;
    cloud.rigids = {plate};
    const SoilFields before = download_soil(corrected<B>(cloud, 0)),
                     after = download_soil(corrected<B>(cloud, 1));
    int still = 0, moved = 0;
    for (std::size_t p = 0; p < before.id.size(); ++p) {
      const double* x = &before.position[p * Dim];
      const double dx = std::max(0.0, std::fabs(x[0] - 6 * h) - 2 * h), dy = 7 * h - x[1];
      bool same = true;
      for (int d = 0; d < Dim; ++d) same = same && x[d] == after.position[p * Dim + d];
      if (std::sqrt(dx * dx + dy * dy) < 1.45 * h) still += same, moved += !same;
    }
    INFO(B::name());
    CHECK(still > 0);
    CHECK(moved == 0);
  });
}
