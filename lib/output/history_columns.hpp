#pragma once
// The columns of history.csv: their names, in order, and to what of the run each belongs.

#include <string>
#include <vector>

#include "common/snapshot.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// A column of history.csv.
struct HistoryColumn {
  std::string name;
  std::string
      list;  // the option that names its owner: "bodies"; empty where it belongs to the run or the mesh
  std::string kind;   // of the owner, in words: "rigid body"
  std::string owner;  // its name
};

/// All columns of a run, in order.
std::vector<HistoryColumn> history_columns(const Config& config);

/// A line for the user where two columns have one name; empty where none have.
std::string equal_columns(const Config& config);

/// Whether the history has the kinetic energy of a rigid body.
inline bool has_energy(const RigidConfig& rigid) { return rigid.motion == Motion::dynamic && rigid.turns(); }

/// A column of the energy balance.
struct EnergyColumn {
  const char* name;
  double EnergyRow::*value;
};
inline constexpr EnergyColumn k_energy_columns[] = {
    {"energy_kinetic", &EnergyRow::kinetic}, {"energy_internal", &EnergyRow::internal},
    {"energy_elastic", &EnergyRow::elastic}, {"energy_dissipated", &EnergyRow::dissipated},
    {"energy_lost", &EnergyRow::lost},       {"work_gravity", &EnergyRow::gravity},
    {"work_loads", &EnergyRow::loads},       {"work_rigids", &EnergyRow::rigids},
    {"work_contact", &EnergyRow::contact},   {"work_damping", &EnergyRow::damping},
    {"work_update", &EnergyRow::update},     {"energy_error", &EnergyRow::error}};

/// Calls f(column) for those of a run: the work of loads where it has some.
template <class F>
void for_each_energy(const Config& config, F&& f) {
  for (const EnergyColumn& column : k_energy_columns)
    if (column.value != &EnergyRow::loads || !config.loads.empty()) f(column);
}

/// Calls f(direction, side) for each side of the mesh that holds soil.
template <class F>
void for_each_wall(const Config& config, F&& f) {
  for (int d = 0; d < config.dim; ++d)
    for (int side = 0; side < 2; ++side)
      if (!is_open(config.mesh.walls[d][side])) f(d, side);
}

}  // namespace mpm
