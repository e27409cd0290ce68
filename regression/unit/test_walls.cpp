// Walls as planes of symmetry, soil that leaves or is put back, and strays.

#include <catch2/catch_test_macros.hpp>
#include <functional>

#include "compare.hpp"
#include "functions/wall_force.hpp"
#include "rebuild/limit_volumes.hpp"
#include "transfer/measure.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_edge = 0.1;  // m

/// Random particles at the corner of the mesh's lower walls, and, if `whole`, with their images in the lower
/// wall of direction 0, which then lies in the middle. kind: of that wall.
template <int Dim>
Cloud slump(int seed, bool whole, Wall kind) {
  Dice dice{std::mt19937_64(seed)};
  const std::array<int, 3> cells{11, 9, 7};
  Cloud cloud;
  cloud.grid = grid_of<Dim>(cells, k_edge, Wall::roller);
  cloud.grid.walls[1][0] = Wall::fixed;
  cloud.grid.walls[0][0] = kind;
  cloud.materials = clays();
  cloud.gravity = {kind == Wall::fixed ? 0.5 : 0.0, kind == Wall::fixed ? 0 : -9.81, 0};
  BodyInput body = random_body<Dim>(dice, {0, 0, 0}, {5, 4, 3}, 0.9, 2, k_edge);
  // A particle between two cells is in the upper one, and so would its image be: F-bar asks for its cell.
  for (std::size_t k = 0; k < body.position.size(); k += Dim) {
    const double cells_from_wall = body.position[k] / k_edge;
    if (std::fabs(cells_from_wall - std::round(cells_from_wall)) < 1e-6) body.position[k] += 0.01 * k_edge;
  }
  if (whole) {
    const std::size_t count = strength_of(body).size();
    const double middle = cells[0] * k_edge;
    for (std::size_t p = 0; p < count; ++p) body.position[p * Dim] += middle;
    for (std::size_t p = 0; p < count; ++p) {
      for (int d = 0; d < Dim; ++d) {
        const double x = body.position[p * Dim + d], v = body.velocity[p * Dim + d];
        body.position.push_back(d == 0 ? 2 * middle - x : x);
        body.velocity.push_back(d == 0 || kind == Wall::fixed ? -v : v);
      }
      // Its stress turns as the velocity does: at a fixed wall as if turned about by half a turn.
      for (int k = 0; k < sym_size<Dim>; ++k) {
        const bool shear = k >= 3 && (k == 3 || k == 5);  // xy, zx
        const double stress = body.stress[p * sym_size<Dim> + k];
        body.stress.push_back(shear ? -stress : stress);
      }
      strength_of(body).push_back(strength_of(body)[p]);
    }
    cloud.grid = grid_of<Dim>({2 * cells[0], cells[1], cells[2]}, k_edge, Wall::roller);
    cloud.grid.walls[1][0] = Wall::fixed;
  }
  body.velocity_gradient.assign(body.position.size() * Dim, 0.0);  // else neighbours beyond the wall give it
  cloud.bodies = {body};
  return cloud;
}

/// Positions of the first `count` particles by id [m].
template <class B>
std::vector<double> places_after(const Cloud& cloud, P2G how, int steps, std::size_t count) {
  auto s = state_of<B>(cloud, how);
  run_steps(s, 5e-5, steps);
  std::vector<double> x = download_soil(s).position;
  x.resize(count * B::dim);
  return x;
}

/// The velocity updates.
void for_each_update(Cloud cloud, const std::function<void(const Cloud&, const char*)>& f) {
  f(cloud, "flip");
  cloud.f_bar_fraction = 0.98;
  f(cloud, "flip with F-bar");
  cloud.flip_fraction = 0, cloud.affine = true;
  f(cloud, "apic");
  cloud.affine = false, cloud.xpic_order = 3;
  f(cloud, "xpic");
}

/// One particle in the middle of a mesh of 6 cells a side, with this velocity [m/s].
template <int Dim>
Cloud lone_particle(Wall wall, std::array<double, 3> velocity, std::array<double, 3> at) {
  Cloud cloud;
  cloud.grid = grid_of<Dim>({6, 6, 6}, k_edge, wall);
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>({at.begin(), at.begin() + Dim}, 2, k_edge, 1)};
  cloud.bodies[0].common_velocity = velocity;
  return cloud;
}

}  // namespace

