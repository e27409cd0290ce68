#pragma once
// Distance to a surface that is given by samples, at any point.

#include "data/surface_samples.hpp"
#include "physics/distance.hpp"

namespace mpm {

/// Tables of SurfaceTables that a distance reads, passed by value. A thread of a GPU that called a function
/// with a reference to a member of its kernel would copy the kernel's data to its own memory, some thousand
/// bytes.
struct SampleTables {
  const int* blocks;
  const SurfaceSample* samples;
  const unsigned char* edges;
};

/// The cell of a grid of samples that a point is in.
struct SampleCell {
  int first, stride[3];  // number of the sample at its lower corner, and from one to the next
  double at[3];          // place in it, in cells
  double spacing;        // m
  bool near;             // it is one of a block near the surface
};

KOKKOS_INLINE_FUNCTION SampleCell cell_of(const SampleTables& tables, const SampleGrid& grid,
                                          const Vector<double, 3>& in_cells) {
  constexpr int edge = SampleGrid::edge;
  int block[3];
  for (int d = 0; d < 3; ++d)
    block[d] = Kokkos::min(static_cast<int>(in_cells[d] / edge), grid.blocks[d] - 1);
  const int first =
      tables.blocks[grid.first_block + (block[2] * grid.blocks[1] + block[1]) * grid.blocks[0] + block[0]];
  SampleCell cell;
  cell.near = first >= 0;
  cell.first = cell.near ? first : grid.first_corner;
  cell.spacing = cell.near ? grid.spacing : grid.spacing * edge;
  int stride = 1;
  for (int d = 0; d < 3; ++d) {
    const double in_block = in_cells[d] - edge * block[d];
    const int place = cell.near ? Kokkos::min(static_cast<int>(in_block), edge - 1) : block[d];
    cell.at[d] = cell.near ? in_block - place : in_block / edge;
    cell.stride[d] = stride;
    cell.first += stride * place;
    stride *= cell.near ? edge + 1 : grid.blocks[d] + 1;
  }
  return cell;
}

/// Mean of what the samples of a cell give, each with its distance and half of its slope: exact where the
/// distance is of second order. The normal is the mean of theirs.
KOKKOS_INLINE_FUNCTION Distance<3> distance_in(const SampleTables& tables, const SampleCell& cell) {
  Distance<3> out{};
  for (int k = 0; k < 8; ++k) {
    double weight = 1;
    int n = cell.first;
    for (int d = 0; d < 3; ++d) {
      const int upper = k >> d & 1;
      weight *= upper ? cell.at[d] : 1 - cell.at[d];
      n += upper * cell.stride[d];
    }
    const SurfaceSample sample = tables.samples[n];
    double value = sample.value;
    for (int d = 0; d < 3; ++d) {
      value += 0.5 * cell.spacing * (cell.at[d] - (k >> d & 1)) * sample.normal[d];
      out.normal[d] += weight * sample.normal[d];
    }
    out.value += weight * value;
  }
  return out;
}

/// Distance to a sampled surface at x [m]. Far from it the distance is a lower bound of its size: beyond the
/// grid that to the grid and from there on.
MPM_SAME_BITS_FUNCTION Distance<3> distance_to_samples(SampleTables tables, const SampleGrid& grid, double x,
                                                       double y, double z) {
  constexpr double k_off = 0.25;  // of a block's edge: by which the mean of its corners may be too large
  const double place[3] = {x, y, z};
  Vector<double, 3> in_cells, beyond;
  for (int d = 0; d < 3; ++d) {
    const double from = (place[d] - grid.lower[d]) / grid.spacing;
    in_cells[d] = Kokkos::fmin(double(SampleGrid::edge * grid.blocks[d]), Kokkos::fmax(0.0, from));
    beyond[d] = (from - in_cells[d]) * grid.spacing;
  }
  const SampleCell cell = cell_of(tables, grid, in_cells);
  Distance<3> out = distance_in(tables, cell);
  const double length = Kokkos::sqrt(dot(out.normal, out.normal));
  for (int d = 0; d < 3; ++d) out.normal[d] = length > k_on_edge ? out.normal[d] / length : 0;
  if (cell.near) {
    int nearest = cell.first;
    for (int d = 0; d < 3; ++d) nearest += cell.at[d] > 0.5 ? cell.stride[d] : 0;
    out.at_edge = tables.edges[nearest] != 0;
  } else {
    const double sign = tables.samples[cell.first].value < 0 ? -1 : 1;
    out.value = sign * Kokkos::fmax(grid.band, sign * out.value - k_off * cell.spacing);
  }
  const double square = dot(beyond, beyond);
  if (square > 0) {
    const double here = Kokkos::fmax(0.0, out.value), all = Kokkos::sqrt(square + here * here);
    for (int d = 0; d < 3; ++d) out.normal[d] = (beyond[d] + here * out.normal[d]) / all;
    out.value = all;
    out.at_edge = false;
  }
  return out;
}

}  // namespace mpm
