// Columns of the free field beside sides of the mesh.

#include <catch2/catch_test_macros.hpp>
#include <map>

#include "compare.hpp"
#include "functions/absorbing_sides.hpp"
#include "physics/sides.hpp"
#include "transfer/upload_sides.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_edge = 0.1, k_young = 1.5e6, k_poisson = 0.25;  // m, Pa, -
constexpr double k_shear = k_young / (2 * (1 + k_poisson)),
                 k_lame = 2 * k_shear * k_poisson / (1 - 2 * k_poisson);

/// Level elastic ground, the surface of which lies in the middle of a cell, between sides of the free field.
template <int Dim>
Cloud level_ground(Wall base) {
  Cloud cloud;
  cloud.grid = grid_of<Dim>({6, Dim == 2 ? 9 : 5, 8}, k_edge, Wall::free_field);
  cloud.grid.walls[Dim - 1] = {base, Wall::free};
  cloud.materials = {{0, {k_young, k_poisson}}};
  BodyInput body =
      body_of<Dim>(lattice<Dim>({0, 0, 0}, {6, Dim == 2 ? 6.5 : 5, 5.5}, 2, k_edge), 2, k_edge, 0);
  body.state.clear();
  cloud.bodies = {body};
  cloud.f_bar_fraction = 0.98;
  return cloud;
}

template <class B>
StateOf<B> begun(const Cloud& cloud, P2G how = P2G::tile) {
  constexpr int Dim = B::dim;
  auto s = state_of<B>(cloud, how);
  std::vector<SideInput> sides;
  for (int d = 0; d < Dim - 1; ++d)
    for (int side = 0; side < 2; ++side) sides.push_back({.direction = d, .side = side});
  if (is_acting(cloud.grid.walls[Dim - 1][0]))
    sides.push_back({.direction = Dim - 1,
                     .holds_all = true,
                     .velocity = Dim == 2 ? std::array<double, 3>{1e-6, 5e-7, 0}
                                          : std::array<double, 3>{1e-6, -7e-7, 5e-7}});
  upload_sides(s, cloud.grid, sides, k_density);
  interpolate(s);
  finish_sums(s);
  begin_absorbing(s, {std::sqrt((1 - 2 * k_poisson) / (2 - 2 * k_poisson))}, {});
  return s;
}

/// Largest difference of velocities of particles at one height, over the largest velocity.
template <int Dim>
double spread(const SoilFields& soil, const std::vector<double>& start) {
  std::map<long, std::array<double, 6>> of_row;
  double largest = 0, worst = 0;
  for (std::size_t p = 0; p < soil.velocity.size() / Dim; ++p) {
    const long row = std::lround(start[p * Dim + Dim - 1] / k_edge * 16);
    auto& range =
        of_row.try_emplace(row, std::array<double, 6>{1e9, 1e9, 1e9, -1e9, -1e9, -1e9}).first->second;
    for (int d = 0; d < Dim; ++d) {
      const double v = soil.velocity[p * Dim + d];
      range[d] = std::min(range[d], v), range[3 + d] = std::max(range[3 + d], v);
      largest = std::max(largest, std::fabs(v));
    }
  }
  for (const auto& [row, range] : of_row)
    for (int d = 0; d < Dim; ++d) worst = std::max(worst, range[3 + d] - range[d]);
  REQUIRE(largest > 5e-7);
  return worst / largest;
}

}  // namespace

TEST_CASE("level ground between sides of the free field moves alike at all places of one height",
          "[free_field]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const Wall base : {Wall::driven, Wall::absorbing})
      for (const int update : {0, 1, 2, 3})
        for (const P2G how : k_strategies) {
          if (how != P2G::tile && (update > 0 || base == Wall::absorbing)) continue;
          INFO(build.name() << " " << word_of(how) << " base " << int(base) << " update " << update);
          Cloud cloud = level_ground<B::dim>(base);
          cloud.affine = update == 1, cloud.xpic_order = update == 2 ? 2 : 0;
          if (update > 1) cloud.flip_fraction = 0.9;
          if (update == 1) cloud.flip_fraction = 0;
          if (update == 3) cloud.damping = 0.1;
          auto s = begun<B>(cloud, how);
          const auto start = download_soil(s).position;
          run_steps(s, 4e-4, 100);
          CHECK(spread<B::dim>(download_soil(s), start) < B::of(1e-6, 0.01));
        }
  });
}

