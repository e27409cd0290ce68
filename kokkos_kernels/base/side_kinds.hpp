#pragma once
// Kinds of sides of the mesh: their words (-mesh_xmin ...), and the numbers that they take (-mesh_xmin_KEY).
// The options, their help and their checks, the configuration and the kernels follow these tables.

#include <limits>

namespace mpm {

/// Condition at one side of the mesh (-mesh_xmin ...): roller, no velocity normal to the side; fixed, no
/// velocity; free, nothing; friction, a roller with friction along it; absorbing, dashpots; free_field,
/// dashpots between the soil and a column of it that moves as the ground beside; periodic, the opposite side.
/// In kernels a roller or fixed side that moves is `driven`, and periodic sides are free sides of a mesh with
/// a period (Grid). Checkpoints hold these numbers.
enum class Wall { periodic = -1, roller, fixed, free, friction, absorbing, driven, free_field };
/// Whether the soil goes on beyond a side as its mirror image; beyond sides that act, it moves as the side's
/// nodes do.
constexpr bool is_mirror(Wall wall) { return wall == Wall::roller || wall == Wall::fixed; }
constexpr bool is_acting(Wall wall) { return wall > Wall::free; }
/// Whether dashpots hold the soil at a side.
constexpr bool has_dashpots(Wall wall) { return wall == Wall::absorbing || wall == Wall::free_field; }
/// Whether a side gives the soil no force.
constexpr bool is_open(Wall wall) { return wall == Wall::free || wall == Wall::periodic; }
/// Whether a side takes a velocity of its own.
constexpr bool may_move(Wall wall) {
  return is_mirror(wall) || wall == Wall::friction || wall == Wall::absorbing;
}

/// A word of -mesh_xmin ..., and what then holds at the side.
struct SideWord {
  const char* word;
  Wall kind;
  const char* meaning;
};
inline constexpr SideWord k_side_words[] = {
    {"roller", Wall::roller, "no normal velocity"},
    {"fixed", Wall::fixed, "no velocity at all"},
    {"free", Wall::free, "nothing"},
    {"friction", Wall::friction, "no velocity into it, and friction along it"},
    {"smooth", Wall::friction, "no velocity into it"},
    {"absorbing", Wall::absorbing, "dashpots that absorb waves"},
    {"free_field", Wall::free_field, "dashpots to a column that moves as the free field beside"},
    {"periodic", Wall::periodic, "the opposite side, which is periodic too"},
};
/// Kind with the largest number.
inline constexpr Wall k_last_wall = [] {
  Wall last = Wall::driven;
  for (const SideWord& of : k_side_words) last = of.kind > last ? of.kind : last;
  return last;
}();

inline constexpr double k_no_limit = std::numeric_limits<double>::infinity();

/// Numbers of a side beside its kind and its velocity.
struct SideNumbers {
  double friction = 0;              // -
  double shear_limit = k_no_limit;  // Pa
  double dashpot_factor = 1;        // -
  double spring_length = 0;         // m; 0: no springs
};

/// The option -mesh_xmin_KEY ... of one of them.
struct SideNumber {
  const char* key;
  double SideNumbers::*member;
  bool (*of)(Wall);  // kinds that take it; `smooth` takes none
  const char *unit, *meaning;
  double highest;        // the lowest is 0
  bool positive;         // 0 itself is not accepted
  const char* standard;  // the default in words, where it is no number; else empty
  bool required = false;
};
inline constexpr SideNumber k_side_numbers[] = {
    {"friction", &SideNumbers::friction, [](Wall kind) { return kind == Wall::friction; }, "-",
     "friction: coefficient of friction, tan of the angle", 1e3, false, "", true},
    {"shear_limit", &SideNumbers::shear_limit, [](Wall kind) { return kind == Wall::friction; }, "Pa",
     "friction: largest shear stress along the side", 1e15, false, "none"},
    {"dashpot_factor", &SideNumbers::dashpot_factor, has_dashpots, "-",
     "absorbing, free_field: factor of the dashpots rho c", 1e3, false, ""},
    {"spring_length", &SideNumbers::spring_length, has_dashpots, "m",
     "absorbing, free_field: length L of springs rho c^2 / L beside the dashpots, against drift", 1e9, true,
     "no springs"},
};

}  // namespace mpm
