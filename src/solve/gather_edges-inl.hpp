/// The edges of a block near a patch. Highway includes this file once for each instruction set.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "solve/axis_range.hpp"
#include "solve/candidates-inl.hpp"

#if defined(ESES_SOLVE_GATHER_EDGES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_GATHER_EDGES_INL_
#undef ESES_SOLVE_GATHER_EDGES_INL_
#else
#define ESES_SOLVE_GATHER_EDGES_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// Indices along one axis: the points in a box, and the lower points of edges along the axis that
// meet it. They are those of axis_range.hpp, rounded by the instruction set.
struct BoxRange {
  AxisRange points, edges;

  HWY_INLINE BoxRange(const BlockGrid& grid, std::size_t axis, const Box& box) {
    const auto index_of = [&](double coordinate) {
      return (coordinate - grid.grid.origin[axis]) * grid.inverse_spacing -
             static_cast<double>(grid.block.first[axis]);
    };
    const auto owned = static_cast<double>(grid.block.owned[axis]);
    const auto whole = [&](double index) {
      return static_cast<std::int64_t>(std::min(std::max(index, 0.0), owned));
    };
    const double low = index_of(box.low[axis]) - range_slack;
    const double high = index_of(box.high[axis]) + range_slack;
    points = {whole(std::ceil(low)), whole(std::floor(high) + 1)};
    // A crossing may lie slightly beyond the end of its edge.
    edges = {whole(std::ceil(low - 1 - tolerance::edge_end)),
             whole(std::floor(high + tolerance::edge_end) + 1)};
  }
};

// Appends the edges along an axis that start at the points `changes` of a word to the batch.
template <std::size_t axis>
HWY_INLINE void append_edges(const Candidates& candidates, const WordPosition& word,
                             std::uint64_t changes, EdgeBatch& batch) {
  const auto& coordinates = candidates.grid.coordinates;
  const std::uint64_t inside = candidates.inside.words[word.word];
  const double* const x = coordinates[0].data() + word.column * PointBits::column_step;
  const double* const y = coordinates[1].data() + word.y;
  const double* const z = coordinates[2].data() + word.z;
  std::size_t n = batch.count;
  for (; changes != 0; changes &= changes - 1, ++n) {
    const int bit = std::countr_zero(changes);
    const double* const ends = axis == 0 ? x + bit : axis == 1 ? y : z;
    const std::size_t outside = inside >> bit & 1;  // 1 if the upper end is outside
    const double from = ends[outside];
    batch.x[n] = axis == 0 ? from : x[bit];
    batch.y[n] = axis == 1 ? from : *y;
    batch.z[n] = axis == 2 ? from : *z;
    batch.to[n] = ends[1 - outside];
    batch.axis[n] = axis;
    batch.key[n] = Candidates::key_of(word.word, bit, axis);
  }
  batch.count = n;
}

// Gathers the edges with one end inside and one outside that may meet a box. Calls `meet()`, which
// empties the batch, when it is full and at the end.
template <class Meet>
HWY_INLINE void for_edges_near(const Candidates& candidates, const Box& box, Meet&& meet) {
  const Words lanes;
  const PointBits& inside = candidates.inside;
  EdgeBatch& batch = candidates.scratch.batch;
  const BoxRange x(candidates.grid, 0, box), y(candidates.grid, 1, box), z(candidates.grid, 2, box);
  const auto& changes = candidates.scratch.edges.changes;
  const AxisRange columns = columns_of(x.edges, inside.columns);
  // The rows of a plane that are in the box, in the lanes from `first` on.
  const auto rows_in_box = [&](std::int64_t first) {
    const auto rows = [&](std::int64_t end) {
      return hn::FirstN(lanes, static_cast<std::size_t>(std::max<std::int64_t>(end - first, 0)));
    };
    return hn::VecFromMask(lanes, hn::AndNot(rows(y.points.begin), rows(y.points.end)));
  };
  for (std::int64_t column = columns.begin; column < columns.end; ++column) {
    const auto x_edges = hn::Set(lanes, column_bits(x.edges, column));
    const auto x_points = hn::Set(lanes, column_bits(x.points, column));
    for (std::int64_t k = z.edges.begin; k < z.edges.end; ++k) {
      const std::uint64_t is_in_z = k >= z.points.begin && k < z.points.end ? ~std::uint64_t{0} : 0;
      const auto in_z = hn::Set(lanes, is_in_z);
      for (std::int64_t j = y.edges.begin; j < y.edges.end;
           j += static_cast<std::int64_t>(hn::Lanes(lanes))) {
        const std::size_t word = inside.word_index(column, j, k);
        const auto in_y = rows_in_box(j);
        const auto along_x =
            hn::And(hn::And(hn::LoadU(lanes, &changes[0][word]), x_edges), hn::And(in_y, in_z));
        const auto along_y = hn::And(hn::LoadU(lanes, &changes[1][word]), hn::And(x_points, in_z));
        const auto along_z = hn::And(hn::LoadU(lanes, &changes[2][word]), hn::And(x_points, in_y));
        const auto any = hn::Or(along_x, hn::Or(along_y, along_z));
        const auto has_edges =
            hn::AndNot(hn::Eq(any, hn::Zero(lanes)),
                       hn::FirstN(lanes, static_cast<std::size_t>(y.edges.end - j)));
        if (hn::AllFalse(lanes, has_edges)) continue;
        std::array<std::array<std::uint64_t, HWY_MAX_BYTES / sizeof(std::uint64_t)>, 3> found;
        hn::StoreU(along_x, lanes, found[0].data());
        hn::StoreU(along_y, lanes, found[1].data());
        hn::StoreU(along_z, lanes, found[2].data());
        for_each_lane(lanes, has_edges, [&](std::size_t lane) {
          const WordPosition position{column, j + static_cast<std::int64_t>(lane), k, word + lane};
          append_edges<0>(candidates, position, found[0][lane], batch);
          append_edges<1>(candidates, position, found[1][lane], batch);
          append_edges<2>(candidates, position, found[2][lane], batch);
          if (batch.count + 3 * PointBits::column_points > EdgeBatch::capacity) meet();
        });
      }
    }
  }
  meet();
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
