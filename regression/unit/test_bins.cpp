// Patches, bins and the order of the points: where everything is after an upload and after a rebuild.

#include <catch2/catch_test_macros.hpp>
#include <numeric>
#include <set>

#include "compare.hpp"
#include "data/footprint.hpp"
#include "data/state_memory.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Fault of the bins of a set of points; empty if there is none.
template <class Space, class T, int Dim, class Set>
std::string fault_of_bins(const State<Space, T, Dim>& s, const Set& set) {
  const auto begin = on_host(set.bins.begin), active_slots = on_host(set.bins.active_slots);
  const auto cell = on_host(set.points.cell), id = on_host(set.points.id);
  const auto x = on_host(set.points.coordinate);
  const int cells = s.patches.node_count();
  std::set<int> ids;
  for (int c = 0; c < cells; ++c)
    for (int p = begin(c); p < begin(c + 1); ++p) {
      if (cell(p) != c) return "a point is in the range of another cell";
      if (p > begin(c) && id(p - 1) >= id(p)) return "points of a cell are not in the order of their ids";
      for (int d = 0; d < Dim; ++d)
        if (!(x(p)[d] >= 0 && x(p)[d] < 1)) return "a point is outside its cell";
      ids.insert(id(p));
    }
  if (begin(0) != 0 || begin(cells) != set.points.count) return "the ranges do not hold every point";
  if (static_cast<int>(ids.size()) != set.points.count || *ids.rbegin() != set.points.count - 1)
    return "an id is missing";

  std::set<int> slots;
  for (int n = set.bins.first_active; n < set.bins.last_active; ++n) {
    const int slot = active_slots(n);
    if (n > set.bins.first_active && active_slots(n - 1) >= slot) return "slots do not rise";
    if (begin(slot * Patch<Dim>::cells) == begin((slot + 1) * Patch<Dim>::cells))
      return "an empty slot is listed";
    slots.insert(slot);
  }
  for (int p = 0; p < set.points.count; ++p)
    if (!slots.count(cell(p) / Patch<Dim>::cells)) return "a slot that holds points is not listed";
  return "";
}

/// Fault of the patch table; empty if there is none.
template <class Space, class T, int Dim>
std::string fault_of_patches(const State<Space, T, Dim>& s) {
  const auto slot_of = on_host(s.patches.slot_of);
  const auto origin = on_host(s.patches.origin);
  const auto neighbours = on_host(s.patches.neighbours);
  std::set<int> holding;
  const auto note = [&](const auto& set) {
    const auto cell = on_host(set.points.cell);
    for (int p = 0; p < set.points.count; ++p) holding.insert(cell(p) / Patch<Dim>::cells);
  };
  note(s.soil);
  for (const auto& set : s.rigid_points) note(set);

  int active = 0;
  for (long n = 0; n < s.grid.patch_count(); ++n) {
    if (slot_of(n) < 0) continue;
    ++active;
    if (s.grid.patch_of(origin(slot_of(n))) != n) return "a patch's slot has another patch's origin";
    if (s.grid.patch_of(s.grid.origin_of(n)) != n) return "origin_of is not the inverse of patch_of";
  }
  if (active != s.patches.slots) return "not every slot belongs to a patch";
  const auto& patches = s.grid.patches;
  const int shortest = static_cast<int>(std::min_element(patches.c, patches.c + Dim) - patches.c);
  for (int slot = 0; slot < active; ++slot) {
    const int next = neighbours(slot, Patch<Dim>::neighbours / 2 + power(3, shortest));
    if (next >= 0 && next != slot + 1)
      return "slots do not count the direction with the fewest patches first";
    bool needed = false;
    for (int k = 0; k < Patch<Dim>::neighbours; ++k) {
      const int other = neighbours(slot, k);
      if (other < 0) {
        if (holding.count(slot)) return "a patch that holds points lacks a patch of its ring";
        continue;
      }
      needed = needed || holding.count(other);
      for (int d = 0, rest = k; d < Dim; ++d, rest /= 3)
        if (origin(other)[d] - origin(slot)[d] != (rest % 3 - 1) * Patch<Dim>::edge)
          return "a patch around is elsewhere";
      if (neighbours(other, Patch<Dim>::neighbours - 1 - k) != slot)
        return "a neighbour does not list its neighbour";
    }
    if (!needed) return "a patch is active that no point can reach";
  }
  return "";
}

template <class Space, class T, int Dim>
std::string fault_of(const State<Space, T, Dim>& s) {
  std::string fault = fault_of_patches(s) + fault_of_bins(s, s.soil);
  for (const auto& set : s.rigid_points) fault += fault_of_bins(s, set);
  return fault;
}

