#pragma once
// Values at nodes that several ranks reach, of other types than the sums of the soil, or that come together
// in another way: how they go into the entries of a halo message, and come out.

#include "functions/halo.hpp"
#include "loops/window.hpp"

namespace mpm {

/// A value as numbers of the type that halo messages have.
template <class T, class Value>
struct InWords {
  static constexpr int count = sizeof(Value) / sizeof(T);
  T of[count];
};

// A Field has
//   Value                    of 4 or 8 bytes, not fewer than a T
//   size                     of a node
//   load(node, k)            one that changes nothing where this rank has none
//   store(node, k, value)
//   combine(a, b)            in whichever order

/// Writes the values of shared nodes to the entries of `out`.
template <class Space, class T, class Field>
void pack_words(const Space& space, const HaloLists<Space>& lists, const Field& field, T* out) {
  using Value = typename Field::Value;
  constexpr int words = InWords<T, Value>::count;
  const auto node = lists.node;
  Kokkos::parallel_for(
      "mpm::pack_words", light(Kokkos::RangePolicy<Space>(space, 0, lists.sent * field.size)),
      KOKKOS_LAMBDA(int m) {
        const auto value =
            Kokkos::bit_cast<InWords<T, Value>>(field.load(node(m / field.size), m % field.size));
        for (int w = 0; w < words; ++w) out[std::size_t(m) * words + w] = value.of[w];
      });
}

/// Combines the values of each shared node with those that came in: the same on all ranks that reach it.
template <class Space, class T, class Field>
void combine_words(const Space& space, const HaloLists<Space>& lists, const Field& field, const T* in) {
  using Value = typename Field::Value;
  constexpr int words = InWords<T, Value>::count;
  const auto node = lists.shared_node, begin = lists.begin, source = lists.source;
  Kokkos::parallel_for(
      "mpm::combine_words", light(Kokkos::RangePolicy<Space>(space, 0, lists.shared * field.size)),
      KOKKOS_LAMBDA(int m) {
        const int n = m / field.size, k = m % field.size;
        Value all = field.load(node(n), k);
        for (int e = begin(n); e < begin(n + 1); ++e) {
          if (source(e) < 0) continue;
          InWords<T, Value> value;
          const std::size_t at = (std::size_t(source(e)) * field.size + k) * words;
          for (int w = 0; w < words; ++w) value.of[w] = in[at + w];
          all = field.combine(all, Kokkos::bit_cast<Value>(value));
        }
        field.store(node(n), k, all);
      });
}

}  // namespace mpm
