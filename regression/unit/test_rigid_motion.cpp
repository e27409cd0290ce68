// How rigid bodies move: poses, wrenches, and a step of a body.

#include <catch2/catch_test_macros.hpp>

#include <cmath>
#include <random>

#include "data/motion_terms.hpp"
#include "physics/rigid_motion.hpp"

using namespace mpm;

namespace {

struct Dice {
  std::mt19937 engine{7};
  double operator()(double scale) { return std::uniform_real_distribution<double>(-scale, scale)(engine); }
  template <int N>
  Vector<double, N> vector(double scale) {
    Vector<double, N> v;
    for (int d = 0; d < N; ++d) v[d] = (*this)(scale);
    return v;
  }
};

template <int Dim>
MovingRigid<Dim> random_rigid(Dice& dice) {
  MovingRigid<Dim> rigid{};
  rigid.motion = {{dice.vector<Dim>(3)}, dice.vector<Dim>(2)};
  for (int k = 0; k < Wrench<Dim>::size; ++k) rigid.force[k] = dice(50);
  rigid.inertia.mass = 7, rigid.inertia.dynamic = true;
  return rigid;
}

template <int Dim>
Wrench<Dim> random_wrench(Dice& dice) {
  Wrench<Dim> wrench;
  for (int k = 0; k < Wrench<Dim>::size; ++k) wrench[k] = dice(50);
  return wrench;
}

/// A dynamic body that is turned and turns.
template <int Dim>
MovingRigid<Dim> turned_rigid(Dice& dice) {
  MovingRigid<Dim> rigid = random_rigid<Dim>(dice);
  constexpr int n = k_turning_axes<Dim>;
  Turning<Dim>& turning = rigid.inertia.turning;
  rigid.motion.pose.turns = true;
  rigid.motion.pose.centre = dice.vector<Dim>(4);
  rigid.motion.pose.rotation = Rotation<Dim>::by(dice.vector<n>(2));
  rigid.motion.spin = dice.vector<n>(2);
  for (int k = 0; k < n; ++k) turning.principal[k] = 3 + dice(1);
  if constexpr (Dim == 3) turning.axes = Rotation<3>::by(dice.vector<3>(2));
  turning.axis = Turning<Dim>::k_free, turning.reach = 1.5;
  rigid.momentum = momentum_of(turning, rigid.motion.pose.rotation, rigid.motion.spin);
  return rigid;
}

/// Kinetic energy of the rotation of a body [J].
double spin_energy(const MovingRigid<3>& rigid) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += rigid.momentum[k] * rigid.motion.spin[k] / 2;
  return sum;
}

template <class F>
void in_both_dimensions(F&& f) {
  f(std::integral_constant<int, 2>());
  f(std::integral_constant<int, 3>());
}

}  // namespace

TEST_CASE("a pose takes points and directions to the world, and back", "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    Dice dice;
    for (int n = 0; n < 40; ++n) {
      const bool turned = n % 2 == 1;
      const RigidPose<dim> pose = (turned ? turned_rigid<dim>(dice) : random_rigid<dim>(dice)).motion.pose;
      const auto x = dice.vector<dim>(5), along = dice.vector<dim>(1);
      auto next = x;
      for (int d = 0; d < dim; ++d) next[d] += along[d];
      const auto place = pose.to_world(x), ahead = pose.to_world(next), centre = pose.to_world(pose.centre);
      const auto back = pose.to_body([&](int d) { return place[d]; });
      const auto there = pose.turn_to_world(along), here = pose.turn_to_body(there);
      double length = 0, length_there = 0;
      for (int d = 0; d < dim; ++d) {
        CHECK(std::fabs(back[d] - x[d]) < 1e-13);
        CHECK(std::fabs(here[d] - along[d]) < 1e-14);
        CHECK(std::fabs(ahead[d] - place[d] - there[d]) < 1e-13);  // it turns with the points
        CHECK(std::fabs(centre[d] - pose.centre[d] - pose.displacement[d]) < 1e-13);
        length += along[d] * along[d], length_there += there[d] * there[d];
      }
      CHECK(std::fabs(length - length_there) < 1e-13);
      CHECK((std::fabs(there[0] - along[0]) > 1e-6) == turned);
    }
  });
}

