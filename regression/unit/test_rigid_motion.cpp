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

template <class F>
void in_both_dimensions(F&& f) {
  f(std::integral_constant<int, 2>());
  f(std::integral_constant<int, 3>());
}

}  // namespace

TEST_CASE("a pose takes points and directions to the world, and back", "[rigid_motion]") {
  in_both_dimensions([](auto dim) {
    Dice dice;
    for (int n = 0; n < 20; ++n) {
      const RigidPose<dim> pose = random_rigid<dim>(dice).motion.pose;
      const auto x = dice.vector<dim>(5), along = dice.vector<dim>(1);
      const auto place = pose.to_world(x), ahead = pose.to_world([&] {
        auto y = x;
        for (int d = 0; d < dim; ++d) y[d] += along[d];
        return y;
      }());
      const auto back = pose.to_body([&](int d) { return place[d]; });
      const auto there = pose.turn_to_world(along), here = pose.turn_to_body(there);
      for (int d = 0; d < dim; ++d) {
        CHECK(std::fabs(back[d] - x[d]) < 1e-14);
        CHECK(std::fabs(here[d] - along[d]) < 1e-14);
        CHECK(std::fabs(ahead[d] - place[d] - there[d]) < 1e-14);  // it turns with the points
      }
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
      const auto way = rigid.motion.pose.way_from(before.motion.pose);
      double work = 0, gained = 0, most = 0;
      for (int k = 0; k < Wrench<dim>::size; ++k) {
        work += (before.force[k] + contact[k]) * way[k];
        CHECK(std::fabs(rigid.impulse[k] - before.impulse[k] - dt * contact[k]) < 1e-14);
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
  STATIC_CHECK(MotionTerms::size == 12);  // numbers of a rigid in the checkpoints of earlier versions
}
