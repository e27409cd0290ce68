// Bodies whose particles come from a file: of the user's, or of another run.

#include <algorithm>
#include <numeric>

#include "common/revolution.hpp"
#include "common/text.hpp"
#include "input/files/particle_file.hpp"
#include "input/geometry/shapes.hpp"
#include "input/options/groups.hpp"
#include "run/load_model.hpp"

namespace mpm {
namespace {

bool all_equal(const std::vector<double>& x) {
  return std::all_of(x.begin(), x.end(), [&](double value) { return value == x.front(); });
}

/// Masses and volumes: one figure for all particles where they are the same.
void take_masses(bool from_run, const Config& config, double density, BodyParticles& particles) {
  auto &volume = particles.volume, &mass = particles.mass;
  particles.particle_volume = volume.front();
  const bool has_mass = !mass.empty();
  if (!has_mass)
    for (const double v : volume) mass.push_back(density * v);
  if (has_mass) particles.particle_mass = mass.front();
  // Volumes in a file of the user's own may be anything; those that a run left have changed since creation.
  for (std::size_t p = 0; p < volume.size(); ++p)
    for (double v : {mass[p] / density, from_run ? mass[p] / density : volume[p]}) {
      v /= revolved_length(config, particles.position[p * config.dim]);
      particles.least_volume = particles.most_volume > 0 ? std::min(particles.least_volume, v) : v;
      particles.most_volume = std::max(particles.most_volume, v);
    }
  if (all_equal(volume)) volume.clear();
  if (all_equal(mass))
    mass.clear();
  else
    particles.least_mass = *std::min_element(mass.begin(), mass.end());
}

/// Text for the log on values that the file gives in the place of the material, and on values that it lacks.
std::string missing(const ParticleTable& table, const BodyConfig& body) {
  std::string text;
  const auto add = [&](const std::string& line) { text += "\n  " + line; };
  for (const auto& [key, own] : table.own_parameters)
    add(formatted("each with its own %s: %.6g to %.6g", key.c_str(),
                  *std::min_element(own.begin(), own.end()), *std::max_element(own.begin(), own.end())));
  if (table.mass.empty()) add("without masses: they are the material's density times the volumes");
  if (table.reference_height.empty() && table.own_parameters.empty())
    add("without reference heights: strengths that grow with depth are those of where the particles are now");
  if (table.put_inside > 0)
    add(formatted("%ld that were less than half a cell outside the mesh are put to its side",
                  table.put_inside));
  if (body.velocity_given) add("their velocity is that of -" + body.name + "_velocity");
  if (body.stress_given) add("their stress is that of -" + body.name + "_stress");
  return text;
}

double sum(const std::vector<double>& x) { return std::accumulate(x.begin(), x.end(), 0.0); }

}  // namespace

PetscErrorCode load_file(Job& job, const BodyConfig& body, BodyParticles* particles, bool* from_run) {
  PetscFunctionBeginUser;
  const Config& config = job.config;
  ParticleTable table;
  std::string fault;
  const ParticleSource source = source_of(body, config);
  PetscCallCXX(fault = read_particles(source, config.mesh, config.dim, table));
  PetscCheck(fault.empty(), job.comm, PETSC_ERR_FILE_READ, "%s has changed: it should be %s",
             body.shape.file.c_str(), fault.c_str());
  const long cut = cut_particles(cut_out_of(config, body), config.mesh, config.dim, table);
  if (cut > 0 && !body.from_before)
    PetscCall(job.log.print("body %s: %ld particles of the file were cut out", body.name.c_str(), cut));
  const double density = density_of(config, body);
  const double volume = sum(table.volume), mass = mean_density(table, density) * volume;
  const std::string origin =
      table.origin.empty() ? "" : " (body " + body.shape.file_body + ", " + table.origin + ")";
  if (!body.from_before)
    PetscCall(job.log.line(
        formatted("body %s: %ld particles of %s%s stand for %.6g %s, %.9g kg", body.name.c_str(),
                  static_cast<long>(table.volume.size()), body.shape.file.c_str(), origin.c_str(), volume,
                  config.dim == 2 && config.geometry == Geometry::plane_strain ? "m2" : "m3", mass) +
        missing(table, body)));
  const bool left_by_run = !table.origin.empty();
  *from_run = *from_run || left_by_run;
  particles->spacing = config.mesh.spacing / body.shape.particles_per_cell;
  if (config.velocity_update != VelocityUpdate::apic) table.velocity_gradient.clear();
  if (config.particle_domain == ParticleDomain::fixed) table.domain.clear();
  PetscCallCXX(static_cast<ParticleColumns&>(*particles) = std::move(table));
  PetscCallCXX(take_masses(left_by_run, config, density, *particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
