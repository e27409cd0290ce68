// Particles to nodes: every strategy gives what the plain loop gives, on every backend, real type and
// dimension.

#include <catch2/catch_test_macros.hpp>
#include <map>
#include <set>

#include "compare.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

constexpr int k_seeds[] = {1, 2, 7};

/// Nodal fields after the particles have drifted up to the margin from where they were binned.
template <class B>
std::vector<Table> drifted_fields(const Cloud& cloud, P2G how, const typename B::Space& space = B::space()) {
  auto s = state_of<B>(cloud, how, space);
  drift_within_margin(s);
  interpolate(s);
  return nodal_fields(s);
}

/// Total of one column of a table, and of the magnitudes.
struct Total {
  double sum = 0, size = 0;
};
Total total_of(const Table& table, int column) {
  Total t;
  for (std::size_t n = column; n < table.value.size(); n += table.width) {
    t.sum += table.value[n];
    t.size += std::fabs(table.value[n]);
  }
  return t;
}

/// Notes which of the mosaic's blocks give to a node; the number of nodes that two blocks of one colour
/// share.
template <int Dim>
int shared_nodes(const StateOf<Reference<Dim>>& s) {
  const SoilSource<Processor, double, Dim> source{s.soil.points, s.grid.inv_spacing};
  const auto& bins = s.soil.bins;
  int shared = 0;
  for (int colour = 0; colour < Patch<Dim>::colours; ++colour) {
    std::map<int, long> owner;
    for (int b = bins.block_begin[colour]; b < bins.block_begin[colour + 1]; ++b)
      for_each_cell_of_block(s.grid, bins.blocks(b), s.p2g.mosaic_cells, [&](const Coord<Dim>& c, int) {
        const int slot = s.patches.slot_of(s.grid.patch_of(c));
        if (slot < 0) return;
        const int cell = slot * Patch<Dim>::cells + place_of<Dim>(c);
        for (int p = bins.begin(cell); p < bins.begin(cell + 1); ++p)
          give_to_nodes(source, NodePlaces(s.grid, s.patches), p, [&](int i, int, double) {
            shared += owner.emplace(i, bins.blocks(b)).first->second != bins.blocks(b);
          });
      });
  }
  return shared;
}

}  // namespace

TEST_CASE("every strategy gives the nodal fields of the plain loop in double on one thread", "[strategies]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    for (int seed : k_seeds)
      for (double margin : {0.5, 0.2}) {
        Cloud cloud = random_cloud<Dim>(seed);
        cloud.p2g.margin = margin;
        const auto expected = drifted_fields<Reference<Dim>>(cloud, P2G::sequential);
        REQUIRE(expected.size() == 4);
        for_each_build([&](auto build) {
          using B = decltype(build);
          if constexpr (B::dim == Dim) {
            for (P2G how : k_strategies) {
              INFO(build.name() << ' ' << word_of(how) << " seed " << seed << " margin " << margin);
              CHECK(largest_difference(drifted_fields<B>(cloud, how), expected) < B::of(1e-12, 1e-5));
            }
          }
        });
      }
  });
}

TEST_CASE("the mosaic gives the same nodal fields whatever the edge of its blocks", "[strategies]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    Cloud cloud = random_cloud<Dim>(3);
    const auto expected = drifted_fields<Reference<Dim>>(cloud, P2G::sequential);
    for (int cells : {3, 4, 5, 8}) {
      cloud.p2g.mosaic_cells = cells;
      for_each_build([&](auto build) {
        using B = decltype(build);
        INFO(build.name() << " blocks of " << cells);
        if constexpr (B::dim == Dim)
          CHECK(largest_difference(drifted_fields<B>(cloud, P2G::mosaic), expected) < B::of(1e-12, 1e-5));
      });
    }
  });
}

TEST_CASE("blocks of one colour share no node when every particle has moved by the margin", "[strategies]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    for (int seed : k_seeds)
      for (int cells : {3, 4, 5, 8}) {
        Cloud cloud = random_cloud<Dim>(seed);
        cloud.p2g.mosaic_cells = cells;
        auto s = state_of<Reference<Dim>>(cloud, P2G::mosaic);
        drift_within_margin(s);
        INFO(Dim << "D, blocks of " << cells);
        CHECK(shared_nodes<Dim>(s) == 0);
      }
  });
}

