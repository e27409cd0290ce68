#include "functions/free_field.hpp"

#include <algorithm>

#include "loops/node_update.hpp"
#include "physics/column.hpp"

namespace mpm {
namespace {

template <class Space, class T, int Dim>
ColumnStep<T, Dim> column_step(const State<Space, T, Dim>& s, int side, double dt) {
  const auto& ends = s.grid.wall[k_vertical<Dim>];
  return {.ends = {ends[0], ends[1]},
          .sides = s.sides.all.data(),
          .g = s.gravity,
          .timed_g = s.timed.of_step().gravity,
          .dt = dt,
          .change = s.scheme.kick * dt,
          .flip = s.scheme.flip_fraction,
          .damping = s.scheme.damping,
          .still = k_still<T>,
          .mass_cut = s.scheme.mass_cut,
          .xpic = s.scheme.xpic_order,
          .affine = s.soil.points.has_affine,
          .d = side / 2};
}

/// The columns of a side that begin at its rows 0, 1 ...
template <int Dim>
struct SideColumns {
  double* first;
  int count, rows;

  template <class Space, class T>
  SideColumns(const State<Space, T, Dim>& s, int side)
      : first(s.sides.columns.data() + s.sides.host[side].first_column * ColumnTerms<Dim>::size),
        count(s.sides.host[side].step[k_vertical<Dim>]),
        rows(s.grid.cells[k_vertical<Dim>] + 3) {}
  KOKKOS_INLINE_FUNCTION Column<Dim> operator()(int n) const {
    return {first + n * ColumnTerms<Dim>::size, static_cast<long>(count) * ColumnTerms<Dim>::size, rows};
  }
};

/// A step of a column by a team.
template <class T, int Dim, class Team>
KOKKOS_INLINE_FUNCTION void advance(const ColumnStep<T, Dim>& step, const Column<Dim>& column,
                                    const Team& team) {
  const auto for_rows = [&](bool with_soil, const auto& work) {
    for_team(team, column.rows, [&](int r) {
      if (column.has_soil(r) == with_soil) work(r);
    });
    team.team_barrier();
  };
  for_rows(true, [&](int r) { step.accelerate(column, r); });
  for_rows(false, [&](int r) { step.follow(column, r); });
  for (int pass = 0; pass < step.xpic; ++pass) for_rows(true, [&](int r) { step.filter(column, r, pass); });
  for_rows(true, [&](int r) { step.move(column, r); });
}

template <class Space, class T, int Dim>
void advance_by_teams(const State<Space, T, Dim>& s, int side, double dt) {
  using Team = Kokkos::TeamPolicy<Space>;
  constexpr int k_threads = 64;
  const ColumnStep<T, Dim> step = column_step(s, side, dt);
  const SideColumns<Dim> columns(s, side);
  const auto control = s.control;
  Kokkos::parallel_for(
      "mpm::advance_columns", light(Team(s.space, columns.count, k_threads)),
      KOKKOS_LAMBDA(const typename Team::member_type& team) {
        if (!control().paused) advance(step, columns(team.league_rank()), team);
      });
}

/// A thread takes a column.
template <class Space, class T, int Dim>
void advance_on_host(const State<Space, T, Dim>& s, int side, double dt) {
  constexpr int k_few = 16;  // one thread is done with them before the others have come together
  if (s.control().paused) return;
  const ColumnStep<T, Dim> step = column_step(s, side, dt);
  const SideColumns<Dim> columns(s, side);
  const auto one = [&](int n) { advance(step, columns(n), SerialTeam{}); };
  if (columns.count < k_few)
    for (int n = 0; n < columns.count; ++n) one(n);
  else
    Kokkos::parallel_for("mpm::advance_columns", Kokkos::RangePolicy<Space>(s.space, 0, columns.count), one);
}

}  // namespace

template <class Space, class T, int Dim>
void advance_columns(State<Space, T, Dim>& s, double dt) {
  for (int n = 0; n < 2 * Dim; ++n) {
    if (s.sides.host[n].kind != Wall::free_field) continue;
    if constexpr (is_device<Space>)
      advance_by_teams(s, n, dt);
    else
      advance_on_host(s, n, dt);
  }
}

#define MPM_INSTANTIATE(Space, T, Dim) template void advance_columns(State<Space, T, Dim>&, double);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
