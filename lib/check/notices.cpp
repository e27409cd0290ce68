#include "check/notices.hpp"

#include <algorithm>
#include <cmath>

#include "common/rigid_contact.hpp"
#include "common/text.hpp"

namespace mpm {

std::vector<std::string> Notices::report(const HistoryRow& row, const Config& config,
                                         const std::vector<double>& rigid_zero) {
  std::vector<std::string> lines;
  const auto report = [&](bool happened, const std::string& body, const char* what, const std::string& line) {
    if (happened && logged_.insert(body + what).second)
      lines.push_back(formatted("step %ld, time %.6g s: ", row.step, row.time) + "body " + body + ": " +
                      line);
  };
  const int up = config.dim - 1;  // the vertical axis
  const std::string lid = std::string("-mesh_") + "xyz"[up] + "max";
  for (std::size_t b = 0; b < row.bodies.size(); ++b) {
    const BodyRow& body = row.bodies[b];
    const std::string& name = config.bodies[b].name;
    report(body.put_back > 0, name, " put back",
           formatted("%ld particles had passed a wall and were put back on it, at rest against it (column "
                     "%s_put_back counts them); a smaller -time_courant keeps them from it",
                     body.put_back, name.c_str()));
    report(body.strays > 0, name, " alone",
           formatted(
               "%ld particles are alone, with hardly any other soil in reach: they carry no stress and fly "
               "freely until they land (column %s_strays; -stray_particles remove or stop does otherwise)",
               body.strays, name.c_str()));
    report(body.limited > 0, name, " limited",
           formatted(
               "the volume of %ld particles has come to a bound, a fifth or twice that at the start, and "
               "is kept there (column %s_limited): their density is no longer that of the soil; soil that "
               "comes apart needs a law with a limit of tension (docs/soils.md, Soil that parts), soil that "
               "is pressed together a stiffer one",
               body.limited, name.c_str()));
    const long ids = body.particles + body.lost_count + body.merged;
    const long more = ids - particles_.emplace(name, ids).first->second;
    report(config.particle_domain == ParticleDomain::split && more > 0, name, " split",
           formatted("%ld particles whose soil was stretched have been split (column %s_particles)", more,
                     name.c_str()));
    report(
        body.merged > 0, name, " merged",
        formatted(
            "%ld particles that crowded have been taken up by others (columns %s_merged, %s_merged_energy)",
            body.merged, name.c_str(), name.c_str()));
    report(config.particle_domain == ParticleDomain::stretch && 20 * body.stretched > body.particles, name,
           " stretched",
           formatted(
               "the domains of %ld of %ld particles have come to half a cell and stretch no further (column "
               "%s_stretched): gaps may open between them; -particle_domain split keeps them closed",
               body.stretched, body.particles, name.c_str()));
    report(body.lost_count > 0, name, " left",
           formatted("%ld particles of %.6g kg have left the run (columns %s_lost_mass, %s_lost_momentum, "
                     "%s_lost_energy)",
                     body.lost_count, body.lost_mass, name.c_str(), name.c_str(), name.c_str()));
    const double top = config.mesh.upper[up] - config.mesh.spacing / 2;
    const Wall above = config.mesh.walls[up][1];  // soil may go on beyond one with dashpots
    report(body.mass > 0 && !is_open(above) && !has_dashpots(above) && body.upper[up] > top && row.step > 0,
           name, " lid",
           "soil has come to the top of the mesh, which stops it: a higher mesh, or " + lid +
               " free, lets it go on");
  }
  report_rigids(row, config, rigid_zero, &lines);
  report_soil(row, config, &lines);
  return lines;
}

/// Rigid bodies of which a dynamic one has come into another: its way is unknown at the start.
void Notices::report_rigids(const HistoryRow& row, const Config& config,
                            const std::vector<double>& rigid_zero, std::vector<std::string>* lines) {
  const int count = static_cast<int>(row.rigids.size());
  if (count < 2) return;
  const bool first = !places_;
  if (first) places_ = std::make_unique<RigidPlaces>(config), parts_.clear();
  const auto moved_by = [&](int rigid) {
    Vec3 by = row.rigids[rigid].displacement;
    for (std::size_t d = 0; d < 3 && !rigid_zero.empty(); ++d) by[d] += rigid_zero[3 * rigid + d];
    return by;
  };
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) {
      const RigidConfig &one = config.rigids[a], &other = config.rigids[b];
      if (one.absent || other.absent || parts_.contains({a, b})) continue;
      if (one.motion != Motion::dynamic && other.motion != Motion::dynamic) continue;
      if (have_contact(config, one, other)) continue;
      if (!places_->share_space(a, b, moved_by(a), moved_by(b))) continue;
      parts_.emplace(a, b);
      if (!first)
        lines->push_back(
            formatted("step %ld, time %.6g s: rigid %s is in rigid %s: these two do not touch each other",
                      row.step, row.time, one.name.c_str(), other.name.c_str()));
    }
}

/// Notices about the soil as a whole that lower the trust in the run.
void Notices::report_soil(const HistoryRow& row, const Config& config, std::vector<std::string>* lines) {
  const auto report = [&](bool happened, const char* what, const std::string& line) {
    if (happened && logged_.insert(what).second)
      lines->push_back(formatted("step %ld, time %.6g s: ", row.step, row.time) + line);
  };
  constexpr double k_gaps = 0.01;  // of the cells that hold soil
  const bool may_split =
      config.particle_domain != ParticleDomain::split && config.geometry == Geometry::plane_strain;
  report(row.empty_cells > k_gaps * row.filled_cells, " gaps",
         formatted("%ld cells inside the soil hold no particle, and %ld hold some (column empty_cells): the "
                   "soil comes apart; ",
                   row.empty_cells, row.filled_cells) +
             (may_split ? "-analysis flow keeps together soil that flows or is stretched (docs/flow.md)"
                        : "docs/flow.md has the options that keep it together"));
  if (!config.output.energy) return;
  const EnergyRow& e = row.energy;
  for (const double energy : {e.kinetic, e.internal, e.gravity, e.rigids})
    passed_ = std::max(passed_, std::fabs(energy));
  constexpr double k_error = 0.05, k_update = 0.2;  // of the largest energy or work so far
  constexpr long k_begun = 100;                     // steps, before which these are the work of few steps
  if (row.step < k_begun) return;
  report(std::fabs(e.error) > k_error * passed_, " error",
         formatted("%.3g of %.3g J are missing in the energy balance (column energy_error): do not trust the "
                   "run; a smaller -time_courant or smaller cells may cure it",
                   std::fabs(e.error), passed_));
  report(-e.update > k_update * passed_, " update",
         formatted("the velocity update has taken %.3g of %.3g J (column work_update), as a damping of the "
                   "mesh: smaller cells take less; -velocity_update flip takes least and keeps noise",
                   -e.update, passed_));
}

}  // namespace mpm
