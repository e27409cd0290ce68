#pragma once
// Function 5 of a patch whose bins are about nodes, with the sums of the next step: as UpdateParticles, whose
// data it has, by the window and the stage of NodeWindow and NodeTile.

#include "data/cell_means.hpp"
#include "loops/gpu/node_tile.hpp"
#include "loops/gpu/patch_update.hpp"

namespace mpm {

/// Images in walls of the nodes of a NodeWindow, as WindowImages.
template <class T>
struct NodeImages {
  using Window = NodeWindow<T>;
  const Grid<T, 3>& grid;
  Coord<3> origin;
  bool at_wall;

  /// Place in the window of the image of node n; n itself, but beyond a wall. Nodes more than one beyond an
  /// upper wall, which no particle reaches, have none.
  KOKKOS_INLINE_FUNCTION int operator()(int n) const {
    const Coord<3> c = Window::coord(n);
    int place = 0;
    bool outside = false;
    for (int d = 2; d >= 0; --d) {
      const int to = image_along(grid, d, origin[d] + c[d]) - origin[d] + 1;
      outside |= to < 0;
      place = place * Window::edge + to;
    }
    return outside ? n : place;
  }
  /// Factor from what a node at a wall, or beyond it, has of component k to what its image gets of it
  /// (`keeps`, 0 or 1: of the component that turns at a node on the wall), and from the image's motion to the
  /// node's.
  KOKKOS_INLINE_FUNCTION T factor(int n, int k, T keeps) const {
    const Coord<3> c = Window::coord(n);
    T factor = 1;
    for (int d = 0; d < 3; ++d) {
      const int at = origin[d] + c[d];
      if (at > 0 && at < grid.cells[d]) continue;
      const Wall wall = grid.wall[d][at > 0];
      const bool beyond = at < 0 || at > grid.cells[d];
      if (is_mirror(wall) && (k == d || wall == Wall::fixed)) factor *= beyond ? T(-1) : keeps;
    }
    return factor;
  }
};

/// A team moves the particles of a patch, whose laws are of the list Laws, and adds them where they now are
/// to the nodes for the next step. The patch may lie at lower walls. No upper side is near, and none of its
/// particles is alone. HasMeans: for runs with F-bar, whose sums over cells are there; kernels of laws that
/// are not light are for runs without it too.
template <class Space, class T, class Laws, bool HasMeans>
struct UpdateAboutNodes {
  using Update = UpdateParticles<Space, T, 3, true, PatchKind::common, Laws>;
  static constexpr std::size_t mean_bytes = HasMeans ? CellWindow::cells * sizeof(T) : 0;
  static constexpr bool is_light = std::is_same_v<Laws, LightMaterials>;
  using Tile_ = NodeTile<T, mean_bytes, teams_about_nodes<T>(is_light)>;
  using Window = NodeWindow<T>;
  using S = SoilTerms<3>;
  static constexpr int threads = Tile_::threads, teams = Tile_::teams, bins = Tile_::bins;
  static_assert(CellWindow::cells <= threads);  // a thread loads the mean of one cell

  Update all;
  CellMeans<Space, T> means;  // in use with F-bar

  static constexpr std::size_t bytes() { return Tile_::bytes(); }

  KOKKOS_INLINE_FUNCTION bool averages() const { return HasMeans && (is_light || all.has_means); }

  KOKKOS_INLINE_FUNCTION void operator()(const LargeTeam& team, unsigned char* scratch, int index) const {
    const int paused = all.control().paused, slot = all.slots(all.first + index);  // both asked for at once
    if (paused) return;
    const Tile_ tile(scratch);
    for (int b = team.rank; b <= bins; b += threads) tile.begin[b] = all.begin(slot * bins + b);
    prefetch_particles(team, slot);
    const Window window(tile.window);
    T* const mean = reinterpret_cast<T*>(scratch + Tile_::bytes() - Tile_::rounded(mean_bytes));
    const NodeImages<T> images{all.grid, all.origin(slot), all.reach(all.origin(slot))};
    T moved = 0;
    load_window(team, slot, images, window, averages() ? mean : nullptr);
    const int end = tile.begin[bins];
    for (int bin = 0; bin < bins;) {  // once, but of fuller patches than the stage has room for
      const int first = tile.begin[bin], rank = team.rank;
      int last_bin = bins;
      if (end - first > Tile_::room)
        last_bin =
            bin + team.count(rank >= bin && rank < bins && tile.begin[rank + 1] - first <= Tile_::room);
      if (bin > 0) load_window(team, slot, images, window, nullptr);
      const int last = tile.begin[last_bin];
      for (int p = first + rank; p < last; p += threads)
        step_particle(tile, window, mean, slot, images.at_wall, p, p - first, moved);
      team.barrier();
      tile.add(team, bin, last_bin);
      team.barrier();
      give(team, slot, images, tile);
      if (last_bin < bins) team.barrier();
      bin = last_bin;
    }
    const T most = largest_of_warp(moved);
    if (team.rank % k_warp == 0) all.movements.of(0).note(slot, most);
  }

