#pragma once
// The laws of particles on a processor: as many particles at once as an instruction takes.

#include "data/contact_core.hpp"
#include "loops/cpu/host_window.hpp"
#include "physics/advance.hpp"

namespace mpm {

/// The lanes that are active where these are the first ones and the others repeat the last of them.
struct FirstLanes {
  int count;
  KOKKOS_INLINE_FUNCTION bool operator()(int lane) const { return lane < count; }
};

/// The update of a law in lanes, as a function that the loop around short laws calls, which stays as it is
/// without long ones.
template <class Law, class R, class T, int Dim, int N>
[[gnu::noinline]] KOKKOS_FUNCTION void called_in_lanes(const Law& law, SymTensor<R, Dim>& stress,
                                                       LawState<R, N>& state,
                                                       const Increment<R, T, Dim>& by) {
  law.update(stress, state, by);
}
/// Calls the law where only some lanes are active. The others take the values of an active lane, so that no
/// iteration goes on for what is no particle of the law.
template <class Law, class R, class T, int Dim, int N, class Active>
KOKKOS_FUNCTION void called_in_some_lanes(const Law& law, SymTensor<R, Dim>& stress, LawState<R, N>& state,
                                          Increment<R, T, Dim> by, const Active& active) {
  int one = 0;
  while (one < R::k_count && !active(one)) ++one;
  if (one == R::k_count) return;
  const auto fill = [&](R& a) {
    for (int l = 0; l < R::k_count; ++l)
      if (!active(l)) a.set(l, a[one]);
  };
  for (R& a : stress.c) fill(a);
  for (int k = 0; k < N; ++k) fill(state[k]);
  for (R& a : by.strain.c) fill(a);
  for (R& a : by.spin.c) fill(a);
  for (auto& row : by.gradient)
    for (R& a : row) fill(a);
  called_in_lanes(law, stress, state, by);
}

/// Whether a law's update is called lane by lane: where it takes a single particle, or where lanes are
/// arrays, which a long update does not gain by.
template <class Law>
constexpr bool goes_by_lane() {
  return has_scalar_update<Law>() || (k_plain_lanes && !is_light<Law>());
}

/// The update of a law. One that goes lane by lane is called for the lanes that are active(lane), and where
/// it asks for the particle's place, with place(lane).
template <class Law, class R, class T, int Dim, int N, class Active, class Place>
KOKKOS_INLINE_FUNCTION void update_lanes(const Law& law, SymTensor<R, Dim>& stress, LawState<R, N>& state,
                                         const Increment<R, T, Dim>& by, const Active& active,
                                         [[maybe_unused]] const Place& place) {
  if constexpr (!goes_by_lane<Law>()) {
    if constexpr (std::is_same_v<Active, FirstLanes>)
      called_in_lanes(law, stress, state, by);
    else
      called_in_some_lanes(law, stress, state, by, active);
  } else {
    for (int l = 0; l < R::k_count; ++l) {
      if (!active(l)) continue;
      SymTensor<T, Dim> own_stress;
      LawState<T, N> own_state{};  // 0 where a particle does not carry a variable
      Increment<T, T, Dim> own_by;
      own_by.dt = by.dt, own_by.clock = by.clock;
      for (int k = 0; k < sym_size<Dim>; ++k)
        own_stress[k] = stress[k][l], own_by.strain[k] = by.strain[k][l];
      for (int k = 0; k < (Dim == 2 ? 1 : 3); ++k) own_by.spin.c[k] = by.spin.c[k][l];
      for (int k = 0; k < Dim * Dim; ++k)
        own_by.gradient[k / Dim][k % Dim] = by.gradient[k / Dim][k % Dim][l];
      for (int k = 0; k < N && carries(law, k); ++k) own_state[k] = state[k][l];
      if constexpr (takes_place<Law>())
        law.update(own_stress, own_state, own_by, place(l));
      else
        law.update(own_stress, own_state, own_by);
      for (int k = 0; k < sym_size<Dim>; ++k) stress[k].set(l, own_stress[k]);
      for (int k = 0; k < N && carries(law, k); ++k) state[k].set(l, own_state[k]);
    }
  }
}

/// The laws of the particles [p, p + count), as many as R has lanes at most, with their state in memory.
/// Particles that fly freely, being alone, carry no stress and no excess pore pressure, and keep their state.
template <class R, class Space, class T, int Dim>
struct LawLanes {
  const Soil<Space, T, Dim>& soil;
  int p, count;
  bool one_law;  // only material[0] is set
  bool some_fly = false;
  R flies = 0;  // 1 where a particle does
  int material[R::k_count] = {};
  Coord<Dim> corner{};  // cells, of the patch
  double spacing = 1;   // m

