#include "input/geometry/free_faces.hpp"

#include "common/collectives.hpp"
#include "common/revolution.hpp"
#include "data/face_terms.hpp"
#include "input/geometry/point_bins.hpp"
#include "input/geometry/shapes.hpp"

namespace mpm {
namespace {

constexpr double k_slack = 1e-6;  // of a particle's width

double along(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The directions along which the particles of a shape's lattice lie.
std::array<Vec3, 3> axes_of(const Shape& shape, int dim) {
  std::array<Vec3, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (shape.kind != ShapeKind::box) return axes;
  const int up = dim - 1;
  axes[0][0] = axes[up][up] = std::cos(shape.angle);
  axes[0][up] = std::sin(shape.angle), axes[up][0] = -axes[0][up];
  return axes;
}

/// Particles that may cover the faces of others, with their widths [m].
class Cover {
 public:
  Cover(const Config& config, double widest)
      : config_(config), widest_(widest), points_(config.dim, 2 * widest) {}
  void add(const Vec3& x, const Vec3& width) {
    put(x, width);
    for (int d = 0; d < config_.dim; ++d) {  // their images round a period
      if (!is_periodic(config_.mesh, d)) continue;
      Vec3 image = x;
      const double low = config_.mesh.lower[d], high = config_.mesh.upper[d];
      if (x[d] < low + 2 * widest_) image[d] += high - low;
      if (x[d] > high - 2 * widest_) image[d] -= high - low;
      if (image[d] != x[d]) put(image, width);
    }
  }
  void order() { points_.order(); }
  /// Whether some particle is where the neighbour of a face would be, at x; axes: those of its lattice.
  /// shifted: how far from there, over the width, in deformed soil and where cells are cut.
  bool holds(const Vec3& x, const Vec3& width, const std::array<Vec3, 3>& axes, double shifted = 0.75) const {
    return points_.any_near(x, [&](int n) {
      Vec3 way{};
      for (int d = 0; d < config_.dim; ++d) way[d] = points_[n][d] - x[d];
      for (int d = 0; d < config_.dim; ++d) {
        const double reach = std::max(shifted * width[d], width_[n][d] / 2 + k_slack * width[d]);
        if (!(std::fabs(along(way, axes[d])) < reach)) return false;
      }
      return true;
    });
  }
  /// Whether soil goes on beyond a side of the mesh, as its mirror image, or held by it.
  bool is_beyond_wall(const Vec3& x) const {
    const MeshConfig& mesh = config_.mesh;
    const double slack = k_slack * mesh.spacing;
    for (int d = 0; d < config_.dim; ++d) {
      if (x[d] < mesh.lower[d] - slack && !is_open(mesh.walls[d][0])) return true;
      if (x[d] > mesh.upper[d] + slack && !is_open(mesh.walls[d][1])) return true;
    }
    return false;
  }

 private:
  void put(const Vec3& x, const Vec3& width) { points_.add(x), width_.push_back(width); }
  const Config& config_;
  double widest_;
  PointBins points_;
  std::vector<Vec3> width_;
};

/// A particle with faces of a load: how many more point along each axis of its lattice than against it.
struct Marked {
  std::size_t particle = 0;
  Vec3 at{}, width{}, count{};
};

class Finder {
 public:
  Finder(MPI_Comm comm, const Config& config, const std::vector<SearchedBody>& bodies,
         const std::vector<int>& loads)
      : comm_(comm), config_(config), bodies_(bodies), loads_(loads) {}

  /// The particles of all ranks that may cover a face.
  PetscErrorCode gather() {
    PetscFunctionBeginUser;
    for (const SearchedBody& body : bodies_) {
      widest_ = std::max(widest_, body.spacing);
      for (const double width : body.width) widest_ = std::max(widest_, width);
    }
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &widest_, 1, MPI_DOUBLE, MPI_MAX, comm_));
    PetscCallCXX(cover_.emplace(config_, widest_));
    std::vector<double> open;  // particles here that others may cover on other ranks, and their widths
    if (size_of(comm_) > 1) PetscCallCXX(open = open_particles());
    for (const SearchedBody& body : bodies_) add(body, *cover_);
    PetscCall(share_records(comm_, &open));
    for (std::size_t k = 0; k < open.size(); k += 6)
      PetscCallCXX(cover_->add({open[k], open[k + 1], open[k + 2]}, {open[k + 3], open[k + 4], open[k + 5]}));
    PetscCallCXX(cover_->order());
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  /// The faces of a load on this rank.
  std::vector<Marked> mark(const LoadConfig& load) const {
    std::vector<Marked> marked;
    const SearchedBody& body = bodies_[load.body];
    const auto axes = axes_of(config_.bodies[load.body].shape, config_.dim);
    for (std::size_t p = 0; p < body.count(config_.dim); ++p) {
      Marked found{p, body.at(p, config_.dim), body.width_of(p, config_.dim), {}};
      if (!is_near(found.at, load, widest_)) continue;
      bool some = false;
      for (int n = 0; n < 2 * config_.dim; ++n) {
        const double sign = n % 2 == 0 ? -1 : 1;
        if (!is_face(load, found, axes, n / 2, sign)) continue;
        found.count[n / 2] += sign, some = true;
      }
      if (some) marked.push_back(found);
    }
    return marked;
  }

  /// The faces of a load on all ranks, which give the direction of the surface.
  PetscErrorCode gather_marked(const LoadConfig& load, const std::vector<Marked>& own, PointBins* places,
                               std::vector<Vec3>* counts) const {
    PetscFunctionBeginUser;
    std::vector<double> numbers;
    for (const Marked& marked : own) {
      numbers.insert(numbers.end(), marked.at.begin(), marked.at.end());
      numbers.insert(numbers.end(), marked.count.begin(), marked.count.end());
    }
    if (!bodies_[load.body].on_all_ranks) PetscCall(share_records(comm_, &numbers));
    for (std::size_t k = 0; k < numbers.size(); k += 6) {
      PetscCallCXX(places->add({numbers[k], numbers[k + 1], numbers[k + 2]}));
      PetscCallCXX(counts->push_back({numbers[k + 3], numbers[k + 4], numbers[k + 5]}));
    }
    PetscCallCXX(places->order());
    PetscFunctionReturn(PETSC_SUCCESS);
  }

 private:
  /// Whether a particle is in the box of a load, or this much beside it.
  bool is_near(const Vec3& x, const LoadConfig& load, double reach) const {
    for (int d = 0; d < config_.dim; ++d)
      if (x[d] < load.lower[d] - reach || x[d] > load.upper[d] + reach) return false;
    return true;
  }
  bool is_near_some(const Vec3& x) const {
    return std::any_of(loads_.begin(), loads_.end(),
                       [&](int load) { return is_near(x, config_.loads[load], 4 * widest_); });
  }
  void add(const SearchedBody& body, Cover& cover) const {
    for (std::size_t p = 0; p < body.count(config_.dim); ++p)
      if (const Vec3 x = body.at(p, config_.dim); is_near_some(x))
        cover.add(x, body.width_of(p, config_.dim));
  }
  static Vec3 beyond(const Vec3& x, const Vec3& axis, double way) {
    return {x[0] + way * axis[0], x[1] + way * axis[1], x[2] + way * axis[2]};
  }
  /// Places and widths of the particles, of bodies that ranks share, that may be neighbours of particles of
  /// other ranks: all but those that have neighbours of their own lattice here on all sides.
  std::vector<double> open_particles() const {
    std::vector<double> open;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (bodies_[b].on_all_ranks) continue;
      Cover own(config_, widest_);
      add(bodies_[b], own);
      own.order();
      const auto axes = axes_of(config_.bodies[b].shape, config_.dim);
      for (std::size_t p = 0; p < bodies_[b].count(config_.dim); ++p) {
        const Vec3 x = bodies_[b].at(p, config_.dim), width = bodies_[b].width_of(p, config_.dim);
        if (is_near_some(x) && !is_inside(own, x, width, axes))
          open.insert(open.end(), {x[0], x[1], x[2], width[0], width[1], width[2]});
      }
    }
    return open;
  }
  bool is_inside(const Cover& own, const Vec3& x, const Vec3& width, const std::array<Vec3, 3>& axes) const {
    constexpr double k_in_lattice = 0.25;
    for (int n = 0; n < 2 * config_.dim; ++n) {
      const double way = width[n / 2] * (n % 2 == 0 ? -1 : 1);
      if (!own.holds(beyond(x, axes[n / 2], way), width, axes, k_in_lattice)) return false;
    }
    return true;
  }
  bool is_face(const LoadConfig& load, const Marked& of, const std::array<Vec3, 3>& axes, int axis,
               double sign) const {
    constexpr double k_least_cosine = 0.5;
    if (load.facing) {
      const double cosine =
          sign * along(*load.facing, axes[axis]) / std::sqrt(along(*load.facing, *load.facing));
      if (cosine < k_least_cosine - k_slack) return false;
    }
    const double width = of.width[axis];
    if (!is_near(beyond(of.at, axes[axis], sign * width / 2), load, k_slack * width)) return false;
    const Vec3 next = beyond(of.at, axes[axis], sign * width);
    return !cover_->is_beyond_wall(next) && !cover_->holds(next, of.width, axes);
  }

