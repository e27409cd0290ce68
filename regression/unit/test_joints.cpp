// Joints, springs and dashpots of rigid bodies, step by step.

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>

#include <cmath>
#include <random>
#include <vector>

#include "physics/linked_step.hpp"

using namespace mpm;
using Catch::Approx;

namespace {

/// Rigid bodies with joints, on the host.
template <int Dim>
struct Linkage {
  std::vector<Rigid<Dim>> rigids{};
  std::vector<Joint<Dim>> joints{};
  std::vector<RigidSupport<Dim>> supports{};
  Vector<double, Dim> gravity{};
  double dt = 1e-3;
  int opened = -1;

  Rigid<Dim>& add(double mass, const Vector<double, Dim>& centre, const AngularVector<Dim>& inertia) {
    Rigid<Dim> rigid{};
    rigid.motion.pose.turns = rigid.inertia.dynamic = true;
    rigid.motion.pose.centre = centre;
    rigid.inertia.mass = mass;
    rigid.inertia.turning.principal = inertia;
    rigid.inertia.turning.axis = Turning<Dim>::k_free, rigid.inertia.turning.reach = 1;
    for (int d = 0; d < Dim; ++d) rigid.force[d] = mass * gravity[d];
    rigids.push_back(rigid), supports.emplace_back();
    return rigids.back();
  }
  Joint<Dim>& join(int first, int second, const Vector<double, Dim>& at) {
    Joint<Dim>& joint = joints.emplace_back();
    joint.body[0] = first, joint.body[1] = second;
    joint.end[0] = joint.end[1] = at;
    return joint;
  }
  void go(int steps) {
    int rows = 0;
    for (const auto& joint : joints) rows += joint.rows();
    std::vector<JointRow<Dim>> row(2 * rows);
    std::vector<double> matrix(rows * rows), numbers(3 * rows), contact(rigids.size() * Wrench<Dim>::size);
    std::vector<int> first(rows);
    std::vector<LinkedStart<Dim>> starts(rigids.size());
    const JointSystem<Dim> system{row.data(), rows, matrix.data(), first.data()};
    const JointSolver<Dim> solver{rigids.data(),
                                  starts.data(),
                                  joints.data(),
                                  row.data(),
                                  row.data() + rows,
                                  system,
                                  numbers.data(),
                                  numbers.data() + rows,
                                  numbers.data() + 2 * rows,
                                  static_cast<int>(rigids.size()),
                                  static_cast<int>(joints.size()),
                                  10,
                                  dt};
    const LinkedStep<double, Dim> step{solver,         supports.data(),   starts.data(),
                                       contact.data(), Wrench<Dim>::size, 0};
    for (int n = 0; n < steps && opened < 0; ++n) opened = step();
  }
  /// Kinetic energy and that of height [J].
  double energy() const {
    double sum = 0;
    for (const auto& r : rigids) {
      for (int k = 0; k < k_turning_axes<Dim>; ++k) sum += r.momentum[k] * r.motion.spin[k] / 2;
      for (int d = 0; d < Dim; ++d)
        sum += r.inertia.mass *
               (r.motion.velocity[d] * r.motion.velocity[d] / 2 - gravity[d] * r.motion.pose.displacement[d]);
    }
    return sum;
  }
  /// Largest distance of the ends of joints that hold a point [m].
  double gap() const {
    double most = 0;
    for (const auto& joint : joints)
      for (int d = 0; d < Dim; ++d)
        most = std::fmax(most, std::fabs(place(joint, 0)[d] - place(joint, 1)[d]));
    return most;
  }
  Vector<double, Dim> place(const Joint<Dim>& joint, int side) const {
    return joint.body[side] < 0 ? joint.end[side]
                                : rigids[joint.body[side]].motion.pose.to_world(joint.end[side]);
  }
};

constexpr double k_g = 9.81;

/// Sets the axes of a joint about y.
void about_y(Joint<3>& joint) {
  joint.axes[0] = {0, 1, 0}, joint.axes[1] = {0, 0, 1}, joint.axes[2] = {1, 0, 0};
}

}  // namespace