 private:
  KOKKOS_INLINE_FUNCTION int number_of(int slot, int n) const {
    return number_at<decltype(all.neighbours), 3>(all.neighbours, slot, Window::coord(n));
  }

  /// Number of a cell of the patch's CellWindow.
  KOKKOS_INLINE_FUNCTION int number_of_cell(int slot, int c) const {
    return number_at<decltype(all.neighbours), 3>(all.neighbours, slot, CellWindow::coord(c));
  }

 public:
  /// Sets the window; a team of any size takes it. mean: of the cells of the patch's CellWindow [1/s], or
  /// null where no mean is asked for. All loads of a thread are under way at once.
  template <int size = threads>
  KOKKOS_INLINE_FUNCTION void load_window(const LargeTeam& team, int slot, const NodeImages<T>& images,
                                          const Window& window, T* mean) const {
    using Motion = typename Window::Motion;
    constexpr int rounds = (Window::nodes + size - 1) / size;
    int number[rounds];
    for (int k = 0; k < rounds; ++k) {
      const int n = team.rank + k * size;
      number[k] = n < Window::nodes ? number_of(slot, n) : -1;
    }
    const bool has_cell = mean && team.rank < CellWindow::cells;
    const int cell = has_cell ? number_of_cell(slot, team.rank) : -1;
    for (int k = 0; images.at_wall && k < rounds; ++k) {
      const int n = team.rank + k * size;
      if (n < Window::nodes) number[k] = number_of(slot, images(n));
    }
    Motion motion[rounds]{};  // zero of nodes outside the grid, which no particle reaches
    for (int k = 0; k < rounds; ++k)
      if (number[k] >= 0) motion[k] = *reinterpret_cast<const Motion*>(&all.kinematics(number[k], 0));
    const Vector<T, 2> of_cell = cell < 0 ? Vector<T, 2>{} : means.sums(cell);
    for (int k = 0; k < rounds; ++k) {
      const int n = team.rank + k * size;
      if (n >= Window::nodes) continue;
      if (images.at_wall)
        for (int v = 0; v < Window::values; ++v) motion[k].c[v] *= images.factor(n, v % 3, T(1));
      Window::store(window.motion, n, motion[k]);
    }
    if (has_cell) mean[team.rank] = CellMean<T>{of_cell[0], of_cell[1]}.value();
    team.barrier();
    for (int n = team.rank; n < Window::nodes - 1; n += size) window.subtract(n);
    team.barrier();
  }

 private:
  /// Asks for the lines of memory that hold the particles of the patch.
  KOKKOS_INLINE_FUNCTION void prefetch_particles(const LargeTeam& team, int slot) const {
    constexpr int k_line = 128;
    const auto& soil = all.source.points;
    const int first = all.begin(slot * bins), last = all.begin((slot + 1) * bins);
    const auto lines = [&](const auto& field) {
      const char *at = reinterpret_cast<const char*>(&field(first)),
                 *end = reinterpret_cast<const char*>(field.data() + last);
      MPM_ROLLED
      for (at += k_line * team.rank; at < end; at += k_line * threads) prefetch(at);
    };
    lines(soil.coordinate), lines(soil.velocity), lines(soil.stress), lines(soil.volume);
    for (int k = 0; k < soil.history.columns; ++k) lines(soil.history.column[k]);
  }

