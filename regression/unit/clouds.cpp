// Particles for tests, compiled once for every build.

#include "clouds.hpp"

namespace mpm::test {

std::string name_of_build(Backend backend, bool is_double, int dim) {
  constexpr const char* words[] = {"serial", "openmp", "cuda"};
  return words[static_cast<int>(backend)] + std::string(is_double ? " double " : " single ") +
         std::to_string(dim) + "D";
}

template <class Space, class T, int Dim>
HeldState<Space, T, Dim>::HeldState() = default;
template <class Space, class T, int Dim>
HeldState<Space, T, Dim>::HeldState(const HeldState&) = default;
template <class Space, class T, int Dim>
HeldState<Space, T, Dim>::HeldState(HeldState&&) noexcept = default;
template <class Space, class T, int Dim>
HeldState<Space, T, Dim>& HeldState<Space, T, Dim>::operator=(const HeldState&) = default;
template <class Space, class T, int Dim>
HeldState<Space, T, Dim>& HeldState<Space, T, Dim>::operator=(HeldState&&) noexcept = default;
template <class Space, class T, int Dim>
HeldState<Space, T, Dim>::~HeldState() = default;

template <class Space, class T, int Dim>
HeldState<Space, T, Dim> state_on(const Space& space, const Cloud& cloud, P2G how) {
  HeldState<Space, T, Dim> s;
  s.space = space;
  s.p2g = cloud.p2g;
  s.p2g.strategy = how;
  for (int d = 0; d < Dim; ++d) s.gravity[d] = cloud.gravity[d];
  s.scheme.flip_fraction = cloud.flip_fraction;
  s.scheme.xpic_order = cloud.xpic_order;
  s.soil.points.has_affine = cloud.affine;
  s.soil.points.has_domain = cloud.stretch;
  s.soil.points.splits = cloud.split;
  s.soil.points.rings = cloud.rings;
  s.scheme.damping = cloud.damping;
  s.f_bar.fraction = cloud.f_bar_fraction;
  s.batches.limit = cloud.memory_limit;
  s.energy.on = cloud.energy;
  s.soil.points.face_count = cloud.face_count;
  std::vector<SurfaceLoad<Dim>> loads;
  for (const auto& load : cloud.surface_loads) {
    SurfaceLoad<Dim>& now = loads.emplace_back(SurfaceLoad<Dim>{load[0], {}});
    for (int d = 0; d < Dim; ++d) now.traction[d] = load[1 + d];
  }
  upload_surface_loads(s, loads);
  if (upload(s, cloud.grid, cloud.materials, cloud.bodies, cloud.rigids).kind != FaultKind::none)
    throw std::runtime_error("a particle of the test lies outside the mesh");
  upload_flow(s, cloud.flow);
  sort_and_list(s);
  begin_domains(s);
  if (cloud.energy) begin_works(s);
  return s;
}

#define MPM_INSTANTIATE(Space, T, Dim)      \
  template struct HeldState<Space, T, Dim>; \
  template HeldState<Space, T, Dim> state_on<Space, T, Dim>(const Space&, const Cloud&, P2G);
MPM_FOR_TESTED(MPM_INSTANTIATE)
#undef MPM_INSTANTIATE

template <int Dim>
GridInput grid_of(std::array<int, 3> cells, double spacing, Wall wall) {
  GridInput grid;
  grid.spacing = spacing;
  grid.cells = cells;
  for (int d = 0; d < 3; ++d) {
    grid.patches[d] = d < Dim ? (cells[d] + Patch<Dim>::edge - 1) / Patch<Dim>::edge + 2 : 1;
    grid.walls[d] = {wall, wall};
  }
  return grid;
}

std::vector<MaterialInput> clays() { return {{0, {1.5e6, 0.49}}, {1, {1.5e6, 0.49, 3000, 0, 0}}}; }

template <int Dim>
std::vector<double> lattice(std::array<double, 3> low, std::array<double, 3> high, int n, double spacing) {
  std::vector<double> position;
  std::array<int, 3> count{1, 1, 1};
  for (int d = 0; d < Dim; ++d) count[d] = static_cast<int>(std::lround((high[d] - low[d]) * n));
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        const int at[3] = {i, j, k};
        for (int d = 0; d < Dim; ++d) position.push_back((low[d] + (at[d] + 0.5) / n) * spacing);
      }
  return position;
}

