// Several ranks against one: run by mpirun on 2, 3 and 4 ranks (and on 1, where there is nothing to share).

#include <mpi.h>

#include <algorithm>
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <cmath>
#include <limits>

#include "clouds.hpp"
#include "common/collectives.hpp"
#include "parallel/decomposition.hpp"
#include "parallel/kept_by_id.hpp"
#include "step/follow_soil.hpp"
#include "step/step.hpp"
#include "transfer/velocity_gradients.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// An owner for each patch, drawn at random: far more neighbours than any real partition has.
Owners random_owners(long patches, int ranks, int seed) {
  Dice dice{std::mt19937_64(seed)};
  Owners owners;
  for (long n = 0; n < patches; ++n) owners.push_back(dice.below(ranks));
  return owners;
}

/// Every n-th particle of a cloud, with the ids that they have in it.
template <int Dim>
Cloud share_of_cloud(const Cloud& whole, int rank, int ranks) {
  const auto keep = [&](std::vector<double>& values, int width) {
    std::vector<double> kept;
    for (std::size_t k = 0; k < values.size(); ++k)
      if (static_cast<int>(k / width % ranks) == rank) kept.push_back(values[k]);
    values = kept;
  };
  Cloud own = whole;
  int first = 0;
  for (BodyInput& body : own.bodies) {
    const int count = static_cast<int>(strength_of(body).size());
    for (int p = rank; p < count; p += ranks) body.id.push_back(first + p);
    first += count;
    if (whole.affine) {  // from all neighbours of a particle
      std::vector<double> cells = body.position;
      for (double& x : cells) x /= whole.grid.spacing;
      body.velocity_gradient = velocity_gradients(cells, body.velocity, Dim);
      keep(body.velocity_gradient, Dim * Dim);
    }
    keep(body.position, Dim), keep(strength_of(body), 1), keep(body.velocity, Dim);
    keep(body.stress, sym_size<Dim>), keep(body.mass, 1), keep(body.domain, Dim * (Dim + 1) / 2);
  }
  return own;
}

/// Moves particles at the walls inwards, so that none leaves the mesh in a few steps.
template <int Dim>
void keep_inside(Cloud& cloud) {
  constexpr double k_inside = 0.3;  // cells
  for (BodyInput& body : cloud.bodies)
    for (std::size_t k = 0; k < body.position.size(); ++k) {
      const double end = (cloud.grid.cells[k % Dim] - k_inside) * cloud.grid.spacing;
      body.position[k] = std::clamp(body.position[k], k_inside * cloud.grid.spacing, end);
    }
}

/// A cloud on all ranks together, brought to its owners, and the same on each rank alone.
template <class B>
struct Pair {
  StateOf<B> alone, here;
  Decomposition<typename B::Space, typename B::real, B::dim> ranks;

  Pair(const Cloud& cloud, const PartitionConfig& config, int seed, P2G how = P2G::gather) {
    const int rank = rank_of(MPI_COMM_WORLD), size = size_of(MPI_COMM_WORLD);
    alone = state_of<B>(cloud, how);
    Cloud share = share_of_cloud<B::dim>(cloud, rank, size);
    share.f_bar_fraction = 0;  // a cell's particles are still on several ranks
    here = state_of<B>(share, how);
    here.f_bar.fraction = cloud.f_bar_fraction;
    const Owners owners = random_owners(alone.grid.patches_of_field(), size, seed);
    REQUIRE(ranks.start(MPI_COMM_WORLD, config, owners, here) == PETSC_SUCCESS);
  }
};

/// Values of a field at all nodes of the grid where `reached`, `empty` elsewhere.
template <class State_, class Field>
std::vector<double> dense(const State_& s, const Field& field, int size, const std::vector<char>& reached,
                          double empty) {
  constexpr int cells = 64;
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), field);
  const auto origin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), s.patches.origin);
  std::vector<double> all(s.grid.patch_count() * cells * size, empty);
  for (int i = 0; i < s.patches.node_count(); ++i)
    for (int k = 0; k < size && reached[i]; ++k)
      all[(s.grid.patch_of(origin(i / cells)) * cells + i % cells) * size + k] = host(i, k);
  return all;
}

