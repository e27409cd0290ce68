#pragma once
// The sides of the mesh. A roller is a plane of symmetry; a fixed side is one with the opposite sign of what
// moves along it. Beyond it the soil goes on as its mirror image, so that the row of nodes beyond has no sums
// and no motion of its own: what particles give it goes to its image inside, and what they take from it is
// its image's, with the signs of this file. A free side has nodes beyond as any other. Beyond a side that
// acts (data/sides.hpp) the soil moves as the node on the side, which is the image of the node beyond.

#include <type_traits>

#include "base/lanes.hpp"
#include "data/nodes.hpp"

namespace mpm {

/// Which sides of the mesh a node lies on or outside of: bit 2 d + side.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION unsigned sides_of(const Grid<T, Dim>& grid, const Coord<Dim>& node) {
  unsigned sides = 0;
  for (int d = 0; d < Dim; ++d) {
    if (node[d] <= 0) sides |= 1u << (2 * d);
    if (node[d] >= grid.cells[d]) sides |= 2u << (2 * d);
  }
  return sides;
}

/// Velocity (momentum, force) that the walls allow: no normal component at a roller, none at all where fixed.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void apply_walls(const Grid<T, Dim>& grid, unsigned sides, T* v) {
  if (sides == 0) return;
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side) {
      if (!(sides >> (2 * d + side) & 1u)) continue;
      for (int k = 0; k < Dim; ++k)
        if (grid.wall[d][side] == Wall::fixed || (grid.wall[d][side] == Wall::roller && k == d)) v[k] = 0;
    }
}
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void apply_walls(const Grid<T, Dim>& grid, unsigned sides, Vector<T, Dim>& v) {
  apply_walls(grid, sides, v.c);
}

/// Leaves out what the mirrored half beyond rollers cancels of a vector in space, as the soil's boundary.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void cancel_at_rollers(const Grid<T, Dim>& grid, unsigned sides, Vector<T, Dim>& v) {
  for (int d = 0; d < Dim; ++d)
    for (int side = 0; side < 2; ++side)
      if ((sides >> (2 * d + side) & 1u) && grid.wall[d][side] == Wall::roller) v[d] = 0;
}

/// Coordinate along direction d of the image inside of a node that lies beyond a wall; else its own.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION int image_along(const Grid<T, Dim>& grid, int d, int at) {
  if (at < 0 && grid.wall[d][0] != Wall::free) return is_mirror(grid.wall[d][0]) ? -at : 0;
  if (at > grid.cells[d] && grid.wall[d][1] != Wall::free)
    return is_mirror(grid.wall[d][1]) ? 2 * grid.cells[d] - at : grid.cells[d];
  return at;
}

/// Kind of a node's values, which determines their sign at its image.
enum class Kind {
  geometry,  // scalars and vectors in space, as a boundary's area: normal components change sign
  motion     // scalars and velocities, momenta, forces: at a fixed side all components do
};

/// Factor from the values of the image along d of a node at `at` to those of the node itself: 1 inside, or -1
/// where component k of a vector turns. 0 at a wall where the parts of soil and image cancel. k < 0: a
/// scalar.
template <Kind kind, class T, int Dim>
KOKKOS_INLINE_FUNCTION T image_sign(const Grid<T, Dim>& grid, int d, int at, int k) {
  if (k < 0 || (at > 0 && at < grid.cells[d])) return 1;
  const Wall wall = grid.wall[d][at > 0];
  const bool turns = k == d || (kind == Kind::motion && k >= 0 && wall == Wall::fixed);
  if (!is_mirror(wall) || !turns) return 1;
  const bool beyond = at < 0 || at > grid.cells[d];
  return beyond ? T(-1) : (kind == Kind::motion ? T(0) : T(1));
}

/// Whether the window of a patch holds nodes at a wall or beyond it, by the lower cell of the patch.
template <int Dim>
struct WallReach {
  Coord<Dim> low, high;  // a patch that begins at or below `low`, or at or above `high`, reaches a wall

  template <class T>
  KOKKOS_INLINE_FUNCTION explicit WallReach(const Grid<T, Dim>& grid) {
    constexpr int none = Kokkos::Experimental::finite_max<int>::value;
    for (int d = 0; d < Dim; ++d) {
      low[d] = grid.wall[d][0] == Wall::free ? -none : 0;
      high[d] = grid.wall[d][1] == Wall::free ? none : grid.cells[d] - Patch<Dim>::edge - 1;
    }
  }
  KOKKOS_INLINE_FUNCTION bool operator()(const Coord<Dim>& origin) const {
    bool reaches = false;
    for (int d = 0; d < Dim; ++d) reaches |= origin[d] <= low[d] || origin[d] >= high[d];
    return reaches;
  }
};
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool reaches_wall(const Grid<T, Dim>& grid, const Coord<Dim>& origin) {
  return WallReach<Dim>(grid)(origin);
}

