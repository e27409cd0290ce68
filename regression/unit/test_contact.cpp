// Contact of the soil with rigids: at a node by hand, and what its forces sum to.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "physics/contact.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr double k_infinite = std::numeric_limits<double>::infinity();

bool near(const Vector<double, 2>& v, double x, double y) {
  return std::fabs(v[0] - x) + std::fabs(v[1] - y) < 1e-15;
}

/// Soil and a rigid plate in one another, with velocities that press them together.
template <int Dim>
Cloud pressed() {
  const double spacing = 0.1;
  Cloud cloud;
  cloud.grid = grid_of<Dim>({20, 18, 12}, spacing, Wall::free);
  cloud.materials = clays();
  cloud.bodies = {body_of<Dim>(lattice<Dim>({6, 5, 3}, {14, 9, 8}, 2, spacing), 2, spacing, 1)};
  cloud.bodies[0].common_velocity = {0.05, 0.2, -0.03};
  cloud.rigids = {rigid_of<Dim>(lattice<Dim>({8, 9, 4}, {12, 11, 7}, 4, spacing), 4, spacing)};
  cloud.rigids[0].velocity = {0.3, -0.5, 0.1};
  cloud.rigids[0].dynamic = true;
  cloud.rigids[0].shear_limit = 500;
  return cloud;
}

/// Momentum of the nodes' mass at their new velocity.
template <class Space, class T, int Dim>
Vector<double, Dim> nodal_momentum(const State<Space, T, Dim>& s) {
  const auto soil = on_host(s.nodes.soil);
  const auto motion = on_host(s.nodes.kinematics);
  auto sum = filled<double, Dim>(0);
  for (int i = 0; i < s.patches.node_count(); ++i)
    for (int d = 0; d < Dim; ++d) sum[d] += double(soil(i, 0)) * motion(i, d);
  return sum;
}

}  // namespace

TEST_CASE("contact: no pull, no penetration, and shear up to the lesser of its bounds", "[contact]") {
  const Vector<double, 2> v{1, -2}, v_r{0, -0.5}, n{0, -1};  // relative (1, -1.5): approach 1.5, slip 1
  const auto change = [&](double shear_speed, double friction) {
    Interface<double> interface { shear_speed, friction };
    return contact_correction<double, 2>(v, {v_r, n}, interface);
  };
  CHECK(near(change(0, -1), 0, 1.5));               // smooth
  CHECK(near(change(0.25, -1), -0.25, 1.5));        // limited
  CHECK(near(change(k_infinite, -1), -1, 1.5));     // rough: it sticks
  CHECK(near(change(3, -1), -1, 1.5));              // a limit above the slip does not reverse it
  CHECK(near(change(k_infinite, 0.4), -0.6, 1.5));  // friction
  CHECK(near(change(k_infinite, 0), 0, 1.5));
  CHECK(near(change(0.25, 0.4), -0.25, 1.5));  // both: the limit is less
  CHECK(near(change(0.8, 0.4), -0.6, 1.5));    // both: friction is less
  const Vector<double, 2> away{0, 1};
  const auto with = [](auto dim, auto own, auto v, auto v_r, auto n) {
    Interface<double> interface = own;
    return contact_correction<double, decltype(dim)::value>(v, {v_r, n}, interface);
  };
  using In2D = std::integral_constant<int, 2>;
  using V2 = Vector<double, 2>;
  const Interface<double> rough{k_infinite, -1};
  CHECK(near(with(In2D{}, rough, v, v_r, away), 0, 0));         // they part
  CHECK(near(with(In2D{}, rough, V2{1, -0.5}, v_r, n), 0, 0));  // no approach, no pressing
  CHECK(near(with(In2D{}, Interface<double>{0.1, -1}, V2{0, -2}, v_r, n), 0, 1.5));  // no slip
  Interface<double> pressed{0.25, -1};
  pressed.pressing = 1e-3;  // bounces off, but the soil behind presses: shear acts on
  CHECK(near(with(In2D{}, pressed, V2{1, -0.4}, v_r, n), -0.25, 0));
  Interface<double> glued{0, -1};
  glued.separates = false;  // no gap opens
  CHECK(near(with(In2D{}, glued, v, v_r, away), 0, 1.5));
  Interface<double> partly{0, -1};
  partly.gap_scaling = 0.25;
  CHECK(near(with(In2D{}, partly, v, v_r, n), 0, 0.375));
  const double r = std::sqrt(0.5);
  CHECK(near(with(In2D{}, Interface<double>{0, -1}, V2{2, 0}, V2{0, 0}, V2{r, r}), -1,
             -1));  // an inclined face
  const auto in_3d =
      with(std::integral_constant<int, 3>{}, Interface<double>{1, -1}, Vector<double, 3>{3, 4, 2},
           Vector<double, 3>{0, 0, 0}, Vector<double, 3>{0, 0, 1});  // slip (3, 4, 0)
  CHECK(std::fabs(in_3d[0] + 0.6) + std::fabs(in_3d[1] + 0.8) + std::fabs(in_3d[2] + 2) < 1e-15);
}

