#pragma once
// Tables of the surfaces of rigid bodies, from the host to the device.

#include <vector>

#include "data/surface_samples.hpp"
#include "transfer/fill_view.hpp"
#include "transfer/upload.hpp"

namespace mpm {

/// Tables of surfaces on the host, as SurfaceTables.
template <int Dim>
struct HostTables {
  std::vector<Vertex> vertices;
  std::vector<Surface<Dim>> parts;
  std::vector<SampleGrid> grids;
  std::vector<int> blocks;
  std::vector<SurfaceSample> samples;
  std::vector<unsigned char> edges;
  int sampled = 0;  // sampled surfaces so far

  /// Adds the numbers of a surface, and returns it with their places in the tables. spacing [m]: edge of the
  /// cells. A sampled surface that comes without samples has those of other tables, to which the same sampled
  /// surfaces were added in this order.
  Surface<Dim> add(const SurfaceInput& in, double spacing) {
    Surface<Dim> surface = surface_of<Dim>(in, spacing);
    surface.first = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), in.vertices.begin(), in.vertices.end());
    if (in.kind == SurfaceKind::sampled) surface.first = sampled++;
    if (in.kind == SurfaceKind::sampled && !in.samples.empty()) add_samples(in);
    if (in.kind == SurfaceKind::parts) {
      std::vector<Surface<Dim>> own;
      for (const SurfaceInput& part : in.parts) own.push_back(add(part, spacing));
      surface.first = static_cast<int>(parts.size()), surface.count = static_cast<int>(own.size());
      parts.insert(parts.end(), own.begin(), own.end());
    }
    return surface;
  }
  template <class Memory>
  void upload(SurfaceTables<Memory, Dim>& tables) const {
    const auto fill = [](auto& view, const char* label, const auto& from) {
      fill_view(view, label, static_cast<int>(from.size()), [&](int n) { return from[n]; });
    };
    fill(tables.vertices, "mpm::vertices", vertices);
    fill(tables.parts, "mpm::surface_parts", parts);
    fill(tables.grids, "mpm::sample_grids", grids);
    fill(tables.blocks, "mpm::sample_blocks", blocks);
    fill(tables.samples, "mpm::samples", samples);
    fill(tables.edges, "mpm::sample_edges", edges);
  }

 private:
  void add_samples(const SurfaceInput& in) {
    const int before = static_cast<int>(samples.size());
    grids.push_back(in.grid);
    grids.back().first_block = static_cast<int>(blocks.size());
    grids.back().first_corner = before;
    for (const int block : in.blocks) blocks.push_back(block < 0 ? -1 : before + block);
    samples.insert(samples.end(), in.samples.begin(), in.samples.end());
    edges.insert(edges.end(), in.edges.begin(), in.edges.end());
  }
};

}  // namespace mpm