std::vector<double>& strength_of(BodyInput& body) {
  body.state.resize(state_size<VonMises<double>>);
  return body.state[VonMises<double>::strength].values;
}
const std::vector<double>& strength_of(const BodyInput& body) {
  return body.state[VonMises<double>::strength].values;
}

template <int Dim>
void give_excess_pressure(BodyInput& body, std::vector<double> excess) {
  body.stress.resize(excess.size() * sym_size<Dim>);
  for (std::size_t p = 0; p < excess.size(); ++p)
    for (int k = 0; k < 3; ++k) body.stress[p * sym_size<Dim> + k] -= excess[p];
  body.state.push_back({k_excess_pore_pressure, std::move(excess)});
}

template <int Dim>
BodyInput body_of(std::vector<double> position, int per_cell, double spacing, int material) {
  BodyInput body;
  strength_of(body).assign(position.size() / Dim, 3000.0);
  body.position = std::move(position);
  body.particle_volume = std::pow(spacing / per_cell, Dim);
  body.half_length = 0.5 / per_cell;
  body.density = k_density;
  body.material = material;
  return body;
}
template <int Dim>
RigidInput rigid_of(std::vector<double> position, int per_cell, double spacing) {
  RigidInput rigid;
  rigid.position = std::move(position);
  rigid.particle_volume = std::pow(spacing / per_cell, Dim);
  rigid.half_length = 0.5 / per_cell;
  rigid.density = 2 * k_density;
  return rigid;
}

void revolve(Cloud& cloud) {
  cloud.rings = true;
  cloud.grid.walls[0][0] = Wall::roller;
  for (BodyInput& body : cloud.bodies) {
    body.least_volume = body.most_volume = body.particle_volume;
    for (std::size_t p = 0; p < body.position.size(); p += 2) {
      if (body.position[p] == 0) body.position[p] = 0.01 * cloud.grid.spacing;
      body.volume.push_back(body.particle_volume * 2 * std::numbers::pi * body.position[p]);
      body.mass.push_back(body.density * body.volume.back());
    }
    body.least_mass = *std::min_element(body.mass.begin(), body.mass.end());
  }
}

template <int Dim>
BodyInput random_body(Dice& dice, std::array<int, 3> low, std::array<int, 3> high, double share, int per_cell,
                      double spacing) {
  std::vector<double> position;
  const double l = 0.5 / per_cell, special[] = {0, l, 1 - l, 0.5};
  for (int k = low[2]; k < (Dim == 3 ? high[2] : low[2] + 1); ++k)
    for (int j = low[1]; j < high[1]; ++j)
      for (int i = low[0]; i < high[0]; ++i) {
        if (dice.uniform(0, 1) > share) continue;
        const int cell[3] = {i, j, k};
        for (int n = 1 + dice.below(5); n > 0; --n)
          for (int d = 0; d < Dim; ++d)
            position.push_back(
                (cell[d] + (dice.below(4) == 0 ? special[dice.below(4)] : dice.uniform(0, 1))) * spacing);
      }
  BodyInput body = body_of<Dim>(std::move(position), per_cell, spacing, per_cell % 2);
  for (double& strength : strength_of(body)) strength = dice.uniform(1000, 3000);
  for (std::size_t n = 0; n < body.position.size(); ++n) body.velocity.push_back(dice.uniform(-1, 1));
  for (std::size_t n = 0; n < strength_of(body).size() * sym_size<Dim>; ++n)
    body.stress.push_back(dice.uniform(-3000, 3000));
  return body;
}

void give_own_masses(Cloud& cloud, int seed, double spread) {
  Dice dice{std::mt19937_64(seed)};
  for (BodyInput& body : cloud.bodies) {
    const double common = body.density * body.particle_volume;
    for (std::size_t p = 0; p < strength_of(body).size(); ++p)
      body.mass.push_back(common * (1 + spread * dice.uniform(-1, 1)));
    body.least_mass = *std::min_element(body.mass.begin(), body.mass.end());
  }
}

