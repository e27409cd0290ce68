#pragma once
// Choices of the user at run time that the kernels obey: plain enumerations, whose words are the options'
// words.

#include <utility>

namespace mpm {

/// Where the time step runs (-backend).
enum class Backend { serial, openmp, cuda };

/// Particle-to-node strategy (-p2g). `automatic` is the word `auto`: the fastest known for the backend.
enum class P2G { sequential, atomic, mosaic, gather, tile, automatic };

/// The words of -p2g.
inline constexpr std::pair<const char*, P2G> k_p2g_words[] = {
    {"sequential", P2G::sequential}, {"atomic", P2G::atomic}, {"mosaic", P2G::mosaic},
    {"gather", P2G::gather},         {"tile", P2G::tile},     {"auto", P2G::automatic}};
constexpr const char* word_of(P2G how) {
  for (const auto& [word, strategy] : k_p2g_words)
    if (strategy == how) return word;
  return "";
}

/// How particles take their velocity from the nodes (-velocity_update).
enum class VelocityUpdate { flip, pic, xpic, apic };

/// Body that a 2D run is a section of (-geometry): a body without end along z, or a body of revolution about
/// the axis x = 0.
enum class Geometry { plane_strain, axisymmetric };

/// How the domains of particles follow the deformation of the soil (-particle_domain): not at all, by half
/// lengths of their own along each axis, or so that particles whose domains become too long are split too.
/// Kernels of a step have the first two, and `ring`: fixed, and revolved about the axis (Geometry).
enum class ParticleDomain { fixed, stretch, split, ring };
/// Bounds of the half lengths [cells] of domains that stretch. Up to a half, a particle reaches three nodes
/// along an axis, also where it has drifted by half a cell. The shorter a domain, the shorter the stable time
/// step; where particles begin shorter than the least, they bound it.
inline constexpr double k_least_half_length = 0.1, k_most_half_length = 0.5;

/// Treatment of particles that are alone, or whose volume leaves its bounds (-stray_particles).
enum class StrayRule { keep, remove, stop };

/// The strategy that `auto` stands for.
constexpr P2G chosen(P2G how) { return how == P2G::automatic ? P2G::tile : how; }

}  // namespace mpm
