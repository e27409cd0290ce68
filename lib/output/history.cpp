#include "output/history.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "common/checksum.hpp"
#include "common/numbers.hpp"
#include "common/rigid_contact.hpp"
#include "common/text.hpp"
#include "output/files.hpp"
#include "output/history_columns.hpp"

namespace mpm {
namespace {

/// Appends ",a,b[,c]".
void append(std::string& row, const Vec3& vector, int dim) {
  for (int d = 0; d < dim; ++d) row += "," + text_of(vector[d]);
}

}  // namespace

std::string history_header(const Config& config) {
  std::vector<std::string> names;
  for (const HistoryColumn& column : history_columns(config)) names.push_back(column.name);
  return join(names);
}

std::string format_history_row(const HistoryRow& row, const Config& config) {
  const int dim = config.dim;
  std::string text = std::to_string(row.step);
  for (double value : {row.time, row.dt, row.wall_time}) text += "," + text_of(value);
  for (const BodyRow& body : row.bodies) {
    for (int d = 0; d < dim; ++d) text += "," + text_of(body.lower[d]) + "," + text_of(body.upper[d]);
    text += "," + text_of(body.kinetic_energy);
    for (const Vec3* vector : {&body.momentum, &body.quantile, &body.centre}) append(text, *vector, dim);
    for (const double value : {body.grid_velocity, body.mass, body.lost_mass, body.lost_energy})
      text += "," + text_of(value);
    append(text, body.lost_momentum, dim);
    for (const long number : {body.strays, body.limited, body.put_back}) text += "," + std::to_string(number);
    if (water_flows(config)) text += "," + text_of(body.pore_water) + "," + text_of(body.outflow);
    if (config.particle_domain != ParticleDomain::fixed) text += "," + std::to_string(body.stretched);
    if (config.particle_domain == ParticleDomain::split)
      text += "," + std::to_string(body.particles) + "," + std::to_string(body.merged) + "," +
              text_of(body.merged_energy);
    if (config.position_correction) text += "," + text_of(body.corrected) + "," + text_of(body.raised);
  }
  const std::vector<char> in_contact = contact_columns(config);
  for (std::size_t r = 0; r < row.rigids.size(); ++r) {
    const RigidRow& rigid = row.rigids[r];
    for (const Vec3* vector : {&rigid.displacement, &rigid.velocity, &rigid.force})
      append(text, *vector, dim);
    const RigidConfig& of = config.rigids[r];
    const int spins = dim == 2 ? 1 : 3;
    for (const Vec3* vector : {&rigid.angle, &rigid.angular_velocity, &rigid.moment})
      if (of.turns()) append(text, *vector, spins);
    if (has_energy(of)) text += "," + text_of(rigid.kinetic_energy);
    if (of.is_sprung()) append(text, rigid.spring_force, dim);
    if (of.is_sprung() && of.turns()) append(text, rigid.spring_moment, spins);
    if (in_contact[r]) append(text, rigid.contact_force, dim);
    if (in_contact[r] && of.turns()) append(text, rigid.contact_moment, spins);
    for (std::size_t n = 0; of.part_forces && n < of.shape.parts.size(); ++n) {
      const PartRow part = n < rigid.parts.size() ? rigid.parts[n] : PartRow{};
      append(text, part.force, dim);
      if (of.turns()) append(text, part.moment, spins);
    }
  }
  for (const JointReaction& joint : row.joints) {
    append(text, joint.force, dim), append(text, joint.moment, dim == 2 ? 1 : 3);
    for (const double value : {joint.peak, joint.work}) text += "," + text_of(value);
  }
  for (const InterfaceRow& pair : row.interfaces) {
    append(text, pair.force, dim);
    for (const double value : {pair.area, pair.work}) text += "," + text_of(value);
  }
  for_each_wall(config, [&](int d, int side) { append(text, row.walls[d][side], dim); });
  for (const LoadRow& load : row.loads) {
    append(text, load.force, dim);
    text += "," + text_of(load.area);
  }
  text += "," + std::to_string(row.empty_cells);
  if (config.output.energy)
    for_each_energy(config,
                    [&](const EnergyColumn& column) { text += "," + text_of(row.energy.*column.value); });
  for (const double value : row.probes) text += "," + text_of(value);
  if (!config.stages.empty()) text += "," + std::to_string(row.stage);
  if (config.balance) text += "," + text_of(row.unbalanced_ratio);
  return text;
}

std::string format_energy(const EnergyRow& e) {
  return formatted(
      "energy (J): kinetic %.4g, elastic %.4g, dissipated in the soil %.4g, lost with particles %.4g; work "
      "of "
      "gravity %.4g, loads %.4g, rigids %.4g, walls and contact %.4g, damping %.4g, velocity update %.4g; "
      "missing %.3g",
      e.kinetic, e.elastic, e.dissipated, e.lost, e.gravity, e.loads, e.rigids, e.contact, e.damping,
      e.update, e.error);
}

HistoryMark mark_of(const std::string& path, long bytes, std::string* text) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(0, std::ios::end);
  std::string start(static_cast<size_t>(std::clamp<long>(file.tellg(), 0, bytes)), '\0');
  file.seekg(0);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<size_t>(file.gcount()));
  const HistoryMark mark{static_cast<long>(start.size()), checksum(0, start)};
  if (text) *text = std::move(start);
  return mark;
}

History::~History() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

PetscErrorCode History::open(const Config& config, const std::string& rows) {
  PetscFunctionBeginUser;
  PetscCall(close());
  config_ = config;
  path_ = config.output.directory + "/history.csv";
  const std::string text = rows.empty() ? history_header(config) + "\n" : rows;
  PetscCall(replace_file(path_, text));
  mark_ = {static_cast<long>(text.size()), checksum(0, text)};
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  PetscCheck(descriptor_ >= 0, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "Cannot open %s: %s", path_.c_str(),
             std::strerror(errno));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode History::write(const HistoryRow& row) {
  PetscFunctionBeginUser;
  PetscCheck(descriptor_ >= 0, PETSC_COMM_SELF, PETSC_ERR_ORDER, "history.csv is not open");
  const off_t whole = ::lseek(descriptor_, 0, SEEK_END);
  const std::string text = format_history_row(row, config_) + "\n";
  const PetscErrorCode failed = write_all(descriptor_, text, path_);
  // Should the cut fail too, there is nothing better to do than to report the write that failed first.
  if (failed && ::ftruncate(descriptor_, whole) != 0) errno = 0;
  PetscCall(failed);
  mark_ = {mark_.bytes + static_cast<long>(text.size()), checksum(mark_.crc, text)};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode History::settle(HistoryMark* mark) const {
  PetscFunctionBeginUser;
  PetscCall(bring_to_disk(path_));
  *mark = mark_;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode History::close() {
  PetscFunctionBeginUser;
  PetscCall(close_file(&descriptor_, path_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
