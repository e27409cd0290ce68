// -probes and -output_rasters: what is measured at places of the mesh.

#include <algorithm>
#include <cmath>

#include "common/text.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr std::size_t k_most_sections = 64;
const Option k_raster_bodies{.name = "raster_bodies",
                             .meaning = "bodies that count for the rasters",
                             .standard = "all",
                             .names_of = "bodies"};

/// Indices of the bodies that an option names; empty where it is not given: all count.
void read_bodies(OptionReader& in, const Option& option, const Config& config, std::vector<int>& bodies) {
  std::vector<std::string> known, names;
  for (const BodyConfig& body : config.bodies) known.push_back(body.name);
  const std::string takes = in.listing() ? "names of -bodies" : "names of -bodies: " + join(known, ", ");
  if (!in.list_of(option, takes, names)) return;
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found != known.end())
      bodies.push_back(static_cast<int>(found - known.begin()));
    else if (!in.is_left_out(name))
      return in.reject(option.name, takes);
  }
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
}

/// -NAME_at of a probe, which has `count` coordinates from `first` on: within the mesh.
void read_place(OptionReader& in, const MeshConfig* mesh, int first, int count, ProbeConfig& probe) {
  const Option option{
      .name = probe.name + "_at",
      .meaning =
          "place: of a point or particle all coordinates; of a gauge those along the ground, x or x,y; of a "
          "section the one along its axis",
      .unit = "m",
      .range = k_coordinate,
      .required = true};
  if (in.listing()) {
    in.numbers(option, "x,y", "x,y,z", std::span(probe.at).first(2));
    return;
  }
  const bool given = count == 1 ? in.number(option, probe.at[first]) : in.vector(option, count, probe.at);
  if (!given || !mesh) return;
  for (int d = first; d < first + count; ++d)
    if (!(probe.at[d] >= mesh->lower[d] && probe.at[d] <= mesh->upper[d]))
      return in.reject(option.name, formatted("a place in the mesh, whose %c is from %g to %g", "xyz"[d],
                                              (*mesh).lower[d], (*mesh).upper[d]));
}

void read_axis(OptionReader& in, int dim, ProbeConfig& probe) {
  const std::vector<std::string> axes = dim == 2 && !in.listing() ? std::vector<std::string>{"x", "y"}
                                                                  : std::vector<std::string>{"x", "y", "z"};
  const auto only = in.where(probe.name + "_kind", {"section"});
  in.word({.name = probe.name + "_axis", .meaning = "section: axis that it is normal to", .required = true},
          axes, probe.axis);
}

void read_width(OptionReader& in, const MeshConfig* mesh, ProbeConfig& probe) {
  if (mesh) probe.width = mesh->spacing;
  const auto only = in.where(probe.name + "_kind", {"gauge"});
  in.number(
      {.name = probe.name + "_width",
       .meaning =
           "gauge: width of the strip (the square in 3D) over which it is a mean; 0: of the line itself",
       .unit = "m",
       .range = {.lowest = 0, .highest = 1e9},
       .standard = in.listing() || !mesh ? "mesh_spacing" : ""},
      probe.width);
}

/// Checks that a section leaves mesh on both sides.
void check_section(OptionReader& in, const MeshConfig& mesh, const ProbeConfig& probe) {
  const int d = probe.axis;
  if (probe.at[d] > mesh.lower[d] && probe.at[d] < mesh.upper[d]) return;
  in.reject(probe.name + "_at", formatted("a place between the sides of the mesh, whose %c is from %g to %g",
                                          "xyz"[d], mesh.lower[d], mesh.upper[d]));
}

/// The columns of the rasters are counted by int.
void check_columns(OptionReader& in, const MeshConfig& mesh, int dim, double spacing) {
  constexpr double k_most = 1 << 28;
  double columns = 1;
  for (int d = 0; d + 1 < dim; ++d) columns *= std::ceil((mesh.upper[d] - mesh.lower[d]) / spacing);
  if (columns > k_most)
    in.reject("raster_spacing",
              formatted("a length in m that gives at most %.0f columns; this gives %.4g", k_most, columns));
}

}  // namespace

