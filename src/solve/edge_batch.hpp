#pragma once
/// A batch of edges along one axis, for the intersection with one saddle patch.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "system/padding.hpp"

namespace eses::detail {

/// Edges as a structure of arrays. Lengths are in angstrom.
struct EdgeBatch {
  static constexpr std::size_t capacity = 512;

  /// The outside ends, relative to the centre of the arc's circle.
  std::array<std::vector<double>, 3> start;
  std::vector<double> from;        ///< coordinate of the outside ends along the axis
  std::vector<double> step;        ///< signed step along the axis to the inside ends
  std::vector<std::uint64_t> key;  ///< any number by which the caller knows the edge
  std::size_t count = 0;

  void make_room() {
    for (auto* values : {&start[0], &start[1], &start[2], &from, &step})
      values->resize(capacity + vector_padding);
    key.resize(capacity + vector_padding);
  }

  /// Copies the edge at one index to another index.
  void move(std::size_t index, std::size_t to) {
    for (auto* values : {&start[0], &start[1], &start[2], &from, &step})
      (*values)[to] = (*values)[index];
    key[to] = key[index];
  }
};

}  // namespace eses::detail