TEST_CASE("a rigid body gains the work of the forces on it", "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    Dice dice;
    for (int n = 0; n < 20; ++n) {
      const MovingRigid<dim> before = random_rigid<dim>(dice);
      const Wrench<dim> contact = random_wrench<dim>(dice);
      MovingRigid<dim> rigid = before;
      const double dt = 0.01, furthest = advance_rigid<double>(rigid, contact, 0, dt);
      const auto way = way_between(before.motion.pose, rigid.motion.pose);
      double work = 0, gained = 0, most = 0;
      for (int k = 0; k < Wrench<dim>::size; ++k) {
        work += (before.force[k] + contact[k]) * way[k];
        const double given = k < wrench_size<dim>(false) ? dt * contact[k] : 0;  // it does not turn
        CHECK(std::fabs(rigid.impulse[k] - before.impulse[k] - given) < 1e-14);
      }
      for (int d = 0; d < dim; ++d) {
        const double v = rigid.motion.velocity[d], v_old = before.motion.velocity[d];
        gained += rigid.inertia.mass * (v * v - v_old * v_old) / 2;
        most = std::fmax(most, std::fabs(way[d]));
      }
      CHECK(std::fabs(gained - work) < 1e-12);
      CHECK(std::fabs(furthest - most) < 1e-14);
    }
  });
}

TEST_CASE("the pose after a step is found without the step", "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    Dice dice;
    for (int n = 0; n < 20; ++n) {
      MovingRigid<dim> rigid = random_rigid<dim>(dice);
      const Wrench<dim> contact = random_wrench<dim>(dice);
      const double damping = n % 2 * 0.3, dt = 0.01;
      const auto a = acceleration_of<double>(rigid, contact, damping, dt);
      const RigidPose<dim> next = next_pose(rigid.motion, a, dt);
      advance_rigid<double>(rigid, contact, damping, dt);
      for (int d = 0; d < dim; ++d) CHECK(next.displacement[d] == rigid.motion.pose.displacement[d]);
    }
  });
}

TEST_CASE("forces move no body that is not dynamic, and none across a plane that cuts it", "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    Dice dice;
    MovingRigid<dim> held = random_rigid<dim>(dice);
    held.inertia.held[0] = true;
    MovingRigid<dim> prescribed = held;
    prescribed.inertia.dynamic = false;
    const Wrench<dim> contact = random_wrench<dim>(dice);
    const auto a = acceleration_of<double>(held, contact, 0, 0.01),
               none = acceleration_of<double>(prescribed, contact, 0, 0.01);
    for (int d = 0; d < dim; ++d) {
      CHECK((a[d] == 0) == (d == 0));
      CHECK(none[d] == 0);
    }
  });
}

TEST_CASE("a row of a checkpoint has room for the motion of a body", "[rigid_motion]") {
  STATIC_CHECK(MotionTerms::impulse_size >= Wrench<2>::size);
  STATIC_CHECK(MotionTerms::impulse_size >= Wrench<3>::size);
  STATIC_CHECK(MotionTerms::binned_rotation - MotionTerms::rotation >= Rotation<3>::size);
  // Numbers of a rigid in the checkpoints of earlier versions.
  STATIC_CHECK(MotionTerms::moment + MotionTerms::rotation - MotionTerms::binned == 12);
}

TEST_CASE("a point of a rigid body moves at the velocity of its place", "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    Dice dice;
    for (int n = 0; n < 20; ++n) {
      MovingRigid<dim> rigid = turned_rigid<dim>(dice);
      rigid.inertia.dynamic = false;
      const auto x = dice.vector<dim>(3);
      const auto from = rigid.motion.pose.to_world(x);
      const double dt = 1e-6;
      const auto v = rigid.motion.velocity_at([&](int d) { return from[d]; });
      const double furthest = advance_rigid<double>(rigid, Wrench<dim>{}, 0, dt);
      const auto to = rigid.motion.pose.to_world(x);
      for (int d = 0; d < dim; ++d) CHECK(std::fabs((to[d] - from[d]) / dt - v[d]) < 1e-4);
      CHECK(furthest >= dt * std::fabs(rigid.motion.velocity[0]));
    }
  });
}

TEST_CASE("no point within its reach moves further than a rigid body says", "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    Dice dice;
    for (int n = 0; n < 20; ++n) {
      MovingRigid<dim> rigid = turned_rigid<dim>(dice);
      auto arm = dice.vector<dim>(1);
      double length = 0;
      for (int d = 0; d < dim; ++d) length += arm[d] * arm[d];
      for (int d = 0; d < dim; ++d) arm[d] *= rigid.inertia.turning.reach / std::sqrt(length);
      auto x = rigid.motion.pose.centre;
      for (int d = 0; d < dim; ++d) x[d] += arm[d];
      const auto from = rigid.motion.pose.to_world(x);
      const double furthest = advance_rigid<double>(rigid, random_wrench<dim>(dice), 0, 0.02);
      const auto to = rigid.motion.pose.to_world(x);
      for (int d = 0; d < dim; ++d) CHECK(std::fabs(to[d] - from[d]) <= furthest * (1 + 1e-3));
    }
  });
}

