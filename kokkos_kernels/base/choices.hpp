#pragma once
// What a user chooses at run time and the kernels obey: plain enumerations, whose words are the options'
// words.

namespace mpm {

/// Where the time step runs (-backend).
enum class Backend { serial, openmp, cuda };

/// Particle-to-node strategy (-p2g). `automatic` is the word `auto`: the fastest known for the backend.
enum class P2G { sequential, atomic, mosaic, gather, tile, automatic };

/// What holds at one side of the mesh (-mesh_xmin ...): roller, no velocity normal to the side; fixed, no
/// velocity; free, nothing.
enum class Wall { roller, fixed, free };

/// How particles take their velocity from the nodes (-velocity_update).
enum class VelocityUpdate { flip, pic, xpic, apic };

/// What becomes of particles that are alone, or whose volume leaves its bounds (-stray_particles).
enum class StrayRule { keep, remove, stop };

/// The strategy that `auto` stands for on a backend.
constexpr P2G chosen(P2G how, Backend) { return how == P2G::automatic ? P2G::tile : how; }

}  // namespace mpm
