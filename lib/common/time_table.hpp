#pragma once
// Tables in time, on the host.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/text.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Value of largest size of each component.
inline Vec3 largest_of(const TimeTable& table) {
  Vec3 largest{};
  for (const Vec3& value : table.values)
    for (int d = 0; d < 3; ++d)
      if (std::fabs(value[d]) > std::fabs(largest[d])) largest[d] = value[d];
  return largest;
}

/// Rate of change of largest size of each component [1/s].
inline Vec3 largest_rate(const TimeTable& table) {
  constexpr double k_smooth = 1.5;  // the slope in the middle over the mean slope
  Vec3 largest{};
  for (std::size_t k = 1; k < table.times.size(); ++k)
    for (int d = 0; d < 3; ++d) {
      const double rate = (table.smooth ? k_smooth : 1) * (table.values[k][d] - table.values[k - 1][d]) /
                          (table.times[k] - table.times[k - 1]);
      if (std::fabs(rate) > std::fabs(largest[d])) largest[d] = rate;
    }
  return largest;
}

/// End of the option that gives the motion of a side.
inline const char* motion_of(const SideConfig& side) {
  return side.of_accelerations ? "_acceleration_table"
         : side.velocity_table ? "_velocity_table"
                               : "_velocity";
}

/// The tables of a configuration, by their options with dash.
inline std::vector<std::pair<std::string, const TimeTable*>> tables_of(const Config& config) {
  std::vector<std::pair<std::string, const TimeTable*>> tables;
  const auto add = [&](const std::string& option, const std::optional<TimeTable>& table) {
    if (table) tables.emplace_back(option, &*table);
  };
  add("-gravity_table", config.gravity_table);
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side) {
      const SideConfig& of = config.mesh.sides[d][side];
      add("-" + side_option(d, side) + motion_of(of), of.velocity_table);
    }
  for (const LoadConfig& load : config.loads) {
    add("-" + load.name + "_pressure_table", load.pressure_table);
    add("-" + load.name + "_traction_table", load.traction_table);
  }
  for (const RigidConfig& rigid : config.rigids) {
    add("-" + rigid.name + "_velocity_table", rigid.velocity_table);
    add("-" + rigid.name + "_displacement_table", rigid.displacement_table);
    add("-" + rigid.name + "_force_table", rigid.force_table);
    add("-" + rigid.name + "_angular_velocity_table", rigid.angular_velocity_table);
    add("-" + rigid.name + "_angle_table", rigid.angle_table);
    add("-" + rigid.name + "_moment_table", rigid.moment_table);
  }
  for (const JointConfig& joint : config.joints) {
    add("-" + joint.name + "_velocity_table", joint.velocity_table);
    add("-" + joint.name + "_displacement_table", joint.displacement_table);
  }
  return tables;
}
/// Options that name a file of a table, and that file.
inline std::vector<std::pair<std::string, std::string>> table_files(const Config& config) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& [option, table] : tables_of(config))
    if (!table->file.empty()) files.emplace_back(option, table->file);
  return files;
}

/// Movement of a rigid body with prescribed motion along direction d till a time [s], in m. The interval that
/// the time cuts counts as straight.
inline double travel(const RigidConfig& rigid, int d, double end) {
  const auto& table = rigid.displacement_table ? rigid.displacement_table : rigid.velocity_table;
  if (!table) return rigid.velocity[d] * end;
  const auto& times = table->times;
  double sum = 0, first = table->values[0][d], last = first;
  for (std::size_t k = 1; k < times.size() && times[k - 1] < end; ++k) {
    const double from = std::max(0.0, times[k - 1]), to = std::min(end, times[k]);
    if (to <= from) continue;
    const auto at = [&](double t) {
      return table->values[k - 1][d] + (table->values[k][d] - table->values[k - 1][d]) *
                                           ((t - times[k - 1]) / (times[k] - times[k - 1]));
    };
    if (from == 0) first = at(0);
    sum += (to - from) * (at(from) + at(to)) / 2, last = at(to);
  }
  return rigid.displacement_table ? last - first : sum;
}

}  // namespace mpm