/// A cell by the lower cell of its patch and its place there.
template <int Dim>
KOKKOS_INLINE_FUNCTION Coord<Dim> in_mesh(const Coord<Dim>& origin, const Coord<Dim>& cell) {
  Coord<Dim> c;
  for (int d = 0; d < Dim; ++d) c[d] = origin[d] + cell[d];
  return c;
}

/// Whether a particle is where put_on_walls() moves it: beyond a wall, or on the upper one, which belongs to
/// no cell.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool is_beyond_walls(const Grid<T, Dim>& grid, const Coord<Dim>& cell,
                                            const Vector<T, Dim>& x) {
  bool beyond = false;
  for (int d = 0; d < Dim; ++d) {
    beyond |= grid.wall[d][0] != Wall::free && static_cast<T>(-cell[d]) > x[d];
    beyond |= grid.wall[d][1] != Wall::free && x[d] >= static_cast<T>(grid.cells[d] - cell[d]);
  }
  return beyond;
}

/// Brings a particle that has passed walls back to them, at rest against them; false if it has passed none.
/// One that has passed a side that acts keeps its velocity and does not count: such a side may move.
/// cell(d): the cell along direction d from whose lower corner x [cells] is measured; v [m/s]. One that lies
/// on a wall may be beyond it by round-off, which changes no velocity. The loops stay loops: where x and v
/// are in memory they take few registers of a kernel that seldom comes here.
template <class T, int Dim, class Cell>
KOKKOS_INLINE_FUNCTION bool put_on_walls(const Grid<T, Dim>& grid, const Cell& cell, Vector<T, Dim>& x,
                                         Vector<T, Dim>& v) {
  constexpr T epsilon = Kokkos::Experimental::epsilon<T>::value;
  constexpr T within = 1 - epsilon;          // the upper wall belongs to no cell
  constexpr T k_round_off = 1000 * epsilon;  // cells
  bool passed = false;
  MPM_ROLLED
  for (int n = 0; n < 2 * Dim; ++n) {
    const int d = n / 2, side = n % 2;
    const T wall = static_cast<T>((side == 0 ? 0 : grid.cells[d]) - cell(d));
    const T beyond = side == 0 ? wall - x[d] : x[d] - wall;
    if (grid.wall[d][side] == Wall::free || (side == 0 ? !(beyond > 0) : !(beyond >= 0))) continue;
    x[d] = side == 0 ? wall : wall * within;
    if (!(beyond > k_round_off) || is_acting(grid.wall[d][side])) continue;
    MPM_ROLLED
    for (int k = 0; k < Dim; ++k)
      if (k == d || grid.wall[d][side] == Wall::fixed) v[k] = 0;
    passed = true;
  }
  return passed;
}
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION bool put_on_walls(const Grid<T, Dim>& grid, const Coord<Dim>& cell, Vector<T, Dim>& x,
                                         Vector<T, Dim>& v) {
  return put_on_walls(
      grid, [&](int d) { return cell[d]; }, x, v);
}

/// Images of the nodes of a team's window. Where none of them lies at a wall or beyond it:
struct NoImages {
  /// Place in the window of the image of node n.
  KOKKOS_INLINE_FUNCTION int operator()(int n) const { return n; }
};
/// Images of a window for a patch anywhere, at `origin`.
template <class T, int Dim>
struct WindowImages {
  static constexpr int k_place_bits = 16;

  const Grid<T, Dim>& grid;
  Coord<Dim> origin;
  bool at_wall;                // the window holds nodes at a wall or beyond it
  const int* table = nullptr;  // entry() of each node, where a team has tabulated them

  KOKKOS_INLINE_FUNCTION WindowImages(const Grid<T, Dim>& mesh, const WallReach<Dim>& reach,
                                      const Coord<Dim>& from)
      : grid(mesh), origin(from), at_wall(reach(from)) {}
  KOKKOS_INLINE_FUNCTION int operator()(int n) const {
    return at_wall ? entry_of(n) & ((1 << k_place_bits) - 1) : n;
  }
  /// Bit k: component k of a velocity at node n is opposite to that at its image.
  KOKKOS_INLINE_FUNCTION int turned(int n) const { return at_wall ? entry_of(n) >> k_place_bits : 0; }
  /// Place of the image of node n, n itself but beyond a wall, and its turned components in one number. A
  /// patch outside the mesh, which holds no particles, has no images.
  KOKKOS_INLINE_FUNCTION int entry(int n) const {
    constexpr int across = Patch<Dim>::window_edge, all = (1 << Dim) - 1;
    const Coord<Dim> c = window_coord<Dim>(n);
    int place = 0, turns = 0;
    bool outside = false;
    for (int d = 0, step = 1; d < Dim; ++d, step *= across) {
      const int at = origin[d] + c[d], image = image_along(grid, d, at), to = image - origin[d] + 1;
      const Wall wall = at > 0 ? grid.wall[d][1] : grid.wall[d][0];
      if (image != at && is_mirror(wall)) turns ^= wall == Wall::fixed ? all : 1 << d;
      outside |= to < 0 || to >= across;
      place += to * step;
    }
    return outside ? n : place | turns << k_place_bits;
  }

