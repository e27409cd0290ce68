#pragma once
// Sites of contact: points fixed in the grid, half a cell apart, at which a rigid body and the soil exchange
// impulses (physics/contact_site.hpp).

#include <cstdint>

#include "base/spaces.hpp"
#include "base/types.hpp"
#include "data/site_list.hpp"
#include "data/site_terms.hpp"

namespace mpm {

/// A site in a step.
template <class T, int Dim>
struct ContactSite {
  Vector<T, Dim> normal;    // -, out of the body
  Vector<T, Dim> place;     // cells from the site's node: on the body's face, and then where the soil is
  Vector<T, Dim> velocity;  // m/s, of the body there
  T share[k_sites<Dim>];    // -, of the nodes round the place in an impulse
  T part;                   // -, of it in the mesh: planes of symmetry halve it
  T gap;                    // m, from the face to the soil
  T inverse_mass;           // 1/kg, against impulses of all sites at once; 0: there is no contact
  T press;                  // N s, normal impulse on the soil in this step
  Vector<T, Dim> shear;     // N s, impulse along the face
  T sum, weight, store;     // of the normal impulses before this step
};

/// Sums at the nodes over sites, as whole numbers, which do not depend on the order of their terms: the
/// momentum that sites have for a node, how many sites a node serves, and the momentum that it has been given
/// in this step.
template <int Dim>
struct SiteSums {
  static constexpr int momentum = 0, sites = Dim, given = Dim + 1, size = 2 * Dim + 1;
};

/// The sites of the nodes in a list.
template <class Space, class T, int Dim>
struct ContactSites {
  using Memory = typename Space::memory_space;
  bool in_use = false;                               // some rigid body touches the soil at sites
  double mass = 0;                                   // kg, of the order of that of a full node
  int rank = 0;                                      // this one
  SiteList<Space> list;                              // of nodes, from a rebuild to the next
  Kokkos::View<ContactSite<T, Dim>*, Memory> sites;  // [node of the list][site of it]
  Kokkos::View<std::uint64_t*, Memory> gaps;         // of the sites, as GapKey
  Kokkos::View<std::int64_t * [SiteSums<Dim>::size], Kokkos::LayoutRight, Memory>
      sums;  // [contact slot][node of it]
};

/// Gaps [cells] as whole numbers of the same order, to 2^-36 of them, with the rank of the soil that is so
/// near in the last bits: of equal gaps that of the lowest rank is the least. none: there is no site.
struct GapKey {
  static constexpr std::uint64_t none = 0, open = ~std::uint64_t(0), ranks = 0xffff;
  KOKKOS_INLINE_FUNCTION static std::uint64_t of(double gap, int rank) {
    const auto bits = Kokkos::bit_cast<std::uint64_t>(gap);
    const std::uint64_t ordered = bits >> 63 ? ~bits : bits | std::uint64_t(1) << 63;
    return (ordered & ~ranks) | static_cast<std::uint64_t>(rank);
  }
  KOKKOS_INLINE_FUNCTION static double gap(std::uint64_t key) {
    key &= ~ranks;
    return Kokkos::bit_cast<double>(key >> 63 ? key & ~(std::uint64_t(1) << 63) : ~key);
  }
  KOKKOS_INLINE_FUNCTION static int rank(std::uint64_t key) { return static_cast<int>(key & ranks); }
};

}  // namespace mpm
