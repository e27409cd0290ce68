#pragma once
// Probes: places at which the history reports the soil. Their values follow from the particles near by, on
// the host, in the order of the particles' numbers: the bits do not depend on which rank holds which
// particle.

#include <string>
#include <vector>

#include "data/probe_data.hpp"
#include "mpm/config.hpp"

namespace mpm {

/// Memory of the probes since the start, which a checkpoint has. By probe; members for other kinds are
/// unused.
struct ProbeState {
  std::vector<long> followed;        // particle: its id; -1: none
  std::vector<double> start;         // particle: m, 3 a probe: where it began
  std::vector<double> section_zero;  // section: 2 a probe: kg and m3 (initial volume) beyond at the start
};

/// The names of the columns of a probe, in order.
std::vector<std::string> columns_of(const ProbeConfig& probe, const Config& config);

/// Requests to the kernels: the regions of all probes that are no sections, one a probe (that of a section
/// holds nothing), and the planes of the sections, in the order of the probes.
std::vector<ProbeRegion> regions_of(const Config& config, const ProbeState& state);
std::vector<SectionPlane> planes_of(const Config& config);

/// The numbers of the columns of all probes, in order. Particles: by region and id, of all ranks, with
/// positions from the mesh's lower corner and the stress as frames have it; `pore_pressure` [Pa] of each.
/// Sections: by plane, with what has left beyond them. NaN where there is no soil.
std::vector<double> probe_values(const Config& config, const ProbeState& state,
                                 const std::vector<ProbeParticle>& particles,
                                 const std::vector<double>& pore_pressure,
                                 const std::vector<SectionSum>& sections);

}  // namespace mpm
