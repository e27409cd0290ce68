// Contact at sites: the gap along a line to a particle's box, the list of sites, and the impulse of a site.

#include <catch2/catch_test_macros.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "physics/contact_site.hpp"
#include "physics/face_distance.hpp"

namespace {

using namespace mpm;
using Site = ContactSite<double, 2>;

constexpr ContactLaw k_smooth{.at_sites = true,
                              .separates = true,
                              .reach = 0,
                              .exponent = 6,
                              .shear_limit = 0,
                              .shear_fraction = -1,
                              .friction = -1};
constexpr double k_none = std::numeric_limits<double>::infinity();

/// A site whose face looks along y, with an impulse of the step before.
Site site_of(double press, double shear, double gap = 0) {
  Site site{};
  site.normal = {0, 1};
  site.gap = gap;
  site.inverse_mass = 0.5;  // 1/kg
  site.part = 1;
  site.press = press, site.shear = {shear, 0};
  return site;
}

}  // namespace

TEST_CASE("the gap of a site is that to the near side of a particle's box, wherever the line enters it",
          "[contact_sites]") {
  const Vector<double, 2> half{0.25, 0.2}, up{0, 1};
  for (double off : {-0.25, -0.1, 0.0, 0.2, 0.25})
    for (double below : {0.1, 0.3, 0.45})  // cells, from the face to the middle of the box
      CHECK(std::fabs(gap_to_box<double, 2>({off, -below}, up, half) - (below - 0.2)) < 1e-14);
  CHECK(gap_to_box<double, 2>({0.4, -0.3}, up, half) == k_none);  // beside the box
  CHECK(gap_to_box<double, 2>({0, -1.3}, up, half) == k_none);    // too far ahead
  const double c = std::sqrt(0.5);
  CHECK(std::fabs(gap_to_box<double, 2>({-0.5, -0.5}, {c, c}, {0.25, 0.25}) - 0.25 * std::sqrt(2.0)) < 1e-14);
}

TEST_CASE("no site in touch with a box is left out before its gap is computed", "[contact_sites]") {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> any(-1.5, 1.5), length(0.1, 0.5);
  int touching = 0;
  for (int n = 0; n < 100000; ++n) {
    const Vector<double, 3> from{any(engine), any(engine), any(engine)};
    const Vector<double, 3> half{length(engine), length(engine), length(engine)};
    Vector<double, 3> normal{any(engine), any(engine), any(engine)};
    const double size = std::sqrt(dot(normal, normal));
    for (int d = 0; d < 3; ++d) normal[d] /= size;
    if (!(gap_to_box(from, normal, half) < SiteReach::touch)) continue;
    ++touching;
    CHECK(may_meet_box(from, normal, half));
  }
  CHECK(touching > 1000);
}

TEST_CASE("the bits of nodes in a box are those of all patches that it lies in", "[contact_sites]") {
  for (int low = -3; low <= 2; ++low)
    for (int high = low - 1; high <= 6; ++high) {
      const Coord<3> from{low, 0, -1}, to{high, 1, 5};
      int found = 0;
      for (int k = 0; k < Patch<3>::neighbours; ++k) {
        const std::uint64_t bits = nodes_between(k, from, to);
        for (int place = 0; place < Patch<3>::cells; ++place) {
          if ((bits >> place & 1) == 0) continue;
          ++found;
          Coord<3> c = coord_of<3>(place);
          for (int d = 0, rest = k; d < 3; rest /= 3, ++d) {
            c[d] += (rest % 3 - 1) * Patch<3>::edge;
            CHECK((from[d] <= c[d] && c[d] <= to[d]));
          }
        }
      }
      CHECK(found == (high - low + 1) * 2 * 7);
    }
}