namespace {

/// Leaves of the normal impulses what a step keeps of them.
void fade(Interface<double>& interface) {
  double* const terms[] = {&interface.pressed.sum, &interface.pressed.weight, &interface.pressed.store};
  for (int n = 0; n < ImpulseTerms::size; ++n) *terms[n] *= kept_share(n, interface.fresh);
}

}  // namespace

TEST_CASE("friction over many steps is a fraction of the normal impulse of all of them, which comes in few",
          "[contact]") {
  // the impulse comes in every fourth step only; the driving is less than friction takes on the whole
  Interface<double> interface { k_infinite, 0.5 };
  interface.fresh = 0.05;
  double normal = 0, tangential = 0, v = 0;
  const auto run = [&](double drive, int steps) {
    normal = tangential = 0;
    for (int step = 0; step < steps; ++step) {
      v += drive;
      fade(interface);
      const auto change =
          contact_correction<double, 2>({v, step % 4 == 0 ? -4.0 : 0.01}, {{0, 0}, {0, -1}}, interface);
      v += change[0];
      normal += change[1], tangential -= change[0];
    }
  };
  run(0.45, 400);  // the mean comes up from nothing
  CHECK(tangential < 0.5 * normal + 1e-9);
  run(0.45, 400);  // tan = 0.45 < 0.5: it sticks
  CHECK(std::fabs(v) < 1e-12);
  CHECK(std::fabs(tangential - 0.45 * 400) < 1e-9);
  run(0.6, 400);
  const double before = v;
  run(0.6, 400);  // it slides, under all that friction gives
  CHECK(std::fabs(tangential / normal - 0.5) < 1e-12);
  CHECK(std::fabs(v - before - 0.1 * 400) < 1e-9);
}

TEST_CASE(
    "soil that has stuck for long has no friction in store, and soil that comes to a body has all of its own",
    "[contact]") {
  const auto friction_of = [](Interface<double>& interface, double slip) {
    return -contact_correction<double, 2>({slip, -1}, {{0, 0}, {0, -1}}, interface)[0];
  };
  Interface<double> held{k_infinite, 0.5};
  held.fresh = 0.05;
  for (int step = 0; step < 1000; ++step) {
    fade(held);
    friction_of(held, 0);
  }
  double friction = 0;
  for (int step = 0; step < 10; ++step) {
    fade(held);
    friction += friction_of(held, 100);
  }
  CHECK(std::fabs(friction - 0.5 * 10) < 1e-12);
  for (int step = 0; step < 400; ++step) fade(held), friction_of(held, 0);
  fade(held);
  const double lifted = -contact_correction<double, 2>({100, 1}, {{0, 0}, {0, -1}}, held)[0];
  CHECK(std::fabs(lifted - 0.5 * 0.95) < 1e-9);  // a trough: the mean
  Interface<double> comes{k_infinite, 0.5};
  comes.fresh = 0.05;
  CHECK(std::fabs(friction_of(comes, 100) - 0.5) < 1e-12);
}