/// Which nodes hold mass.
template <class State_>
std::vector<char> with_mass(const State_& s) {
  const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), s.nodes.soil);
  std::vector<char> reached;
  for (int i = 0; i < s.patches.node_count(); ++i) reached.push_back(host(i, 0) != 0);
  return reached;
}

/// Fields of all particles by id, from all ranks.
template <class State_>
std::vector<double> particles_of(const State_& s, long total, MPI_Comm comm) {
  const SoilFields f = download_soil(s);
  const std::size_t vectors = f.position.size() + f.velocity.size() + f.stress.size();
  const std::size_t width = f.id.empty() ? 0 : vectors / f.id.size() + f.history.size() + 2;
  unsigned long all_width = width;
  MPI_Allreduce(MPI_IN_PLACE, &all_width, 1, MPI_UNSIGNED_LONG, MPI_MAX, comm);
  std::vector<double> values(total * all_width);
  for (std::size_t p = 0; p < f.id.size(); ++p) {
    double* to = &values[f.id[p] * all_width];
    const auto put = [&](const std::vector<double>& from) {
      const std::size_t n = from.size() / f.id.size();
      for (std::size_t k = 0; k < n; ++k) *to++ = from[p * n + k];
    };
    put(f.position), put(f.velocity), put(f.stress), put(f.volume);
    for (const auto& column : f.history) put(column);
    *to = 1;  // how often the id is there
  }
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
  return values;
}

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0, difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(largest, std::abs(b[k]));
    difference = std::max(difference, std::abs(a[k] - b[k]));
  }
  return difference / largest;
}

}  // namespace

TEST_CASE("nodal sums of several ranks are those of one, with the same bits wherever a node is shared",
          "[halo]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    for (const int seed : {1, 2}) {
      Pair<B> pair(random_cloud<B::dim>(seed), {}, seed);
      auto& s = pair.here;
      sum_present_soil(pair.alone);
      sum_present_soil(s);
      const std::vector<char> reached = with_mass(s);
      REQUIRE(pair.ranks.add_soil(s) == PETSC_SUCCESS);
      REQUIRE(pair.ranks.drain() == PETSC_SUCCESS);
      const int size = SoilTerms<B::dim>::size;
      constexpr double far = std::numeric_limits<double>::max();
      std::vector<double> least = dense(s, s.nodes.soil, size, reached, far),
                          most = dense(s, s.nodes.soil, size, reached, -far);
      const int count = static_cast<int>(least.size());
      MPI_Allreduce(MPI_IN_PLACE, least.data(), count, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
      MPI_Allreduce(MPI_IN_PLACE, most.data(), count, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
      long differing = 0;
      for (int k = 0; k < count; ++k) {
        if (least[k] == far) least[k] = most[k] = 0;  // no rank reaches it
        differing += least[k] != most[k];
      }
      CHECK(differing == 0);
      CHECK(apart(least, dense(pair.alone, pair.alone.nodes.soil, size, with_mass(pair.alone), 0)) < 1e-13);
    }
  });
}

TEST_CASE("every particle is on the rank that owns its patch, once, with all its fields", "[migration]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    for (const bool affine : {false, true}) {
      Cloud cloud = random_cloud<B::dim>(4);
      cloud.affine = affine;
      Pair<B> pair(cloud, {}, 5);
      const long total = pair.alone.soil.points.count;
      CHECK(particles_of(pair.here, total, MPI_COMM_WORLD) == particles_of(pair.alone, total, MPI_COMM_SELF));
      const auto address =
          Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), pair.here.soil.points.cell);
      const auto origin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), pair.here.patches.origin);
      for (int p = 0; p < pair.here.soil.points.count; ++p) {
        const long patch = pair.here.grid.patch_of(origin(address(p) / Patch<B::dim>::cells));
        REQUIRE(pair.ranks.owners()[patch] == rank_of(MPI_COMM_WORLD));
      }
    }
  });
}