TEST_CASE("half a slump at a roller is half of the whole one, with every strategy and velocity update",
          "[walls]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for_each_update(slump<B::dim>(3, false, Wall::roller), [&](const Cloud& half, const char* update) {
      Cloud whole = slump<B::dim>(3, true, Wall::roller);
      whole.f_bar_fraction = half.f_bar_fraction, whole.flip_fraction = half.flip_fraction;
      whole.affine = half.affine, whole.xpic_order = half.xpic_order;
      const std::size_t count = strength_of(half.bodies[0]).size();
      for (const P2G how : k_strategies) {
        INFO(build.name() << " " << word_of(how) << " " << update);
        const auto own = places_after<B>(half, how, 100, count),
                   all = places_after<B>(whole, how, 100, count);
        double worst = 0, moved = 0;
        for (std::size_t k = 0; k < own.size(); ++k) {
          worst = std::max(worst, std::fabs(all[k] - own[k] - (k % B::dim == 0 ? 11 * k_edge : 0)));
          moved = std::max(moved, std::fabs(own[k] - half.bodies[0].position[k]));
        }
        CHECK(moved > 0.002 * k_edge);
        CHECK(worst < B::of(1e-13, 1e-5));
      }
    });
  });
}

TEST_CASE("the nodes beyond a wall hold nothing, and those at it move as it allows", "[walls]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    for (const Wall wall : {Wall::roller, Wall::fixed})
      for (const P2G how : k_strategies) {
        INFO(build.name() << " " << word_of(how));
        auto s = state_of<B>(random_cloud<Dim>(2, wall), how);
        interpolate(s);
        finish_sums(s);
        const auto soil = on_host(s.nodes.soil);
        const auto origin = on_host(s.patches.origin);
        double total = 0;
        int wrong = 0;
        for (int i = 0; i < s.patches.node_count(); ++i) {
          Coord<Dim> at = coord_of<Dim>(i);
          bool beyond = false;
          for (int d = 0; d < Dim; ++d) {
            at[d] += origin(i / Patch<Dim>::cells)[d];
            beyond = beyond || at[d] < 0 || at[d] > s.grid.cells[d];
          }
          total += soil(i, 0);
          for (int k = 0; k < SoilTerms<Dim>::size && beyond; ++k) wrong += soil(i, k) != 0;
          for (int d = 0; d < Dim && !beyond; ++d)
            if (at[d] == 0 || at[d] == s.grid.cells[d]) wrong += soil(i, SoilTerms<Dim>::momentum + d) != 0;
        }
        CHECK(wrong == 0);
        double mass = 0;
        const auto body = on_host(s.soil.points.body);
        const auto bodies = on_host(s.soil.points.bodies);
        for (int p = 0; p < s.soil.points.count; ++p) mass += bodies(body(p)).mass;
        CHECK(std::fabs(total - mass) < B::of(1e-12, 1e-5) * mass);
      }
  });
}

TEST_CASE("soil that leaves through a free side is taken out, with all that it had", "[walls]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    auto s = state_of<B>(lone_particle<B::dim>(Wall::free, {3, -1, 0}, {0.55, 0.31, 0.3}));
    const double mass = k_density * std::pow(k_edge / 2, B::dim);
    for (int n = 0; n < 40; ++n) {
      one_step(s, 1e-3);
      if (read_control(s).paused == 0) continue;
      locate(s);
      if (read_control(s).lost > 0) note_lost(s);
      sort_and_list(s);
    }
    CHECK(s.soil.points.count == 0);
    CHECK(read_control(s).fault_count == 0);
    const Lost& lost = s.strays.lost[0];
    CHECK(lost.count == 1);
    CHECK(std::fabs(lost.mass - mass) < B::of(1e-12, 1e-5) * mass);
    CHECK(std::fabs(lost.momentum[0] - 3 * mass) < B::of(1e-12, 1e-5) * mass);
    CHECK(std::fabs(lost.momentum[1] + mass) < B::of(1e-12, 1e-5) * mass);
    CHECK(std::fabs(lost.kinetic_energy - 5 * mass) < B::of(1e-11, 1e-4) * mass);
  });
}

