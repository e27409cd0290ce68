// Start of the columns of the free field: the terms that they take from the soil when their side begins.

#include <algorithm>
#include <cmath>

#include "base/copy.hpp"
#include "functions/free_field.hpp"
#include "functions/raw_column.hpp"
#include "functions/side_moduli.hpp"
#include "loops/particle_to_node.hpp"

namespace mpm {
namespace {

// Sums are whole numbers, as those of begin_absorbing.
constexpr double k_resolution = 1e12;  // of the largest term of one particle

/// Their units: kg, m3, Pa m3.
enum Unit { k_mass, k_volume, k_energy, k_units };

/// Source of the sums in the columns.
template <class Space, class T, int Dim>
struct GiveColumns {
  using Memory = typename Space::memory_space;
  using C = ColumnTerms<Dim>;
  using S = ColumnSum<Dim>;
  using Sum = Kokkos::View<long long * [S::size], Kokkos::LayoutRight, Memory>;
  static constexpr int vertical = k_vertical<Dim>;
  Soil<Space, T, Dim> soil;
  NodePlaces<Space, T, Dim> places;
  ActingSides<Dim> acting;
  unsigned sides;
  Kokkos::View<double*, Memory> shear_ratio;
  double f_bar;  // -, of the run
  bool affine;   // APIC
  Sum sums;
  double unit[k_units];

  /// A particle: its mass, volume, moduli times volume, and cell. `turning`: its shear stiffness along the
  /// level, which the rotation of its stress adds to.
  struct Point {
    double mass, volume;
    double shear, turning, own_bulk, mean_bulk;  // Pa m3: of its own dilatation, and of its cell's mean
    Coord<Dim> first;
  };
  /// A row that it reaches, or the image in a wall of one.
  struct Row {
    int at;          // node along the vertical
    double w, g;     // weight, gradient [1/cell]
    double r;        // cells from the particle
    double turn[2];  // sign of movement along the vertical, and along the level
  };

  KOKKOS_INLINE_FUNCTION Point point(int p) const {
    const auto of = soil.properties(p);
    const SideModuli m = side_moduli(soil, shear_ratio(of.material), p);
    const int cell = soil.cell(p);
    const double volume = soil.volume(p), bulk = m.wave - 4.0 / 3 * m.shear + m.pore,
                 mean = f_bar * double(soil.materials(of.material).f_bar_share);
    const SymTensor<T, Dim> stress = soil.stress(p);
    double level = 0;  // Pa, mean stress along the level
    for (int d = 0; d < vertical; ++d) level += double(stress[d]) / vertical;
    return {double(of.mass),
            volume,
            volume * m.shear,
            volume * (m.shear + (double(stress[vertical]) - level) / 2),
            volume * bulk * (1 - mean),
            volume * bulk * mean,
            in_mesh(places.origin(cell / Patch<Dim>::cells), coord_of<Dim>(cell))};
  }
  /// The unit of a sum.
  static Unit unit_of(int k) {
    if (k == S::mass || (k >= S::inertia && k < S::pull)) return k_mass;
    return k >= S::volume && k < S::pressed ? k_volume : k_energy;
  }
  /// The largest term of a unit.
  KOKKOS_INLINE_FUNCTION double size(int p, int of_unit) const {
    const Point q = point(p);
    return of_unit == k_mass     ? q.mass
           : of_unit == k_volume ? q.volume
                                 : 2 * q.shear + q.own_bulk + q.mean_bulk;
  }

  KOKKOS_INLINE_FUNCTION void operator()(int p) const {
    const Point q = point(p);
    bool near = false;
    for (int d = 0; d < Dim; ++d)
      near |= (sides >> (2 * d) & 1u && q.first[d] < 2) ||
              (sides >> (2 * d + 1) & 1u && q.first[d] >= places.grid.cells[d] - 2);
    if (!near) return;
    const auto x = soil.coordinate(p);
    with_weights(x, any_domain_of(soil, p), [&](const auto& a) {
      Row rows[3];
      double spread = 0;  // cells2, as APIC's
      for (int k = 0; k < 3; ++k) {
        rows[k] = row_of(q.first[vertical] + a[vertical].first + k, a[vertical].w[k], a[vertical].g[k]);
        rows[k].r = a[vertical].first + k - x[vertical];
        spread += rows[k].w * rows[k].r * rows[k].r;
      }
      for (int line = 0; line < (Dim == 2 ? 3 : 9); ++line) {
        const int step[2] = {line % 3, line / 3};
        Coord<Dim> at;
        double w = 1;
        at[vertical] = 0;
        for (int d = 0; d < vertical; ++d) {
          at[d] = places.grid.in_period(d, image_along(places.grid, d, q.first[d] + a[d].first + step[d]));
          w *= a[d].w[step[d]];
        }
        const unsigned on = sides_of(places.grid, at) & sides;
        for (int n = 0; n < 2 * vertical; ++n) {
          if (!(on >> n & 1u)) continue;
          double normal = a[n / 2].g[step[n / 2]];
          for (int d = 0; d < vertical; ++d) normal *= d == n / 2 ? 1 : double(a[d].w[step[d]]);
          give_line(n, at, q, rows, {w, normal, affine ? 1 / spread : 0});
        }
      }
    });
  }

