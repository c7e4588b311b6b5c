/// Candidates for the crossings of a block. Highway includes this file once for each instruction
/// set.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "geometry/tolerances.hpp"
#include "grid/block_crossing.hpp"
#include "grid/point_bits.hpp"
#include "solve/block_features.hpp"
#include "solve/intersect.hpp"
#include "system/lanes-inl.hpp"

#if defined(ESES_SOLVE_CANDIDATES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_CANDIDATES_INL_
#undef ESES_SOLVE_CANDIDATES_INL_
#else
#define ESES_SOLVE_CANDIDATES_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// Calls `action(axis)` with each axis as a compile-time constant.
template <class Action>
HWY_INLINE void for_each_axis(Action&& action) {
  action(std::integral_constant<std::size_t, 0>());
  action(std::integral_constant<std::size_t, 1>());
  action(std::integral_constant<std::size_t, 2>());
}

// Collects candidates for the crossings of the edges of one block.
struct Candidates {
  const BlockGrid& grid;
  const BlockFeatures& features;
  const PointBits& inside;
  IntersectScratch& scratch;
  std::vector<BlockCrossing>& crossings;

  double coordinate(std::size_t axis, std::int64_t index) const {
    return grid.coordinates[axis][static_cast<std::size_t>(index)];
  }

  bool is_inside(std::size_t word, int bit) const { return (inside.words[word] >> bit & 1) != 0; }

  // Returns the index of an edge in canonical order.
  std::uint32_t edge_rank(std::size_t axis, std::size_t word, int bit) const {
    const EdgeTable& edges = scratch.edges;
    const std::uint64_t before = (std::uint64_t{1} << bit) - 1;
    int rank = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      rank += std::popcount(edges.changes[a][word] & before);
      if (a < axis) rank += static_cast<int>(edges.changes[a][word] >> bit & 1);
    }
    return edges.rank[word] + static_cast<std::uint32_t>(rank);
  }

  // Adds a candidate for the crossing of an edge.
  void add_candidate(std::uint32_t edge, BlockCrossing candidate, bool needs_proof = false) {
    BlockCrossing& first = crossings[edge];
    candidate.x = first.x;
    if (first.atom_count == 0 && !needs_proof) {
      first = candidate;
    } else {
      scratch.more_candidates.push_back({edge, needs_proof, candidate});
    }
  }

  void add_doubtful(const GridIndex& lower, std::size_t axis) {
    scratch.doubtful.push_back(
        {static_cast<std::uint32_t>(lower[2] * grid.block.owned[1] + lower[1]),
         static_cast<std::uint16_t>(lower[0]), static_cast<std::uint8_t>(axis)});
  }

  // Adds a candidate to the edge that starts at `lower`, if the block owns this edge, if its inside
  // end is that of the candidate, and if the candidate lies on it.
  void add_to_edge(GridIndex lower, BlockCrossing crossing, bool needs_proof) {
    const std::size_t axis = crossing.axis;
    if (lower[axis] < 0 || lower[axis] >= grid.block.owned[axis]) return;
    if (lower[axis] + 1 >= grid.block.points[axis]) return;
    const std::int64_t column = std::min(lower[0] / PointBits::column_step, inside.columns - 1);
    const auto bit = static_cast<int>(lower[0] - column * PointBits::column_step);
    const std::size_t word = inside.word_index(column, lower[1], lower[2]);
    const bool is_change = (scratch.edges.changes[axis][word] >> bit & 1) != 0;
    // If an edge is cut twice, one of its crossings has the inside end above.
    const bool may_be_doubtful = scratch.finds_doubtful && !is_change && !crossing.lower_is_inside;
    if (!may_be_doubtful && (!is_change || is_inside(word, bit) != crossing.lower_is_inside))
      return;
    const double low = coordinate(axis, lower[axis]), high = coordinate(axis, lower[axis] + 1);
    const double slack = tolerance::edge_end * (high - low);
    if (crossing.coordinate < low - slack || crossing.coordinate > high + slack) return;
    if (may_be_doubtful) {
      add_doubtful(lower, axis);
      return;
    }
    crossing.coordinate = std::clamp(crossing.coordinate, low, high);
    add_candidate(edge_rank(axis, word, bit), crossing, needs_proof);
  }

  // Adds a candidate to the edge of the line on which it lies, and to the next edge if it lies near
  // their common end.
  void add_on_line(GridIndex line, const BlockCrossing& crossing, bool needs_proof = false) {
    constexpr double near_end = 2 * tolerance::edge_end;
    const std::size_t axis = crossing.axis;
    const double position = (crossing.coordinate - grid.grid.origin[axis]) * grid.inverse_spacing -
                            static_cast<double>(grid.block.first[axis]);
    const double cell = std::floor(position);
    line[axis] = static_cast<std::int64_t>(cell);
    add_to_edge(line, crossing, needs_proof);
    if (position - cell < near_end) {
      --line[axis];
      add_to_edge(line, crossing, needs_proof);
    } else if (position - cell > 1 - near_end) {
      ++line[axis];
      add_to_edge(line, crossing, needs_proof);
    }
  }
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