TEST_CASE("a particle that has passed walls is put back on them, at rest against them", "[walls]") {
  Grid<double, 2> grid{};
  grid.cells = {6, 5};
  grid.wall[0][1] = Wall::fixed, grid.wall[1][1] = Wall::free;
  Vector<double, 2> x{-0.25, 0.5}, v{-3, 2};
  CHECK(put_on_walls(grid, Coord<2>{0, 1}, x, v));
  CHECK((x[0] == 0 && x[1] == 0.5 && v[0] == 0 && v[1] == 2));
  x = {1.5, -0.1}, v = {1, -1};  // fixed above, roller below
  CHECK(put_on_walls(grid, Coord<2>{5, 0}, x, v));
  CHECK((x[0] < 1 && x[0] > 1 - 1e-15 && x[1] == 0 && v[0] == 0 && v[1] == 0));
  x = {-1e-15, 0.5}, v = {-3, 2};  // on the wall but for round-off
  CHECK_FALSE(put_on_walls(grid, Coord<2>{0, 1}, x, v));
  CHECK((x[0] == 0 && v[0] == -3));
  x = {0.5, 1.5}, v = {1, 1};  // free above
  CHECK_FALSE(put_on_walls(grid, Coord<2>{2, 4}, x, v));
  CHECK((x[1] == 1.5 && v[1] == 1));
}

TEST_CASE("a particle that is alone carries no stress and flies as a stone does", "[walls]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const P2G how : k_strategies) {
      INFO(build.name() << " " << word_of(how));
      Cloud cloud = lone_particle<B::dim>(Wall::roller, {1, 2, 0}, {0.13, 0.2, 0.3});
      cloud.gravity = {0, -10, 0};
      cloud.bodies[0].stress.assign(sym_size<B::dim>, 500.0);
      auto s = state_of<B>(cloud, how);
      run_steps(s, 1e-3, 100);
      const SoilFields soil = download_soil(s);
      for (const double stress : soil.stress) CHECK(stress == 0);
      CHECK(std::fabs(soil.velocity[0] - 1) < 0.01);
      CHECK(std::fabs(soil.velocity[1] - 1) < 0.01);
      CHECK(std::fabs(soil.volume[0] / std::pow(k_edge / 2, B::dim) - 1) < 1e-3);
      CHECK(measure(s, 0).alone == 1);
    }
  });
}

TEST_CASE("in a block no particle is alone, not at its corners either", "[walls]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const int per_cell : {1, 2, 3})
      for (const double shift : {0.0, 0.13, 0.49, 0.77}) {
        INFO(build.name() << " " << per_cell << " particles a cell's edge, shifted by " << shift);
        Cloud cloud;
        cloud.grid = grid_of<B::dim>({8, 8, 8}, k_edge, Wall::roller);
        cloud.materials = clays();
        std::vector<double> position = lattice<B::dim>({2 + shift, 2 + shift, 2 + shift},
                                                       {5 + shift, 5 + shift, 5 + shift}, per_cell, k_edge);
        cloud.bodies = {body_of<B::dim>(std::move(position), per_cell, k_edge, 1)};
        auto s = state_of<B>(cloud);
        one_step(s, 1e-5);
        CHECK(measure(s, 0).alone == 0);
      }
  });
}

TEST_CASE("a volume beyond its bounds is limited, or a fault where strays stop the run", "[walls]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const P2G how : k_strategies)
      for (const StrayRule rule : {StrayRule::keep, StrayRule::stop}) {
        INFO(build.name() << " " << word_of(how) << (rule == StrayRule::stop ? " stop" : " keep"));
        Cloud cloud;
        cloud.grid = grid_of<B::dim>({8, 8, 8}, k_edge, Wall::roller);
        cloud.materials = clays();
        BodyInput body = body_of<B::dim>(lattice<B::dim>({2, 2, 2}, {5, 5, 5}, 2, k_edge), 2, k_edge, 1);
        const int count = static_cast<int>(body.position.size()) / B::dim, swollen = count / 2;
        body.volume.assign(count, body.particle_volume);
        body.volume[swollen] = 1.25 * k_most_volume * body.particle_volume;
        body.least_volume = body.most_volume = body.particle_volume;
        cloud.bodies = {body};
        auto s = state_of<B>(cloud, how);
        s.strays.rule = rule;
        one_step(s, 1e-6);
        CHECK(measure(s, 0).limited == 1);
        CHECK(std::fabs(download_soil(s).volume[swollen] / (k_most_volume * body.particle_volume) - 1) <
              1e-6);
        const Control control = read_control(s);
        CHECK((control.fault_count > 0) == (rule == StrayRule::stop));
        if (rule != StrayRule::stop) continue;
        CHECK(control.fault.kind == FaultKind::volume);
        CHECK(control.fault.particle == swollen);
      }
  });
}

