#include "check/memory_need.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <type_traits>

#include "common/f_bar.hpp"
#include "common/host_memory.hpp"
#include "common/material_table.hpp"
#include "common/text.hpp"
#include "data/footprint.hpp"
#include "input/files/particle_file.hpp"
#include "input/geometry/shapes.hpp"
#include "mesh/background.hpp"
#include "output/rasters.hpp"
#include "step/sample_surface.hpp"
#include "step/stepper.hpp"

namespace mpm {
namespace {

constexpr double k_made = 125, k_framed = 550;  // bytes of the host for a particle of the soil: its place,
                                                // strength and order while it is brought to the device; of
                                                // a frame its fields, put together, and the file in memory
constexpr double k_mesh = 24;                   // for a patch, while PETSc's DMDA is made
constexpr double k_rigid_framed = 150;          // for a rigid's particle in a frame

/// The vectors of the soil that a run uses, without their memory.
template <class Space, class T, int Dim>
Soil<Space, T, Dim> soil_of(const Config& config) {
  Soil<Space, T, Dim> soil;
  bool undrained = false, own_mass = config.geometry == Geometry::axisymmetric;
  for (const BodyConfig& body : config.bodies) {
    const MaterialConfig& material = config.materials[body.material];
    soil.history.columns = std::max(soil.history.columns, static_cast<int>(state_variables(material).size()));
    undrained = undrained || material.has_pore_pressure();
    soil.has_flow = soil.has_flow || material.saturated();
    own_mass = own_mass || body.shape.kind == ShapeKind::particles || body.shape.fill == Fill::cut;
  }
  soil.history.columns += undrained;  // the excess pore pressure
  soil.has_affine = config.velocity_update == VelocityUpdate::apic;
  soil.has_domain = config.particle_domain != ParticleDomain::fixed;
  soil.splits = config.particle_domain == ParticleDomain::split;
  soil.has_own_mass = own_mass || soil.splits || soil.has_flow;
  soil.has_periods = is_periodic(config.mesh);
  soil.face_count = config.loads.empty() ? 0 : 1;
  return soil;
}

/// The nodal fields that a run uses.
NodeUses uses_of_nodes(const Config& config) {
  const auto by_strength = [](const auto& of) { return of.shear_fraction.has_value(); };
  const bool pairs = !config.contact_pairs.empty();
  return {.boundary = pairs || !config.rigids.empty(),
          .strength = std::any_of(config.rigids.begin(), config.rigids.end(), by_strength),
          .water = config.water.level.has_value(),
          .loads = !config.loads.empty(),
          .residual = config.velocity_update == VelocityUpdate::xpic,
          .correction = bool(config.position_correction),
          .domains = config.particle_domain != ParticleDomain::fixed,
          .cloud = pairs,
          .flow = water_flows(config)};
}

/// Whether F-bar may need sums over cells beside those of bins (CellMeans).
template <class Space, int Dim>
bool may_have_cell_means(const Config& config) {
  return is_device<Space> && Dim == 3 && config.particle_domain == ParticleDomain::fixed &&
         f_bar_range(config).largest > 0;
}

/// Bytes that a particle of the soil takes, with what sorts it and what some runs keep of it in a step.
template <class Space, class T, int Dim>
double bytes_of_particle(const Config& config) {
  const auto soil = soil_of<Space, T, Dim>(config);
  double bytes = bytes_of_point(soil) + bytes_to_sort(soil);
  if (!config.loads.empty()) bytes += k_grown * 3 * sizeof(Vector<T, Dim>);  // SurfaceLoads
  if (config.output.energy) bytes += k_grown * (2 * sizeof(SymTensor<T, Dim>) + sizeof(T));
  if (config.velocity_update == VelocityUpdate::xpic) bytes += k_grown * sizeof(Vector<T, Dim>);
  if (may_have_cell_means<Space, Dim>(config)) bytes += k_grown * sizeof(CellPlace);
  if (config.p2g.strategy == P2G::gather) {
    // a particle is in the lists of the nodes that it may reach before the margin is used up
    const double reach = 2 * (1.25 + config.p2g.margin);
    bytes += sizeof(int) * std::pow(reach, Dim);
  }
  return bytes;
}

/// Bytes of all that fills so many cells with soil: the soil's own, which -device_memory_limit keeps on the
/// host, and the nodes', the rigids' and the patches'.
template <class Space, class T, int Dim>
void add_bytes(const Config& config, double cells, MemoryNeed& need) {
  constexpr double k_ring = 1.1;  // the patches round the soil
  const double soil = need.particles * bytes_of_particle<Space, T, Dim>(config);
  need.nodes = k_ring * cells * bytes_of_node(Nodes<Space, T, Dim>{}, uses_of_nodes(config));
  if (may_have_cell_means<Space, Dim>(config))
    need.nodes += k_ring * cells * k_grown *
                  (2 * sizeof(T) + sizeof(int) * double(CellWindow::cells + 1) / Patch<3>::cells);
  if (config.backend == Backend::openmp && chosen(config.p2g.strategy) == P2G::tile)
    need.nodes += cells * k_window_bytes<T, Dim> *
                  (1 + (water_flows(config) ? double(FlowTerms<Dim>::size) / SoilTerms<Dim>::size : 0));
  const RigidPoints<Space, T, Dim> point;
  need.all_ranks = need.rigids * (bytes_of_point(point) + bytes_to_sort(point)) +
                   need.patches * k_patch_bytes + need.samples;
  need.device = soil + need.nodes;
  const double place = sizeof(Vector<T, Dim>) + 2 * (sizeof(Vector<double, Dim>) + sizeof(long));
  need.host += 2 * need.samples + need.rigids * (place + (config.output.frames ? k_rigid_framed : 0)) +
               need.patches * k_mesh;
  if (!config.device_memory_limit) return;
  need.device = std::min(need.device, *config.device_memory_limit * k_gib);
  need.host += soil;
}
template <class T, int Dim>
void add_bytes(const Config& config, double cells, MemoryNeed& need) {
#define MPM_ADD(Space, Real, Dims)                      \
  if constexpr (std::is_same_v<Real, T> && Dims == Dim) \
    if (runs_on<Space>(config.backend)) add_bytes<Space, Real, Dims>(config, cells, need);
  MPM_FOR_EACH(MPM_ADD)
#undef MPM_ADD
}

/// Cells that a shape fills.
double cells_in(const Shape& shape, const Config& config) {
  return shape_volume(shape, config.mesh, config.dim) / std::pow(config.mesh.spacing, config.dim);
}

/// Counts the particles of bodies and rigids, and the cells that soil fills.
double count_particles(const Config& config, MemoryNeed& need) {
  double cells = 0;
  for (const BodyConfig& body : config.bodies) {
    if (body.absent) continue;
    const double in_cell = std::pow(body.shape.particles_per_cell, config.dim);
    const bool listed = body.shape.kind == ShapeKind::particles;
    const double count = listed ? double(listed_particles(body.shape.file, body.shape.file_body))
                                : cells_in(body.shape, config) * in_cell;
    constexpr double k_numbers = 40;  // of a particle as it is read and as it is kept
    if (listed) need.host += k_numbers * sizeof(double) * count;
    need.host += fill_bytes(body.shape, config.mesh, config.dim);
    cells += count / in_cell;
    need.particles += count;
  }
  for (const RigidConfig& rigid : config.rigids) {
    if (rigid.absent) continue;
    need.samples += sample_bytes(rigid.shape, config.mesh);
    need.rigids += cells_in(rigid.shape, config) * std::pow(rigid.shape.particles_per_cell, config.dim);
  }
  return cells;
}

}  // namespace

MemoryNeed memory_need(const Config& config) {
  MemoryNeed need;
  const double cells = count_particles(config, need);
  need.patches = patch_count(config.mesh, config.dim);
  need.host += need.particles * (config.output.frames ? k_framed : k_made);
  const bool single = config.precision == Precision::single;
  if (config.dim == 2)
    single ? add_bytes<float, 2>(config, cells, need) : add_bytes<double, 2>(config, cells, need);
  else
    single ? add_bytes<float, 3>(config, cells, need) : add_bytes<double, 3>(config, cells, need);
  const RasterBytes rasters = raster_bytes(config);
  need.all_ranks += rasters.device, need.all_ranks_host = rasters.host;
  need.device += need.all_ranks, need.host += rasters.host;
  return need;
}

double free_memory(Backend backend) {
#ifdef KOKKOS_ENABLE_CUDA
  std::size_t free = 0, total = 0;
  if (backend == Backend::cuda) return cudaMemGetInfo(&free, &total) == cudaSuccess ? double(free) : 0;
#endif
  (void)backend;
  return free_host_memory();
}

/// The part of the whole need that falls to one rank, or to the ranks of one node that share its memory.
MemoryNeed need_here(const Config& config, MPI_Comm comm, bool shared) {
  MemoryNeed need = memory_need(config);
  int ranks = 1, here = 1;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) return need;
  MPI_Comm node = MPI_COMM_NULL;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &node);
  MPI_Comm_size(node, &here);
  MPI_Comm_free(&node);
  constexpr double k_table = 13;  // bytes that a rank has for every patch of the mesh, wherever it is
  const double at_once = shared ? here : 1;
  need.device = (need.device - need.all_ranks) * at_once / ranks + at_once * need.all_ranks;
  // Every rank makes the whole lattice before it keeps its own; rank 0 puts the frames together.
  need.host += (here - 1) * need.all_ranks_host;
  need.host += here * (need.particles * config.dim * sizeof(double) + k_table * need.patches);
  need.host += (here - 1) * need.rigids * (config.dim + 1) * sizeof(double);
  return need;
}

