#include "check/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/collectives.hpp"
#include "common/text.hpp"
#include "input/geometry/filled.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr double k_most_points = 5e7;  // of a pair
constexpr double k_nothing = 1e-6;     // of a particle's width

/// Points in the part of space where the bounds of two shapes meet: an odd number in each direction, so that
/// there is one in the middle of what is thin.
struct Samples {
  Bounds common;
  Vec3 step{};
  std::array<long, 3> count{1, 1, 1};
  double touch = 0;  // m: what is thinner is no overlap
  bool any = true;

  Samples(const Filled& a, const Filled& b, int dim) {
    const double coarse = std::max(a.width, b.width), whole = a.listed || b.listed ? 1 : 0.5;
    // The bounds of a half plane have some round-off to spare.
    touch = std::max(k_nothing * coarse, std::min({whole * coarse, a.thinnest / 2, b.thinnest / 2}));
    double points = 1, edge = coarse / 2;
    for (int d = 0; d < dim; ++d) {
      common.lower[d] = std::max(a.bounds.lower[d], b.bounds.lower[d]);
      common.upper[d] = std::min(a.bounds.upper[d], b.bounds.upper[d]);
      const double extent = common.upper[d] - common.lower[d];
      any = any && extent > touch * (1 + 1e-6);
      points *= std::max(1.0, extent / edge);
    }
    if (!any) return;
    edge *= std::pow(std::max(1.0, points / k_most_points), 1.0 / dim);
    for (int d = 0; d < dim; ++d) {
      const double extent = common.upper[d] - common.lower[d];
      count[d] = 2 * std::lround(std::ceil(extent / edge / 2)) + 1;
      step[d] = extent / static_cast<double>(count[d]);
    }
  }
  double at(long k, int d) const { return common.lower[d] + (static_cast<double>(k) + 0.5) * step[d]; }
};

/// The directions in which a point must be deep inside: along the axes and between them.
std::vector<Vec3> directions_of(int dim) {
  std::vector<Vec3> directions;
  for (int d = 0; d < dim; ++d)
    for (const double sign : {-1.0, 1.0}) directions.emplace_back()[d] = sign;
  for (int k = 0; k < 1 << dim; ++k) {
    Vec3& diagonal = directions.emplace_back();
    for (int d = 0; d < dim; ++d) diagonal[d] = (k >> d & 1 ? 1 : -1) / std::sqrt(double(dim));
  }
  return directions;
}

/// Where two shapes overlap.
struct Pair {
  Filled& a;
  Filled& b;
  int dim;
  std::vector<Vec3> directions;

  bool hold(const Vec3& x) const { return a.holds(x) && b.holds(x); }

  bool hold_deep(const Vec3& x, double depth) const {
    return std::all_of(directions.begin(), directions.end(), [&](const Vec3& along) {
      Vec3 y = x;
      for (int d = 0; d < dim; ++d) y[d] += depth * along[d];
      return hold(y);
    });
  }

  /// How many of this rank's points both hold, and whether one of them is deep inside.
  std::array<long, 2> count(const Samples& samples, int rank, int ranks) const {
    const int up = dim - 1;
    const double depth = samples.touch / 2 * (1 - 1e-6);
    long held = 0, deep = 0;
    for (long row = rank; row < samples.count[up]; row += ranks) {
      Vec3 x{};
      x[up] = samples.at(row, up);
      a.enter_row(x[up] - depth, x[up] + depth), b.enter_row(x[up] - depth, x[up] + depth);
      for (long j = 0; j < (dim == 3 ? samples.count[1] : 1); ++j) {
        if (dim == 3) x[1] = samples.at(j, 1);
        for (long i = 0; i < samples.count[0]; ++i) {
          x[0] = samples.at(i, 0);
          if (!hold(x)) continue;
          ++held;
          if (deep == 0) deep = hold_deep(x, depth);
        }
      }
    }
    return {held, deep};
  }
};

/// The volume of an overlap of two shapes, 0 where they do not overlap.
PetscErrorCode overlap_of(MPI_Comm comm, Filled& a, Filled& b, int dim, double* volume) {
  PetscFunctionBeginUser;
  *volume = 0;
  const Samples samples(a, b, dim);
  if (!samples.any) PetscFunctionReturn(PETSC_SUCCESS);
  std::array<long, 2> found{};
  PetscCallCXX(found = (Pair{a, b, dim, directions_of(dim)}.count(samples, rank_of(comm), size_of(comm))));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, found.data(), 2, MPI_LONG, MPI_SUM, comm));
  if (found[1] == 0) PetscFunctionReturn(PETSC_SUCCESS);
  *volume = static_cast<double>(found[0]);
  for (int d = 0; d < dim; ++d) *volume *= samples.step[d];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/// Bodies and rigids by one number each: bodies first.
