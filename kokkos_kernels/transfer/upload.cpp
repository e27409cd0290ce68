#include "transfer/upload.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/copy.hpp"
#include "data/contact_core.hpp"
#include "data/light_rigids.hpp"
#include "physics/domain.hpp"
#include "physics/rigid_motion.hpp"
#include "physics/surface.hpp"
#include "rebuild/list_pairs.hpp"
#include "rebuild/shift_particle.hpp"
#include "transfer/fill_view.hpp"
#include "transfer/host_tables.hpp"
#include "transfer/place_points.hpp"
#include "transfer/upload_soil.hpp"

namespace mpm {
namespace {

template <int Dim>
void set_turning(const RigidTurning& in, Rigid<Dim>& rigid) {
  RigidMotion<Dim>& motion = rigid.motion;
  motion.pose.turns = in.turns;
  if (!in.turns) return;
  Turning<Dim>& turning = rigid.inertia.turning;
  for (int d = 0; d < Dim; ++d) motion.pose.centre[d] = in.centre[d];
  for (int k = 0; k < k_turning_axes<Dim>; ++k) {
    motion.spin[k] = in.spin[k];
    rigid.force[Wrench<Dim>::moment + k] = in.moment[k];
    turning.principal[k] = in.principal[k];
  }
  if constexpr (Dim == 3) turning.axes = Rotation<3>::load(in.axes.data());
  turning.axis = in.axis;
  turning.reach = in.reach;
  if (rigid.inertia.dynamic && in.axis != Turning<Dim>::k_held)
    rigid.momentum = momentum_of(turning, motion.pose.rotation, motion.spin);
}

template <class Space, int Dim>
void upload_light_rigids(const std::vector<RigidInput>& rigids, LightRigids<Space, Dim>& to) {
  const auto is_light = [](const RigidInput& rigid) { return rigid.light; };
  to.in_use = std::any_of(rigids.begin(), rigids.end(), is_light);
  fill_view(to.motions, "mpm::light_motions", static_cast<int>(rigids.size()), [&](int r) {
    LightMotion<Dim> motion{};
    motion.light = rigids[r].light;
    return motion;
  });
  const int count = static_cast<int>(rigids.size());
  const int numbers = light_numbers<Dim>(count) + LightPast<Dim>::size * count;
  to.sums = decltype(to.sums)("mpm::light_sums", to.in_use ? numbers : 0);
}

/// Puts the parts of rigids on the device where the forces on them are wanted. surfaces: of the rigids; the
/// surfaces of their parts are in the tables.
template <class Space, int Dim>
void upload_parts(const std::vector<RigidInput>& rigids, const std::vector<Surface<Dim>>& surfaces,
                  double spacing, HostTables<Dim>& tables, PartForces<Space, Dim>& forces) {
  forces = {};
  if (std::none_of(rigids.begin(), rigids.end(), [](const RigidInput& of) { return of.part_forces; })) return;
  std::vector<int> rigid;
  std::vector<Surface<Dim>> parts;
  for (std::size_t r = 0; r < rigids.size(); ++r)
    for (std::size_t n = 0; n < rigids[r].parts.size(); ++n) {
      const SurfaceInput& part = rigids[r].parts[n];
      const bool sampled = part.kind == SurfaceKind::sampled;
      parts.push_back(sampled ? tables.parts[surfaces[r].first + n] : tables.add(part, spacing));
      rigid.push_back(static_cast<int>(r));
    }
  forces.count = static_cast<int>(parts.size());
  fill_view(forces.surfaces, "mpm::part_surfaces", forces.count, [&](int n) { return parts[n]; });
  fill_view(forces.rigid, "mpm::part_rigids", forces.count, [&](int n) { return rigid[n]; });
  forces.impulse = decltype(forces.impulse)("mpm::part_impulse", forces.count);
}

template <class Space, class T, int Dim>
void upload_rigids(ContactCore<Space, T, Dim>& s, const std::vector<RigidInput>& rigids, double cut,
                   Fault& fault) {
  const double spacing = s.spacing;
  s.rigid_points.resize(rigids.size());
  for (std::size_t r = 0; r < rigids.size(); ++r) {
    auto& points = s.rigid_points[r].points;
    points.count = static_cast<int>(rigids[r].position.size() / Dim);
    points.mass = static_cast<T>(rigids[r].density * rigids[r].particle_volume);
    points.half_length = static_cast<T>(rigids[r].half_length);
    points.surface_normal = rigids[r].surface_normal;
    const bool sound = fault.kind == FaultKind::none;
    if (s.grid.fields > 1 && !rigids[r].surface_normal)
      throw std::invalid_argument("normals from the mass gradient know one velocity field only");
    const auto first_field = [](int) { return 0; };
    place_points(s.grid, spacing, rigids[r].position, first_field, s.rigid_points[r], fault);
    if (sound && fault.kind != FaultKind::none) fault.particle = -1 - static_cast<int>(r);
    fill_view(points.reference_position, "mpm::reference_position", points.count, [&](int p) {
      Vector<double, Dim> x;
      for (int d = 0; d < Dim; ++d) x[d] = rigids[r].position[std::size_t(p) * Dim + d] / spacing;
      return x;
    });
  }
  HostTables<Dim> tables;
  std::vector<Surface<Dim>> surfaces;
  for (const RigidInput& rigid : rigids) surfaces.push_back(tables.add(rigid.surface, spacing));
  upload_parts(rigids, surfaces, spacing, tables, s.part_forces);
  tables.upload(s.vertices);
  share_samples(s.vertices, s.pairs.vertices);
  fill_view(s.rigids, "mpm::rigids", static_cast<int>(rigids.size()), [&](int r) {
    Rigid<Dim> rigid{};
    for (int d = 0; d < Dim; ++d) {
      rigid.motion.velocity[d] = rigids[r].velocity[d];
      rigid.force[Wrench<Dim>::force + d] = rigids[r].force[d];
      rigid.inertia.held[d] = rigids[r].held[d];
    }
    const double particle_mass = rigids[r].density * rigids[r].particle_volume;
    rigid.inertia.mass = rigids[r].revolved_volume > 0
                             ? rigids[r].density * rigids[r].revolved_volume
                             : particle_mass * static_cast<double>(rigids[r].position.size() / Dim);
    rigid.inertia.dynamic = rigids[r].dynamic;
    set_turning(rigids[r].turning, rigid);
    rigid.binned = rigid.motion.pose;
    rigid.law = {.at_sites = rigids[r].at_sites,
                 .separates = rigids[r].separates,
                 .permeable = rigids[r].permeable,
                 .reach = rigids[r].reach,
                 .exponent = rigids[r].exponent,
                 .shear_limit = rigids[r].shear_limit,
                 .shear_fraction = rigids[r].shear_fraction > 0 ? rigids[r].shear_fraction : -1,
                 .friction = rigids[r].friction};
    rigid.surface_normal = rigids[r].surface_normal;
    rigid.surface = surfaces[r];
    rigid.mass_cut = cut * particle_mass;
    return rigid;
  });
}

/// Chooses whether slots have lists of the bodies near them, and the spheres by which these are found.
template <class Space, class T, int Dim>
void begin_near_bodies(const std::vector<RigidInput>& rigids, double spacing, NearBodies<Space>& near) {
  const auto by_surface = [](const RigidInput& rigid) { return rigid.surface_normal; };
  near = {};
  near.width = static_cast<int>(rigids.size());
  const auto without_parts = [](const RigidInput& rigid) { return !rigid.part_forces; };
  near.listed = near.width > k_few_bodies && std::all_of(rigids.begin(), rigids.end(), by_surface) &&
                std::all_of(rigids.begin(), rigids.end(), without_parts);
  if (!near.listed) return;
  near.spheres = decltype(near.spheres)("mpm::spheres", rigids.size(), Dim + 1);
  const auto spheres = Kokkos::create_mirror_view(near.spheres);
  for (std::size_t r = 0; r < rigids.size(); ++r) {
    const std::vector<double>& x = rigids[r].position;
    double squares = 0;
    for (int d = 0; d < Dim; ++d) {
      double low = x[d], high = x[d];
      for (std::size_t n = d; n < x.size(); n += Dim) low = std::min(low, x[n]), high = std::max(high, x[n]);
      const double half = (high - low) / 2 + spacing;  // the surface may be beyond the middles of particles
      spheres(r, d) = (low + high) / 2;
      squares += half * half;
    }
    spheres(r, Dim) = std::sqrt(squares);
  }
  copy(near.spheres, spheres);
}

/// Bytes of scratch memory that sorting the rigid with the most points takes.
template <class Space, class T, int Dim>
std::size_t scratch_of_rigids(const std::vector<RigidInput>& rigids) {
  RigidPoints<Space, T, Dim> points;
  std::size_t most = 0;
  for (const RigidInput& rigid : rigids) most = std::max(most, rigid.position.size() / Dim);
  return most * scratch_of_point(points);
}

}  // namespace

template <int Dim>
Surface<Dim> surface_of(const SurfaceInput& in, double spacing) {
  Surface<Dim> out{};
  out.kind = in.kind;
  for (int d = 0; d < Dim; ++d)
    out.centre[d] = in.centre[d], out.half[d] = in.half[d], out.normal[d] = in.normal[d];
  out.radius = in.radius;
  out.cosine = std::cos(in.angle), out.sine = std::sin(in.angle);
  out.count = static_cast<int>(in.vertices.size());
  out.columns = in.columns;
  out.round_off = k_on_edge * spacing;
  return out;
}

template Surface<2> surface_of(const SurfaceInput&, double);
template Surface<3> surface_of(const SurfaceInput&, double);

template <class Space, class T, int Dim>
Fault upload(ContactCore<Space, T, Dim>& s, const GridInput& grid,
             const std::vector<MaterialInput>& materials, const std::vector<BodyInput>& bodies,
             const std::vector<RigidInput>& rigids) {
  // Shares of a particle's mass. A node's weight falls with the square of its gradient, so a node that is
  // left out with 1e-14 would have felt a ten-millionth of a particle's force, and with 1e-12 a millionth; a
  // rigid holds a node that it reaches by a thousandth of a cell.
  constexpr double k_cut = sizeof(T) == sizeof(double) ? 1e-14 : 1e-12, k_rigid_cut = 1e-6;
  s.grid.spacing = static_cast<T>(grid.spacing);
  s.grid.inv_spacing = static_cast<T>(1 / grid.spacing);
  for (int d = 0; d < Dim; ++d) {
    s.grid.cells[d] = grid.cells[d];
    s.grid.patches[d] = grid.patches[d];
    const bool periodic = grid.walls[d][0] == Wall::periodic;
    s.grid.period[d] = periodic ? grid.cells[d] : 0;
    for (int side = 0; side < 2; ++side) s.grid.wall[d][side] = periodic ? Wall::free : grid.walls[d][side];
  }
  s.soil.points.has_periods = s.grid.is_periodic();
  s.spacing = grid.spacing;
  Fault fault{};
  s.scheme.mass_cut = std::numeric_limits<double>::max();
  for (const BodyInput& body : bodies)
    s.scheme.mass_cut =
        std::min(s.scheme.mass_cut, k_cut * (body.least_mass > 0 ? body.least_mass : common_mass(body)));
  double heaviest = 0;
  for (const BodyInput& body : bodies) heaviest = std::max(heaviest, body.density);
  s.at_sites.mass = heaviest * std::pow(grid.spacing, Dim);
  if (s.soil.points.rings) s.at_sites.mass *= grid.cells[0] * grid.spacing;
  double smallest = std::numeric_limits<double>::max(), largest = 0;
  for (const BodyInput& body : bodies) {
    smallest = std::min(smallest, body.most_volume > 0 ? body.least_volume : body.particle_volume);
    largest = std::max(largest, body.most_volume > 0 ? body.most_volume : body.particle_volume);
  }
  double least_half_length = k_least_half_length;
  for (const BodyInput& body : bodies) least_half_length = std::min(least_half_length, body.half_length);
  s.soil.points.least_half_length = static_cast<T>(least_half_length);
  if (s.soil.points.splits) smallest *= k_least_piece, s.scheme.mass_cut *= k_least_piece;
  s.strays.least_volume = k_least_volume * smallest, s.strays.most_volume = k_most_volume * largest;
  const bool alike = smallest == largest && !s.soil.points.splits;
  fill_view(s.strays.start_volume, "mpm::start_volume", alike ? 0 : static_cast<int>(bodies.size()),
            [&](int b) { return bodies[b].weighed ? 1 / bodies[b].density : 0; });
  s.strays.lost.assign(bodies.size(), {});
  s.strays.put_back = decltype(s.strays.put_back)("mpm::put_back", bodies.size());
  s.rigid_moves = s.rigid_turns = s.rigid_dynamic = s.mass_normals = s.soil_boundary = s.shear_fraction =
      s.has_friction = s.at_sites.in_use = false;
  for (const RigidInput& rigid : rigids) {
    s.rigid_turns = s.rigid_turns || rigid.turning.turns;
    s.rigid_moves = s.rigid_moves || rigid.dynamic || rigid.timed || rigid.turning.turns ||
                    rigid.velocity != std::array<double, 3>{};
    s.rigid_dynamic = s.rigid_dynamic || rigid.dynamic;
    s.at_sites.in_use = s.at_sites.in_use || rigid.at_sites;
    s.has_friction = s.has_friction || (rigid.friction > 0 && !rigid.at_sites);
    s.mass_normals = s.mass_normals || !rigid.surface_normal;
    s.shear_fraction = s.shear_fraction || rigid.shear_fraction > 0;
    if (rigid.at_sites) {
      const bool limited = rigid.shear_limit > 0 && std::isfinite(rigid.shear_limit);
      s.soil_boundary = s.soil_boundary || limited || rigid.shear_fraction > 0;
      continue;
    }
    s.soil_boundary = s.soil_boundary || rigid.surface_normal || rigid.shear_limit > 0 || rigid.reach > 0;
    s.soil_boundary = s.soil_boundary || rigid.shear_fraction > 0;
  }
  s.control = ControlView<Space>("mpm::control");
  s.never_paused = ControlView<Space>("mpm::never_paused");
  s.launch.barrier = decltype(s.launch.barrier)("mpm::launch_barrier");
  s.movements.bits = decltype(s.movements.bits)("mpm::movements");
  s.launch.movements.bits = decltype(s.launch.movements.bits)("mpm::launch_movements");
  upload_soil(s, materials, bodies, scratch_of_rigids<Space, T, Dim>(rigids), fault);
  upload_rigids(s, rigids, k_rigid_cut, fault);
  const std::size_t wrenches = rigids.size() + s.part_forces.count;
  s.rigid_force = decltype(s.rigid_force)("mpm::rigid_force", Wrench<Dim>::size * wrenches);
  upload_light_rigids(rigids, s.light_rigids);
  begin_near_bodies<Space, T, Dim>(rigids, grid.spacing, s.contact.near);
  if (fault.kind == FaultKind::none) find_parts(s);
  return fault;
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                    \
  template Fault upload(ContactCore<Space, T, Dim>&, const GridInput&, const std::vector<MaterialInput>&, \
                        const std::vector<BodyInput>&, const std::vector<RigidInput>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