TEST_CASE("two bodies that meet take opposite impulses, until they stick or slip under the limit of shear",
          "[contact]") {
  const double m[] = {3, 0.5}, n[] = {0.6, -0.8}, v[2][2] = {{2, -1}, {-0.5, 0.5}};
  const double approach = (v[0][0] - v[1][0]) * n[0] + (v[0][1] - v[1][1]) * n[1];
  const double slip[] = {v[0][0] - v[1][0] - approach * n[0], v[0][1] - v[1][1] - approach * n[1]};
  const double speed = std::hypot(slip[0], slip[1]), reduced = m[0] * m[1] / (m[0] + m[1]);
  for (const double friction : {-1., 0.2})
    for (const double limit : {0., 0.1, 1e3}) {  // N s
      double impulse[2][2];
      for (int b = 0; b < 2; ++b) {
        const double sign = b == 0 ? 1 : -1;
        Interface<double> interface { limit / m[b], friction };
        Opponent<double, 2> other{{v[1 - b][0], v[1 - b][1]}, {sign * n[0], sign * n[1]}};
        other.share = m[1 - b] / (m[0] + m[1]);
        const auto change = contact_correction<double, 2>({v[b][0], v[b][1]}, other, interface);
        for (int d = 0; d < 2; ++d) impulse[b][d] = m[b] * change[d];
      }
      const double normal = reduced * approach;
      const double shear = std::min({limit, reduced * speed, friction < 0 ? limit : friction * normal});
      INFO("friction " << friction << ", limit " << limit);
      for (int d = 0; d < 2; ++d) {
        CHECK(std::fabs(impulse[0][d] + impulse[1][d]) < 1e-14);
        CHECK(std::fabs(impulse[0][d] + normal * n[d] + shear * slip[d] / speed) < 1e-14);
      }
    }
}

TEST_CASE("the inward normal is against the mass gradient, in a roller's plane, and none in the body",
          "[contact]") {
  const auto grid = small_grid<2>(Wall::roller);
  Vector<double, 2> n{3, 4};
  REQUIRE(inward_normal(grid, 0u, 10.0, n));
  CHECK(near(n, -0.6, -0.8));
  n = {3, 4};  // on the plane x = 0 the mirrored half is missing
  REQUIRE(inward_normal(grid, sides_of<double, 2>(grid, {0, 3}), 10.0, n));
  CHECK(near(n, 0, -1));
  n = {3, 4};  // a fixed wall is no plane of symmetry
  REQUIRE(inward_normal(small_grid<2>(Wall::fixed), sides_of<double, 2>(grid, {0, 3}), 10.0, n));
  CHECK(near(n, -0.6, -0.8));
  n = {0.03, 0.03};  // less than a twentieth of the mass a cell's edge
  CHECK_FALSE(inward_normal(grid, 0u, 1.0, n));
  n = {0, 0.06};
  CHECK(inward_normal(grid, 0u, 1.0, n));
  n = {0, 0};
  CHECK_FALSE(inward_normal(grid, 0u, 0.0, n));
}

TEST_CASE("below a plate the mass gradient points down, out of it, and none counts in its middle",
          "[contact]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud = pressed<Dim>();
    cloud.rigids = {rigid_of<Dim>(lattice<Dim>({4, 9, 2}, {14, 13, 9}, 4, 0.1), 4, 0.1)};
    auto s = state_of<B>(cloud);
    interpolate(s);
    const Table field = nodes_of(s, rigid_field(s, 0));
    const auto at = [&](Coord<Dim> node, int k) {
      return field.value[s.grid.address_of(node) * field.width + k];
    };
    const auto node = [](int y) {
      Coord<Dim> c{9, y};
      if constexpr (Dim == 3) c[2] = 5;
      return c;
    };
    INFO(build.name());
    CHECK(at(node(9), 2) < -0.5 * at(node(9), 0));
    CHECK(std::fabs(at(node(9), 1)) < 1e-5 * at(node(9), 0));    // and not along it
    CHECK(std::fabs(at(node(11), 2)) < 1e-5 * at(node(11), 0));  // in its middle there is none
    CHECK(at(node(13), 2) > 0.5 * at(node(13), 0));              // and up at its far face
  });
}

