#pragma once
// Sums, extents and quantiles over the particles of a body, for the history and the checks.

#include <functional>

#include "base/spaces.hpp"
#include "data/core.hpp"

namespace mpm {

/// Extent and centre of mass [m from the mesh's lower corner], kinetic and stored energy [J], momentum [kg
/// m/s] and mass [kg] of one body, and the number of its particles, of those that are alone, and of those
/// whose volume is at a bound. The centre is a mean by `weight`: the mass, or where all particles have one
/// mass their number, which is exact. water_energy: of the water that the body displaces, by
/// its depth below the level [J].
struct BodyMeasure {
  double lower[3], upper[3], kinetic_energy, stored_energy, momentum[3], centre[3], mass, weight;
  double water_energy;
  double pore_water, outflow;  // m3, without pressure: of water that flows, in the pores and out of them
  long count, alone, limited;
  long stretched;  // particles whose domain is at its upper bound along some axis
};

template <class Space, class T, int Dim>
BodyMeasure measure(const Core<Space, T, Dim>& s, int body);

/// Speed of the fastest wave in any particle [m/s] (Eq. 14), once its soil has been compressed by a volume
/// strain; 0 without particles.
template <class Space, class T, int Dim>
double fastest_wave(const Core<Space, T, Dim>& s, double compression = 0);

/// Range of the velocities of the particles along each axis [m/s], from `least` to `most`, both 0 without
/// particles. 0, the velocity of a side at rest, is always in it.
struct VelocityRange {
  double least[3] = {}, most[3] = {};
};
template <class Space, class T, int Dim>
VelocityRange velocity_range(const Core<Space, T, Dim>& s);

/// Reductions over ranks that a measure calls: sums and maxima, number by number. Empty on one rank.
struct OverRanks {
  std::function<void(int*, int)> sum;
  std::function<void(double*)> largest;
};

/// The rank-th smallest coordinate (1 <= rank <= m.count) of a body's particles along d [m from the mesh's
/// lower corner]; m is the measure of the whole body. It is a particle's coordinate, at most 2^-24 of the
/// body's extent above the exact one, and the same whatever the number of threads.
template <class Space, class T, int Dim>
double ranked_coordinate(const Core<Space, T, Dim>& s, int body, int d, long rank, const BodyMeasure& m,
                         const OverRanks& over = {});

}  // namespace mpm
