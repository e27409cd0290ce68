#pragma once
// Copies between views as bytes. Kokkos::deep_copy compiles kernels for each pair of types, in case the
// entries are strided.

#include <stdexcept>
#include <type_traits>

#include <Kokkos_Core.hpp>

namespace mpm {

/// All entries of a view that lie one after the other, as bytes. T: char or const char.
template <class T, class View>
auto bytes_of(const View& view) {
  if (!view.span_is_contiguous()) throw std::logic_error("mpm: view " + view.label() + " is strided");
  using Bytes = Kokkos::View<T*, typename View::memory_space, Kokkos::MemoryUnmanaged>;
  return Bytes(reinterpret_cast<T*>(view.data()), view.span() * sizeof(typename View::value_type));
}

/// Whether the bytes of one kind of view mean the same in another.
template <class To, class From>
inline constexpr bool k_same_bytes =
    std::is_same_v<typename To::non_const_value_type, typename From::non_const_value_type> &&
    (std::is_same_v<typename To::array_layout, typename From::array_layout> || To::rank <= 1);

/// Kokkos::deep_copy(space, to, from) of views of one type of value without strides. Their values are those
/// that memcpy may copy, and sizes must agree.
template <class Space, class To, class From>
void copy(const Space& space, const To& to, const From& from) {
  static_assert(k_same_bytes<To, From>);
  Kokkos::deep_copy(space, bytes_of<char>(to), bytes_of<const char>(from));
}
/// Copies as above, after every kernel that was launched before has ended, and waits for the copy.
template <class To, class From>
void copy(const To& to, const From& from) {
  static_assert(k_same_bytes<To, From>);
  Kokkos::deep_copy(bytes_of<char>(to), bytes_of<const char>(from));
}

/// Kokkos::create_mirror_view_and_copy to the host: the view itself, where the host can read it.
template <class View>
auto mirror_of(const View& view) {
  const auto host = Kokkos::create_mirror_view(Kokkos::WithoutInitializing, view);
  if (host.data() != view.data())
    copy(host, view);
  else
    Kokkos::fence("mpm::mirror_of");
  return host;
}
/// Its first n entries.
template <class View>
auto mirror_of(const View& view, int n) {
  return mirror_of(Kokkos::subview(view, Kokkos::make_pair(0, n)));
}

}  // namespace mpm
