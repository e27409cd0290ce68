#pragma once
// Entries of a field as plain numbers.

#include <type_traits>
#include <utility>

namespace mpm {

/// The number that an entry of a field is made of, and how many of them it has.
template <class Value>
auto number_of(const Value& value) {
  if constexpr (std::is_arithmetic_v<Value>)
    return value;
  else
    return value.c[0];
}
template <class Value>
using Number = decltype(number_of(std::declval<Value>()));
template <class Value>
constexpr int components_of = sizeof(Value) / sizeof(Number<Value>);

}  // namespace mpm
