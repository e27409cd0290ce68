#pragma once
// Particles for tests, described once and put on every execution space, real type and dimension.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "data/state.hpp"
#include "functions/energy_works.hpp"
#include "functions/follow_soil.hpp"
#include "functions/step_kernels.hpp"
#include "physics/materials/any.hpp"
#include "rebuild/rebuild_state.hpp"
#include "transfer/download.hpp"
#include "transfer/upload.hpp"
#include "transfer/upload_flow.hpp"
#include "transfer/upload_loads.hpp"

namespace mpm::test {

/// While one of these lives, processors run the tests of for_each_build on several threads.
class SeveralThreads {
 public:
  explicit SeveralThreads(bool several = true) { use_ = several; }
  SeveralThreads(const SeveralThreads&) = delete;
  SeveralThreads& operator=(const SeveralThreads&) = delete;
  ~SeveralThreads() { use_ = false; }
  static bool in_use() { return use_; }

 private:
  static inline bool use_ = false;
};

/// The words for a build in messages, "serial double 2D".
std::string name_of_build(Backend backend, bool is_double, int dim);

/// One of the builds of the kernels. one_thread: on processors, whatever SeveralThreads says.
template <class Space_, class T, int Dim, bool one_thread = false>
struct Build {
  using Space = Space_;
  using real = T;
  static constexpr int dim = Dim;
  static constexpr bool is_double = sizeof(T) == sizeof(double);
  /// The tolerance that belongs to the real type.
  static constexpr double of(double for_double, double for_single) {
    return is_double ? for_double : for_single;
  }
  static Backend backend() {
    if (is_device<Space>) return Backend::cuda;
    return one_thread || !SeveralThreads::in_use() ? Backend::serial : Backend::openmp;
  }
  static Space space() { return space_of<Space>(backend()); }
  static std::string name() { return name_of_build(backend(), is_double, Dim); }
};
template <class T, int Dim>
using OneThread = Build<Processor, T, Dim, true>;
template <int Dim>
using Reference = OneThread<double, Dim>;

/// A State whose special members are compiled once, in clouds.cpp: in a test they would be half of the code.
template <class Space, class T, int Dim>
struct HeldState : State<Space, T, Dim> {
  HeldState();
  HeldState(const HeldState&);
  HeldState(HeldState&&) noexcept;
  HeldState& operator=(const HeldState&);
  HeldState& operator=(HeldState&&) noexcept;
  ~HeldState();
};
template <class B>
using StateOf = HeldState<typename B::Space, typename B::real, B::dim>;

// Applies X(Space, T, Dim) to what unit tests run on: with MPM_TEST_EVERY_BUILD to all that the kernels are
// built for, else on processors not to single precision, which whole runs test.
#ifdef MPM_TEST_EVERY_BUILD
#define MPM_FOR_TESTED_ON_PROCESSOR(X) MPM_FOR_EACH_REAL_DIM(X, Processor)
#else
#define MPM_FOR_TESTED_ON_PROCESSOR(X) MPM_FOR_EACH_DIM(X, Processor, double)
#endif
#define MPM_FOR_TESTED(X) MPM_FOR_TESTED_ON_PROCESSOR(X) MPM_FOR_CUDA(X)

/// Calls f(Build) for what is tested, on processors with one thread and then with several.
template <class F>
void for_each_build(F&& f) {
#ifdef MPM_WITH_OPENMP
  constexpr int k_most = 2;
#else
  constexpr int k_most = 1;
#endif
#define MPM_TEST_BUILD(Space, T, Dim) f(Build<Space, T, Dim>{});
  for (int n = 0; n < k_most; ++n) {
    const SeveralThreads threads(n > 0);
    MPM_FOR_TESTED_ON_PROCESSOR(MPM_TEST_BUILD)
  }
  MPM_FOR_CUDA(MPM_TEST_BUILD)
#undef MPM_TEST_BUILD
}
/// Calls f(Build) for each dimension of the reference.
template <class F>
void for_each_reference(F&& f) {
#define MPM_TEST_BUILD(Space, T, Dim) f(Build<Space, T, Dim, true>{});
  MPM_FOR_EACH_DIM(MPM_TEST_BUILD, Processor, double)
#undef MPM_TEST_BUILD
}

/// The space of a build with another number of threads, where it has threads to number.
template <class B>
typename B::Space with_other_threads() {
#ifdef MPM_WITH_OPENMP
  if constexpr (!is_device<typename B::Space>) return typename B::Space(B::space().concurrency() > 1 ? 1 : 2);
#endif
  return B::space();
}

inline constexpr P2G k_strategies[] = {P2G::sequential, P2G::atomic, P2G::mosaic, P2G::gather, P2G::tile};

/// Everything that a State is made of, on the host.
struct Cloud {
  GridInput grid;
  std::vector<MaterialInput> materials;
  std::vector<BodyInput> bodies;
  std::vector<RigidInput> rigids;
  P2GPlan p2g{P2G::sequential, 0.5, 3};
  std::array<double, 3> gravity{};
  double flip_fraction = 1, damping = 0, f_bar_fraction = 0;
  int xpic_order = 0;
  bool affine = false;
  bool rings = false;                                // the particles are rings about x = 0
  bool stretch = false, split = false;               // the domains of particles; those that are too long
  bool energy = false;                               // an energy balance
  int face_count = 0;                                // loads that a particle is on at most
  std::vector<std::array<double, 4>> surface_loads;  // Pa: pressure and traction of each
  double memory_limit = 0;                           // bytes, for batches of the soil
  FlowInput flow;                                    // of water in pores
};

/// The cloud uploaded, sorted into bins, with its loads; throws where a particle lies outside the mesh.
template <class Space, class T, int Dim>
HeldState<Space, T, Dim> state_on(const Space& space, const Cloud& cloud, P2G how);
template <class B>
StateOf<B> state_of(const Cloud& cloud, P2G how = P2G::sequential,
                    const typename B::Space& space = B::space()) {
  return state_on<typename B::Space, typename B::real, B::dim>(space, cloud, how);
}

/// A mesh with the same wall on every side.
template <int Dim>
GridInput grid_of(std::array<int, 3> cells, double spacing, Wall wall);

/// Model 0 linear_elastic, model 1 von_mises, of the footing's clay.
std::vector<MaterialInput> clays();
inline constexpr double k_density = 500;

/// A lattice of n particles along each edge of a cell in the box [low, high), in cells.
template <int Dim>
std::vector<double> lattice(std::array<double, 3> low, std::array<double, 3> high, int n, double spacing);

/// Undrained shear strength of each particle of a body of clay [Pa].
std::vector<double>& strength_of(BodyInput& body);
const std::vector<double>& strength_of(const BodyInput& body);

/// Gives each particle of a body an excess pore pressure [Pa] beside its effective stress.
template <int Dim>
void give_excess_pressure(BodyInput& body, std::vector<double> excess);

template <int Dim>
BodyInput body_of(std::vector<double> position, int per_cell, double spacing, int material);
template <int Dim>
RigidInput rigid_of(std::vector<double> position, int per_cell, double spacing);

/// The particles of all bodies as rings: a roller at the axis, and the volumes and masses of whole rings.
void revolve(Cloud& cloud);

/// Random numbers that are the same everywhere.
struct Dice {
  std::mt19937_64 engine;
  double uniform(double low, double high) { return low + (high - low) * ((engine() >> 11) * 0x1p-53); }
  int below(int n) { return static_cast<int>(engine() % n); }
};

/// Random particles in a share of the cells of [low, high). Some lie exactly on a node, in the middle of a
/// cell, or where the shape function changes its branch.
template <int Dim>
BodyInput random_body(Dice& dice, std::array<int, 3> low, std::array<int, 3> high, double share, int per_cell,
                      double spacing);

/// Gives each particle a mass of its own, at most this share above or below that of its body.
void give_own_masses(Cloud& cloud, int seed, double spread);

/// Gives each particle a domain of its own, of half lengths from 0.1 to 0.5 cells, and sheared.
template <int Dim>
void give_own_domains(Cloud& cloud, int seed);

/// Bodies of 1 to 4 particles a cell edge: in the first and the last cells of the mesh, dense in the middle,
/// and sparse with empty patches between; two rigids, one with a limited shear, one dynamic with friction.
template <int Dim>
Cloud random_cloud(int seed, Wall wall = Wall::free);

}  // namespace mpm::test
