#pragma once
// How far places are from the faces of a rigid body.

#include "physics/surface.hpp"

namespace mpm {

/// Distance [m] of x to the faces of a body, on either side of them, or less: it changes by no more than the
/// way of a point, also where a face on the mesh's boundary is none. Ground by heights gives no such
/// distance, so it counts as near everywhere. x, tables: as in distance_to.
template <int Dim, class Tables>
KOKKOS_INLINE_FUNCTION double distance_to_faces(const Surface<Dim>& body, const Tables& tables,
                                                const Vector<double, Dim>& x) {
  const bool several = body.kind == SurfaceKind::parts;
  const Surface<Dim>* part = several ? &tables.parts(body.first) : &body;
  const int count = several ? body.count : 1;
  double least = Kokkos::Experimental::infinity_v<double>;
  MPM_ROLLED
  for (int n = 0; n < count; ++n)
    least = part[n].kind == SurfaceKind::heights
                ? 0
                : Kokkos::fmin(least, Kokkos::fabs(distance_to_part(part[n], tables, x).value));
  return least;
}

}  // namespace mpm
