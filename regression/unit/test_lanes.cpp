// Lanes: what many particles at once give is what one by one gives, for every real type and dimension.

#include <array>
#include <catch2/catch_test_macros.hpp>
#include <map>
#include <utility>

#include "compare.hpp"
#include "physics/advance.hpp"

using namespace mpm;
using namespace mpm::test;

namespace {

/// Calls f(T) for each real type that is built.
template <class F>
void for_each_real(F&& f) {
  f(double{});
#ifndef MPM_ONLY_DOUBLE
  f(float{});
#endif
}
template <class T>
using Native = Lanes<T, native_lanes<T>>;

template <class R>
R random_lanes(Dice& dice, double low, double high) {
  R a;
  for (int l = 0; l < R::k_count; ++l) a.set(l, static_cast<typename R::real>(dice.uniform(low, high)));
  return a;
}

template <int N, class T>
void check_groups() {
  using R = Native<T>;
  constexpr int W = R::k_count;
  T in[N * W], out[N * W];
  for (int n = 0; n < N * W; ++n) in[n] = static_cast<T>(n);
  R a[N];
  load_groups(in, a);
  for (int k = 0; k < N; ++k)
    for (int l = 0; l < W; ++l) CHECK(a[k][l] == in[l * N + k]);
  store_groups(a, out);
  for (int n = 0; n < N * W; ++n) CHECK(out[n] == in[n]);
}

/// Result that update_particles should give, particle by particle, without lanes: by id, as moved_fields.
template <class B>
std::vector<Table> moved_one_by_one(const StateOf<B>& s, double dt) {
  using T = typename B::real;
  constexpr int Dim = B::dim;
  using M = NodeKinematics<Dim>;
  auto soil = s.soil.points;
  for (int k = 0; k < soil.history.columns; ++k) {  // of its own
    const auto column = soil.history.column[k];
    soil.history.column[k] = Kokkos::View<T*, typename B::Space::memory_space>("test", column.extent(0));
    Kokkos::deep_copy(soil.history.column[k], column);
  }
  const NodePlaces places(s.grid, s.patches);
  const T inv = s.grid.inv_spacing;
  const UpdateScalars<T> by{T(dt),
                            inv,
                            T(s.scheme.flip_fraction),
                            T(1 - s.scheme.flip_fraction),
                            T(s.f_bar.fraction),
                            T(s.strays.least_volume),
                            T(s.strays.most_volume),
                            false};
  std::vector<GridSample<T, Dim>> taken(soil.count);
  struct Mean {
    double volume = 0, sum = 0;  // m3, m3/s
  };
  std::map<std::pair<int, int>, Mean> means;  // of a cell and a material
  const auto mean_for = [&](int p) -> Mean& { return means[{soil.cell(p), soil.material_of(p)}]; };
  for (int p = 0; p < soil.count; ++p) {
    GridSample<T, Dim>& t = taken[p] = {};
    for_each_node<Kind::motion>(soil, soil.bodies(soil.body(p)).half_length, places, p,
                                [&](int i, T w, const Vector<T, Dim>& grad, auto&&, auto&& sign) {
                                  T v[M::size];
                                  for (int k = 0; k < M::size; ++k)
                                    v[k] = sign(k % Dim) * s.nodes.kinematics(i, k);
                                  for (int k = 0; k < M::size; ++k) t.kinematics[k] += w * v[k];
                                  for (int d = 0; d < Dim; ++d)
                                    for (int e = 0; e < Dim; ++e)
                                      t.gradient[d][e] += v[M::velocity + d] * grad[e] * inv;
                                });
    mean_for(p).volume += soil.volume(p);
    for (int d = 0; d < Dim; ++d) mean_for(p).sum += soil.volume(p) * t.gradient[d][d];
  }
  std::vector<Table> fields{{Dim, {}}, {Dim, {}}, {sym_size<Dim>, {}}, {1, {}}, {1, {}}};
  for (auto& field : fields) field.value.resize(std::size_t(field.width) * soil.count);
  for (int p = 0; p < soil.count; ++p) {
    Particle<T, Dim> q{soil.coordinate(p), soil.velocity(p), soil.stress(p), soil.volume(p)};
    const ParticleLaw<typename B::Space, T, Dim, Materials> law{soil, p, soil.bodies(soil.body(p)).material,
                                                                -1, false};
    UpdateScalars<T> own = by;
    own.f_bar *= soil.materials(soil.material_of(p)).f_bar_share;
    advance(q, law, taken[p], static_cast<T>(mean_for(p).sum / mean_for(p).volume), own, PlaneDomain{});
    const int id = soil.id(p);
    for (int d = 0; d < Dim; ++d) fields[0].value[id * Dim + d] = q.x[d];
    for (int d = 0; d < Dim; ++d) fields[1].value[id * Dim + d] = q.v[d];
    for (int k = 0; k < sym_size<Dim>; ++k) fields[2].value[id * sym_size<Dim> + k] = q.stress[k];
    fields[3].value[id] = q.volume;
    fields[4].value[id] = soil.history.column[VonMises<T>::plastic_strain](p);
  }
  return fields;
}
template <class B>
std::vector<Table> moved_fields(const StateOf<B>& s) {
  const auto& soil = s.soil.points;
  constexpr int plastic_strain = VonMises<typename B::real>::plastic_strain;
  return {by_id(soil, soil.coordinate), by_id(soil, soil.velocity), by_id(soil, soil.stress),
          by_id(soil, soil.volume), by_id(soil, soil.history.column[plastic_strain])};
}

/// A random cloud, of which one cell holds more particles than any stage, of two bodies, and others are
/// empty.
template <int Dim>
Cloud crowded_cloud(int seed) {
  Cloud cloud = random_cloud<Dim>(seed);
  Dice dice{std::mt19937_64(seed + 100)};
  for (int n : {703, 402}) {
    std::vector<double> position;
    for (int k = 0; k < n * Dim; ++k) position.push_back(dice.uniform(1, 2) * cloud.grid.spacing);
    BodyInput crowd = body_of<Dim>(std::move(position), 2 + n % 2, cloud.grid.spacing, n % 2);
    for (int k = 0; k < n * Dim; ++k) crowd.velocity.push_back(dice.uniform(-1, 1));
    for (int k = 0; k < n * sym_size<Dim>; ++k) crowd.stress.push_back(dice.uniform(-3000, 3000));
    cloud.bodies.push_back(std::move(crowd));
  }
  return cloud;
}

}  // namespace