/// Gives plastic_strain and volume, which an upload makes uniform, a value for each id.
template <class Space, class T, int Dim>
void mark_by_id(const State<Space, T, Dim>& s) {
  const auto id = on_host(s.soil.points.id);
  const auto& column = s.soil.points.history.column[VonMises<T>::plastic_strain];
  const auto plastic_strain = on_host(column), volume = on_host(s.soil.points.volume);
  for (int p = 0; p < s.soil.points.count; ++p)
    plastic_strain(p) = id(p) + T(0.5), volume(p) = id(p) + T(0.25);
  Kokkos::deep_copy(column, plastic_strain);
  Kokkos::deep_copy(s.soil.points.volume, volume);
}

template <class Space, class T, int Dim>
std::vector<int> order_of(const State<Space, T, Dim>& s) {
  const auto id = on_host(s.soil.points.id);
  return {id.data(), id.data() + s.soil.points.count};
}

/// Moves every point by up to a cell, soil points towards the middle of the mesh and the rigids upwards; some
/// points to so little below their cell that 1 minus it rounds to 1.
template <class Space, class T, int Dim>
void move_points(const State<Space, T, Dim>& s) {
  const auto& soil = s.soil.points;
  const auto x = on_host(soil.coordinate);
  const auto cell = on_host(soil.cell), id = on_host(soil.id);
  const auto origin = on_host(s.patches.origin);
  for (int p = 0; p < soil.count; ++p)
    for (int d = 0; d < Dim; ++d) {
      const int at = origin(cell(p) / Patch<Dim>::cells)[d] + coord_of<Dim>(cell(p))[d];
      const double far = std::fabs(drift_of(id(p), d, 1.0));
      x(p)[d] = id(p) % 7 == 0 && at > 0 ? T(-1e-20)
                                         : static_cast<T>(x(p)[d] + (at < s.grid.cells[d] / 2 ? far : -far));
    }
  Kokkos::deep_copy(soil.coordinate, x);
  const auto rigids = on_host(s.rigids);
  for (std::size_t r = 0; r < rigids.extent(0); ++r)
    for (int d = 0; d < Dim; ++d) rigids(r).motion.pose.displacement[d] += 0.6 * s.spacing;
  Kokkos::deep_copy(s.rigids, rigids);
}

}  // namespace

TEST_CASE("every point is in its cell's range, in order, and every patch has its ring", "[bins]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    for (int seed : {1, 2, 3}) {
      INFO(build.name() << " seed " << seed);
      auto s = state_of<B>(random_cloud<B::dim>(seed));
      CHECK(fault_of(s) == "");
      for (int n = 0; n < 3; ++n) {
        move_points(s);
        rebuild(s);
        REQUIRE(read_control(s).fault_count == 0);
        CHECK(fault_of(s) == "");
      }
    }
  });
}

TEST_CASE("a rebuild leaves every point where it is", "[bins]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    auto s = state_of<B>(random_cloud<B::dim>(6));
    move_points(s);
    const auto soil = download_soil(s).position;
    rebuild(s);
    double moved = 0;
    const auto after = download_soil(s).position;
    for (std::size_t n = 0; n < soil.size(); ++n)
      moved = std::max(moved, std::fabs(after[n] - soil[n]) / s.spacing);
    CHECK(moved < B::of(1e-14 * 45, 1.5e-7));  // the round-off of a position, and of a coordinate up to 2
  });
}

TEST_CASE("every field goes with its particle", "[bins]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    Cloud cloud = random_cloud<B::dim>(8);
    cloud.affine = true;
    give_own_domains<B::dim>(cloud, 3);
    auto s = state_of<B>(cloud);
    mark_by_id(s);
    const auto soil = carried_fields(s.soil.points);
    REQUIRE(soil.size() == 11);
    // The order after an upload is already not that of creation: compare with the input.
    std::size_t id = 0, wrong = 0;
    for (std::size_t b = 0; b < cloud.bodies.size(); ++b)
      for (std::size_t p = 0; p < strength_of(cloud.bodies[b]).size(); ++p, ++id) {
        wrong += soil[0].value[id * B::dim] != typename B::real(cloud.bodies[b].velocity[p * B::dim]);
        wrong += soil[4].value[id] != typename B::real(strength_of(cloud.bodies[b])[p]);
        wrong += soil[5].value[id] != double(b);
      }
    CHECK(wrong == 0);
    std::vector<Table> homes;
    for (const auto& set : s.rigid_points) homes.push_back(carried_fields(set.points)[0]);
    const auto order = order_of(s);
    move_points(s);
    locate(s), sort_and_list(s);  // domains would follow the soil
    CHECK(order_of(s) != order);
    CHECK(carried_fields(s.soil.points) == soil);
    for (std::size_t r = 0; r < homes.size(); ++r)
      CHECK(carried_fields(s.rigid_points[r].points)[0] == homes[r]);
  });
}