TEST_CASE("the volume of a small particle among large ones is limited by its own mass", "[walls]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (const bool weighed : {true, false})  // a file's masses and volumes are its own
      for (const StrayRule rule : {StrayRule::keep, StrayRule::stop}) {
        INFO(build.name() << (weighed ? " shape" : " file") << (rule == StrayRule::stop ? " stop" : " keep"));
        Cloud cloud;
        cloud.grid = grid_of<B::dim>({8, 8, 8}, k_edge, Wall::roller);
        cloud.materials = clays();
        BodyInput body = body_of<B::dim>(lattice<B::dim>({2, 2, 2}, {5, 5, 5}, 2, k_edge), 2, k_edge, 1);
        const int count = static_cast<int>(body.position.size()) / B::dim;
        const int swollen = count / 2, pressed = swollen + 1;
        body.volume.assign(count, body.particle_volume);
        body.least_volume = body.particle_volume / 64, body.most_volume = body.particle_volume;
        for (const int p : {swollen, pressed}) body.volume[p] = body.least_volume;
        for (const double v : body.volume) body.mass.push_back(body.density * v);
        body.least_mass = body.density * body.least_volume;
        body.weighed = weighed;
        body.volume[swollen] *= 40, body.volume[pressed] /= 40;
        const std::vector<double> before = body.volume;
        cloud.bodies = {body};
        auto s = state_of<B>(cloud);
        s.strays.rule = rule;
        limit_volumes(s);
        const std::vector<double> volume = download_soil(s).volume;
        const double own = body.least_volume;
        for (int p = 0; p < count; ++p) {
          const double expected = !weighed       ? before[p]
                                  : p == swollen ? k_most_volume * own
                                  : p == pressed ? k_least_volume * own
                                                 : before[p];
          CHECK(std::fabs(volume[p] / expected - 1) < 1e-6);
        }
        CHECK((measure(s, 0).limited >= 2) == weighed);
        const Control control = read_control(s);
        CHECK((control.fault_count == 2) == (weighed && rule == StrayRule::stop));
        if (control.fault_count > 0) CHECK(control.fault.kind == FaultKind::volume);
      }
  });
}

TEST_CASE("soil at rest presses the floor with its weight and the sides with its stress", "[walls]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    Cloud cloud;
    cloud.grid = grid_of<Dim>({4, 5, 3}, k_edge, Wall::roller);
    cloud.grid.walls[1][1] = Wall::free;
    cloud.materials = clays();
    cloud.gravity = {0, -10, 0};
    BodyInput body = body_of<Dim>(lattice<Dim>({0, 0, 0}, {4, 4, 3}, 2, k_edge), 2, k_edge, 0);
    double weight = 0;
    for (std::size_t p = 0; p < strength_of(body).size(); ++p) {
      weight += 10 * k_density * body.particle_volume;
      const double depth = 4 * k_edge - body.position[p * Dim + 1];
      for (int k = 0; k < sym_size<Dim>; ++k)
        body.stress.push_back(k < 3 ? (k == 1 ? -1 : -0.5) * 10 * k_density * depth : 0);
    }
    cloud.bodies = {body};
    auto s = state_of<B>(cloud);
    const WallForces force = wall_forces(s, s.loads);
    CHECK(std::fabs(force[1][0][1] + weight) < B::of(1e-10, 1e-4) * weight);
    const double width = Dim == 2 ? 1 : 3 * k_edge, side = 0.5 * 10 * k_density * 0.5 * 0.16 * width;
    CHECK(std::fabs(force[0][0][0] + side) < B::of(1e-10, 1e-4) * side);
    CHECK(std::fabs(force[0][1][0] - side) < B::of(1e-10, 1e-4) * side);
    CHECK(force[1][1][1] == 0);
  });
}