TEST_CASE("an operation on lanes is that on each number", "[lanes]") {
  for_each_real([](auto real) {
    using T = decltype(real);
    using R = Native<T>;
    Dice dice{std::mt19937_64(3)};
    for (int n = 0; n < 20; ++n) {
      R a = random_lanes<R>(dice, -2, 2), b = random_lanes<R>(dice, -2, 2);
      b.set(n % R::k_count, a[n % R::k_count]);
      const R sum = a + b, rest = 1 - a, product = 2 * a * b, ratio = a / b, larger = Kokkos::fmax(a, b),
              positive = Kokkos::fmax(T(0), a), size = Kokkos::fabs(a), root = Kokkos::sqrt(size),
              chosen = select(a < b, a, T(7)), smaller = Kokkos::fmin(a, b), up = Kokkos::ceil(a);
      const auto either = (a < 0) | (b < 0);
      const auto equal = a == b;
      T largest = a[0];
      for (int l = 0; l < R::k_count; ++l) {
        CHECK(sum[l] == a[l] + b[l]);
        CHECK(rest[l] == 1 - a[l]);
        CHECK(product[l] == 2 * a[l] * b[l]);
        CHECK(ratio[l] == a[l] / b[l]);
        CHECK(larger[l] == std::fmax(a[l], b[l]));
        CHECK(positive[l] == std::fmax(T(0), a[l]));
        CHECK(size[l] == std::fabs(a[l]));
        CHECK(root[l] == std::sqrt(size[l]));
        CHECK(chosen[l] == (a[l] < b[l] ? a[l] : T(7)));
        CHECK(smaller[l] == std::fmin(a[l], b[l]));
        CHECK(up[l] == std::ceil(a[l]));
        CHECK(either[l] == (a[l] < 0 || b[l] < 0));
        CHECK(equal[l] == (a[l] == b[l]));
        CHECK((!equal)[l] == (a[l] != b[l]));
        largest = std::fmax(largest, a[l]);
      }
      CHECK(largest_of(a) == largest);
    }
    for (int l = 0; l < R::k_count; ++l) {
      R a = 0;
      CHECK(!any_of(a > 0));
      a.set(l, 1);
      CHECK(any_of(a > 0));
      a.set(l, std::numeric_limits<T>::quiet_NaN());
      CHECK(any_of(!(0 * a == 0)));
      CHECK(Kokkos::fmax(R(1), a)[l] == 1);  // as fmax of numbers does
    }
  });
}