 private:
  KOKKOS_INLINE_FUNCTION int entry_of(int n) const { return table ? table[n] : entry(n); }
};

/// Turns the motion that node n of a window has taken from its image.
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void turn_motion(const NoImages&, int, KinematicValues<T, Dim>&) {}
template <class T, int Dim>
KOKKOS_INLINE_FUNCTION void turn_motion(const WindowImages<T, Dim>& images, int n,
                                        KinematicValues<T, Dim>& motion) {
  const int turned = images.turned(n);
  for (int k = 0; k < NodeKinematics<Dim>::size; ++k)
    if (turned >> (k % Dim) & 1) motion.c[k] = -motion.c[k];
}

/// Turns the sums that a window has for nodes at walls and beyond them into what their images get of them;
/// the team must wait before and after. Source: of what the sums are (physics/p2g_terms.hpp).
template <class Source, class Team, class T, int Dim>
KOKKOS_INLINE_FUNCTION void turn_sums(const Team& team, const WindowImages<T, Dim>& images, T* sums) {
  constexpr int size = Source::size;
  constexpr Kind kind = Source::kind;
  constexpr int across = Patch<Dim>::window_edge, plane = Patch<Dim>::window / across;
  unrolled<Dim>([&](auto d) {  // the kernel's arguments are read at constant places
    constexpr int step = power(across, d);
    if (d > 0) team.team_barrier();
    unrolled<4>([&](auto row) {  // the nodes beyond and at the lower wall, at and beyond the upper one
      const int at = row < 2 ? row - 1 : images.grid.cells[d] + row - 2, place = at - images.origin[d] + 1;
      const Wall wall = images.grid.wall[d][row / 2];
      if (!is_mirror(wall) || place < 0 || place >= across) return;
      const T normal = row == 0 || row == 3 ? T(-1) : (kind == Kind::motion ? T(0) : T(1));
      const T along = kind == Kind::motion && wall == Wall::fixed ? normal : T(1);
      Kokkos::parallel_for(Kokkos::TeamThreadRange(team, plane), [&](int n) {
        T* const node = sums + (n / step * step * across + n % step + place * step) * size;
        unrolled<size>([&](auto v) {
          constexpr int k = Source::component(v);
          if constexpr (k >= 0) node[v] *= k == d ? normal : along;
        });
      });
    });
  });
}

/// Calls f(place, image, at) for each node of a window that lies at a wall normal to direction d or beyond
/// it: its place in the window, that of its image, and its coordinate along d. Directions follow one another:
/// the image of a corner is that of its image.
template <class T, int Dim, class F>
KOKKOS_INLINE_FUNCTION void for_each_image(const Grid<T, Dim>& grid, const Coord<Dim>& origin, int d, F&& f) {
  constexpr int across = Patch<Dim>::window_edge, plane = Patch<Dim>::window / across;
  const int step = power(across, d);
  for (int row = 0; row < 4; ++row) {
    const int at = row < 2 ? row - 1 : grid.cells[d] + row - 2;
    if (grid.wall[d][row / 2] == Wall::free) continue;
    const int place = at - origin[d] + 1, to = image_along(grid, d, at) - origin[d] + 1;
    if (place < 0 || place >= across || to < 0 || to >= across) continue;
    for (int n = 0; n < plane; ++n) {
      const int base = n / step * step * across + n % step;
      f(base + place * step, base + to * step, at);
    }
  }
}

/// The nodes of a window beyond walls take the motion (NodeKinematics) of their images. motion_of(n): that of
/// node n.
template <class T, int Dim, class Motion>
KOKKOS_INLINE_FUNCTION void mirror_images(const Grid<T, Dim>& grid, const Coord<Dim>& origin,
                                          const Motion& motion_of) {
  for (int d = 0; d < Dim; ++d)
    for_each_image(grid, origin, d, [&](int place, int image, int at) {
      if (place == image) return;
      const T* const from = motion_of(image);
      T* const to = motion_of(place);
      for (int k = 0; k < NodeKinematics<Dim>::size; ++k)
        to[k] = image_sign<Kind::motion, T>(grid, d, at, k % Dim) * from[k];
    });
}

}  // namespace mpm