TEST_CASE("a pendulum keeps its energy and its joint", "[joints]") {
  Linkage<2> of;
  of.gravity = {0, -k_g};
  of.add(12, {5.5, 5}, {1});
  of.join(0, -1, {5, 5}).holds_point = true;
  const double start = of.energy();
  for (int n = 0; n < 20; ++n) {
    of.go(500);
    CHECK(of.gap() < 1e-12);
    CHECK(std::fabs(of.energy() - start) < 1e-4 * 12 * k_g / 2);
  }
  CHECK(of.opened == -1);
}

TEST_CASE("bodies that a weld joins move as one", "[joints]") {
  Linkage<3> of;
  of.add(1, {4, 5, 5}, {0.2, 0.3, 0.4});
  of.add(3, {6, 5, 5}, {0.2, 0.3, 0.4});
  Joint<3>& joint = of.join(0, 1, {5, 5, 5});
  joint.holds_point = true, joint.held_turn = HeldTurn::all;
  of.rigids[1].motion.velocity = {0, 1, 0.5};
  of.rigids[0].momentum = {0.1, 0.2, -0.3};
  of.go(2000);
  CHECK(of.opened == -1);
  CHECK(of.gap() < 1e-12);
  const auto off = of.rigids[0].motion.pose.rotation.way_from(of.rigids[1].motion.pose.rotation);
  for (int k = 0; k < 3; ++k) CHECK(std::fabs(off[k]) < 1e-12);
  for (int d = 0; d < 3; ++d)
    CHECK(std::fabs(of.rigids[0].motion.velocity[d] + 3 * of.rigids[1].motion.velocity[d] -
                    3 * Vector<double, 3>{0, 1, 0.5}[d]) < 1e-11);
}

TEST_CASE("a closed loop with more conditions than it needs moves on", "[joints]") {
  Linkage<3> of;
  of.gravity = {0, 0, -k_g};
  const Vector<double, 3> corner[4] = {{2, 5, 5}, {2, 5, 4}, {4, 5, 4}, {4, 5, 5}};
  for (int k = 0; k < 3; ++k) {
    Vector<double, 3> centre;
    for (int d = 0; d < 3; ++d) centre[d] = (corner[k][d] + corner[k + 1][d]) / 2;
    of.add(1, centre, {0.1, 0.1, 0.1}).motion.velocity = {k == 1 ? 1.0 : 0.5, 0, 0};
  }
  for (int k = 0; k < 4; ++k) {
    Joint<3>& joint = of.join(k < 3 ? k : 2, k == 0 || k == 3 ? -1 : k - 1, corner[k]);
    joint.holds_point = true, joint.held_turn = HeldTurn::about_others;
    about_y(joint);
  }
  of.go(1);
  const double start = of.energy();
  of.go(5000);
  CHECK(of.opened == -1);
  CHECK(of.gap() < 1e-12);
  CHECK(std::fabs(of.energy() - start) < 1e-4 * start);
}

TEST_CASE("a cable pulls at its length alone", "[joints]") {
  Linkage<2> of;
  of.gravity = {0, -k_g};
  of.add(1, {5, 5}, {0.1});
  Joint<2>& cable = of.join(0, -1, {5, 5});
  cable.holds_length = cable.pulls_only = true, cable.length = 1;
  of.go(300);
  CHECK(of.rigids[0].motion.pose.displacement[1] == Approx(-k_g * 0.3 * 0.3 / 2));
  CHECK(cable.impulse[1] == 0);
  double most = 0;
  for (int n = 0; n < 400; ++n) of.go(1), most = std::fmax(most, -of.rigids[0].motion.pose.displacement[1]);
  CHECK(most < 1 + 1e-12);
  CHECK(of.rigids[0].motion.velocity[1] == Approx(0).margin(1e-12));
  of.rigids[0].motion.velocity = {0, 1};  // it may go up again
  of.go(1);
  CHECK(of.rigids[0].motion.velocity[1] == Approx(1 - k_g * of.dt));
}