  KOKKOS_FORCEINLINE_FUNCTION void operator()(SymTensor<R, Dim>& stress,
                                              const Increment<R, T, Dim>& by) const {
    const AnyMaterial<T>& of = material_in(soil.materials.data()[material[0]]);
    const bool drains = soil.history.pore < 0 || !of.has_pore_pressure();
    if (one_law && !some_fly && drains && update_light(LightMaterials{}, of, stress, by)) return;
    stress = updated(*this, stress, by);
  }
  /// gap_room() of the particles, after their laws.
  [[gnu::noinline]] KOKKOS_FUNCTION R room() const {
    R factor = 1;
    for (int l = 0; l < count; ++l) factor.set(l, gap_room(soil, p + l));
    return factor;
  }

 private:
  /// New value of a state variable where all particles are the law's.
  struct AllChange {
    KOKKOS_FORCEINLINE_FUNCTION R operator()(const R& after, const R&) const { return after; }
  };

  /// The law of a material if it is a light one; false otherwise.
  template <template <class> class... Models>
  KOKKOS_FORCEINLINE_FUNCTION bool update_light(ModelList<Models...>, const AnyMaterial<T>& of,
                                                SymTensor<R, Dim>& stress,
                                                const Increment<R, T, Dim>& by) const {
    return ((of.which == model_index_in<Models>(Materials{}) &&
             (update_by(of.template as<Models>(), stress, by, FirstLanes{count}, AllChange{}), true)) ||
            ...);
  }

  /// Any law, in a function of its own. Beside the code of all laws, that of the light ones would be called
  /// instead of being part of the loop over particles, which then takes an eighth longer. By value, so that
  /// the loop keeps its values in registers.
  [[gnu::noinline]] static KOKKOS_FUNCTION SymTensor<R, Dim> updated(const LawLanes law,
                                                                     SymTensor<R, Dim> stress,
                                                                     const Increment<R, T, Dim> by) {
    if (law.one_law && !law.some_fly)
      law.update(law.material[0], stress, by, FirstLanes{law.count}, AllChange{}, AllChange{});
    else
      law.update_some(stress, by);
    return stress;
  }

  /// Each law takes all lanes; those that are not of its material keep what they have.
  KOKKOS_FUNCTION void update_some(SymTensor<R, Dim>& stress, const Increment<R, T, Dim>& by) const {
    const SymTensor<R, Dim> old = stress;
    bool done[R::k_count] = {};
    const auto material_of = [&](int l) { return material[one_law ? 0 : l]; };
    for (int l = 0; l < R::k_count; ++l) {
      if (done[l]) continue;
      R own = 0;
      for (int k = l; k < R::k_count; ++k)
        if (material_of(k) == material_of(l)) done[k] = true, own.set(k, T(1));
      const auto mine = own > 0;
      SymTensor<R, Dim> now = old;
      const auto moves = (own > 0) & (flies < 1);
      const int own_material = material_of(l);
      const auto kept = [&](const R& after, const R& was) { return select(moves, after, was); };
      update(
          own_material, now, by,
          [&](int k) { return k < count && material_of(k) == own_material && flies[k] < 1; }, kept,
          [&](const R& after, const R& was) {
            return select((own > 0) & (flies > 0), R(0), kept(after, was));
          });
      for (int k = 0; k < sym_size<Dim>; ++k) stress[k] = select(mine, now[k], stress[k]);
    }
    for (int k = 0; k < sym_size<Dim>; ++k) stress[k] = select(flies > 0, R(0), stress[k]);
  }

