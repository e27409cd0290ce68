#include "output/history_columns.hpp"

#include <map>

#include "common/rigid_contact.hpp"
#include "common/text.hpp"
#include "common/velocity_fields.hpp"
#include "output/probes.hpp"

namespace mpm {
namespace {

constexpr const char* k_axis[3] = {"x", "y", "z"};

/// Columns of one owner.
class Columns {
 public:
  Columns(std::vector<HistoryColumn>& all, int dim) : all_(all), dim_(dim) {}
  /// Begins the columns of this owner.
  void begin(const std::string& list, const std::string& kind, const std::string& owner) {
    list_ = list, kind_ = kind, owner_ = owner;
  }
  void add(const std::string& name) { all_.push_back({name, list_, kind_, owner_}); }
  /// BEGINNINGx,BEGINNINGy[,BEGINNINGz].
  void add_vector(const std::string& beginning, const std::string& end = "") {
    for (int d = 0; d < dim_; ++d) add(beginning + k_axis[d] + end);
  }
  /// BEGINNING in 2D, BEGINNING_x,BEGINNING_y,BEGINNING_z in 3D.
  void add_rotation(const std::string& beginning) {
    if (dim_ == 2) return add(beginning);
    add_vector(beginning + "_");
  }

 private:
  std::vector<HistoryColumn>& all_;
  std::string list_, kind_, owner_;
  int dim_;
};

std::string words_of(const HistoryColumn& column) {
  return column.kind + (column.owner.empty() ? "" : " " + column.owner);
}

void add_body(Columns& to, const std::string& name, const Config& config) {
  to.begin("bodies", "body", name);
  for (int d = 0; d < config.dim; ++d)
    for (const char* side : {"min", "max"}) to.add(name + "_" + k_axis[d] + side);
  to.add(name + "_kinetic_energy");
  to.add_vector(name + "_momentum_");
  to.add_vector(name + "_", "q999");
  to.add_vector(name + "_centre_");
  to.add(name + "_grid_velocity");
  for (const char* quantity : {"_mass", "_lost_mass", "_lost_energy"}) to.add(name + quantity);
  to.add_vector(name + "_lost_momentum_");
  for (const char* number : {"_strays", "_limited", "_put_back"}) to.add(name + number);
  if (water_flows(config))
    for (const char* volume : {"_water", "_outflow"}) to.add(name + volume);
  if (config.particle_domain != ParticleDomain::fixed) to.add(name + "_stretched");
  if (config.particle_domain == ParticleDomain::split)
    for (const char* quantity : {"_particles", "_merged", "_merged_energy"}) to.add(name + quantity);
  if (config.position_correction)
    for (const char* energy : {"_corrected_energy", "_raised_energy"}) to.add(name + energy);
}

void add_rigid(Columns& to, const RigidConfig& rigid, bool in_contact) {
  to.begin("rigid_bodies", "rigid body", rigid.name);
  for (const char* quantity : {"_", "_velocity_", "_force_"}) to.add_vector(rigid.name + quantity);
  for (const char* quantity : {"_angle", "_angular_velocity", "_moment"})
    if (rigid.turns()) to.add_rotation(rigid.name + quantity);
  if (has_energy(rigid)) to.add(rigid.name + "_kinetic_energy");
  if (rigid.is_sprung()) to.add_vector(rigid.name + "_spring_force_");
  if (rigid.is_sprung() && rigid.turns()) to.add_rotation(rigid.name + "_spring_moment");
  if (in_contact) to.add_vector(rigid.name + "_contact_force_");
  if (in_contact && rigid.turns()) to.add_rotation(rigid.name + "_contact_moment");
  for (std::size_t n = 0; rigid.part_forces && n < rigid.shape.part_names.size(); ++n) {
    to.add_vector(rigid.shape.part_names[n] + "_force_");
    if (rigid.turns()) to.add_rotation(rigid.shape.part_names[n] + "_moment");
  }
}

}  // namespace

std::vector<HistoryColumn> history_columns(const Config& config) {
  std::vector<HistoryColumn> all;
  Columns to(all, config.dim);
  const auto begin_run = [&to] { to.begin("", "the run", ""); };
  begin_run();
  for (const char* name : {"step", "time", "dt", "wall_time"}) to.add(name);
  for (const BodyConfig& body : config.bodies) add_body(to, body.name, config);
  const std::vector<char> in_contact = contact_columns(config);
  for (std::size_t r = 0; r < config.rigids.size(); ++r) add_rigid(to, config.rigids[r], in_contact[r]);
  for (const JointConfig& joint : config.joints) {
    to.begin("joints", "joint", joint.name);
    to.add_vector(joint.name + "_force_");
    to.add_rotation(joint.name + "_moment");
    for (const char* quantity : {"_peak_force", "_work"}) to.add(joint.name + quantity);
  }
  for (const ContactPairConfig& pair : pairs_of_fields(config)) {
    to.begin("contact_pairs", "pair", pair.name);
    to.add_vector(pair.name + "_force_");
    for (const char* quantity : {"_area", "_friction_work"}) to.add(pair.name + quantity);
  }
  for_each_wall(config, [&](int d, int side) {
    const std::string name = std::string(k_axis[d]) + (side == 0 ? "min" : "max");
    to.begin("", "side", name);
    to.add_vector("wall_" + name + "_force_");
  });
  for (const LoadConfig& load : config.loads) {
    to.begin("loads", "load", load.name);
    to.add_vector(load.name + "_force_");
    to.add(load.name + "_area");
  }
  begin_run();
  to.add("empty_cells");
  if (config.output.energy) for_each_energy(config, [&](const EnergyColumn& column) { to.add(column.name); });
  for (const ProbeConfig& probe : config.probes) {
    to.begin("probes", "probe", probe.name);
    for (const std::string& column : columns_of(probe, config)) to.add(column);
  }
  begin_run();
  if (!config.stages.empty()) to.add("stage");
  if (config.balance) to.add("unbalanced_ratio");
  return all;
}

std::string equal_columns(const Config& config) {
  std::map<std::string, HistoryColumn> known;
  for (const HistoryColumn& column : history_columns(config)) {
    const auto [before, is_new] = known.insert({column.name, column});
    if (is_new) continue;
    const HistoryColumn& named = column.list.empty() ? before->second : column;
    return "mpm: -" + named.list + ": given \"" + named.owner +
           "\", takes names that give each column of history.csv once; " + words_of(before->second) +
           " and " + words_of(column) + " both have " + column.name;
  }
  return "";
}

}  // namespace mpm
