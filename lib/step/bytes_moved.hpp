#pragma once
// The least that each function of a step must move to and from memory: every value of a particle or node that
// it needs is read once, and every one that it changes is written once. What it reads again because a cache
// has lost it, lists, windows and passes over unchanged data are not counted. So a function's share of the
// copy bandwidth says how near it is to the limit of memory.

#include "data/footprint.hpp"
#include "data/state.hpp"
#include "functions/step_kernels.hpp"
#include "step/timers.hpp"

namespace mpm {

/// Function 3: place, body, velocity, stress, volume, domain and APIC's matrix of each particle; the sums of
/// each node.
template <class Space, class T, int Dim>
double bytes_to_nodes(const State<Space, T, Dim>& s) {
  const auto& p = s.soil.points;
  double particle = sizeof(*p.coordinate.data()) + sizeof(*p.cell.data()) + sizeof(*p.body.data());
  particle += sizeof(*p.velocity.data()) + sizeof(*p.stress.data()) + sizeof(*p.volume.data());
  if (p.has_affine) particle += sizeof(*p.affine.data());
  if (p.has_own_mass) particle += sizeof(*p.mass.data());
  if (p.has_domain) particle += sizeof(*p.half_length.data());
  return p.count * particle + s.patches.node_count() * double(sizeof(T) * SoilTerms<Dim>::size);
}

/// Function 5: values of a particle that change are read and written, the others that the update needs are
/// read; the motion of each node. Each pass of XPIC reads places and takes and leaves a velocity, APIC's
/// matrix is written.
template <class Space, class T, int Dim>
double bytes_to_particles(const State<Space, T, Dim>& s) {
  auto p = s.soil.points;
  double particle = sizeof(*p.cell.data()) + sizeof(*p.body.data());
  for_each_field_of(
      [&](const ParticleField& row, const auto& field) {
        const bool counted =
            row.use == Use::none || std::string(row.name) == "body";  // above, of one body too
        if (!counted) particle += (row.use == Use::changes ? 2 : 1) * sizeof(*field.data());
      },
      p);
  const double place = sizeof(*p.coordinate.data()) + sizeof(*p.cell.data()) + sizeof(*p.body.data());
  particle += s.scheme.xpic_order * (place + 2 * sizeof(*p.velocity.data()));
  if (p.has_affine) particle += sizeof(*p.affine.data());
  return p.count * particle + s.patches.node_count() * double(sizeof(T) * NodeKinematics<Dim>::size);
}

/// A third of what the energy balance moves in its three calls of a step: stress and volume before the step
/// and the strain are written and read once, the motion of the nodes and their sums are read.
template <class Space, class T, int Dim>
double bytes_of_energy(const State<Space, T, Dim>& s) {
  const auto& p = s.soil.points;
  const double place = sizeof(*p.coordinate.data()) + sizeof(*p.cell.data()) + sizeof(*p.body.data());
  const double particle = place + 6 * sizeof(SymTensor<T, Dim>) + 4 * sizeof(T);
  const double node = sizeof(T) * (2 * NodeKinematics<Dim>::size + SoilTerms<Dim>::size);
  return (p.count * particle + s.patches.node_count() * node) / 3;
}

/// Bytes that one call of a function must move.
template <class Space, class T, int Dim>
double bytes_of(StepPhase f, const State<Space, T, Dim>& s) {
  double points = 0, sorted = s.soil.points.count * bytes_of_point(s.soil.points);  // of the rigids; of all
  for (const auto& set : s.rigid_points) {
    if (!set.points.surface_normal) points += set.points.count;
    if (!s.contact.near.listed) sorted += set.points.count * bytes_of_point(set.points);
  }
  constexpr double place = sizeof(Vector<T, Dim>) + sizeof(int), home = sizeof(Vector<double, Dim>);
  const double rigid_sums = s.mass_normals ? s.rigid_points.size() * RigidTerms<Dim>::size : 0;
  const double sums = s.patches.node_count() * sizeof(T) * (SoilTerms<Dim>::size + rigid_sums);
  const double soil_sums = s.patches.node_count() * double(sizeof(T) * SoilTerms<Dim>::size);
  const bool ahead = s.plan.sums_ahead;  // then functions 1 and 3 are part of 4 and 5 of the step before
  switch (f) {
    case StepPhase::reset: return ahead ? 0 : sums;
    case StepPhase::rigid_to_nodes: return points * place;  // the few nodes that they reach are left out
    case StepPhase::soil_to_nodes: return ahead ? 0 : bytes_to_nodes(s);
    case StepPhase::nodes:
      return (ahead ? 2 : 1) * sums + s.patches.node_count() * double(sizeof(T) * NodeKinematics<Dim>::size);
    case StepPhase::particles: return bytes_to_particles(s) + (ahead ? soil_sums : 0);
    case StepPhase::rigids: return s.rigid_moves ? points * (place + home) : 0;
    case StepPhase::energy: return bytes_of_energy(s);
    case StepPhase::persistent:
      return bytes_of(StepPhase::rigid_to_nodes, s) + bytes_of(StepPhase::nodes, s) +
             bytes_of(StepPhase::particles, s) + bytes_of(StepPhase::rigids, s);
    default: return 2 * sorted;
  }
}

}  // namespace mpm