struct Things {
  const Config& config;
  int bodies, all;

  explicit Things(const Config& c)
      : config(c),
        bodies(static_cast<int>(c.bodies.size())),
        all(bodies + static_cast<int>(c.rigids.size())) {}
  bool is_body(int n) const { return n < bodies; }
  const std::string& name(int n) const {
    return is_body(n) ? config.bodies[n].name : config.rigids[n - bodies].name;
  }
  /// Whether it is in the run in this stage.
  bool is_there(int n) const {
    return is_body(n) ? !config.bodies[n].absent && !config.bodies[n].removed
                      : !config.rigids[n - bodies].absent;
  }
  /// Whether this stage places it.
  bool is_placed(int n) const {
    const auto& list = is_body(n) ? config.stage.place : config.stage.place_rigids;
    return std::find(list.begin(), list.end(), is_body(n) ? n : n - bodies) != list.end();
  }
  /// Whether -A_cut_out has b.
  bool cuts(int b, int a) const {
    if (!is_body(a)) return false;
    const BodyConfig& body = config.bodies[a];
    const auto& list = is_body(b) ? body.cut_out_bodies : body.cut_out;
    return std::find(list.begin(), list.end(), is_body(b) ? b : b - bodies) != list.end();
  }
  /// Places of the particles that a file lists [m, packed by dim]; none where the file is not sound.
  std::vector<double> places_in_file(const BodyConfig& body) const {
    ParticleTable table;
    const bool sound = read_particles(source_of(body), config.mesh, config.dim, table).empty();
    return sound ? std::move(table.position) : std::vector<double>{};
  }
  /// Space that it fills as it is placed.
  std::unique_ptr<Filled> as_placed(int n) const {
    if (!is_body(n))
      return std::make_unique<Filled>(config.rigids[n - bodies].shape, std::vector<Shape>{}, config.mesh,
                                      config.dim);
    const BodyConfig& body = config.bodies[n];
    const auto holes = cut_out_of(config, body);
    if (body.shape.kind == ShapeKind::particles)
      return std::make_unique<Filled>(body.shape, places_in_file(body), false, holes, config.mesh,
                                      config.dim);
    return std::make_unique<Filled>(body.shape, holes, config.mesh, config.dim);
  }
  /// Space that it fills when the stage begins.
  std::unique_ptr<Filled> as_it_is(int n, const Present& present) const {
    if (is_placed(n)) return as_placed(n);
    if (is_body(n))
      return std::make_unique<Filled>(config.bodies[n].shape, present.soil[n], true, std::vector<Shape>{},
                                      config.mesh, config.dim);
    auto filled = as_placed(n);
    filled->move(present.rigids[n - bodies]);
    return filled;
  }
};

