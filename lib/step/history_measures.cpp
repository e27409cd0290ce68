#include "step/history_measures.hpp"

#include <algorithm>
#include <limits>

#include "base/copy.hpp"
#include "functions/grid_velocity.hpp"
#include "functions/interfaces.hpp"
#include "functions/part_forces.hpp"
#include "functions/rigid_pairs.hpp"
#include "rebuild/batches.hpp"
#include "step/contact_at_sites.hpp"
#include "step/gaps.hpp"
#include "step/load_input.hpp"
#include "transfer/download.hpp"
#include "transfer/filled_cells.hpp"
#include "transfer/unbalanced.hpp"

namespace mpm {

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::measure_bodies(std::vector<BodyRow>* rows) {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  PetscCall(run_.sum_soil());
  rows->clear();
  for (int b = 0; b < static_cast<int>(run_.config.bodies.size()); ++b) {
    BodyRow body;
    PetscCall(measure_body(b, &body));
    rows->push_back(body);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::measure_body(int b, BodyRow* body) const {
  PetscFunctionBeginUser;
  BodyMeasure m = mpm::measure(run_.state, b);
  double speed = largest_grid_speed(run_.state, b);
  if (run_.ranks) PetscCall(sum_measure(&m));
  PetscCall(run_.largest(&speed));
  PetscCall(measure_strays(b, body));
  body->mass = m.mass, body->water_energy = m.water_energy, body->strays = m.alone, body->limited = m.limited;
  body->pore_water = m.pore_water, body->outflow = m.outflow;
  body->particles = m.count, body->stretched = m.stretched;
  if (m.count == 0) PetscFunctionReturn(PETSC_SUCCESS);
  const long rank = m.count - m.count / 1000;  // of the 99.9th percentile, the nearest one above
  const OverRanks over{.sum = [this](int* counts, int n) { static_cast<void>(run_.sum(counts, n)); },
                       .largest = [this](double* value) { static_cast<void>(run_.largest(value)); }};
  const Vec3& origin = run_.config.mesh.lower;
  for (int d = 0; d < Dim; ++d) {
    body->lower[d] = m.lower[d] + origin[d];
    body->upper[d] = m.upper[d] + origin[d];
    body->momentum[d] = m.momentum[d];
    body->quantile[d] = ranked_coordinate(run_.state, b, d, rank, m, over) + origin[d];
    body->centre[d] = m.centre[d] + origin[d];
  }
  body->kinetic_energy = m.kinetic_energy;
  body->stored_energy = m.stored_energy;
  body->grid_velocity = speed;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Makes the measure of this rank's part of a body that of the whole body.
template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::sum_measure(BodyMeasure* m) const {
  PetscFunctionBeginUser;
  for (double& x : m->centre) x = m->count > 0 ? x * m->weight : 0;
  PetscCall(run_.least(m->lower, 3));
  PetscCall(run_.largest(m->upper, 3));
  PetscCall(run_.sum(&m->kinetic_energy));
  PetscCall(run_.sum(&m->stored_energy));
  PetscCall(run_.sum(m->momentum, 3));
  PetscCall(run_.sum(m->centre, 3));
  for (double* value : {&m->mass, &m->water_energy, &m->weight, &m->pore_water, &m->outflow})
    PetscCall(run_.sum(value));
  for (long* count : {&m->count, &m->alone, &m->limited, &m->stretched}) PetscCall(run_.sum(count));
  for (int d = 0; d < 3 && m->weight > 0; ++d) m->centre[d] /= m->weight;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::measure_strays(int b, BodyRow* body) const {
  PetscFunctionBeginUser;
  const Lost& lost = run_.state.strays.lost[b];
  const auto put_back = mirror_of(run_.state.strays.put_back);
  double sums[11] = {lost.mass,          lost.kinetic_energy, lost.momentum[0], lost.momentum[1],
                     lost.momentum[2],   double(put_back(b)), lost.count,       lost.merged,
                     lost.merged_energy, lost.corrected,      lost.raised};
  PetscCall(run_.sum(sums, 11));
  body->lost_mass = sums[0], body->lost_energy = sums[1];
  for (int d = 0; d < 3; ++d) body->lost_momentum[d] = sums[2 + d];
  body->put_back = static_cast<long>(sums[5]), body->lost_count = static_cast<long>(sums[6]);
  body->merged = static_cast<long>(sums[7]), body->merged_energy = sums[8];
  body->corrected = sums[9], body->raised = sums[10];
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::save_strays(SavedState* saved) const {
  PetscFunctionBeginUser;
  if (!run_.ranks) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(run_.sum(saved->lost.data(), saved->lost.size()));
  PetscCall(share_records(run_.comm, &saved->alone));
  std::sort(saved->alone.begin(), saved->alone.end());
  saved->alone.erase(std::unique(saved->alone.begin(), saved->alone.end()), saved->alone.end());
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::count_cells(HistoryRow* row) const {
  PetscFunctionBeginUser;
  std::vector<FilledPatch> patches = filled_cells(run_.state);
  if (run_.ranks) PetscCall(share_records(run_.comm, &patches));
  const MeshConfig& mesh = run_.config.mesh;
  std::array<int, 3> cells{1, 1, 1};
  std::array<bool, 3> periodic{};
  for (int d = 0; d < Dim; ++d) cells[d] = mesh.cells[d], periodic[d] = is_periodic(mesh, d);
  const Gaps gaps = count_gaps<Dim>(patches, cells, periodic);
  row->filled_cells = gaps.filled, row->empty_cells = gaps.empty;
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::measure_rigids(double interval, HistoryRow* row) {
  PetscFunctionBeginUser;
  const Config& config = run_.config;
  const double time = row->time - config.time.start;
  row->rigids.clear();
  const std::vector<PairAction<Dim>> actions = take_pair_actions(run_.state);
  for (const Rigid<Dim>& r : take_rigids(run_.state)) {
    RigidRow rigid;
    Wrench<Dim> impulse = r.impulse;
    if (run_.ranks && !run_.ranks->forces_shared()) PetscCall(run_.sum(impulse.c, Wrench<Dim>::size));
    for (int d = 0; d < Dim; ++d) {
      rigid.displacement[d] = r.motion.pose.displacement[d];
      rigid.velocity[d] = velocity_at(config.rigids[row->rigids.size()], d, r.motion.velocity[d], time);
      rigid.force[d] = interval > 0 ? impulse[Wrench<Dim>::force + d] / interval : 0;
      rigid.kinetic_energy += r.inertia.mass * r.motion.velocity[d] * r.motion.velocity[d] / 2;
    }
    const AngularVector<Dim> angle = r.motion.pose.rotation.way_from({});
    for (int k = 0; k < k_turning_axes<Dim> && r.motion.pose.turns; ++k) {
      rigid.angle[k] = angle[k];
      rigid.angular_velocity[k] = spin_at(config.rigids[row->rigids.size()], k, r.motion.spin[k], time);
      rigid.kinetic_energy += r.inertia.dynamic ? r.momentum[k] * r.motion.spin[k] / 2 : 0;
      rigid.moment[k] = interval > 0 ? impulse[Wrench<Dim>::moment + k] / interval : 0;
    }
    for (int k = 0; k < Wrench<Dim>::size && !actions.empty() && interval > 0; ++k) {
      const double mean = actions[row->rigids.size()].impulse[k] / interval;
      (k < Wrench<Dim>::moment ? rigid.contact_force[k] : rigid.contact_moment[k - Wrench<Dim>::moment]) =
          mean;
    }
    row->rigids.push_back(rigid);
  }
  measure_parts(interval, row);
  PetscCall(measure_interfaces(interval, row));
  run_.rigids.widen(row->rigids);
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void HistoryMeasures<Space, T, Dim>::measure_parts(double interval, HistoryRow* row) {
  const auto impulses = take_part_impulses(run_.state);
  std::size_t n = 0;
  for (std::size_t r = 0; r < row->rigids.size() && !impulses.empty(); ++r)
    for (std::size_t k = 0; k < run_.config.rigids[r].shape.parts.size(); ++k, ++n) {
      PartRow& part = row->rigids[r].parts.emplace_back();
      const double scale = interval > 0 ? 1 / interval : 0;
      for (int d = 0; d < Dim; ++d) part.force[d] = scale * impulses[n][Wrench<Dim>::force + d];
      for (int d = 0; d < k_turning_axes<Dim>; ++d)
        part.moment[d] = scale * impulses[n][Wrench<Dim>::moment + d];
    }
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::measure_interfaces(double interval, HistoryRow* row) {
  using Terms = InterfaceTerms<Dim>;
  PetscFunctionBeginUser;
  std::vector<double> totals;
  PetscCallCXX(totals = take_interface_totals(run_.state));
  PetscCall(run_.sum(totals.data(), static_cast<int>(totals.size())));
  const double scale = interval > 0 ? 1 / interval : 0;
  for (std::size_t at = 0; at < totals.size(); at += Terms::size) {
    InterfaceRow& pair = row->interfaces.emplace_back();
    for (int d = 0; d < Dim; ++d) pair.force[d] = scale * totals[at + Terms::impulse + d];
    pair.area = scale * totals[at + Terms::area];
    pair.work = totals[at + Terms::work];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::unbalanced_ratio(double dt, double* ratio) {
  PetscFunctionBeginUser;
  auto& s = run_.state;
  PetscCall(sum_present_forces(s, run_.ranks.get()));
  const KeptSums kept(s);
  if (s.interfaces.in_use()) press_fields(s, dt, false);
  if (s.at_sites.in_use) PetscCall(sum_site_forces(s, dt, run_.ranks.get()));
  const UnbalancedForces own = unbalanced_forces(s, dt);
  double sums[2] = {own.force, own.weight};
  PetscCall(run_.sum(sums, 2));
  *ratio = sums[1] > 0 ? sums[0] / sums[1] : std::numeric_limits<double>::infinity();
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::fastest_wave(double compression, double* speed) const {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  *speed = mpm::fastest_wave(run_.state, compression);
  PetscCall(run_.largest(speed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode HistoryMeasures<Space, T, Dim>::closing_speed(double* speed) const {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  VelocityRange range = velocity_range(run_.state);
  const auto widen = [&range](int d, double velocity) {
    range.least[d] = std::min(range.least[d], velocity), range.most[d] = std::max(range.most[d], velocity);
  };
  const Config& config = run_.config;
  const auto rigids = mirror_of(run_.state.rigids);
  for (int d = 0; d < Dim; ++d) {
    for (std::size_t r = 0; r < config.rigids.size(); ++r)
      widen(d, config.rigids[r].velocity[d]), widen(d, rigids(r).motion.velocity[d]);
    for (const auto& pair : config.mesh.sides)
      for (const SideConfig& side : pair) widen(d, side.velocity[d]);
  }
  PetscCall(run_.least(range.least, 3));
  PetscCall(run_.largest(range.most, 3));
  *speed = 0;
  for (int d = 0; d < Dim; ++d) *speed += range.most[d] - range.least[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MPM_INSTANTIATE(Space, T, Dim) template class HistoryMeasures<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