 private:
  /// Weight of a line of nodes, its gradient normal to the side [1/cell], and 1/D of APIC, or 0 [1/cells2].
  struct Line {
    double w, normal, inv_spread;
  };
  KOKKOS_INLINE_FUNCTION Row row_of(int at, double w, double g) const {
    const auto turn = [&](int k) {
      return double(image_sign<Kind::motion, T>(places.grid, vertical, at, k));
    };
    return {image_along(places.grid, vertical, at), w, g, 0, {turn(vertical), turn(0)}};
  }
  KOKKOS_INLINE_FUNCTION void give_line(int n, Coord<Dim> at, const Point& q, const Row (&rows)[3],
                                        const Line& line) const {
    const auto row_at = [&](int vertical_at) {
      at[vertical] = vertical_at;
      return acting.all[n].column_row(at);
    };
    const int cell = q.first[vertical], of_cell = row_at(cell);
    add(of_cell, S::volume, line.w * q.volume, k_volume);
    for (const Row& i : rows) {
      const int row = row_at(i.at), place = i.at - cell + 1;
      add(row, S::mass, line.w * i.w * q.mass, k_mass);
      if (place >= 0 && place < k_rows_reached) {
        add(of_cell, S::dilatation + place, line.w * q.volume * i.g * i.turn[0], k_volume);
        add(of_cell, S::pressed + place, line.w * q.mean_bulk * i.g * i.turn[0], k_energy);
        add(of_cell, S::pressing + place, line.normal * q.mean_bulk * i.w * i.turn[1], k_energy);
      }
      for (const Row& j : rows) give_element(row, q, i, j, line);
    }
  }
  KOKKOS_INLINE_FUNCTION void give_element(int row, const Point& q, const Row& i, const Row& j,
                                           const Line& line) const {
    const int place = j.at - i.at + C::reach;
    const double slopes = line.w * i.g * j.g, across = line.normal * i.w * j.g,
                 carried = line.w * q.mass * i.w * j.w * (1 + line.inv_spread * i.r * j.r);
    for (int k = 0; k < 2; ++k) {
      const double turns = i.turn[k] * j.turn[k];
      const double modulus = k == 0 ? q.own_bulk + 4.0 / 3 * q.shear : q.turning,
                   pulled = k == 0 ? q.own_bulk - 2.0 / 3 * q.shear : q.turning;
      add(row, S::stiffness + k * C::band + place, slopes * modulus * turns, k_energy);
      add(row, S::inertia + k * C::band + place, carried * turns, k_mass);
      add(row, S::pull + k * C::band + place, across * pulled * i.turn[1 - k] * j.turn[k], k_energy);
    }
  }
  KOKKOS_INLINE_FUNCTION void add(int row, int k, double value, int of_unit) const {
    Kokkos::atomic_add(&sums(row, k), static_cast<long long>(Kokkos::round(value / unit[of_unit])));
  }
};

template <class Space, class T, int Dim>
struct LargestOfColumns {
  GiveColumns<Space, T, Dim> give;
  int of_unit;
  KOKKOS_INLINE_FUNCTION void operator()(int p, double& largest) const {
    largest = Kokkos::fmax(largest, give.size(p, of_unit));
  }
};

/// Dashpots and springs of an absorbing end of the mesh, as the node there has them. nodes: SideTerms.
template <int Dim>
void set_end(const std::vector<double>& nodes, const Side<Dim>& end, const Coord<Dim>& at, double* row) {
  using C = ColumnTerms<Dim>;
  const double* const node = &nodes[std::size_t(end.row(at)) * SideTerms<Dim>::size];
  for (int k = 0; k < 2; ++k) {
    row[C::dashpot + k] = node[SideTerms<Dim>::dashpot + k];
    row[C::spring + k] = node[SideTerms<Dim>::spring + k];
  }
}

/// Sets the rows of a column, which stands at a node of the side; raw: in kg, m3, Pa m3.
template <class Space, class T, int Dim>
void set_column(const State<Space, T, Dim>& s, RawColumn<Dim>& raw, const Side<Dim>& side, Coord<Dim> at,
                const std::vector<double>& nodes, double* table) {
  using C = ColumnTerms<Dim>;
  using S = ColumnSum<Dim>;
  constexpr int vertical = k_vertical<Dim>;
  raw.add_means();
  raw.tie_light_rows();
  const double per_area = 1 / (s.spacing * s.spacing);  // gradients are by cells
  for (std::size_t r = 0; r < raw.sums.size(); ++r) {
    at[vertical] = static_cast<int>(r) - 1;
    double* const row = table + side.column_row(at) * C::size;
    std::fill_n(row, C::size, 0.0);
    row[C::mass] = raw.sums[r][S::mass];
    for (int k = 0; k < Dim; ++k) row[C::gravity + k] = s.gravity[k];
    for (int k = 0; k < C::matrix; ++k) {
      row[C::stiffness + k] = raw.sums[r][S::stiffness + k] * per_area;
      row[C::inertia + k] = raw.sums[r][S::inertia + k];
      row[C::pull + k] = raw.sums[r][S::pull + k] * per_area;
    }
    for (int upper = 0; upper < 2; ++upper)
      if (at[vertical] == upper * s.grid.cells[vertical] && s.grid.wall[vertical][upper] == Wall::absorbing)
        set_end(nodes, s.sides.host[2 * vertical + upper], at, row);
  }
}

/// A kernel's struct with the units of the sums, and the sums at zero.
template <class Space, class T, int Dim>
GiveColumns<Space, T, Dim> give_columns_of(const State<Space, T, Dim>& s, unsigned sides,
                                           const std::vector<double>& shear_ratio, const SideRanks& ranks) {
  using Give = GiveColumns<Space, T, Dim>;
  Give give{s.soil.points,
            {s.grid, s.patches},
            acting(s.sides),
            sides,
            shear_ratios<Space>(shear_ratio),
            s.f_bar.fraction,
            s.soil.points.has_affine,
            typename Give::Sum("mpm::column_sums", s.sides.columns.extent(0)),
            {}};
  for (int k = 0; k < k_units; ++k) {
    double largest = 0;
    Kokkos::parallel_reduce("mpm::largest_of_columns",
                            Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                            LargestOfColumns<Space, T, Dim>{give, k}, Kokkos::Max<double>(largest));
    ranks.largest(&largest);
    give.unit[k] = std::max(largest, 1e-300) / k_resolution;
  }
  return give;
}

}  // namespace

template <class Space, class T, int Dim>
void begin_columns(State<Space, T, Dim>& s, const std::vector<double>& shear_ratio, const SideRanks& ranks,
                   const std::vector<double>& nodes) {
  using S = ColumnSum<Dim>;
  constexpr int vertical = k_vertical<Dim>;
  unsigned sides = s.sides.unknown;
  for (int n = 0; n < 2 * Dim; ++n)
    if (s.sides.host[n].kind != Wall::free_field) sides &= ~(1u << n);
  if (sides == 0) return;
  const auto give = give_columns_of(s, sides, shear_ratio, ranks);
  Kokkos::parallel_for("mpm::give_columns", Kokkos::RangePolicy<Space>(s.space, 0, s.soil.points.count),
                       give);
  s.space.fence("mpm::begin_columns");
  const auto sums = mirror_of(give.sums);
  ranks.sum(sums.data(), static_cast<int>(sums.size()));
  const auto table = mirror_of(s.sides.columns);
  for (int n = 0; n < 2 * Dim; ++n) {
    if (!(sides >> n & 1u)) continue;
    const Side<Dim>& side = s.sides.host[n];
    for (int c = 0; c < side.step[vertical]; ++c) {
      Coord<Dim> at{};
      at[n / 2] = n % 2 * s.grid.cells[n / 2];
      if constexpr (Dim == 3) at[n / 2 == 0 ? 1 : 0] = c - 1;
      RawColumn<Dim> raw;
      for (int r = 0; r < s.grid.cells[vertical] + 3; ++r) {
        at[vertical] = r - 1;
        raw.sums.emplace_back(S::size);
        for (int k = 0; k < S::size; ++k)
          raw.sums[r][k] = sums(side.column_row(at), k) * give.unit[give.unit_of(k)];
      }
      set_column(s, raw, side, at, nodes, table.data());
    }
  }
  copy(s.sides.columns, table);
}

#define MPM_INSTANTIATE(Space, T, Dim)                                                             \
  template void begin_columns(State<Space, T, Dim>&, const std::vector<double>&, const SideRanks&, \
                              const std::vector<double>&);
MPM_FOR_EACH(MPM_INSTANTIATE)

}  // namespace mpm