TEST_CASE("the distance to faces is that on either side, and of the nearest part", "[contact_sites]") {
  Surface<2> disc{};
  disc.kind = SurfaceKind::disc, disc.centre = {1, 1}, disc.radius = 0.5;
  SurfaceTables<Kokkos::HostSpace, 2> tables;
  tables.parts = decltype(tables.parts)("parts", 2);
  tables.parts(0) = disc;
  disc.centre = {3, 1};
  tables.parts(1) = disc;
  Surface<2> both{};
  both.kind = SurfaceKind::parts, both.count = 2;
  CHECK(std::fabs(distance_to_faces(disc, tables, {3, 1.2}) - 0.3) < 1e-14);
  CHECK(std::fabs(distance_to_faces(disc, tables, {3, 2}) - 0.5) < 1e-14);
  CHECK(std::fabs(distance_to_faces(both, tables, {1, 1.4}) - 0.1) < 1e-14);
  CHECK(std::fabs(distance_to_faces(both, tables, {2.4, 1}) - 0.1) < 1e-14);
}

TEST_CASE("keys of gaps have the order of the gaps and then of the ranks, and give both back",
          "[contact_sites]") {
  const double gaps[] = {-0.7, -1e-9, -0.0, 0.0, 1e-12, 0.2, 0.5};
  for (double a : gaps)
    for (int rank : {0, 1, 65535}) {
      const std::uint64_t key = GapKey::of(a, rank);
      CHECK(std::fabs(GapKey::gap(key) - a) <= 2e-11 * std::fabs(a));
      CHECK(GapKey::rank(key) == rank);
      CHECK((key > GapKey::none && key < GapKey::open));
      for (double b : gaps)
        if (a < b) CHECK(key < GapKey::of(b, 0));
    }
  CHECK(GapKey::of(0.2, 3) < GapKey::of(0.2, 4));
}

TEST_CASE("a site stops soil that comes nearer, no faster than the gap allows, and lets go what leaves",
          "[contact_sites]") {
  const SiteInterface<double> interface { 0, 1, 100, 0 };
  Site site = site_of(0, 0);
  CHECK(resolve(site, k_smooth, {0.3, -2}, interface)[1] == 4);  // kg m/s: 2 m/s over 0.5 / kg
  CHECK(site.press == 4);
  CHECK(site.shear[0] == 0);
  site = site_of(0, 0, 0.01);  // m: 1 m/s close it in a step
  CHECK(std::fabs(resolve(site, k_smooth, {0, -2}, interface)[1] - 2) < 1e-14);
  site = site_of(3, 0);
  CHECK(resolve(site, k_smooth, {0, 5}, interface)[1] == -3);
  CHECK(site.press == 0);
  ContactLaw glued = k_smooth;
  glued.separates = false;
  site = site_of(3, 0);
  CHECK(resolve(site, glued, {0, 5}, interface)[1] == -10);
  CHECK(site.press == -7);
}

TEST_CASE("the shear of a site ends the slip up to its limit, and friction up to its share of the press",
          "[contact_sites]") {
  Site site = site_of(4, 0);
  CHECK(std::fabs(resolve(site, k_smooth, {0.1, 0}, {k_none, 1, 100, 0})[0] + 0.2) < 1e-14);  // rough
  site = site_of(4, 0);
  CHECK(std::fabs(resolve(site, k_smooth, {9, 0}, {0.5, 1, 100, 0})[0] + 0.5) < 1e-14);
  ContactLaw law = k_smooth;
  law.friction = 0.2;
  site = site_of(4, 0);
  CHECK(std::fabs(resolve(site, law, {9, 0}, {k_none, 1, 100, 0})[0] + 0.2 * 4) < 1e-14);
  site = site_of(4, 0);
  CHECK(std::fabs(resolve(site, law, {9, 8}, {k_none, 1, 100, 0})[0]) < 1e-14);  // it has left: no friction
  site = site_of(0, 0);  // a face that round-off presses has no shear, unless soil beside it is pressed
  CHECK(resolve(site, k_smooth, {1, -1e-12}, {5, 1, 100, 0})[0] == 0);
  site = site_of(0, 0);
  CHECK(std::fabs(resolve(site, k_smooth, {1, 0}, {5, 1, 100, 3})[0] + 2) < 1e-14);
}
