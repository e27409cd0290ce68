#include "input/options/revolution_options.hpp"

#include <cmath>

#include "common/text.hpp"
#include "common/time_table.hpp"

namespace mpm {

void read_geometry_of(OptionReader& in, Config& config) {
  if (config.dim == 3 && !in.listing()) return in.not_taken("geometry", "-dim is 3");
  const auto only = in.where("dim", {"2"});
  in.word({.name = "geometry",
           .meaning = "of what the 2D mesh is a section: plane_strain: of a body without end along z; "
                      "axisymmetric: of a body of revolution, x its radius and y its axis. Forces, masses, "
                      "momenta and energies are then those of the whole revolution"},
          Words<Geometry>{{"plane_strain", Geometry::plane_strain}, {"axisymmetric", Geometry::axisymmetric}},
          config.geometry);
}

void check_revolution(OptionReader& in, const Config& config) {
  if (config.geometry != Geometry::axisymmetric || in.listing()) return;
  const std::string where = " with -geometry axisymmetric";
  if (config.mesh.lower[0] != 0)
    in.reject("mesh_lower", "0 as its first number" + where + ": x is the radius, and the axis is at x = 0");
  if (config.mesh.walls[0][0] != Wall::roller)
    in.reject("mesh_xmin", "roller" + where + ": that side is the axis");
  for (int n = 0; n < 4; ++n) {
    const SideConfig& side = config.mesh.sides[n / 2][n % 2];
    const std::string name = side_option(n / 2, n % 2);
    if (side.moves)
      in.reject(name + motion_of(side), "0" + where);
    else if (const Wall wall = config.mesh.walls[n / 2][n % 2];
             is_acting(wall) && wall != Wall::absorbing && wall != Wall::friction)
      in.reject(name, "roller, smooth, fixed, free, friction or absorbing" + where);
    if (std::isfinite(side.numbers.shear_limit)) in.reject(name + "_shear_limit", "nothing" + where);
  }
  if (config.gravity[0] != 0)
    in.reject(config.gravity_table ? "gravity_table" : "gravity",
              "0 along x" + where + ": gravity acts along the axis");
  for (const RigidConfig& rigid : config.rigids) {
    if (rigid.motion != Motion::dynamic) continue;
    const std::string takes = "0 along x" + where + ": forces move a body of revolution along the axis alone";
    if (rigid.velocity[0] != 0) in.reject(rigid.name + "_velocity", takes);
    if (rigid.force[0] != 0) in.reject(rigid.name + "_force", takes);
  }
  for (const MaterialConfig& material : config.materials)
    if (material.model == "umat")
      in.reject(material.name + "_model",
                "a law other than umat" + where + ": no hoop gradient is passed to it");
  if (config.particle_domain != ParticleDomain::fixed) in.reject("particle_domain", "fixed" + where);
  if (config.position_correction) in.reject("position_correction", "none" + where);
}

}  // namespace mpm