  /// Moves particle p and puts it on the stage as number n. As UpdateParticles::step_particle.
  KOKKOS_INLINE_FUNCTION void step_particle(const Tile_& tile, const Window& window, const T* mean, int slot,
                                            bool at_wall, int p, int n, T& moved) const {
    const auto& soil = all.source.points;
    const BodyProperties<T>& body =
        soil.bodies(all.one_body ? 0 : soil.body(p));  // read again in place of kept
    const CellPlace place = averages() ? means.place(p) : CellPlace(soil.cell(p) - slot * bins, 0);
    const int bin = place.bin();
    Particle<T, 3> q;
    for_each_value([&](auto& value, const auto& field) { value = field(p); }, q, soil);
    GridSample<T, 3> t;
    NearestWeights<T> a[3];
    for (int d = 0; d < 3; ++d) a[d] = nearest_weights(q.x[d], body.half_length);
    window.sample(Window::lowest_of(bin), a, t.kinematics, t.gradient);
    for (int d = 0; d < 9; ++d) t.gradient[d / 3][d % 3] *= all.by.inv_spacing;
    const ParticleLaw<Space, T, 3, Laws> law{soil, p, body.material, all.law, false};
    const T of_cell = averages() ? mean[CellWindow::cell_of(bin, place.corner())] : T(0);
    T own = advance(q, law, t, of_cell, all.by, PlaneDomain{});
    for_each_value([&](auto& value, const auto& field) { field(p) = value; }, q, soil);
    if (at_wall && put_back(slot, bin, p, q.x)) q.x = soil.coordinate(p), q.v = soil.velocity(p);
    if (const FaultKind fault = fault_of(q, own, all.by, PlaneDomain{}); fault != FaultKind::none) {
      report_particle(fault, slot, p);
      own = Kokkos::Experimental::infinity_v<T>;  // ends the steps
    }
    moved = Kokkos::fmax(moved, own);
    for (int d = 0; d < 3; ++d) a[d] = nearest_weights(q.x[d], body.half_length);
    tile.put(n, a, all.source.point(body.half_length, soil.mass_of(p, body), q.v, q.stress, q.volume));
  }

  /// Brings a particle that has passed a wall back to it, in memory; whether it has. x: its coordinate.
  KOKKOS_INLINE_FUNCTION bool put_back(int slot, int bin, int p, const Vector<T, 3>& x) const {
    const bool beyond = is_beyond_walls(all.grid, in_mesh(all.origin(slot), coord_of<3>(bin)), x);
    if (beyond) put_on_wall(slot, p);
    return beyond;
  }
  MPM_CALLED_FUNCTION void put_on_wall(int slot, int p) const {
    const auto& soil = all.source.points;
    const Coord<3> cell = in_mesh(all.origin(slot), coord_of<3>(soil.cell(p)));
    if (put_on_walls(all.grid, cell, soil.coordinate(p), soil.velocity(p)))
      Kokkos::atomic_inc(&all.put_back(soil.body(p)));
  }
  MPM_CALLED_FUNCTION void report_particle(FaultKind fault, int slot, int p) const {
    const auto& soil = all.source.points;
    if (fault == FaultKind::not_finite) fault = cause_of<Laws>(soil, p);
    const Coord<3> bin = coord_of<3>(soil.cell(p));
    double position[3] = {};
    for (int d = 0; d < 3; ++d)
      position[d] = (double(all.origin(slot)[d]) + bin[d] + soil.coordinate(p)[d]) * all.spacing;
    report(all.control, fault, soil.id(p), position, 3);
  }

  /// Adds the window's sums to the nodes, to which other teams add too: neighbours in memory by neighbouring
  /// threads.
  KOKKOS_INLINE_FUNCTION void give(const LargeTeam& team, int slot, const NodeImages<T>& images,
                                   const Tile_& tile) const {
    T* const sums = tile.sums();
    int* const to = tile.to();
    for (int n = team.rank; n < Window::nodes; n += threads) {
      T sum[S::size];
      tile.gather(n, sum);
      for (int v = S::momentum; images.at_wall && v < S::size; ++v)
        sum[v] *= images.factor(n, (v - S::momentum) % 3, T(0));
      for (int v = 0; v < S::size; ++v) sums[n * S::size + v] = sum[v];
      to[n] = number_of(slot, images.at_wall ? images(n) : n) - n;
    }
    team.barrier();
    for (int m = team.rank; m < Window::nodes * S::size; m += threads) {
      const T own = sums[m];
      if (own != 0)
        Kokkos::atomic_add(all.sums.soil.data() + (m + S::size * static_cast<long>(to[m / S::size])), own);
    }
  }
};

}  // namespace mpm
