#pragma once
/// The edges of a block with one end inside and one outside.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "system/padding.hpp"

namespace eses::detail {

/// Edges by word of PointBits, then axis, then point. `changes` and `first` are indexed like
/// PointBits::words. Coordinates are in angstrom.
struct EdgeTable {
  std::array<std::vector<std::uint64_t>, 3> changes;  ///< by axis: bits of the edges' lower points
  std::vector<std::uint32_t> first;                   ///< index of the first edge of a word
  std::vector<double> x, y, z;                        ///< the outside ends
  std::vector<double> to;  ///< coordinate of the inside end along the axis
  std::vector<std::uint32_t>
      rank;  ///< index in canonical order: by lower point (z, y, x), then axis
  std::uint32_t count = 0;

  /// Memory of an edge in bytes.
  static constexpr std::size_t bytes_per_edge = 4 * sizeof(double) + sizeof(std::uint32_t);

  /// Sets the number of edges. Their values are unspecified; there is room for one more edge.
  void resize(std::uint32_t new_count) {
    count = new_count;
    if (rank.size() > count) return;
    for (auto* values : {&x, &y, &z, &to}) {
      values->clear();  // nothing is copied, and memory does not grow in large steps
      values->resize(count + 1 + vector_padding);
    }
    rank.clear();
    rank.resize(count + 1);
  }
};

}  // namespace eses::detail