TEST_CASE("a column gives its side the stress of its strain, and resists no translation", "[free_field]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    using C = ColumnTerms<B::dim>;
    constexpr int Dim = B::dim, up = k_vertical<Dim>;
    INFO(build.name());
    auto s = begun<B>(level_ground<Dim>(Wall::absorbing));
    std::vector<double> table = column_table(s);
    constexpr double slope = 1e-6;
    const double face = std::pow(k_edge, Dim - 1);
    for (int n = 0; n < 2 * up; ++n) {  // strains `slope` along the vertical, of all components
      const Side<Dim>& side = s.sides.host[n];
      for (int row = 0; row < side_rows(s.grid.cells, Dim, n / 2); ++row) {
        double* const of = &table[std::size_t(side.first_column + row) * C::size];
        for (int k = 0; k < Dim; ++k) of[C::displacement + k] = slope * k_edge * (row / side.step[up] - 1);
      }
    }
    put_column_table(s, table);
    one_step(s, 1e-9);
    table = column_table(s);
    for (int n = 0; n < 2 * up; ++n) {
      Coord<Dim> at;
      for (int d = 0; d < Dim; ++d) at[d] = d == n / 2 ? n % 2 * s.grid.cells[d] : 2;
      const double* const of = &table[std::size_t(s.sides.host[n].column_row(at)) * C::size];
      const double out = n % 2 == 0 ? -face : face;
      CHECK(std::fabs(of[C::traction + n / 2] / (k_lame * slope * out) - 1) < B::of(1e-9, 1e-4));
      CHECK(std::fabs(of[C::traction + up] / (k_shear * slope * out) - 1) < B::of(1e-9, 1e-4));
      double translated = 0, size = 0, carried = 0;
      for (int k = 0; k < C::band; ++k) {
        translated += of[C::stiffness + k], size += std::fabs(of[C::stiffness + k]);
        carried += of[C::inertia + k];
      }
      CHECK(std::fabs(translated) < 1e-10 * size);
      CHECK(std::fabs(carried / of[C::mass] - 1) < 1e-10);
    }
  });
}

TEST_CASE("a column stands on the dashpots of the base at its own side", "[free_field]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim, up = k_vertical<Dim>;
    Cloud cloud = level_ground<Dim>(Wall::absorbing);
    const BodyInput whole = cloud.bodies[0];
    for (std::size_t p = 0; p < whole.position.size() / Dim; ++p)  // denser to the right
      cloud.bodies[0].mass.push_back(whole.density * whole.particle_volume *
                                     (1 + whole.position[p * Dim] / k_edge));
    cloud.bodies[0].least_mass = whole.density * whole.particle_volume;
    auto s = begun<B>(cloud);
    const std::vector<double> columns = column_table(s), nodes = side_table(s);
    double found[2];
    for (int n = 0; n < 2; ++n) {
      Coord<Dim> at;
      for (int d = 0; d < Dim; ++d) at[d] = d == 0 ? n * s.grid.cells[0] : (d == up ? 0 : 2);
      const double* const of = &columns[s.sides.host[n].column_row(at) * ColumnTerms<Dim>::size];
      const double* const base = &nodes[s.sides.host[2 * up].row(at) * SideTerms<Dim>::size];
      for (int k = 0; k < 2; ++k)
        CHECK(of[ColumnTerms<Dim>::dashpot + k] == base[SideTerms<Dim>::dashpot + k]);
      found[n] = of[ColumnTerms<Dim>::dashpot];
    }
    CHECK(found[1] > 1.5 * found[0]);
  });
}

TEST_CASE("columns stand still while steps are paused", "[free_field]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    auto s = begun<B>(level_ground<B::dim>(Wall::driven));
    run_steps(s, 4e-4, 3);
    const std::vector<double> before = column_table(s);
    const auto control = Kokkos::create_mirror_view(s.control);
    Kokkos::deep_copy(control, s.control);
    control().paused = Pause::due;
    Kokkos::deep_copy(s.control, control);
    one_step(s, 4e-4);
    CHECK(column_table(s) == before);
  });
}

TEST_CASE("a run without sides of the free field has no columns", "[free_field]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    Cloud cloud = level_ground<B::dim>(Wall::driven);
    for (int d = 0; d < B::dim - 1; ++d) cloud.grid.walls[d] = {Wall::absorbing, Wall::absorbing};
    auto s = begun<B>(cloud);
    CHECK(!s.sides.has_columns());
    CHECK(column_table(s).empty());
  });
}