TEST_CASE("a stop holds the angle, and lets it go back", "[joints]") {
  Linkage<3> of;
  of.gravity = {0, 0, -k_g};
  of.add(1, {5.5, 5, 5}, {0.1, 0.1, 0.1});
  Joint<3>& joint = of.join(0, -1, {5, 5, 5});
  joint.holds_point = joint.stops = true, joint.held_turn = HeldTurn::about_others;
  about_y(joint);
  joint.stop[0] = -1, joint.stop[1] = 0.3;
  of.go(3000);
  CHECK(of.opened == -1);
  CHECK(of.rigids[0].motion.pose.rotation.way_from({})[1] == Approx(0.3));
  CHECK(of.rigids[0].motion.spin[1] == Approx(0).margin(1e-10));
  of.rigids[0].motion.spin = {0, -1, 0}, of.rigids[0].momentum = {0, -0.1, 0};
  of.rigids[0].motion.velocity =
      cross(Vector<double, 3>{0, -1, 0}, Vector<double, 3>{0.5 * std::cos(0.3), 0, -0.5 * std::sin(0.3)});
  of.go(10);
  CHECK(of.rigids[0].motion.pose.rotation.way_from({})[1] < 0.295);
}

TEST_CASE("a slider goes down a line by g sin a", "[joints]") {
  Linkage<2> of;
  of.gravity = {0, -k_g};
  of.add(2, {5, 5}, {0.1});
  Joint<2>& joint = of.join(0, -1, {5.2, 5});
  joint.slides = true, joint.held_turn = HeldTurn::all;
  joint.axes[0] = {std::cos(0.5), std::sin(0.5)}, joint.axes[1] = {-std::sin(0.5), std::cos(0.5)};
  of.go(1000);
  const auto& way = of.rigids[0].motion.pose.displacement;
  CHECK(std::hypot(way[0], way[1]) == Approx(k_g * std::sin(0.5) / 2).epsilon(1e-10));
  CHECK(std::fabs(of.rigids[0].motion.pose.rotation.angle) < 1e-12);
}

TEST_CASE("springs of a rotation in space take no energy", "[joints]") {
  Linkage<3> of;
  Rigid<3>& body = of.add(1, {5, 5, 5}, {0.1, 0.2, 0.3});
  of.supports[0].on = true;
  const Vector<double, 3> stiffness{3, 5, 9};
  for (int k = 0; k < 3; ++k) of.supports[0].stiffness[Wrench<3>::moment + k] = stiffness[k];
  body.motion.spin = {2, 3, -4};
  body.momentum = {0.2, 0.6, -1.2};
  const auto stored = [&] {
    const auto a = of.rigids[0].motion.pose.rotation.way_from({});
    return (stiffness[0] * a[0] * a[0] + stiffness[1] * a[1] * a[1] + stiffness[2] * a[2] * a[2]) / 2;
  };
  const double start = of.energy();
  for (int n = 0; n < 20; ++n) {
    of.go(200);
    CHECK(of.energy() + stored() == Approx(start).epsilon(1e-4));
  }
}

TEST_CASE("a dashpot slows a body down by its rate", "[joints]") {
  Linkage<2> of;
  of.add(2, {5, 5}, {0.5}).motion.velocity = {1, 0};
  of.rigids[0].motion.spin = {1}, of.rigids[0].momentum = {0.5};
  of.supports[0].on = true;
  of.supports[0].viscosity[0] = 4, of.supports[0].viscosity[Wrench<2>::moment] = 1;
  of.go(1000);
  CHECK(of.rigids[0].motion.velocity[0] == Approx(std::exp(-2)).epsilon(1e-5));
  CHECK(of.rigids[0].motion.spin[0] == Approx(std::exp(-2)).epsilon(1e-5));
  CHECK(of.supports[0].impulse[0] == Approx(2 * (std::exp(-2) - 1)).epsilon(1e-5));
}