/// Fault of -device_memory_limit, as a line for the user; empty if there is none.
static std::string limit_fault(const Config& config, MPI_Comm comm) {
  if (!config.device_memory_limit) return {};
  constexpr double k_sure = 0.8;  // of an estimate; a closer figure follows once the particles are there
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  const double least = k_sure * memory_need(config).nodes / k_gib, free = free_memory(config.backend) / k_gib;
  std::string takes;
  if (ranks > 1)
    takes = "no limit on several ranks: each holds its part of the particles";
  else if (*config.device_memory_limit < least)
    takes = formatted("at least %.4g GiB, for the nodes alone", least);
  else if (config.backend == Backend::cuda && free > 0 && *config.device_memory_limit > free)
    takes = formatted("at most the %.4g GiB that are free", free);
  if (takes.empty()) return {};
  return formatted("mpm: -device_memory_limit: given \"%g\", takes %s", *config.device_memory_limit,
                   takes.c_str());
}

std::string memory_fault(const Config& config, MPI_Comm comm) {
  if (const std::string fault = limit_fault(config, comm); !fault.empty()) return fault;
  constexpr double k_most_particles = 2147483647;  // they are numbered by int
  const bool shared = config.backend != Backend::cuda;
  const MemoryNeed need = need_here(config, comm, shared);
  const double device = free_memory(config.backend), host = free_host_memory();
  const double on_device = need.device + (shared ? need.host : 0);
  std::string why;
  if (std::max(need.particles, need.rigids) > k_most_particles)
    why = formatted("%.0f is the most", k_most_particles);
  else if (device > 0 && on_device > device)
    why =
        formatted("%s they need about %.4g GB, and %.4g GB are free%s",
                  shared ? "in main memory" : ("on " + device_name(config.backend)).c_str(), on_device / 1e9,
                  device / 1e9, shared ? "" : "; with -device_memory_limit they go there in batches");
  else if (!shared && host > 0 && need.host > host)
    why = formatted("the host needs about %.4g GB for them, and %.4g GB are free%s", need.host / 1e9,
                    host / 1e9, config.output.frames ? " (less is needed with -output_frames off)" : "");
  if (why.empty()) return {};
  std::string what = formatted("these are %.4g", need.particles);
  if (need.rigids > need.particles) what += formatted(", and %.4g of rigids", need.rigids);
  if (need.patches > need.particles) what += formatted(", in a mesh of %.4g patches", need.patches);
  return formatted("mpm: -mesh_spacing: given \"%g\", takes an edge whose particles fit into memory; %s: %s",
                   config.mesh.spacing, what.c_str(), why.c_str());
}

}  // namespace mpm
