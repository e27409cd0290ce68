#include "input/load_faces.hpp"

#include <limits>

#include "common/collectives.hpp"
#include "common/revolution.hpp"
#include "common/text.hpp"
#include "input/groups.hpp"
#include "input/point_bins.hpp"
#include "input/shapes.hpp"

namespace mpm {
namespace {

constexpr double k_slack = 1e-6;  // of a particle's width
constexpr int k_most_loads = 3;   // of a particle: k_most_faces

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

/// Particles that may cover the faces of others, with their width [m].
class Cover {
 public:
  Cover(const Config& config, double widest)
      : config_(config), widest_(widest), points_(config.dim, 2 * widest) {}
  void add(const Vec3& x, double width) {
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
  bool holds(const Vec3& x, double width, const std::array<Vec3, 3>& axes) const {
    constexpr double k_shifted = 0.75;  // of the width: in deformed soil, and where cells are cut
    return points_.any_near(x, [&](int n) {
      const double reach = std::max(k_shifted * width, width_[n] / 2 + k_slack * width);
      Vec3 way{};
      for (int d = 0; d < config_.dim; ++d) way[d] = points_[n][d] - x[d];
      for (int d = 0; d < config_.dim; ++d)
        if (!(std::fabs(along(way, axes[d])) < reach)) return false;
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
  void put(const Vec3& x, double width) { points_.add(x), width_.push_back(width); }
  const Config& config_;
  double widest_;
  PointBins points_;
  std::vector<double> width_;
};

/// A particle with faces of a load: how many more point along each axis of its lattice than against it.
struct Marked {
  std::size_t particle = 0;
  Vec3 at{}, count{};
};

class Finder {
 public:
  Finder(MPI_Comm comm, const Config& config, std::vector<BodyParticles>& bodies)
      : comm_(comm), config_(config), bodies_(bodies), cover_(config, widest()) {}

  /// The particles of all ranks that may cover a face.
  PetscErrorCode gather() {
    PetscFunctionBeginUser;
    std::vector<double> open;  // particles of the lattices here that others may cover, and their widths
    if (size_of(comm_) > 1) PetscCallCXX(open = open_particles());
    for (std::size_t b = 0; b < bodies_.size(); ++b) add(b, cover_);
    PetscCall(share(&open));
    for (std::size_t k = 0; k < open.size(); k += 4)
      PetscCallCXX(cover_.add({open[k], open[k + 1], open[k + 2]}, open[k + 3]));
    PetscCallCXX(cover_.order());
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  /// The faces of a load on this rank.
  std::vector<Marked> mark(const LoadConfig& load) const {
    std::vector<Marked> marked;
    const int dim = config_.dim;
    const BodyParticles& body = bodies_[load.body];
    const auto axes = axes_of(config_.bodies[load.body].shape, dim);
    for (std::size_t p = 0; p < body.position.size() / dim; ++p) {
      Marked found{p, position(body, p), {}};
      if (!is_near(found.at, load, body.spacing)) continue;
      bool some = false;
      for (int n = 0; n < 2 * dim; ++n) {
        const double sign = n % 2 == 0 ? -1 : 1;
        if (!is_face(load, found.at, axes, n / 2, sign, body.spacing)) continue;
        found.count[n / 2] += sign, some = true;
      }
      if (some) marked.push_back(found);
    }
    return marked;
  }

  /// The faces of a load on all ranks, which tell the direction of the surface.
  PetscErrorCode gather_marked(const LoadConfig& load, const std::vector<Marked>& own, PointBins* places,
                               std::vector<Vec3>* counts) const {
    PetscFunctionBeginUser;
    std::vector<double> numbers;
    for (const Marked& marked : own) {
      numbers.insert(numbers.end(), marked.at.begin(), marked.at.end());
      numbers.insert(numbers.end(), marked.count.begin(), marked.count.end());
    }
    if (!is_listed(load.body)) PetscCall(share(&numbers));
    for (std::size_t k = 0; k < numbers.size(); k += 6) {
      PetscCallCXX(places->add({numbers[k], numbers[k + 1], numbers[k + 2]}));
      PetscCallCXX(counts->push_back({numbers[k + 3], numbers[k + 4], numbers[k + 5]}));
    }
    PetscCallCXX(places->order());
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  bool is_listed(int body) const { return config_.bodies[body].shape.kind == ShapeKind::particles; }

 private:
  double widest() const {
    double widest = 0;
    for (const BodyParticles& body : bodies_) widest = std::max(widest, body.spacing);
    return widest;
  }
  Vec3 position(const BodyParticles& body, std::size_t p) const {
    Vec3 x{};
    std::copy_n(&body.position[p * config_.dim], config_.dim, x.begin());
    return x;
  }
  /// Whether a particle is in the box of a load, or this much beside it.
  bool is_near(const Vec3& x, const LoadConfig& load, double reach) const {
    for (int d = 0; d < config_.dim; ++d)
      if (x[d] < load.lower[d] - reach || x[d] > load.upper[d] + reach) return false;
    return true;
  }
  bool is_near_some(const Vec3& x) const {
    const double reach = 4 * widest();
    return std::any_of(config_.loads.begin(), config_.loads.end(),
                       [&](const LoadConfig& load) { return is_near(x, load, reach); });
  }
  void add(std::size_t b, Cover& cover) const {
    for (std::size_t p = 0; p < bodies_[b].position.size() / config_.dim; ++p)
      if (const Vec3 x = position(bodies_[b], p); is_near_some(x)) cover.add(x, bodies_[b].spacing);
  }
  static Vec3 beyond(const Vec3& x, const Vec3& axis, double way) {
    return {x[0] + way * axis[0], x[1] + way * axis[1], x[2] + way * axis[2]};
  }
  /// Of the lattices, of which each rank has a part: x, y, z and width of those that nothing here covers on
  /// all sides.
  std::vector<double> open_particles() const {
    Cover own(config_, widest());
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (!is_listed(static_cast<int>(b))) add(b, own);
    own.order();
    std::vector<double> open;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (is_listed(static_cast<int>(b))) continue;
      const auto axes = axes_of(config_.bodies[b].shape, config_.dim);
      const double width = bodies_[b].spacing;
      for (std::size_t p = 0; p < bodies_[b].position.size() / config_.dim; ++p) {
        const Vec3 x = position(bodies_[b], p);
        if (!is_near_some(x)) continue;
        bool covered = true;
        for (int n = 0; n < 2 * config_.dim && covered; ++n)
          covered = own.holds(beyond(x, axes[n / 2], n % 2 == 0 ? -width : width), width, axes);
        if (!covered) open.insert(open.end(), {x[0], x[1], x[2], width});
      }
    }
    return open;
  }
  /// Numbers of all ranks, in the order of ranks, on every rank.
  PetscErrorCode share(std::vector<double>* numbers) const {
    PetscFunctionBeginUser;
    if (size_of(comm_) == 1) PetscFunctionReturn(PETSC_SUCCESS);
    const char* const bytes = reinterpret_cast<const char*>(numbers->data());
    const std::vector<std::vector<char>> out(size_of(comm_),
                                             {bytes, bytes + numbers->size() * sizeof(double)});
    std::vector<char> in;
    PetscCall(exchange_records(comm_, sizeof(double), out, &in));
    numbers->resize(in.size() / sizeof(double));
    std::copy(in.begin(), in.end(), reinterpret_cast<char*>(numbers->data()));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  bool is_face(const LoadConfig& load, const Vec3& x, const std::array<Vec3, 3>& axes, int axis, double sign,
               double width) const {
    constexpr double k_least_cosine = 0.5;
    if (load.facing) {
      const double cosine =
          sign * along(*load.facing, axes[axis]) / std::sqrt(along(*load.facing, *load.facing));
      if (cosine < k_least_cosine - k_slack) return false;
    }
    if (!is_near(beyond(x, axes[axis], sign * width / 2), load, k_slack * width)) return false;
    const Vec3 next = beyond(x, axes[axis], sign * width);
    return !cover_.is_beyond_wall(next) && !cover_.holds(next, width, axes);
  }

  MPI_Comm comm_;
  const Config& config_;
  std::vector<BodyParticles>& bodies_;
  Cover cover_;
};

/// What a marked particle keeps, as FaceTerms: area vector, area, and the size of the vector over it. The
/// area is that of a plane through the faces around, where they go in steps.
struct FaceOf {
  Vec3 vector{};
  double area = 0, steps = 1;
};
FaceOf face_of(const Config& config, const LoadConfig& load, const Marked& marked, double width,
               const PointBins& places, const std::vector<Vec3>& counts) {
  constexpr double k_around = 2.5;  // particles
  constexpr double k_least = 0.1;   // cosine: less is no plane
  Vec3 mean{};
  places.any_near(marked.at, [&](int n) {
    for (int d = 0; d < config.dim; ++d)
      if (std::fabs(places[n][d] - marked.at[d]) > k_around * width) return false;
    for (int d = 0; d < 3; ++d) mean[d] += counts[n][d];
    return false;
  });
  const double face = std::pow(width, config.dim - 1), size = std::sqrt(along(marked.count, marked.count)),
               length = std::sqrt(along(mean, mean));
  const double cosine = size > 0 && length > 0 ? along(mean, marked.count) / (size * length) : 0;
  const auto axes = axes_of(config.bodies[load.body].shape, config.dim);
  FaceOf of;
  double revolved = 0;  // size of the vector of a ring
  for (int k = 0; k < config.dim; ++k) {
    const double radius = marked.at[0] + (k == 0 ? marked.count[k] * width / 2 : 0);
    const double area = marked.count[k] * face * revolved_length(config, radius);
    for (int d = 0; d < 3; ++d) of.vector[d] += area * axes[k][d];
    revolved += area * area;
  }
  if (cosine > k_least) of.steps = 1 / cosine;
  of.area = std::sqrt(revolved) / of.steps;
  if (size == 0) of.area = 2 * face * revolved_length(config, marked.at[0]);  // both sides of a thin body
  return of;
}

/// Appends a load to those of a particle. `width`: numbers of a load.
void keep(std::vector<std::vector<double>>& of_particles, std::size_t p, int dim, int load,
          const FaceOf& face) {
  auto& all = of_particles[p];
  all.insert(all.end(), face.vector.begin(), face.vector.begin() + dim);
  all.insert(all.end(), {face.area, face.steps, load + 1.0});
}

}  // namespace

PetscErrorCode find_load_faces(MPI_Comm comm, const Config& config, std::vector<BodyParticles>* bodies,
                               int* face_count, std::vector<LoadedSurface>* surfaces) {
  PetscFunctionBeginUser;
  *face_count = 0;
  surfaces->assign(config.loads.size(), {});
  if (config.loads.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  const int dim = config.dim, width = dim + 3;
  Finder finder(comm, config, *bodies);
  PetscCall(finder.gather());
  std::vector<std::vector<std::vector<double>>> found(bodies->size());
  for (int n = 0; n < static_cast<int>(config.loads.size()); ++n) {
    const LoadConfig& load = config.loads[n];
    const BodyParticles& body = (*bodies)[load.body];
    found[load.body].resize(body.position.size() / dim);
    std::vector<Marked> marked;
    PetscCallCXX(marked = finder.mark(load));
    PointBins places(dim, 3 * body.spacing);
    std::vector<Vec3> counts;
    PetscCall(finder.gather_marked(load, marked, &places, &counts));
    double sums[5] = {};  // particles, area, vector
    for (const Marked& one : marked) {
      const FaceOf face = face_of(config, load, one, body.spacing, places, counts);
      PetscCallCXX(keep(found[load.body], one.particle, dim, n, face));
      sums[0] += 1, sums[1] += face.area;
      for (int d = 0; d < dim; ++d) sums[2 + d] += face.vector[d];
    }
    if (!finder.is_listed(load.body))
      PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_DOUBLE, MPI_SUM, comm));
    (*surfaces)[n] = {static_cast<long>(sums[0]), sums[1], {sums[2], sums[3], sums[4]}};
  }
  std::size_t most = 0;
  for (const auto& body : found)
    for (const auto& particle : body) most = std::max(most, particle.size() / width);
  *face_count = static_cast<int>(most);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, face_count, 1, MPI_INT, MPI_MAX, comm));
  for (std::size_t b = 0; b < bodies->size() && *face_count > 0; ++b) {
    BodyParticles& body = (*bodies)[b];
    found[b].resize(body.position.size() / dim);
    body.faces.clear();
    for (auto& particle : found[b]) {
      particle.resize(*face_count * width, 0.0);
      PetscCallCXX(body.faces.insert(body.faces.end(), particle.begin(), particle.end()));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode check_load_faces(MPI_Comm comm, const Config& config, std::vector<std::string>* lines) {
  PetscFunctionBeginUser;
  if (config.loads.empty()) PetscFunctionReturn(PETSC_SUCCESS);
  std::vector<BodyParticles> bodies;
  for (const BodyConfig& body : config.bodies) {
    BodyParticles& particles = bodies.emplace_back();
    particles.spacing = config.mesh.spacing / body.shape.particles_per_cell;
    if (body.shape.kind == ShapeKind::particles) {
      ParticleTable table;
      std::string fault;
      PetscCallCXX(fault = read_particles(source_of(body, config), config.mesh, config.dim, table));
      PetscCallCXX(cut_particles(cut_out_of(config, body), config.mesh, config.dim, table));
      particles.position = std::move(table.position);
    } else {
      Lattice lattice;
      PetscCall(fill(body.shape, config.mesh, config.dim, lattice, cut_out_of(config, body),
                     {rank_of(comm), size_of(comm)}));
      particles.position = std::move(lattice.position);
    }
  }
  int most = 0;
  std::vector<LoadedSurface> surfaces;
  PetscCall(find_load_faces(comm, config, &bodies, &most, &surfaces));
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const LoadConfig& load = config.loads[n];
    if (surfaces[n].particles == 0)
      lines->push_back(
          formatted("mpm: -%s_lower: given \"%s\", takes a lower corner that with -%s_upper \"%s\" makes "
                    "a box round some free surface of body %s; no face of its particles is in this one%s",
                    load.name.c_str(), text_of(load.lower, config.dim).c_str(), load.name.c_str(),
                    text_of(load.upper, config.dim).c_str(), config.bodies[load.body].name.c_str(),
                    config.stage.removed_at.empty()
                        ? ""
                        : " at the start; what a stage bares by -STAGE_remove takes a load in a run that begins "
                          "with the particles of a frame of that stage"));
  }
  if (most > k_most_loads)
    lines->push_back(
        formatted("mpm: -loads: given loads of which %d are on one particle, takes at most %d on each", most,
                  k_most_loads));
  PetscFunctionReturn(PETSC_SUCCESS);
}

}  // namespace mpm
