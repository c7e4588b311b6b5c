#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "solve/intersect.cpp"
#include "solve/intersect.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <type_traits>

#include "eses/error.hpp"
#include "solve/cone_filter-inl.hpp"
#include "solve/edge_saddle-inl.hpp"
#include "solve/index_range.hpp"
#include "solve/line_sphere-inl.hpp"
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

// Fills the table of edges.
void tabulate_edges(const BlockGrid& grid, const PointBits& inside, EdgeTable& edges) {
  for (auto& changes : edges.changes) changes.resize(inside.words.size());
  edges.rank.resize(inside.words.size());
  std::uint64_t count = 0;
  for (std::int64_t z = 0; z < grid.block.owned[2]; ++z) {
    for (std::int64_t column = 0; column < inside.columns; ++column)
      find_changes(grid, inside, column, z, edges);
    for (std::int64_t y = 0; y < grid.block.owned[1]; ++y)
      for (std::int64_t column = 0; column < inside.columns; ++column) {
        const std::size_t w = inside.word_index(column, y, z);
        edges.rank[w] = static_cast<std::uint32_t>(count);
        for (const auto& changes : edges.changes)
          count += static_cast<std::uint64_t>(std::popcount(changes[w]));
      }
  }
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw Error("a block has more than 4.29e9 crossings; use a smaller block size");
  edges.count = static_cast<std::uint32_t>(count);
}

// Calls `action(axis)` with each axis as a compile-time constant.
template <class Action>
HWY_INLINE void for_each_axis(Action&& action) {
  action(std::integral_constant<std::size_t, 0>());
  action(std::integral_constant<std::size_t, 1>());
  action(std::integral_constant<std::size_t, 2>());
}

// The search for the crossings of one block.
struct Search {
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

  // Adds the points in which edges enter a convex patch: a van der Waals sphere in the directions
  // of its exposed face.
  void search_face(const FaceFeature& face) {
    const bool is_point = is_point_atom(face);
    ConeFilter filter(features.cones_of(face));
    for_each_axis([&](auto axis) {
      const auto is_exposed = [&](DoubleMask met, Points direction, DoubleVector length, int side) {
        if (is_point) {
          direction = {broadcast(0), broadcast(0), broadcast(0)};
          along<axis()>(direction) = broadcast(side);
          length = broadcast(1);
        }
        return filter.outside(met, direction, [&](const CapCone& cone) {
          return broadcast(cone.cosine) * length + broadcast(tolerance::seam);
        });
      };
      meet_lines<axis()>(grid, {face.center, face.radius, face.surface_box}, is_exposed,
                         [&](const GridIndex& line, double met, int side, Vec3 direction) {
                           BlockCrossing crossing{met,    direction, {face.atom}, 0,
                                                  axis(), 1,         side > 0};
                           if (is_point) {
                             crossing.normal = {};
                             crossing.normal[axis()] = side;
                           }
                           add_on_line(line, crossing);
                         });
    });
  }

  // Adds the points in which edges cross a concave patch: a probe's sphere in the directions of the
  // placement's normal cone. If the cone is not known, the whole sphere is used, and each candidate
  // needs a proof.
  void search_placement(const PlacementFeature& placement) {
    const auto is_in_cone = [&](DoubleMask met, const Points& direction, DoubleVector, int) {
      if (!placement.is_regular) return met;
      for (const Vec3& normal : placement.cone)
        met = hn::And(met, dot(normal, direction) >= broadcast(-tolerance::seam));
      return met;
    };
    for_each_axis([&](auto axis) {
      meet_lines<axis()>(grid, {placement.center, features.probe_radius, placement.box}, is_in_cone,
                         [&](const GridIndex& line, double met, int side, Vec3 direction) {
                           add_on_line(line,
                                       {met, -direction, placement.atoms, 0, axis(), 3, side < 0},
                                       !placement.is_regular);
                         });
    });
  }

  // Appends the edges of one word to the batch.
  template <std::size_t axis>
  void gather_edges(std::uint64_t changes, const WordPosition& word, Vec3 origin) {
    EdgeBatch& batch = scratch.batch;
    const std::int64_t first_x = word.column * PointBits::column_step;
    for_each_bit(changes, [&](int bit) {
      const GridIndex lower{first_x + bit, word.y, word.z};
      Vec3 start{coordinate(0, lower[0]), coordinate(1, word.y), coordinate(2, word.z)};
      const double low = start[axis], high = coordinate(axis, lower[axis] + 1);
      const bool lower_is_inside = is_inside(word.word, bit);
      start[axis] = lower_is_inside ? high : low;
      for (std::size_t a = 0; a < 3; ++a) batch.start[a][batch.count] = start[a] - origin[a];
      batch.from[batch.count] = start[axis];
      batch.step[batch.count] = lower_is_inside ? low - high : high - low;
      batch.key[batch.count] = word.word * 64 + static_cast<std::uint64_t>(bit);
      ++batch.count;
    });
  }