template <int Dim>
void give_own_domains(Cloud& cloud, int seed) {
  Dice dice{std::mt19937_64(seed)};
  cloud.stretch = true;
  for (BodyInput& body : cloud.bodies)
    for (std::size_t p = 0; p < strength_of(body).size(); ++p) {
      double half[Dim];
      for (double& l : half) l = dice.below(4) == 0 ? (dice.below(2) ? 0.1 : 0.5) : dice.uniform(0.1, 0.5);
      DomainMoments<double, Dim> m;
      for (int i = 0; i < Dim; ++i)
        for (int j = i; j < Dim; ++j)
          m[moment_index<Dim>(i, j)] = half[i] * half[j] * (i == j ? 1 : dice.uniform(-0.4, 0.4));
      body.domain.insert(body.domain.end(), m.c, m.c + Dim * (Dim + 1) / 2);
    }
}

template <int Dim>
Cloud random_cloud(int seed, Wall wall) {
  Dice dice{std::mt19937_64(seed)};
  const double spacing = seed % 2 ? 0.125 : 0.1;
  const std::array<int, 3> cells = Dim == 2 ? std::array<int, 3>{45, 37, 0} : std::array<int, 3>{22, 13, 10};
  const auto from_end = [&](int n) { return std::array<int, 3>{cells[0] - n, cells[1] - n, cells[2] - n}; };
  Cloud cloud;
  cloud.grid = grid_of<Dim>(cells, spacing, wall);
  cloud.materials = clays();
  cloud.bodies = {random_body<Dim>(dice, {0, 0, 0}, {4, 4, 3}, 0.7, 1, spacing),
                  random_body<Dim>(dice, from_end(3), cells, 0.7, 2, spacing),
                  random_body<Dim>(dice, {2, 2, 1},
                                   Dim == 2 ? std::array<int, 3>{14, 12, 0} : std::array<int, 3>{7, 6, 5},
                                   0.5, 3, spacing),
                  random_body<Dim>(dice, {0, 0, 0}, cells, Dim == 2 ? 0.02 : 0.01, 4, spacing)};
  const double x = 3 + dice.uniform(0, 1), y = 4 + dice.uniform(0, 1);
  cloud.rigids = {rigid_of<Dim>(lattice<Dim>({x, y, 2.3}, {x + 4, y + 2, 4.3}, 4, spacing), 4, spacing),
                  rigid_of<Dim>(lattice<Dim>({0, 0, 0}, {3, 1, 2}, 2, spacing), 2, spacing)};
  cloud.rigids[0].velocity = {0.3, -0.5, 0.1};
  cloud.rigids[0].shear_limit = 2000;
  if (seed % 2) {
    cloud.rigids[0].surface_normal = true;
    cloud.rigids[0].reach = 0.8 * spacing;
    for (int d = 0; d < 3; ++d) {
      cloud.rigids[0].surface.centre[d] = spacing * (d == 0 ? x + 2 : d == 1 ? y + 1 : 3.3);
      cloud.rigids[0].surface.half[d] = spacing * (d == 0 ? 2 : 1);
    }
  }
  cloud.rigids[1].dynamic = true;
  cloud.rigids[1].shear_limit = std::numeric_limits<double>::infinity();
  cloud.rigids[1].friction = 0.3;
  return cloud;
}

#define MPM_INSTANTIATE(Dim)                                                                               \
  template GridInput grid_of<Dim>(std::array<int, 3>, double, Wall);                                       \
  template std::vector<double> lattice<Dim>(std::array<double, 3>, std::array<double, 3>, int, double);    \
  template void give_excess_pressure<Dim>(BodyInput&, std::vector<double>);                                \
  template BodyInput body_of<Dim>(std::vector<double>, int, double, int);                                  \
  template RigidInput rigid_of<Dim>(std::vector<double>, int, double);                                     \
  template BodyInput random_body<Dim>(Dice&, std::array<int, 3>, std::array<int, 3>, double, int, double); \
  template void give_own_domains<Dim>(Cloud&, int);                                                        \
  template Cloud random_cloud<Dim>(int, Wall);
MPM_INSTANTIATE(2)
MPM_INSTANTIATE(3)
#undef MPM_INSTANTIATE

}  // namespace mpm::test
