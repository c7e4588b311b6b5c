#pragma once
/// Edges along one axis that wait to be held against one saddle patch.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simd/padding.hpp"

namespace eses::detail {

struct EdgeBatch {
  static constexpr std::size_t capacity = 512;

  /// The outside ends, from the centre of the arc's circle.
  std::array<std::vector<double>, 3> start;
  std::vector<double> from;          ///< coordinate of the outside ends along the axis
  std::vector<double> step;          ///< from there to the inside ends, signed
  std::vector<std::uint64_t> place;  ///< word index * 64 + bit of the lower ends
  std::size_t count = 0;

  void make_room() {
    for (auto* values : {&start[0], &start[1], &start[2], &from, &step})
      values->resize(capacity + vector_padding);
    place.resize(capacity + vector_padding);
  }
};

}  // namespace eses::detail