  template <std::size_t axis>
  void meet_batch(const ArcFeature& arc) {
    meet_saddle<axis>(
        arc, features.probe_radius, grid.grid.spacing, scratch.batch,
        [&](std::uint64_t key, double met, Vec3 normal) {
          const std::size_t word = key / 64;
          const auto bit = static_cast<int>(key % 64);
          add_candidate(
              edge_rank(axis, word, bit),
              {met, normal, {arc.atoms[0], arc.atoms[1]}, 0, axis, 2, is_inside(word, bit)});
        });
    scratch.batch.count = 0;
  }

  // Adds the points in which edges cross a saddle patch. Only edges that meet its box are tested.
  void search_arc(const ArcFeature& arc) {
    const Box& box = arc.surface_box;
    for_each_axis([&](auto axis) {
      std::array<IndexRange, 3> range;
      for (std::size_t a = 0; a < 3; ++a)
        range[a] = a == axis() ? own_edges_within(grid, a, box.low[a], box.high[a])
                               : own_points_within(grid, a, box.low[a], box.high[a]);
      for_each_word(inside, scratch.edges.changes[axis()], range,
                    [&](const WordPosition& word, std::uint64_t changes) {
                      gather_edges<axis()>(changes, word, arc.circle.center);
                      if (scratch.batch.count + 64 > EdgeBatch::capacity) meet_batch<axis()>(arc);
                    });
      meet_batch<axis()>(arc);
    });
  }

  // Appends the edges near the patch that start in a row of points to the batch.
  template <std::size_t axis>
  void gather_row(const ArcFeature& arc, const IndexRange& x, std::int64_t y, std::int64_t z) {
    EdgeBatch& batch = scratch.batch;
    const Doubles doubles;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(doubles));
    const Vec3 center = arc.circle.center;
    const double spacing = grid.grid.spacing;
    Points start{broadcast(0), broadcast(coordinate(1, y) - center.y),
                 broadcast(coordinate(2, z) - center.z)};
    for (std::int64_t i = x.begin; i < x.end; i += lanes) {
      start.x = load(grid.coordinates[0].data() + i) - broadcast(center.x);
      const auto is_off =
          misses_saddle<axis>(arc, features.probe_radius, spacing, start, broadcast(spacing));
      const auto may_cross =
          hn::AndNot(is_off, hn::FirstN(doubles, static_cast<std::size_t>(x.end - i)));
      if (hn::AllFalse(doubles, may_cross)) continue;
      for_each_lane(may_cross, [&](std::size_t lane) {
        const GridIndex lower{i + static_cast<std::int64_t>(lane), y, z};
        const std::int64_t column = std::min(lower[0] / PointBits::column_step, inside.columns - 1);
        const auto bit = static_cast<int>(lower[0] - column * PointBits::column_step);
        const std::size_t word = inside.word_index(column, y, z);
        if ((scratch.edges.changes[axis][word] >> bit & 1) != 0) return;
        const Vec3 from = grid_point(lower) - center;
        for (std::size_t a = 0; a < 3; ++a) batch.start[a][batch.count] = from[a];
        batch.from[batch.count] = coordinate(axis, lower[axis]);
        batch.step[batch.count] = coordinate(axis, lower[axis] + 1) - coordinate(axis, lower[axis]);
        batch.key[batch.count] =
            static_cast<std::uint64_t>((z * grid.block.owned[1] + y) << 16 | lower[0]);
        ++batch.count;
      });
      if (batch.count + hn::Lanes(doubles) > EdgeBatch::capacity) meet_doubtful<axis>(arc);
    }
  }

  Vec3 grid_point(const GridIndex& index) const {
    return {coordinate(0, index[0]), coordinate(1, index[1]), coordinate(2, index[2])};
  }

  template <std::size_t axis>
  void meet_doubtful(const ArcFeature& arc) {
    meet_saddle<axis>(arc, features.probe_radius, grid.grid.spacing, scratch.batch,
                      [&](std::uint64_t key, double, Vec3) {
                        scratch.doubtful.push_back({static_cast<std::uint32_t>(key >> 16),
                                                    static_cast<std::uint16_t>(key), axis});
                      });
    scratch.batch.count = 0;
  }

  // Edges that have both ends on one side, and leave the tube of the arc on the way up.
  void search_doubtful(const ArcFeature& arc) {
    const Box& box = arc.surface_box;
    for_each_axis([&](auto axis) {
      std::array<IndexRange, 3> range{};
      for (std::size_t a = 0; a < 3; ++a)
        range[a] = a == axis() ? own_edges_within(grid, a, box.low[a], box.high[a])
                               : own_points_within(grid, a, box.low[a], box.high[a]);
      range[axis()].end = std::min(range[axis()].end, grid.block.points[axis()] - 1);
      for (std::int64_t z = range[2].begin; z < range[2].end; ++z)
        for (std::int64_t y = range[1].begin; y < range[1].end; ++y)
          gather_row<axis()>(arc, range[0], y, z);
      meet_doubtful<axis()>(arc);
    });
  }

  void search_all() {
    for (const FaceFeature& face : features.faces) search_face(face);
    for (const ArcFeature& arc : features.arcs) search_arc(arc);
    if (scratch.finds_doubtful)
      for (const ArcFeature& arc : features.arcs) search_doubtful(arc);
    for (const PlacementFeature& placement : features.placements) search_placement(placement);
  }
};

