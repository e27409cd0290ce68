#pragma once
// Material points, as plain structs of views. A position is a cell and a coordinate from its lower corner:
// [0, 1) when the particles are binned by cell, [-1/2, 1/2) when they are binned by the nearest node
// (P2GPlan::about_nodes), and up to the margin beyond while they drift between two rebuilds.

#include <cstdint>

#include "base/half_length.hpp"
#include "base/types.hpp"
#include "data/face_terms.hpp"
#include "data/patches.hpp"
#include "physics/materials/stored.hpp"

namespace mpm {

/// Where points are, and in which order: by slot, by cell in it, and by id in the cell.
template <class Space, class T, int Dim>
struct Points {
  using Memory = typename Space::memory_space;
  int count = 0;  // points that have a slot, the first ones
  int all = 0;    // points in memory: those behind are far from the soil, or go to another rank
  Kokkos::View<Vector<T, Dim>*, Memory> coordinate;  // cells, from the lower corner of `cell`
  Kokkos::View<int*, Memory> cell;                   // number of the cell where the point was binned
  Kokkos::View<int*, Memory> id;                     // order of creation
};

/// Properties that all particles of a body share.
template <class T>
struct BodyProperties {
  T mass;                     // kg, of one particle, where the particles have none of their own
  HalfLength<T> half_length;  // cells, of one particle; where domains stretch, that at the start
  int material;               // index into Soil::materials
};

/// State variables [variable][particle]: column k holds variable k of the particle's law, whichever law that
/// is. As many columns are in use as the law with the most variables has, and one more for the excess pore
/// pressure where some material has a pore stiffness; the others take no memory.
template <class Space, class T>
struct LawHistory {
  static constexpr int most = k_most_state<Space> + 1;
  Kokkos::Array<Kokkos::View<T*, typename Space::memory_space>, most> column;
  Kokkos::Array<const char*, most> name{};  // of each column in use
  Kokkos::Array<bool, most> changes{};      // some law changes it
  int columns = 0;                          // in use
  int pore = -1;                            // column of the excess pore pressure [Pa]; -1: there is none
};

template <int Dim>
using Face = Vector<double, FaceTerms<Dim>::size>;

/// The soil: the particles of all deformable bodies.
template <class Space, class T, int Dim>
struct Soil : Points<Space, T, Dim> {
  using Memory = typename Space::memory_space;
  Kokkos::View<Vector<T, Dim>*, Memory> velocity;   // m/s
  Kokkos::View<SymTensor<T, Dim>*, Memory> stress;  // Pa, Cauchy, tension positive
  Kokkos::View<T*, Memory> volume;                  // m3, current
  LawHistory<Space, T> history;                     // state variables of the laws
  Kokkos::View<std::uint16_t*, Memory> body;        // index into bodies
  Kokkos::View<Matrix<T, Dim>*, Memory> affine;     // m/s a cell, C_p of APIC, in use where has_affine
  Kokkos::View<T*, Memory> mass;                    // kg, in use where has_own_mass
  /// In use where has_domain (physics/domain.hpp): half lengths along the axes [cells], which a step reads,
  /// and what they come from: the moments of the domain [cells2], and the coordinate [cells] and the volume
  /// [m3] when these changed last. Between sum_drift() and begin_domains() `begun` is the way since then.
  Kokkos::View<Vector<StoredLength<Space, T>, Dim>*, Memory> half_length;
  Kokkos::View<DomainMoments<T, Dim>*, Memory> domain;
  Kokkos::View<Vector<T, Dim>*, Memory> begun;
  Kokkos::View<T*, Memory> begun_volume;
  /// Id of the particle of the start that this one is, or a part of; in use where particles split.
  Kokkos::View<double*, Memory> ancestor;
  /// How often a particle has passed the upper side of each direction less the lower one; in use where the
  /// mesh is periodic.
  Kokkos::View<Vector<T, Dim>*, Memory> periods;
  /// The surfaces of loads that a particle is on; as many are in use as some particle needs.
  Kokkos::Array<Kokkos::View<Face<Dim>*, Memory>, k_most_faces> faces;
  /// In use where water flows in pores (physics/pore_flow.hpp): Darcy flux w = n (v_water - v) [m/s], volume
  /// of the grains [m3], and volume of water that has left [m3].
  Kokkos::View<Vector<T, Dim>*, Memory> flux;
  Kokkos::View<T*, Memory> solid_volume;
  Kokkos::View<double*, Memory> outflow;