TEST_CASE("exponentials and logarithms of lanes are those of each number", "[lanes]") {
  for_each_real([](auto real) {
    using T = decltype(real);
    using R = Native<T>;
    using Limits = std::numeric_limits<T>;
    Dice dice{std::mt19937_64(4)};
    const double largest = -std::log(double(Limits::min())) - 1;
    double apart = 0;  // relative
    const auto compare = [&](double got, double right) {
      apart = std::fmax(apart, right == 0 ? std::fabs(got) : std::fabs(got / right - 1));
    };
    for (int n = 0; n < 2000; ++n) {
      const double range = n % 2 ? 1 : largest;
      const R a = random_lanes<R>(dice, -range, range);
      R positive;
      for (int l = 0; l < R::k_count; ++l) positive.set(l, std::exp(a[l]));
      const R e = Kokkos::exp(a), less_one = Kokkos::expm1(a), log = Kokkos::log(positive),
              log10 = Kokkos::log10(positive);
      for (int l = 0; l < R::k_count; ++l) {
        compare(e[l], std::exp(double(a[l])));
        compare(less_one[l], std::expm1(double(a[l])));
        compare(log[l], std::log(double(positive[l])));
        compare(log10[l], std::log10(double(positive[l])));
      }
    }
    CHECK(apart < 4 * Limits::epsilon());
    const T infinite = Limits::infinity(), none = Limits::quiet_NaN();
    CHECK(Kokkos::exp(R(0))[0] == 1);
    CHECK(Kokkos::exp(R(infinite))[0] == infinite);
    CHECK(Kokkos::exp(R(-infinite))[0] == 0);
    CHECK(std::isnan(Kokkos::exp(R(none))[0]));
    CHECK(Kokkos::log(R(1))[0] == 0);
    CHECK(Kokkos::log(R(infinite))[0] == infinite);
    CHECK(Kokkos::log(R(0))[0] == -infinite);
    CHECK(std::isnan(Kokkos::log(R(-1))[0]));
    CHECK(std::isnan(Kokkos::log(R(none))[0]));
  });
}

TEST_CASE("groups of values come apart and together again as they lie in memory", "[lanes]") {
  for_each_real([](auto real) {
    using T = decltype(real);
    check_groups<1, T>(), check_groups<2, T>(), check_groups<3, T>(), check_groups<4, T>(),
        check_groups<6, T>(), check_groups<9, T>();
    const T four[] = {1, 2, 3, 4};
    const auto a = Lanes<T, 4>::load(four);
    const auto again = repeated<8>(a), long_ones = stretched<8, 2>(a);
    const auto upper = part_of<4, 4>(long_ones);
    for (int l = 0; l < 8; ++l) {
      CHECK(again[l] == four[l % 4]);
      CHECK(long_ones[l] == four[2 + l / 4]);
    }
    for (int l = 0; l < 4; ++l) CHECK(upper[l] == 4);
  });
}

