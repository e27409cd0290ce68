#pragma once
// Rayleigh damping in a step: forces -alpha M v - beta K v at the nodes, which no stress and no velocity
// keeps.

#include <vector>

#include "data/state.hpp"

namespace mpm {

/// Coefficients and fields of Rayleigh damping. Only a run with such damping has them.
template <class Space, class T, int Dim>
struct Rayleigh {
  using Memory = typename Space::memory_space;
  double mass = 0, stiffness = 0;                   // 1/s, s: alpha, beta
  Kokkos::View<double*, Memory> shear_ratio;        // -, by material, as side_moduli() takes it
  Kokkos::View<SymTensor<T, Dim>*, Memory> stress;  // Pa, viscous, of the particles in this step
  NodeField<Space, T, SoilTerms<Dim>::size> sums;   // of this stress, of this rank's soil
  NodeField<Space, T, Dim> force;                   // N, of both parts in this step
  Kokkos::View<double, Memory> work;                // J, of a step
};

/// Takes the parameters; shear_ratio [-]: speed of shear waves over that of pressure waves, by material.
template <class Space, class T, int Dim>
void begin_rayleigh(Rayleigh<Space, T, Dim>& by, double mass, double stiffness,
                    const std::vector<double>& shear_ratio);

/// The viscous stresses beta D : (rate of strain) of all particles, with the elastic stiffness D of drained
/// soil in its present state. The rates are those of the nodes' velocities before the step, as sides of the
/// mesh hold them, so that s.nodes.soil must be complete. Leaves these velocities in s.nodes.residual.
template <class Space, class T, int Dim>
void find_viscous_stress(State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by);

/// The soil with these stresses in lieu of its own.
template <class Space, class T, int Dim>
Soil<Space, T, Dim> viscous_soil(const State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by) {
  Soil<Space, T, Dim> points = s.soil.points;
  points.stress = by.stress;
  return points;
}

/// Puts the forces among by.sums in s.nodes.residual, for the sum over ranks.
template <class Space, class T, int Dim>
void show_viscous_forces(State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by);

/// Adds both parts to the forces at the nodes. viscous: s.nodes.residual holds the forces of all ranks.
template <class Space, class T, int Dim>
void add_rayleigh_forces(State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by, bool viscous);

/// Behind function 4 and add_node_works, in a step of dt [s]: the work of these forces is one of damping.
template <class Space, class T, int Dim>
void add_rayleigh_work(State<Space, T, Dim>& s, const Rayleigh<Space, T, Dim>& by, double dt);

}  // namespace mpm
