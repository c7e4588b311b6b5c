#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/intersect.cpp"
#include "solve/intersect.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "eses/error.hpp"
#include "solve/search_doubtful-inl.hpp"
#include "solve/search_patches-inl.hpp"
#include "system/dispatch.hpp"
#include "system/padding.hpp"

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// Finds the edges of one column in one plane that have one end inside and one outside.
void find_changes(const BlockGrid& grid, const PointBits& inside, std::int64_t column,
                  std::int64_t z, EdgeTable& edges) {
  const GridIndex points = grid.block.points, owned = grid.block.owned;
  const std::int64_t first = column * PointBits::column_step;
  const std::uint64_t starts = low_bits(inside.owned_in_column(column, owned[0]));
  const std::uint64_t starts_x = starts & low_bits(points[0] - 1 - first);
  const std::uint64_t starts_z = z + 1 < points[2] ? starts : 0;
  const std::size_t begin = inside.word_index(column, 0, z);
  const std::uint64_t* const words = inside.words.data() + begin;
  const std::uint64_t* const above = starts_z != 0 ? words + points[1] : words;
  std::uint64_t* const x = edges.changes[0].data() + begin;
  std::uint64_t* const y = edges.changes[1].data() + begin;
  std::uint64_t* const up = edges.changes[2].data() + begin;
  for (std::int64_t j = 0; j < owned[1]; ++j) {
    x[j] = (words[j] ^ (words[j] >> 1)) & starts_x;
    y[j] = (words[j] ^ words[j + 1]) & starts;
    up[j] = (words[j] ^ above[j]) & starts_z;
  }
  if (owned[1] == points[1]) y[owned[1] - 1] = 0;
}

// Finds the edges, and counts those of each word.
void find_all_changes(const BlockGrid& grid, const PointBits& inside, EdgeTable& edges) {
  for (auto& changes : edges.changes) changes.resize(inside.words.size());
  edges.first.resize(inside.words.size());
  std::uint64_t count = 0;
  for (std::int64_t z = 0; z < grid.block.owned[2]; ++z) {
    for (std::int64_t column = 0; column < inside.columns; ++column)
      find_changes(grid, inside, column, z, edges);
    for (std::int64_t y = 0; y < grid.block.owned[1]; ++y)
      for (std::int64_t column = 0; column < inside.columns; ++column) {
        const std::size_t w = inside.word_index(column, y, z);
        edges.first[w] = static_cast<std::uint32_t>(count);
        for (const auto& changes : edges.changes) count += bit_count(changes[w]);
      }
  }
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw Error("a block has more than 4.29e9 crossings; use a smaller block size");
  edges.resize(static_cast<std::uint32_t>(count));
}

void search_all(const Candidates& candidates) {
  const BlockFeatures& features = candidates.features;
  const auto search = [](const auto& features_of_kind, auto&& kind) {
    for (const auto& feature : features_of_kind) kind.search(feature);
  };
  search(features.faces, PatchSearch{candidates});
  search(features.arcs, PatchSearch{candidates});
  search(features.placements, PatchSearch{candidates});
  if (!candidates.scratch.finds_doubtful) return;
  search(features.faces, DoubtfulSearch{candidates});
  search(features.arcs, DoubtfulSearch{candidates});
  search(features.placements, DoubtfulSearch{candidates});
}

static_assert(max_block_size - 1 <= std::numeric_limits<decltype(BlockCrossing::x)>::max());

// Fills the table with the edges of one word, and makes their crossings, with the edge only. Atom
// count 0 means that no candidate is known yet. `rank` is the number of edges before the word.
// Edges that do not exist are stored, too, where nothing is read, as branches for the edges of a
// point would often be predicted wrongly.
HWY_INLINE std::uint32_t tabulate_word(const BlockGrid& grid, const PointBits& inside,
                                       const WordPosition& word, std::uint32_t rank,
                                       EdgeTable& edges, BlockCrossing* crossings) {
  const std::int64_t first_x = word.column * PointBits::column_step;
  const double* const x = grid.coordinates[0].data() + first_x;
  const double* const y = grid.coordinates[1].data() + word.y;
  const double* const z = grid.coordinates[2].data() + word.z;
  const std::uint64_t is_inside = inside.words[word.word];
  std::array<std::uint64_t, 3> changes{};
  std::array<std::size_t, 3> next{};
  std::size_t end = edges.first[word.word];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    changes[axis] = edges.changes[axis][word.word];
    next[axis] = end;
    end += bit_count(changes[axis]);
  }
  BlockCrossing unused;
  for_each_bit(changes[0] | changes[1] | changes[2], [&](int bit) {
    const bool lower_is_inside = (is_inside >> bit & 1) != 0;
    const std::array<const double*, 3> lower{x + bit, y, z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool exists = (changes[axis] >> bit & 1) != 0;
      const std::size_t at = exists ? next[axis] : edges.count;
      const double low = lower[axis][0], high = lower[axis][1];
      const double from = lower_is_inside ? high : low;
      edges.x[at] = axis == 0 ? from : *lower[0];
      edges.y[at] = axis == 1 ? from : *lower[1];
      edges.z[at] = axis == 2 ? from : *lower[2];
      edges.to[at] = lower_is_inside ? low : high;
      edges.rank[at] = rank;
      BlockCrossing& crossing = exists ? crossings[rank] : unused;
      crossing.x = static_cast<std::uint16_t>(first_x + bit);
      crossing.axis = static_cast<std::uint8_t>(axis);
      crossing.atom_count = 0;
      crossing.lower_is_inside = lower_is_inside;
      next[axis] += exists ? 1 : 0;
      rank += exists ? 1 : 0;
    }
  });
  return rank;
}