TEST_CASE("every strategy keeps the total mass and momentum, and internal forces in balance",
          "[strategies]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    using S = SoilTerms<Dim>;
    const Cloud cloud = random_cloud<Dim>(5);
    const double tolerance = B::of(1e-13, 1e-6);
    double mass = 0, momentum[3] = {}, size[3] = {};
    for (const BodyInput& body : cloud.bodies) {
      const double m_p = body.density * body.particle_volume;
      mass += m_p * strength_of(body).size();
      for (std::size_t n = 0; n < body.velocity.size(); ++n) {
        momentum[n % Dim] += m_p * body.velocity[n];
        size[n % Dim] += m_p * std::fabs(body.velocity[n]);
      }
    }
    for (P2G how : k_strategies) {
      INFO(build.name() << ' ' << word_of(how));
      const auto fields = drifted_fields<B>(cloud, how);
      CHECK(std::fabs(total_of(fields[0], S::mass).sum / mass - 1) < tolerance);
      for (int d = 0; d < Dim; ++d) {
        CHECK(std::fabs(total_of(fields[0], S::momentum + d).sum - momentum[d]) < tolerance * size[d]);
        const Total force = total_of(fields[0], S::force + d);
        CHECK(force.size > 0);
        CHECK(std::fabs(force.sum) < tolerance * force.size);
      }
      for (std::size_t r = 0; r < cloud.rigids.size(); ++r) {
        const RigidInput& rigid = cloud.rigids[r];
        if (rigid.surface_normal) continue;  // contact does not ask for its mass
        const double rigid_mass = rigid.density * rigid.particle_volume * (rigid.position.size() / Dim);
        CHECK(std::fabs(total_of(fields[1 + r], 0).sum / rigid_mass - 1) < tolerance);
      }
    }
  });
}

TEST_CASE("gather and the plain loop give the same bits on every run and number of threads", "[strategies]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = random_cloud<B::dim>(4);
    for (P2G how : {P2G::sequential, P2G::gather}) {
      INFO(build.name() << ' ' << word_of(how));
      const auto first = drifted_fields<B>(cloud, how);
      for (int run = 0; run < 3; ++run) CHECK(drifted_fields<B>(cloud, how) == first);
      if (B::is_double) CHECK(drifted_fields<B>(cloud, how, with_other_threads<B>()) == first);
    }
  });
}

TEST_CASE("on processors tile gives the bits of one thread whatever the number of threads, step by step",
          "[strategies]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    using Space = typename B::Space;
    using One = OneThread<typename B::real, B::dim>;
    if constexpr (!is_device<Space>) {
      for (const int seed : {3, 4}) {
        Cloud cloud = random_cloud<B::dim>(seed, Wall::roller);
        cloud.gravity = {0, -9.81, 0};
        cloud.f_bar_fraction = seed % 2 ? 0.9 : 0;
        auto expected = state_of<One>(cloud, P2G::tile);
        constexpr double k_dt = 1e-5;  // s
        const int steps = 30, rebuilds = run_steps(expected, k_dt, steps);
        REQUIRE(read_control(expected).fault_count == 0);
        sum_present_soil(expected);
        for (const Space& space : {B::space(), with_other_threads<B>()}) {
          INFO(build.name() << ", " << space.concurrency() << " threads, seed " << seed);
          auto s = state_of<B>(cloud, P2G::tile, space);
          CHECK(run_steps(s, k_dt, steps) == rebuilds);
          sum_present_soil(s);
          CHECK(soil_fields(s) == soil_fields(expected));
          CHECK(nodes_of(s, s.nodes.soil) == nodes_of(expected, expected.nodes.soil));
          const auto ours = on_host(s.rigids), theirs = on_host(expected.rigids);
          for (int r = 0; r < 2; ++r)
            for (int d = 0; d < B::dim; ++d) CHECK(ours(r).impulse[d] == theirs(r).impulse[d]);
        }
      }
    }
  });
}

TEST_CASE("no strategy touches a node while the steps are paused", "[strategies]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (P2G how : k_strategies) {
      INFO(build.name() << ' ' << word_of(how));
      auto s = state_of<B>(random_cloud<B::dim>(2), how);
      interpolate(s);
      const auto before = nodal_fields(s);
      auto control = on_host(s.control);
      control().paused = 1;
      Kokkos::deep_copy(s.control, control);
      interpolate(s);
      CHECK(nodal_fields(s) == before);
    }
  });
}
