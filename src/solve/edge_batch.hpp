#pragma once
/// A batch of edges, for the intersection with one patch.

#include <array>
#include <cstddef>
#include <cstdint>

#include "system/padding.hpp"

namespace eses::detail {

/// Edges as a structure of arrays. Lengths are in angstrom.
struct EdgeBatch {
  static constexpr std::size_t capacity = 512;
  template <class Value>
  using List = std::array<Value, capacity + vector_padding>;

  List<double> x{}, y{}, z{};  ///< the outside ends
  List<double> to{};           ///< coordinate of the inside end along the axis
  List<double> axis{};         ///< 0, 1 or 2
  List<std::uint64_t> key{};   ///< any number by which the caller knows the edge
  std::size_t count = 0;
};

}  // namespace eses::detail
