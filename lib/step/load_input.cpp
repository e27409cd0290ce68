#include "step/load_input.hpp"

namespace mpm {
namespace {

std::vector<CurvePoint> points_of(const TimeTable& table, int d) {
  std::vector<CurvePoint> points;
  for (std::size_t k = 0; k < table.times.size(); ++k) points.push_back({table.times[k], table.values[k][d]});
  return points;
}

/// Component d of a table, or a constant where there is none.
NumberInput number_of(const std::optional<TimeTable>& table, double constant, int d,
                      CurveUse use = CurveUse::value) {
  NumberInput number{.constant = constant, .use = use};
  if (table) number.points = points_of(*table, d), number.smooth = table->smooth;
  return number;
}

TimeCurve curve_of(const std::vector<CurvePoint>& points, bool smooth) {
  return {points.data(), static_cast<int>(points.size()), smooth};
}

/// Component d of a table at a time [s], or a constant where there is none.
double value_at(const std::optional<TimeTable>& table, double constant, int d, double time) {
  if (!table) return constant;
  const auto points = points_of(*table, d);
  return curve_of(points, table->smooth).value(time);
}

}  // namespace

std::vector<LoadInput> load_input(const Config& config, const std::vector<double>& carried) {
  std::vector<LoadInput> loads;
  const auto add = [&](LoadTarget target, int rigid, int d, NumberInput&& own, NumberInput&& gravity,
                       double factor) {
    loads.push_back({target, rigid, d, std::move(own), std::move(gravity), factor});
  };
  for (int d = 0; d < config.dim && config.gravity_table; ++d)
    add(LoadTarget::gravity, 0, d, number_of(config.gravity_table, 0, d), {}, 0);
  for (int n = 0; n < 2 * config.dim; ++n)
    for (int d = 0; d < config.dim; ++d)
      if (const auto& table = config.mesh.sides[n / 2][n % 2].velocity_table)
        add(LoadTarget::side, n, d, number_of(table, 0, d), {}, 0);
  for (int n = 0; n < static_cast<int>(config.loads.size()); ++n) {
    const LoadConfig& load = config.loads[n];
    if (load.pressure_table) add(LoadTarget::pressure, n, 0, number_of(load.pressure_table, 0, 0), {}, 0);
    for (int d = 0; d < config.dim && load.traction_table; ++d)
      add(LoadTarget::traction, n, d, number_of(load.traction_table, 0, d), {}, 0);
  }
  for (int r = 0; r < static_cast<int>(config.rigids.size()); ++r) {
    const RigidConfig& rigid = config.rigids[r];
    const bool weighs = rigid.motion == Motion::dynamic && (rigid.force_table || config.gravity_table);
    for (int k = 0; k < (config.dim == 2 ? 1 : 3); ++k) {
      if (rigid.angular_velocity_table)
        add(LoadTarget::spin, r, k, number_of(rigid.angular_velocity_table, 0, k), {}, 0);
      if (rigid.angle_table)
        add(LoadTarget::spin, r, k, number_of(rigid.angle_table, 0, k, CurveUse::rate), {}, 0);
      if (rigid.moment_table) add(LoadTarget::moment, r, k, number_of(rigid.moment_table, 0, k), {}, 0);
    }
    for (int d = 0; d < config.dim; ++d) {
      if (rigid.velocity_table) add(LoadTarget::velocity, r, d, number_of(rigid.velocity_table, 0, d), {}, 0);
      if (rigid.displacement_table)
        add(LoadTarget::velocity, r, d, number_of(rigid.displacement_table, 0, d, CurveUse::rate), {}, 0);
      if (weighs)
        add(LoadTarget::force, r, d, number_of(rigid.force_table, rigid.force[d], d),
            number_of(config.gravity_table, config.gravity[d], d), carried[r]);
    }
  }
  for (int j = 0; j < static_cast<int>(config.joints.size()); ++j)
    for (int d = 0; d < config.dim; ++d) {
      const JointConfig& joint = config.joints[j];
      if (joint.velocity_table) add(LoadTarget::joint, j, d, number_of(joint.velocity_table, 0, d), {}, 0);
      if (joint.displacement_table)
        add(LoadTarget::joint, j, d, number_of(joint.displacement_table, 0, d, CurveUse::rate), {}, 0);
    }
  return loads;
}

double gravity_at(const Config& config, int d, double time) {
  return value_at(config.gravity_table, config.gravity[d], d, time);
}

double pressure_at(const LoadConfig& load, double time) {
  return value_at(load.pressure_table, load.pressure, 0, time);
}

double traction_at(const LoadConfig& load, int d, double time) {
  return value_at(load.traction_table, load.traction[d], d, time);
}

double velocity_at(const RigidConfig& rigid, int d, double present, double time) {
  const auto& table = rigid.displacement_table;
  if (!table) return value_at(rigid.velocity_table, present, d, time);
  const auto points = points_of(*table, d);
  return curve_of(points, table->smooth).rate(time);
}

double spin_at(const RigidConfig& rigid, int k, double present, double time) {
  const auto& table = rigid.angle_table;
  if (!table) return value_at(rigid.angular_velocity_table, present, k, time);
  const auto points = points_of(*table, k);
  return curve_of(points, table->smooth).rate(time);
}

}  // namespace mpm
