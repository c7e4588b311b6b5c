#pragma once
/// Indices with types of their own: enumerations without enumerators, such as FileIndex. The
/// compiler refuses an index of another kind, and there is no cost.

#include <type_traits>

namespace eses::detail {

template <class Index>
requires std::is_enum_v<Index>
constexpr std::underlying_type_t<Index> as_number(Index index) {
  return static_cast<std::underlying_type_t<Index>>(index);
}

}  // namespace eses::detail