  /// The place of a lane's particle before the step.
  KOKKOS_INLINE_FUNCTION ParticlePlace place_of(int l) const {
    ParticlePlace place{.id = soil.id(p + l)};
    const Coord<Dim> cell = coord_of<Dim>(soil.cell(p + l));
    const Vector<T, Dim> x = soil.coordinate(p + l);
    for (int d = 0; d < Dim; ++d) place.position[d] = (double(corner[d]) + cell[d] + x[d]) * spacing;
    return place;
  }

  /// active(lane): whether the lane's particle is of this material. kept(after, before): what becomes of a
  /// state variable; kept_pressure: of the excess pore pressure.
  template <class Active, class Kept, class KeptPressure>
  KOKKOS_FORCEINLINE_FUNCTION void update(int m, SymTensor<R, Dim>& stress, const Increment<R, T, Dim>& by,
                                          const Active& active, const Kept& kept,
                                          const KeptPressure& kept_pressure) const {
    const AnyMaterial<T>& of = material_in(soil.materials.data()[m]);
    const bool undrained = soil.history.pore >= 0 && of.has_pore_pressure();
    R excess = 0;
    if (undrained) {
      load_field(soil.history.column[soil.history.pore], p, count, excess);
      add_isotropic(stress, excess);  // effective: the law's own
    }
    of.visit([&](const auto& law) { update_by(law, stress, by, active, kept); });
    if (!undrained) return;
    const R pressure = undrained_pressure(excess, of.pore_stiffness, by.strain);
    add_isotropic(stress, R(-pressure));
    store_field(kept_pressure(pressure, excess), soil.history.column[soil.history.pore], p, count);
  }

  template <class Law, class Active, class Kept>
  KOKKOS_FORCEINLINE_FUNCTION void update_by(const Law& law, SymTensor<R, Dim>& stress,
                                             const Increment<R, T, Dim>& by, const Active& active,
                                             const Kept& kept) const {
    LawState<R, state_size<Law>> was, state;
    for (int k = 0; k < state.size; ++k) {
      was[k] = 0;
      if (Law::state()[k].used && carries(law, k)) load_field(soil.history.column[k], p, count, was[k]);
      state[k] = was[k];
    }
    if constexpr (is_light<Law>())
      law.update(stress, state, by);  // a part of the caller
    else
      update_lanes(law, stress, state, by, active, [&](int l) { return place_of(l); });
    for (int k = 0; k < state.size && carries(law, k); ++k) {
      if (!changes_all<Law>() && !Law::state()[k].changes) continue;
      state[k] = kept(state[k], was[k]);
      if (any_of(state[k] != was[k])) store_field(state[k], soil.history.column[k], p, count);
    }
    if constexpr (can_fail<Law>()) mark_failed(law, state, stress);
  }

  /// The stress of a particle that its law calls failed is made not finite: fault_of() finds it.
  template <class Law>
  KOKKOS_INLINE_FUNCTION void mark_failed(const Law& law, const LawState<R, state_size<Law>>& state,
                                          SymTensor<R, Dim>& stress) const {
    for (int l = 0; l < count; ++l) {
      LawState<T, state_size<Law>> own;
      for (int k = 0; k < own.size; ++k) own[k] = state[k][l];
      if (law.failed(own)) stress[0].set(l, Kokkos::Experimental::quiet_NaN_v<T>);
    }
  }
};

}  // namespace mpm
