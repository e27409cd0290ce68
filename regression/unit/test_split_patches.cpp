// The patches that a GPU updates by kernels of their own: at walls, or with particles that are alone.

#include <catch2/catch_test_macros.hpp>

#include "compare.hpp"
#include "loops/gpu/patch_update.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Soil in a random share of the cells of a mesh that ends amid patches: at walls, far from them, and alone.
template <int Dim>
Cloud scattered(int seed) {
  constexpr double h = 0.1;
  const std::array<int, 3> cells = Dim == 2 ? std::array<int, 3>{43, 36, 1} : std::array<int, 3>{18, 19, 17};
  Dice dice{std::mt19937_64(seed)};
  Cloud cloud;
  cloud.grid = grid_of<Dim>(cells, h, Wall::roller);
  cloud.grid.walls[1] = {Wall::fixed, Wall::free};
  cloud.materials = clays();
  cloud.bodies = {random_body<Dim>(dice, {0, 0, 0}, cells, Dim == 2 ? 0.5 : 0.3, 2, h)};
  cloud.gravity = {0, -9.81, 0};
  return cloud;
}

/// A state as it is before function 5, without the sums of the next step.
template <class B>
StateOf<B> before_update(const Cloud& cloud) {
  auto s = state_of<B>(cloud, P2G::tile);
  interpolate(s);
  mark_strays(s, s.space);
  update_nodes(s, 1e-4);
  return s;
}

/// Patches [first, last) of a list by the kernel that a GPU has for them.
template <PatchKind kind, class Laws, class Space, class T, int Dim>
void update_by_teams(State<Space, T, Dim>& s, const Kokkos::View<int*, typename Space::memory_space>& slots,
                     int first, int last) {
  using Update = UpdateParticles<Space, T, Dim, false, kind, Laws>;
  if (first == last) return;
  Kokkos::parallel_for(typename Update::Team(s.space, last - first, Update::threads)
                           .set_scratch_size(0, Kokkos::PerTeam(Update::bytes() + k_scratch_slack)),
                       update_of<Update>(s, 1e-4, slots, first));
}

}  // namespace

TEST_CASE("common patches near contact of soil bodies are listed before the other ones", "[split_patches]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    INFO(B::name());
    auto s = before_update<B>(scattered<B::dim>(4));
    s.p2g.about_nodes = s.plan.sums_ahead = true;
    s.interfaces.fields = 2;
    s.interfaces.laws = decltype(s.interfaces.laws)("laws", 4);
    s.contact.place = decltype(s.contact.place)("place", s.patches.slots);
    const auto place = Kokkos::create_mirror_view(s.contact.place);
    for (int slot = 0; slot < s.patches.slots; slot += 3) place(slot) = slot / 3 + 1;
    Kokkos::deep_copy(s.contact.place, place);
    split_patches(s, s.space);
    REQUIRE(s.split.parts.size() == 1);
    const auto part = s.split.parts.front();
    const auto slots = on_host(s.split.slots), active = on_host(s.soil.bins.active_slots);
    CHECK(part.first < part.near);
    CHECK(part.near < part.middle);
    CHECK(s.split.has_early());
    CHECK(s.split.holds({s.space, 0, s.soil.bins.last_active}));
    std::vector<int> listed(slots.data() + part.first, slots.data() + part.last);
    for (int n = part.first; n < part.middle; ++n) CHECK((place(slots(n)) != 0) == (n < part.near));
    CHECK(std::is_sorted(listed.begin(), listed.begin() + part.near));
    CHECK(std::is_sorted(listed.begin() + part.near, listed.begin() + part.middle));
    std::sort(listed.begin(), listed.end());
    std::vector<int> all(active.data(), active.data() + s.soil.bins.last_active);
    std::sort(all.begin(), all.end());
    CHECK(listed == all);
  });
}

TEST_CASE("patches are split by walls and by particles that are alone", "[split_patches]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    auto s = before_update<B>(scattered<B::dim>(3));
    s.plan.form = StepForm::overlapped;
    const int held = s.soil.bins.last_active;
    for (const int border : {0, held / 3, held}) {
      INFO(B::name() << " border " << border);
      s.soil.bins.border = border;
      split_patches(s, s.space);
      const bool parted = border > 0 && border < held;
      REQUIRE(s.split.parts.size() == (parted ? 2u : 1u));
      CHECK(s.split.has_early());
      CHECK(s.split.holds({s.space, 0, held}));
      CHECK(s.split.holds({s.space, border, held}));
      CHECK_FALSE(s.split.holds({s.space, 0, held - 1}));
      const auto slots = on_host(s.split.slots), active = on_host(s.soil.bins.active_slots);
      const auto origin = on_host(s.patches.origin);
      const auto alone = on_host(s.strays.alone);
      int at = 0, commons = 0, lone = 0;
      for (const auto& part : s.split.parts) {
        CHECK(part.first == at);
        at = part.last;
        std::vector<int> common, others;
        for (int n = part.first; n < part.last; ++n) {
          const bool wall = reaches_wall(s.grid, origin(active(n)));
          const bool is_common = !wall && alone(active(n)) == 0;
          lone += !wall && !is_common, commons += is_common;
          if (is_common)
            common.push_back(active(n));
          else
            others.insert(others.begin(), active(n));
        }
        common.insert(common.end(), others.begin(), others.end());
        CHECK(part.middle - part.first == static_cast<int>(common.size() - others.size()));
        CHECK(std::equal(common.begin(), common.end(), slots.data() + part.first));
      }
      CHECK(at == held);
      CHECK(lone > 0);
      CHECK(commons > 0);
    }
  });
}

TEST_CASE("kernels for common patches and for light laws do what those for all do", "[split_patches]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = scattered<B::dim>(5);
    auto whole = before_update<B>(cloud), split = before_update<B>(cloud), step = before_update<B>(cloud);
    INFO(B::name());
    REQUIRE(whole.light_laws);
    const int held = whole.soil.bins.last_active;
    const auto active = whole.soil.bins.active_slots;
    update_by_teams<PatchKind::any, Materials>(whole, active, 0, held);
    split_patches(split, split.space);
    const auto part = split.split.parts.at(0);
    update_by_teams<PatchKind::any, LightMaterials>(split, split.split.slots, part.middle, part.last);
    update_by_teams<PatchKind::common, LightMaterials>(split, split.split.slots, part.first, part.middle);
    CHECK(largest_difference(soil_fields(split), soil_fields(whole)) < B::of(1e-13, 1e-5));
    CHECK(largest_difference(carried_fields(split.soil.points), carried_fields(whole.soil.points)) <
          B::of(1e-12, 1e-4));
    update_particles(step, 1e-4);
    CHECK(largest_difference(soil_fields(step), soil_fields(whole)) < B::of(1e-12, 1e-4));
  });
}