  MPI_Comm comm_;
  const Config& config_;
  const std::vector<SearchedBody>& bodies_;
  const std::vector<int>& loads_;
  double widest_ = 0;  // m, of the particles of all ranks
  std::optional<Cover> cover_;
};

/// The area of a marked particle's faces: that of a plane through the faces around, where they go in steps.
FreeFace face_of(const Config& config, const LoadConfig& load, double spacing, const Marked& marked,
                 const PointBins& places, const std::vector<Vec3>& counts) {
  constexpr double k_around = 2.5;  // particles
  constexpr double k_least = 0.1;   // cosine: less is no plane
  Vec3 mean{};
  places.any_near(marked.at, [&](int n) {
    for (int d = 0; d < config.dim; ++d)
      if (std::fabs(places[n][d] - marked.at[d]) > k_around * spacing) return false;
    for (int d = 0; d < 3; ++d) mean[d] += counts[n][d];
    return false;
  });
  const auto face = [&](int axis) {
    double area = 1;
    for (int d = 0; d < config.dim; ++d)
      if (d != axis) area *= marked.width[d];
    return area;
  };
  const double size = std::sqrt(along(marked.count, marked.count)), length = std::sqrt(along(mean, mean));
  const double cosine = size > 0 && length > 0 ? along(mean, marked.count) / (size * length) : 0;
  const auto axes = axes_of(config.bodies[load.body].shape, config.dim);
  FreeFace of{.particle = marked.particle};
  double revolved = 0;  // size of the vector of a ring
  for (int k = 0; k < config.dim; ++k) {
    const double radius = marked.at[0] + (k == 0 ? marked.count[k] * marked.width[0] / 2 : 0);
    const double area = marked.count[k] * face(k) * revolved_length(config, radius);
    for (int d = 0; d < 3; ++d) of.vector[d] += area * axes[k][d];
    revolved += area * area;
  }
  if (cosine > k_least) of.steps = 1 / cosine;
  of.area = std::sqrt(revolved) / of.steps;
  if (size == 0)  // both sides of a thin body
    of.area = 2 * face(config.dim - 1) * revolved_length(config, marked.at[0]);
  return of;
}

}  // namespace