/// The overlaps of those that fill something, in pairs that `looks`(a, b) takes. Rigids may overlap.
template <class Looks>
PetscErrorCode look_at_pairs(MPI_Comm comm, const Things& things,
                             const std::vector<std::unique_ptr<Filled>>& filled, const Looks& looks,
                             std::vector<Overlap>* overlaps) {
  PetscFunctionBeginUser;
  for (int a = 0; a < things.bodies; ++a)
    for (int b = a + 1; b < things.all; ++b) {
      if (!filled[a] || !filled[b] || !looks(a, b)) continue;
      Overlap overlap;
      PetscCall(overlap_of(comm, *filled[a], *filled[b], things.config.dim, &overlap.volume));
      if (overlap.volume == 0) continue;
      const bool second = things.is_body(b) && filled[b]->volume > filled[a]->volume;
      overlap.body = second ? b : a;
      overlap.other = things.name(second ? a : b);
      overlap.pair = {a, b};
      overlaps->push_back(overlap);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::string volume_text(const Overlap& overlap, const Config& config) {
  return formatted("%.4g %s", overlap.volume, config.dim == 2 ? "m2" : "m3");
}

}  // namespace

PetscErrorCode find_overlaps(MPI_Comm comm, const Config& config, std::vector<Overlap>* overlaps) {
  PetscFunctionBeginUser;
  const Things things(config);
  std::vector<std::unique_ptr<Filled>> filled(things.all);
  for (int n = 0; n < things.all; ++n)
    if (things.is_there(n)) PetscCallCXX(filled[n] = things.as_placed(n));
  PetscCall(look_at_pairs(
      comm, things, filled, [](int, int) { return true; }, overlaps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode find_overlaps_of_placed(MPI_Comm comm, const Config& config, const std::vector<char>& fixed,
                                       std::vector<Overlap>* overlaps) {
  PetscFunctionBeginUser;
  const Things things(config);
  std::vector<std::unique_ptr<Filled>> filled(things.all);
  for (int n = 0; n < things.all; ++n)
    if (things.is_placed(n) || (!things.is_body(n) && things.is_there(n) && fixed[n - things.bodies]))
      PetscCallCXX(filled[n] = things.as_placed(n));
  const auto looks = [&](int a, int b) { return things.is_placed(b) || !things.cuts(b, a); };
  PetscCall(look_at_pairs(comm, things, filled, looks, overlaps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode find_overlaps_at_stage(MPI_Comm comm, const Config& config, const Present& present,
                                      std::vector<Overlap>* overlaps) {
  PetscFunctionBeginUser;
  const Things things(config);
  std::vector<std::unique_ptr<Filled>> filled(things.all);
  for (int n = 0; n < things.all; ++n) {
    const bool gone = things.is_body(n) && !things.is_placed(n) && present.soil[n].empty();
    if (things.is_there(n) && !gone) PetscCallCXX(filled[n] = things.as_it_is(n, present));
  }
  const auto looks = [&](int a, int b) {
    const bool one = things.is_placed(a), other = things.is_placed(b);
    return one && other ? true : (one || other) && !things.cuts(a, b) && !things.cuts(b, a);
  };
  PetscCall(look_at_pairs(comm, things, filled, looks, overlaps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

std::vector<char> cut_at_stage(const Config& config, int body, const Present& present,
                               const std::vector<double>& position) {
  const Things things(config);
  const int dim = config.dim;
  std::vector<char> out(position.size() / dim);
  for (int n = 0; n < things.all; ++n) {
    const bool meet = things.is_placed(n) != things.is_placed(body);  // both are there from now on
    const bool gone = things.is_body(n) && !things.is_placed(n) && present.soil[n].empty();
    if (!meet || gone || !things.is_there(n) || !things.cuts(n, body)) continue;
    const std::unique_ptr<Filled> filled = things.as_it_is(n, present);
    for (std::size_t p = 0; p < out.size(); ++p) {
      Vec3 x{};
      std::copy_n(&position[p * dim], dim, x.begin());
      filled->enter_row(x[dim - 1], x[dim - 1]);
      if (filled->holds(x)) out[p] = 1;
    }
  }
  return out;
}

std::vector<std::string> describe(const std::vector<Overlap>& overlaps, const Config& config) {
  constexpr std::size_t k_most = 10;
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < std::min(k_most, overlaps.size()); ++k) {
    const BodyConfig& body = config.bodies[overlaps[k].body];
    std::vector<std::string> names;
    for (const int rigid : body.cut_out) names.push_back(config.rigids[rigid].name);
    for (const int other : body.cut_out_bodies) names.push_back(config.bodies[other].name);
    lines.push_back("mpm: -" + body.name +
                    "_cut_out: " + (names.empty() ? "not given" : "given \"" + join(names) + "\"") +
                    ", takes " + overlaps[k].other + (names.empty() ? "" : " too") +
                    ", or shapes that do not overlap: " + body.name + " and " + overlaps[k].other + " have " +
                    volume_text(overlaps[k], config) + " in common");
  }
  return lines;
}

std::string describe_at_stage(const std::vector<Overlap>& overlaps, const Config& config) {
  const Things things(config);
  std::vector<std::string> parts;
  for (const Overlap& overlap : overlaps) {
    const auto [a, b] = overlap.pair;
    const int placed = things.is_placed(a) ? a : b, other = placed == a ? b : a;
    const int cut = things.is_body(placed) ? placed : other;
    parts.push_back(things.name(placed) + " has " + volume_text(overlap, config) + " in common with " +
                    things.name(other) + " (-" + things.name(cut) + "_cut_out " +
                    things.name(cut == placed ? other : placed) + " leaves out " + things.name(cut) +
                    " there)");
  }
  return "stage " + config.stage.name +
         " places what is in the place of something else: " + join(parts, ", ");
}

}  // namespace mpm