  Kokkos::View<BodyProperties<T>*, Memory> bodies;
  Kokkos::View<StoredMaterial<T>*, Memory> materials;
  bool has_affine = false;    // the velocity update is APIC
  bool has_own_mass = false;  // the particles of some body differ in mass; the same on all ranks
  bool has_domain = false;    // the domains of the particles stretch with the soil
  T least_half_length = 0;    // cells, of such a domain (k_least_half_length)
  bool splits = false;        // particles with a domain that is too long are split; they have own masses
  bool has_periods = false;   // the mesh is periodic along some direction
  int face_count = 0;         // of `faces` in use; the same on all ranks
  bool has_flow = false;      // water flows in the pores of some body, whose particles have own masses
  bool rings = false;         // the particles are rings about the axis of revolution, as their masses
  const Coord<Dim>* patch_origin = nullptr;  // of them: lower cell of each slot (Patches::origin)

  /// Mass [kg] of particle p, which is of this body.
  KOKKOS_INLINE_FUNCTION T mass_of(int p, const BodyProperties<T>& of) const {
    return has_own_mass ? mass(p) : of.mass;
  }
  /// Index of the material of particle p.
  KOKKOS_INLINE_FUNCTION int material_of(int p) const { return bodies(body(p)).material; }
  /// The values of the state variables of particle p, whose law this is; 0 where the law does not carry one,
  /// and where no update uses it.
  template <class Law>
  KOKKOS_INLINE_FUNCTION LawState<T, state_size<Law>> state_of(const Law& law, int p) const {
    LawState<T, state_size<Law>> state{};
    for (int k = 0; k < state_size<Law>; ++k)
      state[k] = Law::state()[k].used && carries(law, k) ? history.column[k](p) : T(0);
    return state;
  }
  /// Excess pore pressure [Pa] of particle p, which is of this material: its stress is the effective stress
  /// less this pressure.
  template <class Material>
  KOKKOS_INLINE_FUNCTION T excess_pore_pressure(const Material& of, int p) const {
    return history.pore >= 0 && of.has_pore_pressure() ? history.column[history.pore](p) : T(0);
  }
  /// Properties of the body of particle p, with the particle's own mass.
  KOKKOS_INLINE_FUNCTION BodyProperties<T> properties(int p) const {
    BodyProperties<T> of = bodies(body(p));
    of.mass = mass_of(p, of);
    return of;
  }
};

/// The particles of one rigid body. They keep their place in the body, so that their motion gathers no
/// round-off.
template <class Space, class T, int Dim>
struct RigidPoints : Points<Space, T, Dim> {
  using Memory = typename Space::memory_space;
  Kokkos::View<Vector<double, Dim>*, Memory>
      reference_position;       // cells from the mesh's lower corner, at the start
  T mass = 0;                   // kg, of one particle
  HalfLength<T> half_length{};  // cells
  bool surface_normal = false;  // contact does not ask for their mass at the nodes
};

/// Use of a field by the update of the particles (function 5).
enum class Use { none, reads, changes };
/// Value of a field where one particle takes up another; a sum is halved where a particle is split. kept:
/// that of the particle which stays; or the merge sets it.
enum class Merged { kept, mass_mean, volume_mean, sum };
/// Values of a field at the start of a run. column: those of the field's column on the host
/// (k_particle_columns), or zero where there is none. own: upload_soil() has a function for it.
enum class Start { column, own };

/// A row of the table of fields.
struct ParticleField {
  const char* name;
  Use use;
  Merged merged = Merged::kept;
  Start start = Start::column;
};

/// Calls f(row, field...) for every field that holds one entry a particle, but cell and id, of some sets of
/// the same kind at once. The one table of fields: sorting, migration, merging, checkpoints, batches, memory
/// and the bytes that a step moves follow it.
#ifdef __CUDACC__
#pragma nv_exec_check_disable  // f may be of the host alone
#endif
template <class F, class Soil_, class... Others>
requires requires(Soil_& s) { s.history; }
KOKKOS_INLINE_FUNCTION void for_each_field_of(F&& f, Soil_& s, Others&... others) {
  using enum Use;
  using enum Merged;
  constexpr Start own = Start::own;
  f(ParticleField{"coordinate", changes, kept, own}, s.coordinate, others.coordinate...);
  f(ParticleField{"velocity", changes, mass_mean}, s.velocity, others.velocity...);
  f(ParticleField{"stress", changes, volume_mean}, s.stress, others.stress...);
  f(ParticleField{"volume", changes, sum}, s.volume, others.volume...);
  for (int k = 0; k < s.history.columns; ++k)
    f(ParticleField{s.history.name[k], s.history.changes[k] ? changes : reads, volume_mean, own},
      s.history.column[k], others.history.column[k]...);
  f(ParticleField{"body", s.bodies.extent(0) > 1 ? reads : none, kept, own}, s.body, others.body...);
  if (s.has_affine) f(ParticleField{"affine", none, mass_mean, own}, s.affine, others.affine...);
  if (s.has_own_mass) f(ParticleField{"mass", reads, sum}, s.mass, others.mass...);
  if (s.has_domain) {
    f(ParticleField{"half_length", reads, kept, own}, s.half_length, others.half_length...);
    f(ParticleField{"domain", none, kept, own}, s.domain, others.domain...);
    f(ParticleField{"begun", none}, s.begun, others.begun...);
    f(ParticleField{"begun_volume", none}, s.begun_volume, others.begun_volume...);
  }
  if (s.splits) f(ParticleField{"ancestor", none, kept, own}, s.ancestor, others.ancestor...);
  if (s.has_periods) f(ParticleField{"periods", none}, s.periods, others.periods...);
  constexpr const char* face_names[k_most_faces] = {"face_0", "face_1", "face_2"};
  for (int k = 0; k < s.face_count; ++k)
    f(ParticleField{face_names[k], none, kept, own}, s.faces[k], others.faces[k]...);
  if (s.has_flow) {
    f(ParticleField{"darcy_flux", none, volume_mean}, s.flux, others.flux...);
    f(ParticleField{"solid_volume", none, sum, own}, s.solid_volume, others.solid_volume...);
    f(ParticleField{"outflow", none, sum}, s.outflow, others.outflow...);
  }
}
template <class F, class RigidPoints_>
requires requires(RigidPoints_& s) { s.reference_position; }
void for_each_field_of(F&& f, RigidPoints_& s) {
  f(ParticleField{"coordinate", Use::none}, s.coordinate);
  f(ParticleField{"reference_position", Use::none}, s.reference_position);
}
/// The fields alone.
template <class Points_, class F>
void for_each_field(Points_& points, F&& f) {
  for_each_field_of([&](const ParticleField&, auto& field) { f(field); }, points);
}

/// Places for the sums of windows, so that many threads can make them at once.
template <class Space>
struct Windows {
  Kokkos::View<int*, typename Space::memory_space>
      place;  // of the window of a slot, from 1 on; 0: it has none
  Kokkos::View<char*, typename Space::memory_space> sums;  // of the windows, one after the other
};
/// Whether the strategy `tile` needs them.
template <class Space>
bool has_windows(const Space& space) {
  return has_threads(space);
}

/// Ranges of points by cell, and the lists of the strategies that need them. Valid while no point has moved
/// further than the margin that they were built with.
template <class Space>
struct Bins {
  using Memory = typename Space::memory_space;
  Kokkos::View<int*, Memory> begin;         // first point of a cell [cells + 1]
  int first_slot = 0, last_slot = 0;        // slots that may hold points: [first_slot, last_slot)
  Kokkos::View<int*, Memory> active_slots;  // slots that hold points, in rising order
  int first_active = 0, last_active = 0;    // range of active_slots that these bins cover
  int border = 0;  // on several ranks, without threads: this many of active_slots share nodes with other
                   // ranks. They come first; the border and the rest each rise.
  Kokkos::View<int*, Memory> list_begin;  // gather: first entry of a node's list [nodes + 1]
  Kokkos::View<int*, Memory> list;        // gather: points that may reach the node, in order
  Kokkos::View<long*, Memory> blocks;     // mosaic: blocks that hold points, ordered by colour
  int block_begin[8 + 1] = {};            // mosaic: ranges of blocks by colour
  Windows<Space> windows;                 // tile, many threads of a processor
};

/// Some of the slots that hold points, [first, last) of Bins::active_slots, and the stream that works on
/// them. Several parts: on a device, and with one thread.
template <class Space>
struct Part {
  Space space;
  int first, last;
};

/// The bins with these slots alone.
template <class Space>
Bins<Space> bins_of(const Bins<Space>& all, const Part<Space>& part) {
  Bins<Space> bins = all;
  bins.first_active = part.first, bins.last_active = part.last;
  return bins;
}

/// A set of points with what orders it.
template <class Space, class Points_>
struct ParticleSet {
  Points_ points;
  Bins<Space> bins;
  Kokkos::View<long*, typename Space::memory_space>
      address;  // scratch of a rebuild: Grid::address_of each point
  Kokkos::View<int*, typename Space::memory_space> order;  // scratch of a rebuild: former place of each point
};

}  // namespace mpm