// Fills the table of edges, and makes a crossing for each edge in canonical order.
void tabulate_edges(const BlockGrid& grid, const PointBits& inside, EdgeTable& edges,
                    std::vector<BlockCrossing>& crossings, std::vector<std::uint32_t>& row_begin) {
  find_all_changes(grid, inside, edges);
  if (crossings.capacity() < edges.count) crossings.clear();
  crossings.resize(edges.count);
  std::uint32_t rank = 0;
  for (std::int64_t z = 0; z < grid.block.owned[2]; ++z)
    for (std::int64_t y = 0; y < grid.block.owned[1]; ++y) {
      row_begin.push_back(rank);
      for (std::int64_t column = 0; column < inside.columns; ++column)
        rank = tabulate_word(grid, inside, {column, y, z, inside.word_index(column, y, z)}, rank,
                             edges, crossings.data());
    }
  row_begin.push_back(edges.count);
}

// Decides the crossings of edges that have no candidate, or more than one.
void decide_remaining(const SurfaceModel& surface, const BlockGrid& grid,
                      const BlockFeatures& features, IntersectScratch& scratch,
                      std::span<const std::uint32_t> row_begin, Tally& tally,
                      std::vector<BlockCrossing>& crossings) {
  bool is_indexed = false;
  const auto edge_of = [&](std::uint32_t rank) {
    const BlockCrossing& crossing = crossings[rank];
    const auto next_row = std::upper_bound(row_begin.begin(), row_begin.end(), rank);
    const std::int64_t row = next_row - row_begin.begin() - 1;
    const std::int64_t y = row % grid.block.owned[1], z = row / grid.block.owned[1];
    return make_crossed_edge(grid, crossing.axis, {crossing.x, y, z}, crossing.lower_is_inside);
  };
  const auto decide = [&](std::uint32_t rank, bool needs_proof) {
    const std::uint16_t x = crossings[rank].x;
    if (scratch.finds_doubtful) {
      const auto next_row = std::upper_bound(row_begin.begin(), row_begin.end(), rank);
      scratch.doubtful.push_back(
          {static_cast<std::uint32_t>(next_row - row_begin.begin() - 1), x, crossings[rank].axis});
    }
    if (!is_indexed) scratch.patches.reset(features, grid.box);
    is_indexed = true;
    const CrossedEdge edge = edge_of(rank);
    const auto count = [&](int sign) {
      tally.add_edge(surface, crossings[rank], edge.lower, grid.inverse_spacing, sign);
    };
    if (crossings[rank].atom_count != 0) count(-1);
    crossings[rank] = decide_crossing(scratch.patches, edge, scratch.of_edge, needs_proof);
    crossings[rank].x = x;
    count(1);
  };
  auto& more = scratch.more_candidates;
  std::sort(more.begin(), more.end(), [](const auto& a, const auto& b) { return a.edge < b.edge; });
  for (auto next = more.begin(); next != more.end();) {
    const std::uint32_t rank = next->edge;
    bool needs_proof = false;
    scratch.of_edge.clear();
    if (crossings[rank].atom_count != 0) scratch.of_edge.push_back(crossings[rank]);
    for (; next != more.end() && next->edge == rank; ++next) {
      scratch.of_edge.push_back(next->crossing);
      needs_proof = needs_proof || next->needs_proof;
    }
    decide(rank, needs_proof);
  }
  scratch.of_edge.clear();
  for (std::uint32_t rank = 0; rank < crossings.size(); ++rank)
    if (crossings[rank].atom_count == 0) decide(rank, false);
}

void intersect(const SurfaceModel& surface, const BlockGrid& grid, const BlockFeatures& features,
               const PointBits& inside, IntersectScratch& scratch, Tally& tally,
               std::vector<BlockCrossing>& crossings, std::vector<std::uint32_t>& row_begin) {
  tabulate_edges(grid, inside, scratch.edges, crossings, row_begin);
  scratch.more_candidates.clear();
  scratch.doubtful.clear();
  search_all({grid, features, inside, scratch, crossings, surface, tally});
  decide_remaining(surface, grid, features, scratch, row_begin, tally, crossings);
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
void intersect_edges(const SurfaceModel& surface, const BlockGrid& grid,
                     const BlockFeatures& features, const PointBits& inside,
                     IntersectScratch& scratch, Tally& tally, std::vector<BlockCrossing>& crossings,
                     std::vector<std::uint32_t>& row_begin) {
  ESES_BEST_VERSION(intersect)
  (surface, grid, features, inside, scratch, tally, crossings, row_begin);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
