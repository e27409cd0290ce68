#include "step/rigid_inertia.hpp"

#include <petscblaslapack.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "input/geometry/mass_properties.hpp"

namespace mpm {
namespace {

/// A tensor of inertia [kg m2]: xx, yy, zz, xy, yz, zx.
using Inertia = std::array<double, 6>;

/// Inertia of a homogeneous body of a mass [kg] about a point [m].
Inertia inertia_about(const MassProperties& of, double mass, const Vec3& point) {
  const Vec3 r{of.centre[0] - point[0], of.centre[1] - point[1], of.centre[2] - point[2]};
  const double square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
  Inertia inertia{};
  for (int d = 0; d < 3; ++d) {
    inertia[d] = mass * (of.inertia[d] / of.volume + square - r[d] * r[d]);
    inertia[3 + d] = mass * (of.inertia[3 + d] / of.volume - r[d] * r[(d + 1) % 3]);
  }
  return inertia;
}

/// Quaternion of the rotation that takes the axes of space to three orthogonal axes.
std::array<double, 4> quaternion_of(const double (&axis)[3][3]) {
  // The largest of four squares is at least 1, so that no small number divides (Shepperd 1978).
  const double trace = axis[0][0] + axis[1][1] + axis[2][2];
  const std::array<double, 4> squares{1 + trace, 1 + 2 * axis[0][0] - trace, 1 + 2 * axis[1][1] - trace,
                                      1 + 2 * axis[2][2] - trace};
  const auto k = std::max_element(squares.begin(), squares.end()) - squares.begin();
  const double twice = std::sqrt(squares[k]), share = 1 / (2 * twice);  // of the largest component
  const auto skew = [&](int d) { return axis[(d + 1) % 3][(d + 2) % 3] - axis[(d + 2) % 3][(d + 1) % 3]; };
  std::array<double, 4> q{};
  q[k] = twice / 2;
  for (int d = 0; d < 3; ++d) {
    if (k == 0)
      q[1 + d] = share * skew(d);
    else if (d + 1 != k)
      q[1 + d] = share * (axis[d][k - 1] + axis[k - 1][d]);
  }
  if (k > 0) q[0] = share * skew(static_cast<int>(k) - 1);
  return q;
}

/// Principal moments and axes of a tensor.
void set_principal(const Inertia& tensor, RigidTurning& to) {
  double m[3][3] = {{tensor[0], tensor[3], tensor[5]}, {0, tensor[1], tensor[4]}, {0, 0, tensor[2]}};
  double work[26];
  PetscBLASInt n = 3, room = 26, info = 0;
  // LAPACK stores a matrix by columns: it reads the lower triangle here, and leaves axis k in row k.
  LAPACKsyev_("V", "L", &n, &m[0][0], &n, to.principal.data(), work, &room, &info);
  if (info != 0 || !(to.principal[0] > 0)) throw std::runtime_error("a rigid body without inertia");
  double right = 0;  // 1 where the axes are right-handed
  for (int d = 0; d < 3; ++d)
    right += m[0][d] * (m[1][(d + 1) % 3] * m[2][(d + 2) % 3] - m[1][(d + 2) % 3] * m[2][(d + 1) % 3]);
  for (int d = 0; d < 3 && right < 0; ++d) m[2][d] = -m[2][d];
  to.axes = quaternion_of(m);
}

/// Distance from a point to the farthest corner of a particle.
double reach_of(const RigidInput& in, int dim, double edge, const Vec3& centre) {
  double square = 0;
  for (std::size_t p = 0; p < in.position.size() / dim; ++p) {
    double own = 0;
    for (int d = 0; d < dim; ++d) {
      const double r = std::abs(in.position[p * dim + d] - centre[d]) + edge / 2;
      own += r * r;
    }
    square = std::max(square, own);
  }
  return std::sqrt(square);
}

}  // namespace

RigidTurning turning_of(const Config& config, const RigidConfig& rigid, const RigidInput& in) {
  RigidTurning to;
  const int dim = config.dim;
  if (!rigid.turns()) return to;
  const double edge = 2 * in.half_length * config.mesh.spacing;
  to.turns = true;
  const MassProperties of =
      whole_properties(rigid.shape, config.mesh, dim).value();  // the options refuse other shapes
  const Vec3 centre = rigid.centre_of_mass.value_or(of.centre);
  for (int d = 0; d < dim; ++d) to.centre[d] = centre[d] - config.mesh.lower[d];
  to.spin = rigid.angular_velocity, to.moment = rigid.moment;
  to.reach = reach_of(in, dim, edge, to.centre);
  const bool dynamic = rigid.motion == Motion::dynamic;
  const double mass = in.density * in.particle_volume * static_cast<double>(in.position.size() / dim);
  const Inertia inertia = rigid.inertia ? *rigid.inertia : inertia_about(of, mass, centre);
  const int free = dynamic ? rigid.free[3] + rigid.free[4] + rigid.free[5] : 0;
  if (dynamic && dim == 2) to.principal = {rigid.inertia ? inertia[0] : inertia[2], 0, 0};
  if (dynamic && dim == 3) set_principal(inertia, to);
  if (free > 0) to.axis = dim == 2 || free == 3 ? 3 : rigid.free[3] ? 0 : rigid.free[4] ? 1 : 2;
  return to;
}

}  // namespace mpm
