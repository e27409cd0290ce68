#include "output/probes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "common/pore_pressure.hpp"
#include "output/linear_fit.hpp"

namespace mpm {
namespace {

constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
constexpr const char* k_component[3] = {"x", "y", "z"};
constexpr const char* k_stress[6] = {"xx", "yy", "zz", "xy", "yz", "zx"};
constexpr double k_reach = 1.5;  // cells, of a point to the particles that its values come from

int stress_size(const Config& config) { return config.dim == 2 ? 4 : 6; }

/// Particles of one probe, with their pore pressures.
struct Taken {
  std::span<const ProbeParticle> particles;
  std::span<const double> pore_pressure;
};

void add_vector(std::vector<std::string>& columns, const std::string& name, int dim) {
  for (int d = 0; d < dim; ++d) columns.push_back(name + k_component[d]);
}

/// Velocity, stress, pressure and pore pressure, as columns.
void add_state(std::vector<std::string>& columns, const std::string& name, const Config& config) {
  add_vector(columns, name + "_velocity_", config.dim);
  for (int k = 0; k < stress_size(config); ++k) columns.push_back(name + "_stress_" + k_stress[k]);
  columns.push_back(name + "_pressure");
  if (has_pore_pressure(config)) columns.push_back(name + "_pore_pressure");
}

/// Adds the state as numbers, of a particle or fitted.
void add_state(std::vector<double>& values, const Config& config, std::span<const double> velocity,
               std::span<const double> stress, double pore_pressure) {
  for (int d = 0; d < config.dim; ++d) values.push_back(velocity[d]);
  for (int k = 0; k < stress_size(config); ++k) values.push_back(stress[k]);
  values.push_back((0 - (stress[0] + stress[1] + stress[2])) / 3);
  if (has_pore_pressure(config)) values.push_back(pore_pressure);
}

void add_none(std::vector<double>& values, std::size_t count) { values.insert(values.end(), count, k_none); }

/// Weight of a particle at a distance r [reaches] along an axis.
double bell(double r) {
  const double a = std::fabs(r);
  return a < 1 ? (1 - a) * (1 - a) * (1 + 2 * a) : 0;
}

/// A point: fields that are linear between the particles are exact. There is soil within half a cell, or half
/// a domain, of the middle of a particle.
void add_point(std::vector<double>& values, const Config& config, const ProbeConfig& probe,
               const Taken& taken) {
  constexpr int k_fields = 7;  // stress, pore pressure
  const double h = config.mesh.spacing;
  LinearFit motion(config.dim, 3), stress(config.dim, k_fields);
  bool soil = false;
  for (std::size_t n = 0; n < taken.particles.size(); ++n) {
    const ProbeParticle& p = taken.particles[n];
    double r[3] = {}, weight = 1;
    bool near = true;
    for (int d = 0; d < config.dim; ++d) {
      r[d] = (p.position[d] + config.mesh.lower[d] - probe.at[d]) / h;
      weight *= bell(r[d] / k_reach);
      near = near && std::fabs(r[d]) <= std::max(0.5, p.half_length[d] / h) + 1e-9;
    }
    soil = soil || near;
    const double fields[k_fields] = {p.stress[0], p.stress[1], p.stress[2],           p.stress[3],
                                     p.stress[4], p.stress[5], taken.pore_pressure[n]};
    motion.add(weight * p.mass, r, p.velocity);
    stress.add(weight * p.volume, r, fields);
  }
  if (!soil) return add_none(values, columns_of(probe, config).size());
  const auto v = motion.value(), s = stress.value();
  add_state(values, config, v, s, s[6]);
}

/// A particle that is followed: itself, or where it was merged into another one the part of it with the
/// lowest number.
void add_particle(std::vector<double>& values, const Config& config, const ProbeConfig& probe, long id,
                  std::span<const double> start, const Taken& taken) {
  if (taken.particles.empty()) return add_none(values, columns_of(probe, config).size());
  std::size_t n = 0;
  for (std::size_t k = 0; k < taken.particles.size(); ++k)
    if (taken.particles[k].id == id) n = k;
  const ProbeParticle& p = taken.particles[n];
  for (int d = 0; d < config.dim; ++d) values.push_back(p.position[d] + config.mesh.lower[d]);
  for (int d = 0; d < config.dim; ++d) values.push_back(p.position[d] - start[d]);
  add_state(values, config, p.velocity, p.stress, taken.pore_pressure[n]);
}

/// Share of a particle in the strip of a gauge over the measure of the strip [1/m, 1/m2]: times the volume it
/// is the depth that the particle adds.
double share_in_strip(const Config& config, const ProbeConfig& probe, const ProbeParticle& p) {
  double share = 1;
  for (int d = 0; d + 1 < config.dim; ++d) {
    const bool ring = config.geometry == Geometry::axisymmetric;
    const double l = p.half_length[d], at = probe.at[d] - config.mesh.lower[d];
    const double low = ring ? std::max(0.0, p.position[d] - l) : p.position[d] - l, high = low + 2 * l;
    const double from = ring ? std::max(0.0, at - probe.width / 2) : at - probe.width / 2,
                 to = at + probe.width / 2;
    const auto measure = [&](double a, double b) {
      return (b - a) * (ring ? std::numbers::pi * (a + b) : 1.0);
    };
    if (probe.width == 0)  // the line itself: a strip that is thin
      share *= low <= at && at < high ? 1 / measure(low, high) : 0.0;
    else
      share *=
          std::max(0.0, std::min(high, to) - std::max(low, from)) <= 0
              ? 0.0
              : measure(std::max(low, from), std::min(high, to)) / measure(low, high) / measure(from, to);
  }
  return share;
}

/// A gauge: depth, upper and lower edge of the soil, greatest speed, mean velocity over the depth.
void add_gauge(std::vector<double>& values, const Config& config, const ProbeConfig& probe,
               const Taken& taken) {
  const int up = config.dim - 1;
  double depth = 0, top = -HUGE_VAL, base = HUGE_VAL, speed = 0, mass = 0, momentum[3] = {};
  for (const ProbeParticle& p : taken.particles) {
    const double share = share_in_strip(config, probe, p);
    if (!(share > 0)) continue;
    depth += share * p.volume, mass += share * p.mass;
    top = std::max(top, p.position[up] + p.half_length[up]);
    base = std::min(base, p.position[up] - p.half_length[up]);
    speed = std::max(speed, std::hypot(p.velocity[0], p.velocity[1], p.velocity[2]));
    for (int d = 0; d < config.dim; ++d) momentum[d] += share * p.mass * p.velocity[d];
  }
  values.push_back(depth);
  for (const double edge : {top, base}) values.push_back(depth > 0 ? edge + config.mesh.lower[up] : k_none);
  values.push_back(speed);
  for (int d = 0; d < config.dim; ++d) values.push_back(mass > 0 ? momentum[d] / mass : 0);
}

void add_section(std::vector<double>& values, int dim, const SectionSum& sum, const double* zero) {
  for (const double value :
       {sum.mass_flux, sum.volume_flux, sum.mass - zero[0], sum.initial_volume - zero[1]})
    values.push_back(value);
  for (int d = 0; d < dim; ++d) values.push_back(sum.momentum_flux[d]);
}

}  // namespace

std::vector<std::string> columns_of(const ProbeConfig& probe, const Config& config) {
  std::vector<std::string> columns;
  const std::string& name = probe.name;
  switch (probe.kind) {
    case ProbeKind::point: add_state(columns, name, config); break;
    case ProbeKind::particle:
      add_vector(columns, name + "_", config.dim);
      add_vector(columns, name + "_displacement_", config.dim);
      add_state(columns, name, config);
      break;
    case ProbeKind::gauge:
      for (const char* quantity : {"_depth", "_surface", "_base", "_speed"})
        columns.push_back(name + quantity);
      add_vector(columns, name + "_mean_velocity_", config.dim);
      break;
    case ProbeKind::section:
      for (const char* quantity : {"_mass_flux", "_volume_flux", "_mass", "_volume"})
        columns.push_back(name + quantity);
      add_vector(columns, name + "_momentum_flux_", config.dim);
      break;
  }
  return columns;
}

std::vector<ProbeRegion> regions_of(const Config& config, const ProbeState& state) {
  std::vector<ProbeRegion> regions;
  for (std::size_t n = 0; n < config.probes.size(); ++n) {
    const ProbeConfig& probe = config.probes[n];
    ProbeRegion& region = regions.emplace_back();
    region.bodies = probe.bodies;
    region.reach.fill(HUGE_VAL);
    for (int d = 0; d < config.dim; ++d) region.centre[d] = probe.at[d] - config.mesh.lower[d];
    if (probe.kind == ProbeKind::point) region.reach.fill(k_reach * config.mesh.spacing);
    if (probe.kind == ProbeKind::particle)
      region.id =
          state.followed[n] >= 0 ? static_cast<int>(state.followed[n]) : std::numeric_limits<int>::max();
    if (probe.kind == ProbeKind::gauge) {
      region.box = true;
      for (int d = 0; d + 1 < config.dim; ++d) region.reach[d] = probe.width / 2;
    }
    if (probe.kind == ProbeKind::section) region.id = std::numeric_limits<int>::max();
  }
  return regions;
}

std::vector<SectionPlane> planes_of(const Config& config) {
  std::vector<SectionPlane> planes;
  for (const ProbeConfig& probe : config.probes)
    if (probe.kind == ProbeKind::section)
      planes.push_back({probe.axis, probe.at[probe.axis] - config.mesh.lower[probe.axis], probe.bodies});
  return planes;
}

std::vector<double> probe_values(const Config& config, const ProbeState& state,
                                 const std::vector<ProbeParticle>& particles,
                                 const std::vector<double>& pore_pressure,
                                 const std::vector<SectionSum>& sections) {
  std::vector<double> values;
  std::size_t first = 0, section = 0;
  for (std::size_t n = 0; n < config.probes.size(); ++n) {
    const ProbeConfig& probe = config.probes[n];
    std::size_t last = first;
    while (last < particles.size() && particles[last].region == static_cast<int>(n)) ++last;
    const Taken taken{std::span(particles).subspan(first, last - first),
                      std::span(pore_pressure).subspan(first, last - first)};
    first = last;
    switch (probe.kind) {
      case ProbeKind::point: add_point(values, config, probe, taken); break;
      case ProbeKind::particle:
        add_particle(values, config, probe, state.followed[n], std::span(state.start).subspan(3 * n, 3),
                     taken);
        break;
      case ProbeKind::gauge: add_gauge(values, config, probe, taken); break;
      case ProbeKind::section:
        add_section(values, config.dim, sections[section++], &state.section_zero[2 * n]);
        break;
    }
  }
  return values;
}

}  // namespace mpm