void read_probe(OptionReader& in, const MeshConfig* mesh, const Config& config, ProbeConfig& probe) {
  in.section("Each probe NAME", {"probes"});
  const auto errors = in.errors();
  in.word({.name = probe.name + "_kind",
           .meaning = "point: velocity, stress and pressure at a place; particle: the same of the particle "
                      "that is nearest to it at the "
                      "start, and where it moves; gauge: depth and speed of the soil on a vertical line; "
                      "section: what passes a plane "
                      "normal to an axis",
           .required = true},
          Words<ProbeKind>{{"point", ProbeKind::point},
                           {"particle", ProbeKind::particle},
                           {"gauge", ProbeKind::gauge},
                           {"section", ProbeKind::section}},
          probe.kind);
  if (in.errors() != errors) return in.ignore(probe.name + "_");
  const bool section = probe.kind == ProbeKind::section, gauge = probe.kind == ProbeKind::gauge;
  if (section || in.listing()) read_axis(in, config.dim, probe);
  const int count = section ? 1 : gauge ? config.dim - 1 : config.dim;
  if (in.errors() == errors)
    read_place(in, mesh, section ? probe.axis : 0, count, probe);
  else
    in.ignore(probe.name + "_at");
  if (section && mesh && in.errors() == errors) check_section(in, *mesh, probe);
  if (gauge || in.listing()) read_width(in, mesh, probe);
  if (!section) in.not_taken(probe.name + "_axis", "-" + probe.name + "_kind is not section");
  if (!gauge) in.not_taken(probe.name + "_width", "-" + probe.name + "_kind is not gauge");
  read_bodies(in,
              {.name = probe.name + "_bodies",
               .meaning = "bodies that count for the probe",
               .standard = "all",
               .names_of = "bodies"},
              config, probe.bodies);
}

void check_probes(OptionReader& in, const Config& config) {
  const auto sections =
      std::count_if(config.probes.begin(), config.probes.end(),
                    [](const ProbeConfig& probe) { return probe.kind == ProbeKind::section; });
  if (sections > static_cast<long>(k_most_sections))
    in.reject("probes",
              formatted("at most %zu sections; these are %ld", k_most_sections, static_cast<long>(sections)));
}

void read_rasters(OptionReader& in, const MeshConfig* mesh, Config& config) {
  RasterConfig& rasters = config.rasters;
  in.section("Rasters of what passed");
  const bool listing = in.listing();
  in.word({.name = "output_rasters",
           .meaning = "on: at the end of the run rasters of the greatest depth and speed of the soil, of its "
                      "time of arrival and of the "
                      "depth at the end: ESRI ASCII grids in 3D, rasters.csv along x in 2D"},
          Words<bool>{{"on", true}, {"off", false}}, rasters.on);
  if (!rasters.on && !listing) {
    for (const char* key : {"spacing", "interval", "threshold_depth", "threshold_speed", "bodies", "origin"})
      in.not_taken(std::string("raster_") + key, "-output_rasters is off");
    return;
  }
  const auto only = in.where("output_rasters", {"on"});
  const double h = mesh ? mesh->spacing : 1;
  rasters.spacing = h, rasters.threshold_depth = h / 10;
  double interval = config.output.history_interval;
  in.number({.name = "raster_spacing",
             .meaning = "edge of a cell of the rasters, a quarter of mesh_spacing or more",
             .unit = "m",
             .range = {.lowest = listing ? 0 : h / 4, .highest = 1e9, .open_lowest = listing},
             .standard = listing ? "mesh_spacing" : ""},
            rasters.spacing);
  if (mesh) check_columns(in, *mesh, config.dim, rasters.spacing);
  in.number({.name = "raster_interval",
             .meaning = "time between updates of the rasters",
             .unit = "s",
             .range = k_positive,
             .standard = listing ? "history_interval" : "",
             .change = k_always},
            interval);
  if (rasters.on) config.output.raster_interval = interval;
  in.number(
      {.name = "raster_threshold_depth",
       .meaning = "depth above which soil has arrived; less does not count for the greatest speed either",
       .unit = "m",
       .range = k_positive,
       .standard = listing ? "a tenth of mesh_spacing" : ""},
      rasters.threshold_depth);
  in.number({.name = "raster_threshold_speed",
             .meaning = "speed that soil must exceed too for its arrival, as where it lies at rest at first",
             .unit = "m/s",
             .range = k_not_negative},
            rasters.threshold_speed);
  in.vector({.name = "raster_origin",
             .meaning = "what is added to the coordinates in the files, as the origin that scripts/terrain "
                        "took away; the last "
                        "component is not used",
             .unit = "m",
             .range = k_coordinate,
             .change = k_at_any_restart},
            config.dim, rasters.origin);
  if (listing) read_bodies(in, k_raster_bodies, config, rasters.bodies);
}

void read_raster_bodies(OptionReader& in, const Config& config, RasterConfig& rasters) {
  if (rasters.on && !in.listing()) read_bodies(in, k_raster_bodies, config, rasters.bodies);
}

}  // namespace mpm
