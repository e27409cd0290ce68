#include "step/sample_surface.hpp"

#include <algorithm>
#include <cmath>

#include "input/geometry/rounded_surface.hpp"
#include "input/geometry/vectors.hpp"

namespace mpm {
namespace {

constexpr int k_edge_cells = SampleGrid::edge, k_corners = k_edge_cells + 1;
constexpr double k_rounding = 0.5;                   // cells of the mesh
constexpr double k_outside = 1.75, k_inside = 1.25;  // cells of the mesh: how far contact asks from a surface
constexpr double k_margin = 2;                       // cells of the mesh, of the grid round the surface
constexpr double k_far = 3;  // blocks from the surface: how far the distance is looked up
constexpr double k_tenth = 0.1;
constexpr double k_most_bytes = 2e9;

/// Bytes of the blocks near a surface of an area [m2] and of the corners of all blocks of a volume [m3].
double bytes_of(double area, double volume, double block) {
  constexpr double k_layers = 3.6;  // of blocks, as measured
  constexpr double k_sample = sizeof(SurfaceSample) + 1;
  return k_layers * area / (block * block) * SampleGrid::block_size * k_sample +
         volume / (block * block * block) * (k_sample + sizeof(int));
}

/// Edge of the cells of samples [m]: a third of the mesh's, or more where they would not fit; their bytes.
double spacing_of(const TriangleSurface& surface, double cell, double* bytes) {
  double volume = 1, spacing = cell / 3;
  for (int d = 0; d < 3; ++d)
    volume *= surface.bounds().upper[d] - surface.bounds().lower[d] + 2 * k_margin * cell;
  for (;; spacing *= 1.25) {
    *bytes = bytes_of(surface.area(), volume, spacing * k_edge_cells);
    if (*bytes < k_most_bytes) return spacing;
  }
}

/// The sides of the mesh on which triangles lie.
std::vector<Mirror> mirrors_of(const TriangleSurface& surface, const MeshConfig& mesh) {
  constexpr double k_slack = 1e-6;  // cells
  std::vector<Mirror> mirrors;
  for (int d = 0; d < 3; ++d)
    for (const bool upper : {false, true}) {
      const double side = upper ? mesh.upper[d] : mesh.lower[d];
      const double end = upper ? surface.bounds().upper[d] : surface.bounds().lower[d];
      if (std::abs(end - side) < k_slack * mesh.spacing) mirrors.push_back({d, upper, end});
    }
  return mirrors;
}

/// Fills the samples of a grid.
class Sampler {
 public:
  Sampler(const RoundedSurface& surface, const Vec3& origin, double cell, SurfaceInput& out)
      : surface_(surface), origin_(origin), cell_(cell), out_(out) {}

  void fill() {
    fill_corners();
    fill_blocks();
  }

