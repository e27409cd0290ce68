#pragma once
// Loads on surfaces (data/surface_loads.hpp) in a step.

#include <vector>

#include "data/core.hpp"
#include "data/energy_works.hpp"
#include "data/surface_loads.hpp"
#include "physics/p2g_terms.hpp"

namespace mpm {

/// After lists were made: which slots hold particles with loads.
template <class Space, class T, int Dim>
void list_loaded(const Core<Space, T, Dim>& s, SurfaceLoads<Space, T, Dim>& loads);

/// Forces of loads: on the soil as a whole, or those on the water in its pores alone.
enum class LoadsOn { soil, pores };

/// The source of the forces on faces that lie along an axis, of particles in the slots with loads: sum N f_p,
/// N the mean of the linear hat of a node over the face. A face is a box without thickness. The source takes
/// places, boxes and forces of the faces from `loads`, where this puts them, and is summed in its windows.
template <class Space, class T, int Dim>
VectorSource<Space, T, Dim> place_faces(const Core<Space, T, Dim>& s,
                                        const SurfaceLoads<Space, T, Dim>& loads, int axis,
                                        LoadsOn on = LoadsOn::soil);

/// Adds s.nodes.load to the forces at the nodes.
template <class Space, class T, int Dim>
void add_loads(const Core<Space, T, Dim>& s);

/// Behind function 4, before particles move: the work of the loads in the step, and the areas of the faces
/// after it. energy: takes the work out of that of the internal forces, if it is in use. dt [s].
template <class Space, class T, int Dim>
void follow_surfaces(const Core<Space, T, Dim>& s, const SurfaceLoads<Space, T, Dim>& loads,
                     const EnergyWorks<Space, T, Dim>& energy, double dt);

/// The surface of a load as it is now, on this rank: sums over its particles that are not alone.
struct SurfaceSum {
  double vector[3] = {};  // m2, area as a vector out of the soil
  double area = 0;        // m2
  double start_area = 0;  // m2, at the start of the run, of the particles that are here
};
template <class Space, class T, int Dim>
std::vector<SurfaceSum> sum_surfaces(const Core<Space, T, Dim>& s, const SurfaceLoads<Space, T, Dim>& loads);

}  // namespace mpm