TEST_CASE("steps, rebuilds and patches that change hands leave the particles as on one rank", "[migration]") {
  struct Way {
    P2G strategy;
    HaloPath path;
    bool overlap;
  };
  const Way way = GENERATE(Way{P2G::gather, HaloPath::host, true}, Way{P2G::tile, HaloPath::host, true},
                           Way{P2G::tile, HaloPath::device, true}, Way{P2G::tile, HaloPath::peer, true},
                           Way{P2G::tile, HaloPath::peer, false});
  for_each_reference([&](auto build) {
    using B = decltype(build);
    for (const int kind :
         {0, 1, 2, 3, 4, 5}) {  // FLIP, XPIC, APIC, FLIP with own masses, in two velocity fields, own domains
      Cloud cloud = random_cloud<B::dim>(3, Wall::roller);
      cloud.gravity = {0, -9.81, 0};
      keep_inside<B::dim>(cloud);
      cloud.f_bar_fraction = 0.5;
      if (kind != 1) cloud.materials[1].f_bar_share = 0.4;
      if (kind == 1) cloud.xpic_order = 3, cloud.flip_fraction = 0;
      if (kind == 2) cloud.affine = true, cloud.flip_fraction = 0;
      if (kind == 3) give_own_masses(cloud, 3, 0.6);
      if (kind == 5) give_own_domains<B::dim>(cloud, 3);
      if (kind == 4)
        cloud.bodies[1].velocity_field = cloud.bodies[3].velocity_field = 1, cloud.rigids.clear();
      Pair<B> pair(cloud, {PartitionKind::metis, 1.0001, way.path, way.overlap}, 6, way.strategy);
      constexpr double k_dt = 1e-5;  // s: lone particles bear stresses that throw them far
      Timers timers;
      REQUIRE(timers.create() == PETSC_SUCCESS);
      for (int n = 1; n <= 12; ++n) {
        REQUIRE(step(pair.alone, timers, k_dt) == PETSC_SUCCESS);
        REQUIRE(step(pair.here, timers, k_dt, &pair.ranks) == PETSC_SUCCESS);
        REQUIRE(pair.ranks.drain() == PETSC_SUCCESS);
        if (n % 4 != 0) continue;
        rebuild(pair.alone);
        REQUIRE(follow_soil(pair.here, &pair.ranks) == PETSC_SUCCESS);
        locate(pair.here);
        REQUIRE(pair.ranks.rebuild(pair.here) == PETSC_SUCCESS);
        begin_domains(pair.here);
      }
      INFO(B::name() << ", velocity update " << kind << ", path " << static_cast<int>(way.path));
      const long total = pair.alone.soil.points.count;
      const auto a = particles_of(pair.here, total, MPI_COMM_WORLD);
      const auto b = particles_of(pair.alone, total, MPI_COMM_SELF);
      CHECK((read_control(pair.here).fault_count == 0 && read_control(pair.alone).fault_count == 0));
      CHECK(apart(a, b) < 1e-11);
      const auto here = take_rigids(pair.here), alone = take_rigids(pair.alone);
      for (std::size_t r = 0; r < cloud.rigids.size(); ++r)
        for (int d = 0; d < B::dim; ++d)
          CHECK(std::abs(here[r].motion.velocity[d] - alone[r].motion.velocity[d]) < 1e-11);
    }
  });
}

TEST_CASE("friction's impulses follow the nodes to the ranks that come to reach them", "[migration]") {
  for_each_reference([](auto build) {
    using B = decltype(build);
    Pair<B> pair(random_cloud<B::dim>(7), {PartitionKind::metis, 1.0001}, 9);
    const auto set = [](auto& s) {  // a value of this node alone
      const auto origin = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), s.patches.origin);
      const auto host = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), s.nodes.impulse);
      for (int i = 0; i < s.patches.node_count(); ++i)
        for (int r = 0; r < static_cast<int>(host.extent(0)); ++r)
          host(r, i) =
              1 + r + s.grid.patch_of(origin(i / Patch<B::dim>::cells)) * 64. + i % Patch<B::dim>::cells;
      Kokkos::deep_copy(s.nodes.impulse, host);
    };
    set(pair.here);
    locate(pair.here);
    REQUIRE(pair.ranks.rebuild(pair.here) == PETSC_SUCCESS);
    const auto now = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), pair.here.nodes.impulse);
    StateOf<B> wanted = pair.here;
    Kokkos::resize(wanted.nodes.impulse, 0, 0);
    wanted.nodes.impulse = decltype(wanted.nodes.impulse)("impulse", now.extent(0), now.extent(1));
    set(wanted);
    const auto expected = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), wanted.nodes.impulse);
    sum_present_soil(pair.here);
    const std::vector<char> reached = with_mass(pair.here);
    for (int i = 0; i < pair.here.patches.node_count(); ++i)
      for (int r = 0; r < static_cast<int>(now.extent(0)) && reached[i]; ++r)
        REQUIRE(now(r, i) == expected(r, i));
  });
}