Vec3 SearchedBody::at(std::size_t p, int dim) const {
  Vec3 x{};
  std::copy_n(&position[p * dim], dim, x.begin());
  return x;
}

Vec3 SearchedBody::width_of(std::size_t p, int dim) const {
  Vec3 all{spacing, spacing, spacing};
  if (!width.empty()) std::copy_n(&width[p * dim], dim, all.begin());
  return all;
}

std::vector<double> numbers_of(const FreeFace& face, int dim, int load) {
  const FacePlaces places = face_places(dim);
  std::vector<double> numbers(places.size);
  std::copy_n(face.vector.begin(), dim, numbers.begin() + places.area);
  numbers[places.start] = face.area, numbers[places.steps] = face.steps;
  numbers[places.load] = load + 1;
  return numbers;
}

PetscErrorCode find_free_faces(MPI_Comm comm, const Config& config, const std::vector<SearchedBody>& bodies,
                               const std::vector<int>& loads, std::vector<std::vector<FreeFace>>* faces) {
  PetscFunctionBeginUser;
  faces->assign(loads.size(), {});
  if (loads.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  Finder finder(comm, config, bodies, loads);
  PetscCall(finder.gather());
  for (std::size_t n = 0; n < loads.size(); ++n) {
    const LoadConfig& load = config.loads[loads[n]];
    const double spacing = bodies[load.body].spacing;
    std::vector<Marked> marked;
    PetscCallCXX(marked = finder.mark(load));
    PointBins places(config.dim, 3 * spacing);
    std::vector<Vec3> counts;
    PetscCall(finder.gather_marked(load, marked, &places, &counts));
    for (const Marked& one : marked)
      PetscCallCXX((*faces)[n].push_back(face_of(config, load, spacing, one, places, counts)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