TEST_CASE("a body without moments keeps its angular momentum and its energy", "[rigid_motion]") {
  Dice dice;
  MovingRigid<3> rigid = turned_rigid<3>(dice);
  for (int k = 3; k < 6; ++k) rigid.force[k] = 0;
  const auto momentum = rigid.momentum;
  const double energy = spin_energy(rigid);
  double most = 0;
  for (int n = 0; n < 20000; ++n) {
    advance_rigid<double>(rigid, Wrench<3>{}, 0, 1e-3);
    most = std::fmax(most, std::fabs(spin_energy(rigid) / energy - 1));
    for (int k = 0; k < 3; ++k) REQUIRE(rigid.momentum[k] == momentum[k]);
  }
  CHECK(most < 1e-5);
  const auto own = momentum_of(rigid.inertia.turning, rigid.motion.pose.rotation, rigid.motion.spin);
  for (int k = 0; k < 3; ++k) CHECK(std::fabs(own[k] - momentum[k]) < 1e-10);
}

TEST_CASE("a symmetric top without moments precesses at L over its moment of inertia", "[rigid_motion]") {
  MovingRigid<3> rigid{};
  rigid.motion.pose.turns = rigid.inertia.dynamic = true;
  rigid.inertia.mass = 1;
  rigid.inertia.turning = {.principal = {2, 2, 3}, .axis = Turning<3>::k_free, .reach = 1};
  rigid.motion.spin = {0.6, 0, 2};
  rigid.momentum = momentum_of(rigid.inertia.turning, rigid.motion.pose.rotation, rigid.motion.spin);
  const double length = std::sqrt(1.2 * 1.2 + 6 * 6), period = 2 * Kokkos::numbers::pi * 2 / length;
  const int steps = 2000;
  for (int n = 0; n < steps; ++n) advance_rigid<double>(rigid, Wrench<3>{}, 0, period / steps);
  const auto axis = rigid.motion.pose.rotation.turn({0, 0, 1});
  CHECK(std::fabs(axis[0]) < 1e-5);
  CHECK(std::fabs(axis[1]) < 1e-5);
  CHECK(std::fabs(axis[2] - 1) < 1e-5);
  // About its own axis it has turned by (1 - 3/2) of its spin in the meantime, and by a turn with the axis.
  const double own = 2 * (1 - 3.0 / 2) * period;
  const auto along = rigid.motion.pose.rotation.turn({1, 0, 0});
  CHECK(std::fabs(along[0] - std::cos(own)) < 1e-5);
  CHECK(std::fabs(along[1] - std::sin(own)) < 1e-5);
}

TEST_CASE("a constant moment about a principal axis turns a body as a constant force moves it",
          "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    MovingRigid<dim> rigid{};
    rigid.motion.pose.turns = rigid.inertia.dynamic = true;
    rigid.inertia.mass = 1;
    rigid.inertia.turning.principal = filled<double, k_turning_axes<dim>>(2.5);
    rigid.inertia.turning.axis = dim == 2 ? Turning<dim>::k_free : 2;
    rigid.force[Wrench<dim>::size - 1] = 5;
    for (int n = 0; n < 100; ++n) advance_rigid<double>(rigid, Wrench<dim>{}, 0, 0.01);
    CHECK(std::fabs(rigid.motion.spin[k_turning_axes<dim> - 1] - 2) < 1e-12);
    CHECK(std::fabs(rigid.motion.pose.rotation.way_from({})[k_turning_axes<dim> - 1] - 1) < 1e-12);
  });
}

TEST_CASE("a rotation is the same after it was stored and loaded", "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    Dice dice;
    const auto rotation = turned_rigid<dim>(dice).motion.pose.rotation;
    double numbers[Rotation<dim>::size];
    rotation.store(numbers);
    const auto again = Rotation<dim>::load(numbers);
    const auto v = dice.template vector<dim>(1);
    for (int d = 0; d < dim; ++d) CHECK(again.turn(v)[d] == rotation.turn(v)[d]);
    const auto none = rotation.way_from(again);
    for (int k = 0; k < k_turning_axes<dim>; ++k) CHECK(std::fabs(none[k]) < 1e-15);
  });
}