TEST_CASE("values that are kept by id reach whichever rank asks, whoever gave them", "[migration]") {
  const int rank = rank_of(MPI_COMM_WORLD), size = size_of(MPI_COMM_WORLD);
  const auto number_of = [](long id) { return 1.0 / (3 + id); };
  for (const long total : {0L, 1L, 2L, 17L, 1000L}) {
    Dice dice{std::mt19937_64(total)};  // the same on all ranks
    std::vector<long> given, asked;
    std::vector<double> numbers, found, expected;
    for (long id = total - 1; id >= 0; --id)
      if (dice.below(size) == rank) given.push_back(id), numbers.push_back(number_of(id));
    KeptById kept;
    REQUIRE(kept.keep(MPI_COMM_WORLD, total, given, numbers) == PETSC_SUCCESS);
    for (int n = 0; n < 20 * ((rank + 1) % 3) && total > 0; ++n) asked.push_back((7L * n + rank) % total);
    for (const long id : asked) expected.push_back(number_of(id));
    REQUIRE(kept.look_up(asked, &found) == PETSC_SUCCESS);
    CHECK(found == expected);
    REQUIRE(kept.look_up(given, &found) == PETSC_SUCCESS);
    CHECK(found == numbers);
  }
}

TEST_CASE("ranks agree on an error and on the words of one of them", "[halo]") {
  const int rank = rank_of(MPI_COMM_WORLD), size = size_of(MPI_COMM_WORLD);
  CHECK(agree(MPI_COMM_WORLD, rank == size - 1 ? PETSC_ERR_FILE_WRITE : PETSC_SUCCESS) ==
        PETSC_ERR_FILE_WRITE);
  CHECK(agree(MPI_COMM_WORLD, PETSC_SUCCESS) == PETSC_SUCCESS);
  std::string text = rank == 0 && size > 1 ? "" : "rank " + std::to_string(rank);
  REQUIRE(share_text(MPI_COMM_WORLD, &text) == PETSC_SUCCESS);
  CHECK(text == (size > 1 ? "rank 1" : "rank 0"));
}

TEST_CASE("lists are rebuilt in time, with a reserve for what is not yet known", "[halo]") {
  const double margin = 0.5, speed = 0.01;
  CHECK_FALSE(rebuild_due(0.40, speed, margin, GlobalBound::k_late));
  CHECK(rebuild_due(0.475, speed, margin, GlobalBound::k_late));
  CHECK_FALSE(rebuild_due(0.475, speed, margin, 0));
  CHECK(rebuild_due(NAN, speed, margin, 0));
}

TEST_CASE("the bound of all ranks is the sum of what the fastest of each step moved, as on one rank",
          "[migration]") {
  const int rank = rank_of(MPI_COMM_WORLD), size = size_of(MPI_COMM_WORLD);
  const auto increment = [&](int step, int r) { return step % size == r ? 0.03 : 0.01; };
  GlobalBound bound;
  double own = 0, all_steps = 0;
  for (int step = 1; step <= 10; ++step) {  // posts what was before it: first the time before a rebuild
    BoundReport all;
    bool known = false;
    const double last = step > 1 ? increment(step - 1, rank) : 0.3;
    if (step > 1) own += last;
    REQUIRE(bound.post(MPI_COMM_WORLD, {own, last, 0}) == PETSC_SUCCESS);
    REQUIRE(bound.last_but_one(&known, &all) == PETSC_SUCCESS);
    if (step > 2) all_steps += 0.03;
    CHECK(known == (step > 1));
    CHECK(all.bound == all_steps);
  }
  REQUIRE(bound.drain() == PETSC_SUCCESS);
}
