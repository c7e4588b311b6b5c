/// The search for crossings with saddle patches. Highway includes this file once for each
/// instruction set.

#include <algorithm>
#include <array>
#include <cstdint>

#include "solve/axis_range.hpp"
#include "solve/candidates-inl.hpp"
#include "solve/edge_saddle-inl.hpp"

#if defined(ESES_SOLVE_SEARCH_SADDLES_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_SEARCH_SADDLES_INL_
#undef ESES_SOLVE_SEARCH_SADDLES_INL_
#else
#define ESES_SOLVE_SEARCH_SADDLES_INL_
#endif

HWY_BEFORE_NAMESPACE();
namespace eses::detail::HWY_NAMESPACE {

// Returns the edges along an axis that the block owns and that meet a box.
template <std::size_t axis>
HWY_INLINE std::array<AxisRange, 3> edges_near(const BlockGrid& grid, const Box& box) {
  std::array<AxisRange, 3> range;
  for (std::size_t a = 0; a < 3; ++a)
    range[a] = a == axis ? own_edges_within(grid, a, box.low[a], box.high[a])
                         : own_points_within(grid, a, box.low[a], box.high[a]);
  return range;
}

// The search in saddle patches. Only edges that have one end inside and one outside are tested.
struct ArcSearch : Candidates {
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
  void search(const ArcFeature& arc) {
    for_each_axis([&](auto axis) {
      const std::array<AxisRange, 3> range = edges_near<axis()>(grid, arc.surface_box);
      for_each_word(inside, scratch.edges.changes[axis()], range,
                    [&](const WordPosition& word, std::uint64_t changes) {
                      gather_edges<axis()>(changes, word, arc.circle.center);
                      if (scratch.batch.count + 64 > EdgeBatch::capacity) meet_batch<axis()>(arc);
                    });
      meet_batch<axis()>(arc);
    });
  }
};

// The search for edges that cross a saddle patch twice.
struct DoubtfulSearch : Candidates {
  // Appends the edges near the patch that start in a row of points to the batch.
  template <std::size_t axis>
  void gather_row(const ArcFeature& arc, const AxisRange& x, std::int64_t y, std::int64_t z) {
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
  void search(const ArcFeature& arc) {
    for_each_axis([&](auto axis) {
      std::array<AxisRange, 3> range = edges_near<axis()>(grid, arc.surface_box);
      range[axis()].end = std::min(range[axis()].end, grid.block.points[axis()] - 1);
      for (std::int64_t z = range[2].begin; z < range[2].end; ++z)
        for (std::int64_t y = range[1].begin; y < range[1].end; ++y)
          gather_row<axis()>(arc, range[0], y, z);
      meet_doubtful<axis()>(arc);
    });
  }
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