TEST_CASE("weights in lanes are those of each particle, as far as it may drift", "[lanes]") {
  for_each_real([](auto real) {
    using T = decltype(real);
    using R = Native<T>;
    Dice dice{std::mt19937_64(5)};
    const T epsilon = std::numeric_limits<T>::epsilon();
    for (int n = 0; n < 500; ++n) {
      R x = random_lanes<R>(dice, -0.5, 1.5);
      HalfLength<R> half;
      for (int l = 0; l < R::k_count; ++l) {
        const HalfLength<T> own(T(0.5) / static_cast<T>(1 + dice.below(4)));
        half.l.set(l, own.l), half.inverse.set(l, own.inverse);
        const T special[] = {T(-0.5), own.l, 1 - own.l, 1 + own.l, 0, 1, T(1.5), T(0.5)};
        if (dice.below(2) == 0) x.set(l, special[dice.below(8)]);
      }
      const AxisWeights<R> a = axis_weights_near(x, half);
      for (int l = 0; l < R::k_count; ++l) {
        const AxisWeights<T> own = axis_weights_near(x[l], HalfLength<T>(half.l[l]));
        CHECK(a.first[l] == own.first);
        for (int k = 0; k < 3; ++k) {
          CHECK(std::fabs(a.w[k][l] - own.w[k]) <= 4 * epsilon);
          CHECK(std::fabs(a.g[k][l] - own.g[k]) <= 4 * epsilon);
        }
      }
    }
  });
}

TEST_CASE("particles that move many at once move as one by one", "[lanes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    if constexpr (!is_device<typename B::Space>) {
      for (int seed : {1, 2, 3, 4, 5}) {
        Cloud cloud = seed < 3 ? random_cloud<B::dim>(seed) : crowded_cloud<B::dim>(seed);
        cloud.f_bar_fraction = seed % 2 ? 0.9 : 0;
        for (BodyInput& body : cloud.bodies) body.material = seed == 5 ? 1 : body.material;
        if (seed != 1) cloud.materials[0].f_bar_share = 0.3;
        cloud.flip_fraction = seed == 2 ? 0.9 : 1;
        auto s = state_of<B>(cloud);
        drift_within_margin(s);
        interpolate(s);
        const double dt = 1e-5;
        update_nodes(s, dt);
        const auto expected = moved_one_by_one<B>(s, dt);
        update_particles(s, dt);
        const auto moved = moved_fields<B>(s);
        INFO(build.name() << " seed " << seed);
        CHECK(read_control(s).fault_count == 0);
        double furthest = 0;
        for (int n = 0; n < s.movements.places; ++n)
          furthest = std::max(furthest, s.movements.of(0).noted(n));
        Kokkos::deep_copy(s.movements.bits, 0);
        CHECK(furthest > 0);
        for (std::size_t k = 0; k < moved.size(); ++k) {
          INFO("field " << k);
          CHECK(largest_difference(moved[k], expected[k]) < B::of(1e-12, 2e-5));
        }
        double grown = 0;
        for (double strain : moved.back().value) grown = std::max(grown, strain);
        CHECK(grown > 0);  // some particles have yielded
      }
    }
  });
}

TEST_CASE("a crowded cell gives the nodes what its particles give one by one", "[lanes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    const Cloud cloud = crowded_cloud<B::dim>(3);
    const auto fields = [&](P2G how) {
      auto s = state_of<B>(cloud, how);
      drift_within_margin(s);
      interpolate(s);
      return nodal_fields(s);
    };
    INFO(build.name());
    CHECK(largest_difference(fields(P2G::tile), fields(P2G::sequential)) < B::of(1e-12, 1e-5));
  });
}

TEST_CASE("a particle among many is named when it is wrong", "[lanes]") {
  for_each_build([](auto build) {
    using B = decltype(build);
    constexpr int Dim = B::dim;
    Cloud cloud;
    cloud.grid = grid_of<Dim>({16, 16, 12}, 0.1, Wall::free);
    cloud.materials = clays();
    cloud.bodies = {body_of<Dim>(lattice<Dim>({2, 2, 2}, {7, 5, 5}, 3, 0.1), 3, 0.1, 1)};
    const int wrong = 41;
    cloud.bodies[0].stress.assign(strength_of(cloud.bodies[0]).size() * sym_size<Dim>, 0.0);
    cloud.bodies[0].stress[wrong * sym_size<Dim>] = std::numeric_limits<double>::infinity();
    auto s = state_of<B>(cloud);
    reset_nodes(s);
    Kokkos::deep_copy(s.nodes.kinematics, 0);
    update_particles(s, 1e-5);
    const Control control = read_control(s);
    INFO(build.name());
    CHECK(control.fault_count == 1);
    CHECK(control.fault.kind == FaultKind::not_finite);
    CHECK(control.fault.particle == wrong);
  });
}