 private:
  /// Place of a corner of cells, counted from the grid's [m].
  Vec3 place(const std::array<int, 3>& at) const {
    Vec3 x;
    for (int d = 0; d < 3; ++d) x[d] = origin_[d] + out_.grid.lower[d] + at[d] * out_.grid.spacing;
    return x;
  }
  void add(const RoundedSurface::Distance& of) {
    SurfaceSample sample{static_cast<float>(of.value), {}};
    for (int d = 0; d < 3; ++d) sample.normal[d] = static_cast<float>(of.normal[d]);
    out_.samples.push_back(sample);
    out_.edges.push_back(of.at_edge ? 1 : 0);
  }
  /// Whether the surface is nearer to a point than a distance, as far as a tenth of a cell; a triangle near
  /// it.
  bool is_within(const Vec3& x, double far, int& guess) const {
    const TriangleDistance& sharp = surface_.sharp();
    double off = guess < 0 ? far : std::abs(sharp.walked(x, guess).value);
    while (off > 2 * k_tenth * cell_) {  // another part of the surface may be nearer
      const auto nearer = sharp.nearest(x, -1, std::min(far, guess < 0 ? far : off - 2 * k_tenth * cell_));
      if (nearer.triangle < 0) break;
      guess = nearer.triangle, off = std::abs(nearer.value);
    }
    return guess >= 0 && off < far;
  }
  /// Samples of the corners of blocks. Those far from the surface are on the side of the one before, which is
  /// not beyond the surface: nearer ones would lie between.
  void fill_corners() {
    const auto& n = out_.grid.blocks;
    const double far = k_far * k_edge_cells * out_.grid.spacing;
    int guess = -1;
    for (int k = 0; k <= n[2]; ++k)
      for (int j = 0; j <= n[1]; ++j)
        for (int i = 0; i <= n[0]; ++i) {
          const Vec3 x = place({k_edge_cells * i, k_edge_cells * j, k_edge_cells * k});
          const int row = n[0] + 1, before = i > 0 ? 1 : j > 0 ? row : k > 0 ? row * (n[1] + 1) : 0;
          if (is_within(x, far, guess)) {
            add(surface_.at(x, guess, true));
            continue;
          }
          SurfaceSample last{static_cast<float>(far), {}};
          if (before > 0) last = out_.samples[out_.samples.size() - before];
          const double sign = last.value < 0 ? -1 : 1;
          add({sign * far, {last.normal[0], last.normal[1], last.normal[2]}, false});
        }
  }
  void fill_blocks() {
    const auto& n = out_.grid.blocks;
    const double reach = std::sqrt(0.75) * k_edge_cells * out_.grid.spacing;  // of a corner in a block
    for (int k = 0; k < n[2]; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          bool near = false;
          for (int c = 0; c < 8; ++c) {
            const int corner =
                ((k + (c >> 2 & 1)) * (n[1] + 1) + j + (c >> 1 & 1)) * (n[0] + 1) + i + (c & 1);
            near = near || is_near(out_.samples[corner].value, reach + 2 * k_tenth * cell_);
          }
          out_.blocks.push_back(near ? static_cast<int>(out_.samples.size()) : -1);
          if (near) fill_block({k_edge_cells * i, k_edge_cells * j, k_edge_cells * k});
        }
  }
  /// Whether contact may ask for a place that far from one at this distance.
  bool is_near(double distance, double reach) const {
    return distance - reach < k_outside * cell_ && distance + reach > -k_inside * cell_;
  }
  /// Whether a walk over the surface finds the nearest place of all, to a tenth of a cell, at points across a
  /// block, from the one that is the nearest at its middle; the triangle there.
  bool is_smooth(const std::array<int, 3>& first, int& middle) const {
    const auto at = [&](int i, int j, int k) {
      return place({first[0] + i * k_edge_cells / 2, first[1] + j * k_edge_cells / 2,
                    first[2] + k * k_edge_cells / 2});
    };
    const TriangleDistance& sharp = surface_.sharp();
    const auto to = sharp.nearest(at(1, 1, 1), middle);
    middle = to.triangle;
    const double reach = std::abs(to.value) + std::sqrt(3.0) * k_edge_cells * out_.grid.spacing;
    Box round;
    for (const double r : {-reach, reach}) round.add(along(at(1, 1, 1), r, Vec3{1, 1, 1}));
    if (surface_.bends_in(round)) return false;
    for (int n = 0; n < 27; ++n) {
      if (n % 2 == 1) continue;  // corners, and the middles of faces' edges
      const Vec3 x = at(n % 3, n / 3 % 3, n / 9);
      const double off = std::abs(sharp.walked(x, middle).value) - k_tenth * cell_;
      if (off > 0 && sharp.nearest(x, -1, off).triangle >= 0) return false;
    }
    return true;
  }
  /// Samples of a block. Where contact asks for no cell of a sample, a bound on the distance is enough.
  void fill_block(const std::array<int, 3>& first) {
    const double h = out_.grid.spacing, cells = std::sqrt(3.0) * h;
    const bool walks = is_smooth(first, middle_);
    int guess = middle_;
    RoundedSurface::Distance last{};
    Vec3 from{};
    for (int k = 0; k < k_corners; ++k)
      for (int j = 0; j < k_corners; ++j)
        for (int i = 0; i < k_corners; ++i) {
          const Vec3 x = place({first[0] + i, first[1] + j, first[2] + k});
          const double walked = length_of(difference(x, from));
          if (i + j + k > 0 && !is_near(last.value, walked + cells)) {
            add({last.value + (last.value > 0 ? -walked : walked), last.normal, false});
            continue;
          }
          last = surface_.at(x, guess, walks), from = x;
          add(last);
        }
  }

  const RoundedSurface& surface_;
  Vec3 origin_;  // m, of the mesh
  double cell_;  // m, of the mesh
  SurfaceInput& out_;
  int middle_ = -1;  // triangle that is the nearest to the middle of the block before
};

}  // namespace

double sample_bytes(const Shape& shape, const MeshConfig& mesh) {
  double bytes = 0;
  if (shape.kind == ShapeKind::stl) spacing_of(*shape.triangles, mesh.spacing, &bytes);
  for (const Shape& part : shape.parts) bytes += sample_bytes(part, mesh);
  return bytes;
}

SurfaceInput sampled_surface(const Shape& shape, const MeshConfig& mesh) {
  const TriangleSurface& surface = *shape.triangles;
  SurfaceInput out;
  out.kind = SurfaceKind::sampled;
  double bytes = 0;
  SampleGrid& grid = out.grid;
  grid.spacing = spacing_of(surface, mesh.spacing, &bytes);
  grid.band = k_inside * mesh.spacing;
  const double block = k_edge_cells * grid.spacing;
  for (int d = 0; d < 3; ++d) {
    const double extent = surface.bounds().upper[d] - surface.bounds().lower[d] + 2 * k_margin * mesh.spacing;
    grid.blocks[d] = static_cast<int>(std::ceil(extent / block));
    grid.lower[d] =
        (surface.bounds().upper[d] + surface.bounds().lower[d] - grid.blocks[d] * block) / 2 - mesh.lower[d];
  }
  const TriangleDistance sharp(shape.triangles, mirrors_of(surface, mesh));
  const RoundedSurface rounded(sharp, k_rounding * mesh.spacing);
  Sampler(rounded, mesh.lower, mesh.spacing, out).fill();
  return out;
}

}  // namespace mpm
