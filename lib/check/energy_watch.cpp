#include "check/energy_watch.hpp"

#include <algorithm>
#include <cmath>

#include "common/gravity_on_soil.hpp"
#include "common/text.hpp"
#include "input/geometry/shapes.hpp"

namespace mpm {
namespace {

double kinetic_energy_of(const HistoryRow& row) {
  double sum = 0;
  for (const BodyRow& body : row.bodies) sum += body.kinetic_energy;
  return sum;
}

long lost_of(const HistoryRow& row) {
  long sum = 0;
  for (const BodyRow& body : row.bodies) sum += body.lost_count;
  return sum;
}

/// The most work [J] that gravity, of which a component is at most `gravity` [m/s2] in size, does on a body
/// between two rows. Gravity may turn between them, so it does not follow from the movement of the centre.
double most_work(const BodyRow& now, const BodyRow& before, double interval, double gravity, int d) {
  const double mass = std::max(now.mass, before.mass), gain = std::fabs(gravity) * interval;
  if (mass == 0) return 0;
  const double speed = std::max(std::fabs(now.momentum[d]), std::fabs(before.momentum[d])) / mass + gain;
  return mass * gain * speed;
}

/// The most by which the point of the history's moments may be off the centre of mass of a rigid [m].
double arm_of(const Config& config, std::size_t r) {
  if (!config.rigids[r].moment_point) return 0;
  const Bounds bounds = bounds_of(config.rigids[r].shape, config.mesh, config.dim);
  double squares = 0;
  for (int d = 0; d < config.dim; ++d) squares += std::pow(bounds.upper[d] - bounds.lower[d], 2);
  return std::sqrt(squares);
}

/// The most work [J] of the soil on a rigid by its rotation between two rows.
double work_of_turning(const RigidRow& now, const RigidRow& before, double interval, double arm) {
  double force = 0, work = 0;
  for (int d = 0; d < 3; ++d) force += std::fabs(now.force[d]);
  for (int d = 0; d < 3; ++d)
    work += (std::fabs(now.moment[d]) + arm * force) * interval *
            std::max(std::fabs(now.angular_velocity[d]), std::fabs(before.angular_velocity[d]));
  return work;
}

}  // namespace

void EnergyWatch::begin(const HistoryRow& row, double wave_energy) {
  constexpr double k_round_off = 1e-10;
  last_ = row;
  available_ = 0;
  for (const BodyRow& body : row.bodies) available_ += body.kinetic_energy + body.stored_energy;
  passed_ = available_;
  least_ = k_round_off * wave_energy;
}

void EnergyWatch::add_work(const HistoryRow& row, const Config& config) {
  const auto add = [&](double work) { available_ += work, passed_ += std::fabs(work); };
  const Vec3 gravity = gravity_on_soil(config);  // the rows hold the energy of other water
  for (std::size_t b = 0; b < row.bodies.size(); ++b) {
    for (int d = 0; d < config.dim && config.gravity_table; ++d)
      add(most_work(row.bodies[b], last_.bodies[b], row.time - last_.time, gravity[d], d));
    for (int d = 0; d < config.dim && !config.gravity_table; ++d)
      add(row.bodies[b].mass * gravity[d] * (row.bodies[b].centre[d] - last_.bodies[b].centre[d]));
    add(last_.bodies[b].water_energy - row.bodies[b].water_energy);
  }
  add(row.side_work);
  add(row.load_work - last_.load_work);
  for (std::size_t r = 0; r < row.rigids.size(); ++r) {
    const RigidRow &rigid = row.rigids[r], &before = last_.rigids[r];
    for (int d = 0; d < config.dim; ++d)
      add(std::fabs(rigid.force[d] * (rigid.displacement[d] - before.displacement[d])));
    if (config.rigids[r].turns())
      add(work_of_turning(rigid, before, row.time - last_.time, arm_of(config, r)));
  }
}

std::string EnergyWatch::check(const HistoryRow& row, const Config& config) {
  constexpr double k_slack = 0.5;  // of what has passed: forces are means over the rows
  const double now = kinetic_energy_of(row);
  if (lost_of(row) != lost_of(last_)) {  // the centre gives no work where soil has left
    const double passed = passed_, least = least_;
    begin(row, 0);
    passed_ = std::max(passed, passed_), least_ = least;
    return {};
  }
  add_work(row, config);
  last_ = row;
  if (!(now > available_ + k_slack * passed_ + least_)) return {};
  return formatted(
      "the kinetic energy has grown to %.4g J, and only %.4g J of it have a source (the energy at the start, "
      "gravity, loads, water, rigids, sides of the mesh): the time step is not stable for this soil; take a "
      "smaller "
      "-time_courant",
      now, available_);
}

}  // namespace mpm
