// Springs and dashpots that hold a rigid body.

#include "common/text.hpp"
#include "input/options/groups.hpp"

namespace mpm {
namespace {

constexpr const char* k_degrees[] = {"x", "y", "z", "rx", "ry", "rz"};

/// A number for each degree of freedom: x,y,rz in 2D, and x,y,z,rx,ry,rz in 3D.
void read_by_degrees(OptionReader& in, int dim, const Option& option, const RigidConfig& rigid,
                     std::array<double, 6>& value) {
  std::array<double, 6> given{};
  const bool plane = dim == 2;
  if (!in.numbers(option, "x,y,rz", "x,y,z,rx,ry,rz", std::span<double>(given.data(), plane ? 3 : 6))) return;
  if (plane) given = {given[0], given[1], 0, 0, 0, given[2]};
  for (int k = 0; k < 6; ++k)
    if (given[k] != 0 && !rigid.free[k])
      return in.reject(option.name,
                       std::string("0 for ") + k_degrees[k] + ", which is not in -" + rigid.name + "_free");
  value = given;
}

}  // namespace

const std::vector<std::string>& support_keys() {
  static const std::vector<std::string> keys{"stiffness", "viscosity"};
  return keys;
}

void read_support(OptionReader& in, int dim, RigidConfig& rigid) {
  const auto only = in.where(rigid.name + "_motion", {"dynamic"});
  read_by_degrees(
      in, dim,
      {.name = rigid.name + "_stiffness",
       .meaning = "dynamic: stiffness of springs to the ground along and about the axes, about its "
                  "place at the start: x,y,rz in 2D, x,y,z,rx,ry,rz in 3D",
       .unit = "N/m, N m/rad",
       .range = {.lowest = 0, .highest = 1e15},
       .change = k_by_choice},
      rigid, rigid.stiffness);
  read_by_degrees(in, dim,
                  {.name = rigid.name + "_viscosity",
                   .meaning = "dynamic: coefficients of dashpots to the ground, likewise",
                   .unit = "N s/m, N m s/rad",
                   .range = {.lowest = 0, .highest = 1e15},
                   .change = k_by_choice},
                  rigid, rigid.viscosity);
}

}  // namespace mpm
