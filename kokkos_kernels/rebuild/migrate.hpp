#pragma once
// Particles that go from rank to rank between locate() and sort_and_list(), as records of bytes that hold all
// their fields.

#include <vector>

#include "base/spaces.hpp"
#include "data/core.hpp"

namespace mpm {

/// Bytes of a particle on its way.
template <class Space, class T, int Dim>
std::size_t record_size(const Core<Space, T, Dim>& s);

/// A particle whose patch belongs to another rank now.
struct Leaver {
  int particle, rank;
};

/// Particles whose patch (ParticleSet::address) the table `owner` gives to another rank than `own`, in the
/// order of the particles.
template <class Space, class T, int Dim>
std::vector<Leaver> find_leavers(Core<Space, T, Dim>& s,
                                 const Kokkos::View<int*, typename Space::memory_space>& owner, int own);

/// Records of these particles, in this order. The particles have no place here any more: the next sort drops
/// them.
template <class Space, class T, int Dim>
std::vector<char> take_particles(Core<Space, T, Dim>& s, const std::vector<int>& particles);

/// Appends the particles of these records; the next sort puts them where they belong.
template <class Space, class T, int Dim>
void add_particles(Core<Space, T, Dim>& s, const std::vector<char>& records);

/// Makes room for n particles; those that are there stay.
template <class Space, class T, int Dim>
void reserve_particles(Core<Space, T, Dim>& s, int n);

/// Particles of this rank in each patch of the whole grid, by their addresses.
template <class Space, class T, int Dim>
std::vector<int> count_by_patch(const Core<Space, T, Dim>& s);

/// Whether particles of this rank are in each patch of each velocity field, by their addresses: 0 or 1.
template <class Space, class T, int Dim>
std::vector<std::uint8_t> occupied_by_field(const Core<Space, T, Dim>& s);

}  // namespace mpm
