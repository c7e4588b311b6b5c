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

// Edges of a table that may meet a patch. A code is four times the index of an edge, plus its axis.
// Several codes are stored at a time, without a branch for each, which would often be predicted
// wrongly.
struct EdgeCodes {
  std::array<std::uint64_t, EdgeBatch::capacity + vector_padding>& codes;
  std::size_t count = 0;

  // Appends `added` edges along an axis, from `first` on.
  HWY_INLINE void append(std::size_t first, std::size_t added, std::size_t axis) {
    const Words words;
    const std::size_t lanes = hn::Lanes(words);
    const auto steps = hn::ShiftLeft<2>(hn::Iota(words, 0));
    std::size_t stored = 0;
    do {
      const auto code = hn::Set(words, std::uint64_t{4} * (first + stored) + axis);
      hn::StoreU(hn::Add(code, steps), words, &codes[count + stored]);
      stored += lanes;
    } while (stored < added);
    count += added;
  }
};

// Copies the edges with these codes from the table to the batch, whose keys become their indices.
HWY_INLINE void load_edges(const EdgeTable& table, EdgeCodes& edges, EdgeBatch& batch) {
  const Doubles doubles;
  const Words words;
  const hn::RebindToSigned<Doubles> indices;
  batch.count = edges.count;
  for (std::size_t i = 0; i < edges.count; i += hn::Lanes(doubles)) {
    const auto code =
        hn::IfThenElseZero(hn::FirstN(words, edges.count - i), hn::LoadU(words, &edges.codes[i]));
    const auto index = hn::ShiftRight<2>(code);
    const auto copy = [&](const std::vector<double>& from, double* to) {
      hn::StoreU(hn::GatherIndex(doubles, from.data(), hn::BitCast(indices, index)), doubles, to);
    };
    copy(table.x, &batch.x[i]);
    copy(table.y, &batch.y[i]);
    copy(table.z, &batch.z[i]);
    copy(table.to, &batch.to[i]);
    const auto axis = hn::ConvertTo(
        doubles, hn::BitCast(indices, hn::And(code, hn::Set(words, std::uint64_t{3}))));
    hn::StoreU(axis, doubles, &batch.axis[i]);
    hn::StoreU(index, words, &batch.key[i]);
  }
  edges.count = 0;
}

HWY_INLINE std::size_t bit_count(std::uint64_t word) {
  return static_cast<std::size_t>(std::popcount(word));
}

// Gathers the edges with one end inside and one outside that may meet a box. Calls `meet()`, which
// empties the batch, when it is full and at the end.
template <class Meet>
HWY_INLINE void for_edges_near(const Candidates& candidates, const Box& box, Meet&& meet) {
  const Words lanes;
  const PointBits& inside = candidates.inside;
  const EdgeTable& table = candidates.scratch.edges;
  EdgeCodes edges{candidates.scratch.codes};
  const auto meet_edges = [&] {
    load_edges(table, edges, candidates.scratch.batch);
    meet();
  };
  const BoxRange x(candidates.grid, 0, box), y(candidates.grid, 1, box), z(candidates.grid, 2, box);
  const auto& changes = table.changes;
  const AxisRange columns = columns_of(x.edges, inside.columns);
  // The rows of a plane that are in the box, in the lanes from `first` on.
  const auto rows_in_box = [&](std::int64_t first) {
    const auto rows = [&](std::int64_t end) {
      return hn::FirstN(lanes, static_cast<std::size_t>(std::max<std::int64_t>(end - first, 0)));
    };
    return hn::VecFromMask(lanes, hn::AndNot(rows(y.points.begin), rows(y.points.end)));
  };
  for (std::int64_t column = columns.begin; column < columns.end; ++column) {
    const std::uint64_t x_edge_bits = column_bits(x.edges, column);
    const std::uint64_t x_point_bits = column_bits(x.points, column);
    const std::uint64_t before_edges = low_bits(std::countr_zero(x_edge_bits));
    const std::uint64_t before_points = low_bits(std::countr_zero(x_point_bits));
    const auto x_edges = hn::Set(lanes, x_edge_bits), x_points = hn::Set(lanes, x_point_bits);
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
          std::size_t first = table.first[word + lane];
          const auto append = [&](std::size_t axis, std::uint64_t before) {
            const std::uint64_t all = changes[axis][word + lane];
            edges.append(first + bit_count(all & before), bit_count(found[axis][lane]), axis);
            first += bit_count(all);
          };
          append(0, before_edges);
          append(1, before_points);
          append(2, before_points);
          if (edges.count + 3 * PointBits::column_points > EdgeBatch::capacity) meet_edges();
        });
      }
    }
  }
  meet_edges();
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