static_assert(max_block_size - 1 <= std::numeric_limits<decltype(BlockCrossing::x)>::max());

// Makes a crossing for each edge in canonical order, with the edge only. Atom count 0 means that no
// candidate is known yet.
void list_edges(const BlockGrid& grid, const PointBits& inside, const EdgeTable& edges,
                std::vector<BlockCrossing>& crossings, std::vector<std::uint32_t>& row_begin) {
  crossings.resize(edges.count);
  BlockCrossing* next = crossings.data();
  for (std::int64_t z = 0; z < grid.block.owned[2]; ++z)
    for (std::int64_t y = 0; y < grid.block.owned[1]; ++y) {
      row_begin.push_back(static_cast<std::uint32_t>(next - crossings.data()));
      for (std::int64_t column = 0; column < inside.columns; ++column) {
        const std::size_t word = inside.word_index(column, y, z);
        const std::array<std::uint64_t, 3> changes{edges.changes[0][word], edges.changes[1][word],
                                                   edges.changes[2][word]};
        for_each_bit(changes[0] | changes[1] | changes[2], [&](int bit) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            if ((changes[axis] >> bit & 1) == 0) continue;
            next->x = static_cast<std::uint16_t>(column * PointBits::column_step + bit);
            next->axis = static_cast<std::uint8_t>(axis);
            next->lower_is_inside = (inside.words[word] >> bit & 1) != 0;
            ++next;
          }
        });
      }
    }
  row_begin.push_back(edges.count);
}

// Decides the crossings of edges that have no candidate, or more than one.
void decide_remaining(const BlockGrid& grid, const BlockFeatures& features,
                      IntersectScratch& scratch, std::span<const std::uint32_t> row_begin,
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
    crossings[rank] = decide_crossing(scratch.patches, edge_of(rank), scratch.of_edge, needs_proof);
    crossings[rank].x = x;
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

void intersect(const BlockGrid& grid, const BlockFeatures& features, const PointBits& inside,
               IntersectScratch& scratch, std::vector<BlockCrossing>& crossings,
               std::vector<std::uint32_t>& row_begin) {
  tabulate_edges(grid, inside, scratch.edges);
  list_edges(grid, inside, scratch.edges, crossings, row_begin);
  scratch.more_candidates.clear();
  scratch.doubtful.clear();
  Search{grid, features, inside, scratch, crossings}.search_all();
  decide_remaining(grid, features, scratch, row_begin, crossings);
}

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eses::detail {
void intersect_edges(const BlockGrid& grid, const BlockFeatures& features, const PointBits& inside,
                     IntersectScratch& scratch, std::vector<BlockCrossing>& crossings,
                     std::vector<std::uint32_t>& row_begin) {
  scratch.batch.make_room();
  ESES_BEST_VERSION(intersect)(grid, features, inside, scratch, crossings, row_begin);
}

}  // namespace eses::detail
#endif  // HWY_ONCE
