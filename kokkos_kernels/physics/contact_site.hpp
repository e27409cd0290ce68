#pragma once
// Contact at a site (docs/method.md, "Contact at sites"): the soil that it meets, and its impulse.

#include "data/contact_law.hpp"
#include "data/contact_sites.hpp"
#include "physics/contact.hpp"

namespace mpm {

/// Lengths of contact at sites [cells].
struct SiteReach {
  static constexpr double layer = 0.5;      // thickness of the layer of sites outside the face, along an axis
  static constexpr double behind = -0.75;   // from the face: soil that far in the body is found
  static constexpr double ahead = 1;        // and that far before it
  static constexpr double touch = 0.5;      // gap from which on a site has no contact
  static constexpr double near = 1.25;      // particles farther from the face meet no site
  static constexpr double inflated = 1.25;  // box of a particle, over its domain
  static constexpr double edge = 0.05;      // from the rounded edges of a body, where it has no sites
  static constexpr double round = 1;        // radius from which on a rounded edge is a face
  static constexpr double facing = 0.1;     // cosine between the face of a site and the one nearest to soil
  static constexpr double cling = 0.05;     // gap up to which soil that may not part is held

  /// From the middle of a node's sites to the farthest of them.
  template <int Dim>
  static constexpr double of_node = Dim == 2 ? 0.36 : 0.44;
  static constexpr double distance = 0.25;  // by which a distance to a face may be wrong, and round-off
};

/// Gap [cells] from a point of the face, `from` [cells, from the middle of a box], along the normal to the
/// surface of the box with these half lengths [cells]; infinite where the line misses the box. The line finds
/// a larger box, so that it does not slip between two particles.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T gap_to_box(const Vector<T, Dim>& from, const Vector<T, Dim>& normal,
                                    const Vector<T, Dim>& half) {
  constexpr T k_parallel = T(1e-9), none = Kokkos::Experimental::infinity<T>::value;
  T begin = SiteReach::behind, end = SiteReach::ahead, inflation = 0;
  for (int d = 0; d < Dim; ++d) {
    const T reach = T(SiteReach::inflated) * half[d];
    inflation += (reach - half[d]) * Kokkos::fabs(normal[d]);
    if (Kokkos::fabs(normal[d]) < k_parallel) {
      if (Kokkos::fabs(from[d]) > reach) return none;
      continue;
    }
    const T low = (-reach - from[d]) / normal[d], high = (reach - from[d]) / normal[d];
    begin = Kokkos::fmax(begin, Kokkos::fmin(low, high));
    end = Kokkos::fmin(end, Kokkos::fmax(low, high));
  }
  return begin <= end ? begin + inflation : none;
}

/// Whether gap_to_box may find the box so near that they touch: most sites near a particle miss it.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool may_meet_box(const Vector<T, Dim>& from, const Vector<T, Dim>& normal,
                                         const Vector<T, Dim>& half) {
  constexpr T k_round_off = T(1e-5), behind = SiteReach::behind, ahead = SiteReach::touch;
  bool may = true;
  for (int d = 0; d < Dim; ++d) {
    const T one = from[d] + behind * normal[d], other = from[d] + ahead * normal[d];
    const T reach = T(SiteReach::inflated) * half[d] + k_round_off;
    may = may && Kokkos::fmin(one, other) <= reach && Kokkos::fmax(one, other) >= -reach;
  }
  return may;
}

/// Change of a site's impulse on the soil [N s] in a sweep.
template <class T, int Dim>
using Impulse = Vector<T, Dim>;

/// Interface at a site, as its contact takes it.
template <class T>
struct SiteInterface {
  T shear;    // N s, limit of the shear impulse, infinite where only friction limits
  T fresh;    // -, weight of the step in the mean normal impulse
  T inv_dt;   // 1/s, of the length of the step
  T pressed;  // N s, normal impulse of the sites round this one so far
};

/// Largest shear impulse [N s] of a site whose normal impulse is `press`, where soil without it slides by so
/// much [m/s]. Shear acts where the soil round the site is pressed on the body, but for round-off.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION T largest_shear(const ContactSite<T, Dim>& site, const ContactLaw& law, T press,
                                       T slip, const SiteInterface<T>& interface) {
  constexpr T k_along = T(1e-6);  // of the slip: a motion along the face is along it but for round-off
  if (law.friction < 0) {
    const T pressed = Kokkos::fmax(press, interface.pressed) * site.inverse_mass;
    return !law.separates || pressed > k_along * slip ? interface.shear : T(0);
  }
  Pressed<T> pressed{site.sum, site.weight, site.store};
  return Kokkos::fmin(interface.shear, T(law.friction) * usable_impulse(pressed, interface.fresh, press));
}

/// Brings the impulse of a site towards the one with which soil and body do not interpenetrate, where `v` is
/// the soil's velocity over the body's [m/s]. Returns the change. The gap may close in the step.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION Impulse<T, Dim> resolve(ContactSite<T, Dim>& site, const ContactLaw& law,
                                               const Vector<T, Dim>& v, const SiteInterface<T>& interface) {
  const T away = dot(v, site.normal);
  const T leaves_open = law.separates ? Kokkos::fmax(T(0), site.gap) * interface.inv_dt : T(0);
  T press = site.press - (away + leaves_open) / site.inverse_mass;
  if (law.separates) press = Kokkos::fmax(T(0), press);
  Vector<T, Dim> along;
  for (int d = 0; d < Dim; ++d) along[d] = site.shear[d] - (v[d] - away * site.normal[d]) / site.inverse_mass;
  const T size = Kokkos::sqrt(dot(along, along));
  const T largest = largest_shear(site, law, press, size * site.inverse_mass, interface);
  const T factor = size > largest ? largest / size : T(1);
  Impulse<T, Dim> change;
  for (int d = 0; d < Dim; ++d) {
    along[d] *= factor;
    change[d] = (press - site.press) * site.normal[d] + along[d] - site.shear[d];
    site.shear[d] = along[d];
  }
  site.press = press;
  return change;
}

}  // namespace mpm
