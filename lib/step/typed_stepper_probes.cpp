// Reports on probes and columns of soil.

#include <algorithm>
#include <limits>
#include <tuple>

#include "common/collectives.hpp"
#include "output/rasters.hpp"
#include "step/typed_stepper.hpp"
#include "step/water.hpp"
#include "transfer/column_sums.hpp"
#include "transfer/probe_particles.hpp"

namespace mpm {
namespace {

/// Numbers of a SectionSum, which lie one after the other.
constexpr int k_section_numbers = 7;
static_assert(sizeof(SectionSum) == k_section_numbers * sizeof(double));

/// Total stress and pore pressure of particles where the run has them, as frames tell them.
template <int Dim>
std::vector<double> make_total(const Config& config, std::vector<ProbeParticle>& particles) {
  const Water<Dim> water = water_of<Dim>(config);
  std::vector<double> pore_pressure;
  for (ProbeParticle& p : particles) {
    Vector<double, Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = p.position[d];
    const double hydrostatic = water.is_there() ? water.pressure(x) : 0.0;
    for (int k = 0; k < 3; ++k) p.stress[k] -= hydrostatic;
    pore_pressure.push_back(hydrostatic + p.excess_pressure);
  }
  return pore_pressure;
}

}  // namespace

/// The particles of all ranks that probes take, on every rank, by probe and id.
template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::take_probe_particles(const ProbeState& state,
                                                                 std::vector<ProbeParticle>* particles) {
  PetscFunctionBeginUser;
  PetscCallCXX(*particles = particles_in(state_, regions_of(config_, state)));
  if (!ranks_) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(share_records(comm_, particles));
  std::sort(particles->begin(), particles->end(), [](const ProbeParticle& a, const ProbeParticle& b) {
    return std::tie(a.region, a.id) < std::tie(b.region, b.id);
  });
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::begin_probes(ProbeState* state) {
  PetscFunctionBeginUser;
  collect_soil(state_);
  const std::size_t count = config_.probes.size();
  state->followed.assign(count, -1), state->start.assign(3 * count, 0),
      state->section_zero.assign(2 * count, 0);
  for (std::size_t n = 0; n < count; ++n) {
    const ProbeConfig& probe = config_.probes[n];
    if (probe.kind != ProbeKind::particle) continue;
    Vec3 place{};
    for (int d = 0; d < Dim; ++d) place[d] = probe.at[d] - config_.mesh.lower[d];
    std::function<void(double*)> least;
    if (ranks_)
      least = [this](double* square) { MPI_Allreduce(MPI_IN_PLACE, square, 1, MPI_DOUBLE, MPI_MIN, comm_); };
    int id = nearest_particle(state_, place, probe.bodies, least).id;
    if (ranks_) PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &id, 1, MPI_INT, MPI_MIN, comm_));
    if (id != std::numeric_limits<int>::max()) state->followed[n] = id;
  }
  std::vector<ProbeParticle> particles;
  PetscCall(take_probe_particles(*state, &particles));
  for (const ProbeParticle& p : particles)
    if (state->followed[p.region] == p.id)
      std::copy(p.position, p.position + 3, state->start.begin() + 3 * p.region);
  std::vector<SectionSum> sums;
  PetscCall(sum_sections(&sums));
  for (std::size_t n = 0, section = 0; n < count; ++n)
    if (config_.probes[n].kind == ProbeKind::section) {
      state->section_zero[2 * n] = sums[section].mass;
      state->section_zero[2 * n + 1] = sums[section++].initial_volume;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::sum_sections(std::vector<SectionSum>* sums) {
  PetscFunctionBeginUser;
  collect_soil(state_);
  sums->clear();
  for (std::size_t n = 0; n < planes_.size(); ++n) {
    SectionSum sum = section_sum(state_, planes_[n]);
    sum.mass += lost_beyond_[n].mass, sum.initial_volume += lost_beyond_[n].initial_volume;
    sums->push_back(sum);
  }
  if (ranks_)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums->data(), k_section_numbers * static_cast<int>(sums->size()),
                               MPI_DOUBLE, MPI_SUM, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::measure_probes(const ProbeState& state,
                                                           std::vector<double>* values) {
  PetscFunctionBeginUser;
  collect_soil(state_);
  std::vector<ProbeParticle> particles;
  PetscCall(take_probe_particles(state, &particles));
  const std::vector<double> pore_pressure = make_total<Dim>(config_, particles);
  std::vector<SectionSum> sums;
  PetscCall(sum_sections(&sums));
  PetscCallCXX(*values = probe_values(config_, state, particles, pore_pressure, sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::sum_columns(std::vector<long>* sums) {
  PetscFunctionBeginUser;
  collect_soil(state_);
  PetscCallCXX(*sums = column_sums(state_, column_grid(config_)));
  if (ranks_)
    PetscCallMPI(
        MPI_Allreduce(MPI_IN_PLACE, sums->data(), static_cast<int>(sums->size()), MPI_LONG, MPI_SUM, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
BeyondMask<Space> TypedStepper<Space, T, Dim>::mark_beyond() {
  if (planes_.empty()) return {};
  collect_soil(state_);
  return beyond_mask(state_, planes_);
}

template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::note_all_lost(const BeyondMask<Space>& beyond) {
  note_lost(state_);
  if (!planes_.empty()) add_lost_beyond(state_, planes_, beyond, lost_beyond_);
}

template <class Space, class T, int Dim>
PetscErrorCode TypedStepper<Space, T, Dim>::save_sections(SavedState* saved) const {
  PetscFunctionBeginUser;
  saved->sections.clear();
  for (const SectionSum& lost : lost_beyond_)
    saved->sections.push_back(lost.mass), saved->sections.push_back(lost.initial_volume);
  if (ranks_)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, saved->sections.data(), static_cast<int>(saved->sections.size()),
                               MPI_DOUBLE, MPI_SUM, comm_));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Restores the soil that has left beyond the sections, on the first rank.
template <class Space, class T, int Dim>
void TypedStepper<Space, T, Dim>::restore_sections(const SavedState& saved) {
  const bool first = !ranks_ || rank_of(comm_) == 0;
  for (std::size_t n = 0; n < planes_.size(); ++n)
    lost_beyond_[n] = {.mass = first ? saved.sections[2 * n] : 0,
                       .initial_volume = first ? saved.sections[2 * n + 1] : 0};
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                                    \
  template PetscErrorCode TypedStepper<Space, T, Dim>::take_probe_particles(const ProbeState&,            \
                                                                            std::vector<ProbeParticle>*); \
  template PetscErrorCode TypedStepper<Space, T, Dim>::begin_probes(ProbeState*);                         \
  template PetscErrorCode TypedStepper<Space, T, Dim>::sum_sections(std::vector<SectionSum>*);            \
  template PetscErrorCode TypedStepper<Space, T, Dim>::measure_probes(const ProbeState&,                  \
                                                                      std::vector<double>*);              \
  template PetscErrorCode TypedStepper<Space, T, Dim>::sum_columns(std::vector<long>*);                   \
  template BeyondMask<Space> TypedStepper<Space, T, Dim>::mark_beyond();                                  \
  template void TypedStepper<Space, T, Dim>::note_all_lost(const BeyondMask<Space>&);                     \
  template PetscErrorCode TypedStepper<Space, T, Dim>::save_sections(SavedState*) const;                  \
  template void TypedStepper<Space, T, Dim>::restore_sections(const SavedState&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
