#include "step/soil_probes.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

#include "output/rasters.hpp"
#include "rebuild/batches.hpp"
#include "step/water.hpp"
#include "transfer/column_sums.hpp"
#include "transfer/probe_particles.hpp"

namespace mpm {
namespace {

/// Numbers of a SectionSum, which lie one after the other.
constexpr int k_section_numbers = 7;
static_assert(sizeof(SectionSum) == k_section_numbers * sizeof(double));

/// Makes the stress of particles total, as frames have it, where the run has pore pressures; returns these.
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

template <class Space, class T, int Dim>
PetscErrorCode SoilProbes<Space, T, Dim>::take_particles(const ProbeState& state,
                                                         std::vector<ProbeParticle>* particles) const {
  PetscFunctionBeginUser;
  PetscCallCXX(*particles = particles_in(run_.state, regions_of(run_.config, state)));
  if (!run_.ranks) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(share_records(run_.comm, particles));
  std::sort(particles->begin(), particles->end(), [](const ProbeParticle& a, const ProbeParticle& b) {
    return std::tie(a.region, a.id) < std::tie(b.region, b.id);
  });
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode SoilProbes<Space, T, Dim>::begin(ProbeState* state) {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  const auto& probes = run_.config.probes;
  const std::size_t count = probes.size();
  state->followed.assign(count, -1), state->start.assign(3 * count, 0),
      state->section_zero.assign(2 * count, 0);
  for (std::size_t n = 0; n < count; ++n) {
    if (probes[n].kind != ProbeKind::particle) continue;
    Vec3 place{};
    for (int d = 0; d < Dim; ++d) place[d] = probes[n].at[d] - run_.config.mesh.lower[d];
    const auto least = [this](double* square) { static_cast<void>(run_.least(square)); };
    int id = nearest_particle(run_.state, place, probes[n].bodies, least).id;
    PetscCall(run_.least(&id));
    if (id != std::numeric_limits<int>::max()) state->followed[n] = id;
  }
  std::vector<ProbeParticle> particles;
  PetscCall(take_particles(*state, &particles));
  for (const ProbeParticle& p : particles)
    if (state->followed[p.region] == p.id)
      std::copy(p.position, p.position + 3, state->start.begin() + 3 * p.region);
  std::vector<SectionSum> sums;
  PetscCall(sum_sections(&sums));
  for (std::size_t n = 0, section = 0; n < count; ++n)
    if (probes[n].kind == ProbeKind::section) {
      state->section_zero[2 * n] = sums[section].mass;
      state->section_zero[2 * n + 1] = sums[section++].initial_volume;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode SoilProbes<Space, T, Dim>::sum_sections(std::vector<SectionSum>* sums) const {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  sums->clear();
  for (std::size_t n = 0; n < planes_.size(); ++n) {
    SectionSum sum = section_sum(run_.state, planes_[n]);
    sum.mass += lost_beyond_[n].mass, sum.initial_volume += lost_beyond_[n].initial_volume;
    sums->push_back(sum);
  }
  PetscCall(run_.sum(reinterpret_cast<double*>(sums->data()), k_section_numbers * sums->size()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode SoilProbes<Space, T, Dim>::measure(const ProbeState& state,
                                                  std::vector<double>* values) const {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  std::vector<ProbeParticle> particles;
  PetscCall(take_particles(state, &particles));
  const std::vector<double> pore_pressure = make_total<Dim>(run_.config, particles);
  std::vector<SectionSum> sums;
  PetscCall(sum_sections(&sums));
  PetscCallCXX(*values = probe_values(run_.config, state, particles, pore_pressure, sums));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
PetscErrorCode SoilProbes<Space, T, Dim>::sum_columns(std::vector<long>* sums) const {
  PetscFunctionBeginUser;
  collect_soil(run_.state);
  PetscCallCXX(*sums = column_sums(run_.state, column_grid(run_.config)));
  PetscCall(run_.sum(sums->data(), sums->size()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
BeyondMask<Space> SoilProbes<Space, T, Dim>::mark_beyond() const {
  if (planes_.empty()) return {};
  collect_soil(run_.state);
  return beyond_mask(run_.state, planes_);
}

template <class Space, class T, int Dim>
void SoilProbes<Space, T, Dim>::add_lost(const BeyondMask<Space>& beyond) {
  if (!planes_.empty()) add_lost_beyond(run_.state, planes_, beyond, lost_beyond_);
}

template <class Space, class T, int Dim>
PetscErrorCode SoilProbes<Space, T, Dim>::save(SavedState* saved) const {
  PetscFunctionBeginUser;
  saved->sections.clear();
  for (const SectionSum& lost : lost_beyond_)
    saved->sections.push_back(lost.mass), saved->sections.push_back(lost.initial_volume);
  PetscCall(run_.sum(saved->sections.data(), saved->sections.size()));
  PetscFunctionReturn(PETSC_SUCCESS);
}

template <class Space, class T, int Dim>
void SoilProbes<Space, T, Dim>::restore(const SavedState& saved) {
  const bool first = run_.is_first();
  for (std::size_t n = 0; n < planes_.size(); ++n)
    lost_beyond_[n] = {.mass = first ? saved.sections[2 * n] : 0,
                       .initial_volume = first ? saved.sections[2 * n + 1] : 0};
}

#define MPM_INSTANTIATE(Space, T, Dim) template class SoilProbes<Space, T, Dim>;
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
