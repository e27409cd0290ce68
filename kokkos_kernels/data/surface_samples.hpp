#pragma once
// The surface of a rigid body by samples of the distance to it.

#include "base/types.hpp"
#include "data/surface.hpp"

namespace mpm {

/// Distance to a surface at a point [m], positive outside, and the unit normal of the surface at the nearest
/// place: zero where there is none.
struct alignas(16) SurfaceSample {
  float value;
  float normal[3];
};

/// Grid of samples round a surface at the start. It has blocks of cells; those near the surface have samples
/// at the corners of their cells, and for the others those at the corners of the blocks count.
struct SampleGrid {
  static constexpr int edge = 6;  // cells of a block along each axis
  static constexpr int block_size = (edge + 1) * (edge + 1) * (edge + 1);
  Vector<double, 3> lower;  // m from the mesh's lower corner
  double spacing;           // m, edge of a cell
  double band;              // m, blocks without samples are farther from the surface
  int blocks[3];            // along each axis
  int first_block;          // of it in SurfaceTables::blocks, x fastest
  int first_corner;         // of the corners of its blocks in SurfaceTables::samples, x fastest
};

/// Numbers of the surfaces of all rigid bodies, by kind of surface. vertices(v): a vertex of a polygon.
template <class Memory, int Dim>
struct SurfaceTables {
  Kokkos::View<Vertex*, Memory> vertices;
  Kokkos::View<Surface<Dim>*, Memory> parts;  // of bodies of several parts
  Kokkos::View<SampleGrid*, Memory> grids;
  Kokkos::View<int*, Memory> blocks;  // first sample of each block; -1: it has none
  Kokkos::View<SurfaceSample*, Memory> samples;
  Kokkos::View<unsigned char*, Memory> edges;  // of the samples: 1 where an edge is nearest

  KOKKOS_INLINE_FUNCTION const Vertex& operator()(int v) const { return vertices(v); }
  bool has_parts() const { return parts.extent(0) > 0; }  // some body has several parts
};

/// Calls f(view) for all tables.
template <class Memory, int Dim, class F>
void for_each_table(const SurfaceTables<Memory, Dim>& tables, F&& f) {
  f(tables.vertices), f(tables.parts), f(tables.grids), f(tables.blocks), f(tables.samples), f(tables.edges);
}

/// Gives tables the samples of others.
template <class Memory, int Dim>
void share_samples(const SurfaceTables<Memory, Dim>& from, SurfaceTables<Memory, Dim>& to) {
  to.grids = from.grids, to.blocks = from.blocks, to.samples = from.samples, to.edges = from.edges;
}

}  // namespace mpm
