#pragma once
// Sides of the mesh that act on the soil: from the host to a State, and what they have done back.

#include <array>
#include <vector>

#include "data/state.hpp"
#include "functions/wall_force.hpp"
#include "transfer/upload.hpp"

namespace mpm {

/// A side that acts; the others are left out.
struct SideInput {
  int direction = 0, side = 0;       // 0 lower, 1 upper
  bool holds_all = false;            // driven: fixed, not roller
  std::array<double, 3> velocity{};  // m/s, where no table gives it
  SideNumbers numbers{};
};

/// Sets up the sides of `grid` that act; density [kg/m3]: of the lightest soil.
template <class Space, class T, int Dim>
void upload_sides(State<Space, T, Dim>& s, const GridInput& grid, const std::vector<SideInput>& sides,
                  double density);

/// Impulse and work of the acting sides since the host last took them, at the nodes that this rank owns.
struct SideWork {
  WallForces impulse{};  // N s, of the soil on each side
  double work = 0;       // J, of the sides on the soil
};
template <class Space, class T, int Dim>
SideWork take_side_work(const State<Space, T, Dim>& s);

/// The table of the sides' nodes, row by row (SideTerms).
template <class Space, class T, int Dim>
std::vector<double> side_table(const State<Space, T, Dim>& s);
/// Rows of the table that belong to nodes of this rank.
template <class Space, class T, int Dim>
std::vector<int> own_side_rows(const State<Space, T, Dim>& s);
/// This rank's share of the table of all ranks, which is the sum. own: the rows of which it gives what
/// changes in a step and the static reaction; first: it gives the values that are the same on all ranks.
template <class Space, class T, int Dim>
std::vector<double> share_of_side_table(const State<Space, T, Dim>& s, const std::vector<int>& own,
                                        bool first);
/// Puts a table back; own: the rows with whose impulses and works this rank goes on, which only one of
/// several ranks may keep.
template <class Space, class T, int Dim>
void put_side_table(State<Space, T, Dim>& s, const std::vector<double>& table, const std::vector<int>& own);

/// The table of the columns beside sides, row by row (ColumnTerms); all ranks have the same.
template <class Space, class T, int Dim>
std::vector<double> column_table(const State<Space, T, Dim>& s);
template <class Space, class T, int Dim>
void put_column_table(State<Space, T, Dim>& s, const std::vector<double>& table);

}  // namespace mpm