TEST_CASE("the force on a rigid is what the soil's momentum lost in the step", "[contact]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    const double dt = 1e-4;
    for (double shear_limit : {0., 500., k_infinite}) {
      Cloud cloud = pressed<Dim>();
      cloud.rigids[0].shear_limit = shear_limit;
      auto touching = state_of<B>(cloud);
      cloud.rigids.clear();
      auto alone = state_of<B>(cloud);
      for (auto* s : {&touching, &alone}) {
        interpolate(*s);
        update_nodes(*s, dt);
      }
      const auto with = nodal_momentum(touching), without = nodal_momentum(alone);
      const auto forces = on_host(touching.contact.forces);
      std::array<double, Dim> sums{};
      for (int n = 0; n < touching.contact.count * wrench_size<Dim>(false); ++n) sums[n % Dim] += forces(n);
      INFO(build.name() << " shear limit " << shear_limit);
      CHECK(sums[1] > 0);  // the soil pushes the plate up
      CHECK(sums[0] < 0);  // and holds it back
      for (int d = 0; d < Dim; ++d)
        CHECK(std::fabs((without[d] - with[d]) / dt - sums[d]) < B::of(1e-10, 1e-4) * sums[1]);
    }
  });
}

TEST_CASE("soil and a rigid that hits it keep their momentum", "[contact]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (double shear_limit : {0., 500.}) {
      Cloud cloud = pressed<B::dim>();
      cloud.rigids[0].shear_limit = shear_limit;
      auto s = state_of<B>(cloud, P2G::tile);
      s.scheme.mass_cut = 0;  // a node of hardly any mass drops its force
      const auto before = total_momentum(s);
      const double rigid_before = on_host(s.rigids)(0).motion.velocity[1];
      run_steps(s, 2e-4, 50);
      const auto after = total_momentum(s);
      INFO(build.name() << " shear limit " << shear_limit);
      CHECK(read_control(s).fault_count == 0);
      CHECK(on_host(s.rigids)(0).motion.velocity[1] > rigid_before + 0.1);  // it was slowed down
      for (int d = 0; d < B::dim; ++d)
        CHECK(std::fabs(after[d] - before[d]) < B::of(1e-12, 1e-5) * std::fabs(before[1]));
    }
  });
}

TEST_CASE("any number of rigids fits, and those out of touch change nothing but the round-off of atomic sums",
          "[contact]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    Cloud cloud = pressed<B::dim>();
    const auto velocity_after = [&] {
      auto s = state_of<B>(cloud, P2G::tile);
      run_steps(s, 2e-4, 5);
      return on_host(s.rigids)(0).motion.velocity;
    };
    const auto alone = velocity_after();
    for (int r = 1; r < 70; ++r)
      cloud.rigids.push_back(rigid_of<B::dim>(lattice<B::dim>({0, 15, 0}, {1, 16, 1}, 2, 0.1), 2, 0.1));
    const auto among_others = velocity_after();
    INFO(build.name());
    double largest = 0;
    for (int d = 0; d < B::dim; ++d) largest = std::max(largest, std::abs(alone[d]));
    const double allowed = is_device<typename B::Space> ? B::of(1e-14, 1e-6) * largest : 0;  // atomic sums
    for (int d = 0; d < B::dim; ++d) CHECK(std::abs(among_others[d] - alone[d]) <= allowed);
  });
}