TEST_CASE("the order of the points does not depend on the backend, the number of threads or the order before",
          "[bins]") {
  for_each_reference([](auto reference) {
    constexpr int Dim = decltype(reference)::dim;
    const Cloud cloud = random_cloud<Dim>(9);
    auto expected = state_of<Reference<Dim>>(cloud);
    const auto uploaded = order_of(expected);
    move_points(expected);
    rebuild(expected);
    for_each_build([&](auto build) {
      using B = decltype(build);
      if constexpr (B::dim == Dim && B::is_double) {
        for (const auto& space : {B::space(), with_other_threads<B>()}) {
          INFO(build.name() << ' ' << space.concurrency() << " threads");
          auto s = state_of<B>(cloud, P2G::sequential, space);
          CHECK(order_of(s) == uploaded);
          for (int n = 0; n < 2; ++n) rebuild(s);
          CHECK(order_of(s) == uploaded);
          move_points(s);
          rebuild(s);
          CHECK(order_of(s) == order_of(expected));
        }
      }
    });
  });
}

TEST_CASE("positions come back from an upload, far from the mesh's corner too", "[bins]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    INFO(build.name());
    const double spacing = 0.1;
    Cloud cloud;
    cloud.grid = grid_of<Dim>({100000, 20, 12}, spacing, Wall::roller);  // 10 km
    cloud.materials = clays();
    Dice dice{std::mt19937_64(21)};
    std::vector<double> position;
    const double length[] = {10000, 2, 1.2};
    for (int n = 0; n < 2000 * Dim; ++n)
      position.push_back(dice.uniform(0, length[n % Dim]) * (n < 1000 ? 1 - 1e-3 / (1 + n) : 1));
    for (int k = 1; k < 500; ++k)
      for (int d = 0; d < Dim; ++d)
        position.push_back(d == 0 ? k * 20.0 : length[d] * k / 500);  // x on nodes
    cloud.bodies = {body_of<Dim>(position, 2, spacing, 0)};
    const auto s = state_of<B>(cloud);
    double largest = 0;
    const auto got = download_soil(s).position;
    REQUIRE(got.size() == position.size());
    for (std::size_t n = 0; n < got.size(); ++n)
      largest = std::max(largest, std::fabs(got[n] - position[n]) / spacing);
    CHECK(largest < B::of(1e-10, 1e-6));
  });
}

TEST_CASE("an upload names the particle that lies outside the mesh", "[bins]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(build.name());
    for (double wrong : {-0.01, 0.81}) {
      Cloud cloud;
      cloud.grid = grid_of<B::dim>({8, 8, 8}, 0.1, Wall::roller);
      cloud.materials = clays();
      cloud.bodies = {body_of<B::dim>(lattice<B::dim>({1, 1, 1}, {3, 3, 3}, 2, 0.1), 2, 0.1, 0)};
      cloud.bodies[0].position[5 * B::dim + 1] = wrong;
      StateOf<B> s;
      s.space = B::space();
      const Fault fault = upload(s, cloud.grid, cloud.materials, cloud.bodies, cloud.rigids);
      CHECK(fault.kind == FaultKind::outside);
      CHECK(fault.particle == 5);
      CHECK(fault.position[1] == wrong);
    }
  });
}

TEST_CASE("the memory of a state is what particles and nodes take, to a tenth", "[bins]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    using Space = typename B::Space;
    using T = typename B::real;
    constexpr int Dim = B::dim;
    const int edge = Dim == 2 ? 200 : 32;  // cells
    Cloud cloud;
    cloud.grid = grid_of<Dim>({edge, edge, edge}, 0.1, Wall::free);
    cloud.materials = clays();
    const std::array<double, 3> end{double(edge), double(edge), double(edge)};
    cloud.bodies = {body_of<Dim>(lattice<Dim>({0, 0, 0}, end, 2, 0.1), 2, 0.1, 1)};
    const auto s = state_of<B>(cloud, P2G::tile);
    const double cells = power(double(edge), Dim);
    const double a_particle = bytes_of_point(s.soil.points) + bytes_to_sort(s.soil.points);
    const double a_cell = a_particle * power(2, Dim) + bytes_of_node(s.nodes, uses_of_nodes(s)) +
                          (has_windows(s.space) ? k_window_bytes<T, Dim> : 0);
    const double expected = a_cell * cells;
    INFO(build.name());
    CHECK(std::fabs(memory_of<Space, T, Dim>(s) / expected - 1) < (Dim == 2 ? 0.1 : 0.2));
  });
}
