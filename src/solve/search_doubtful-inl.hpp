/// The search for edges with both ends on one side that a patch may cut. Highway includes this file
/// once for each instruction set.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "solve/axis_range.hpp"
#include "solve/search_patches-inl.hpp"

#if defined(ESES_SOLVE_SEARCH_DOUBTFUL_INL_) == defined(HWY_TARGET_TOGGLE)
#ifdef ESES_SOLVE_SEARCH_DOUBTFUL_INL_
#undef ESES_SOLVE_SEARCH_DOUBTFUL_INL_
#else
#define ESES_SOLVE_SEARCH_DOUBTFUL_INL_
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

// Lists the edges. If an edge is cut twice, one of the cuts has the inside end above, so that only
// such cuts are searched.
struct DoubtfulSearch : Candidates {
  void search(const FaceFeature& face) {
    FacePart part(features, face);
    search_sphere(part, -1, [&](Vec3 direction) { return !features.is_filled(face, direction); });
  }

  void search(const PlacementFeature& placement) {
    search_sphere(PlacementPart(features, placement), 1, [](Vec3) { return true; });
  }

  // The edges leave the tube of the arc on the way up.
  void search(const ArcFeature& arc) {
    for_each_axis([&](auto axis) {
      const auto range_of = [&](std::size_t a) {
        const double low = arc.surface_box.low[a], high = arc.surface_box.high[a];
        return a == axis() ? own_edges_within(grid, a, low, high)
                           : own_points_within(grid, a, low, high);
      };
      std::array<AxisRange, 3> range{range_of(0), range_of(1), range_of(2)};
      range[axis()].end = std::min(range[axis()].end, grid.block.points[axis()] - 1);
      for (std::int64_t z = range[2].begin; z < range[2].end; ++z)
        for (std::int64_t y = range[1].begin; y < range[1].end; ++y)
          gather_row<axis()>(arc, range[0], y, z);
      meet_arc(arc);
    });
  }

 private:
  double coordinate(std::size_t axis, std::int64_t index) const {
    return grid.coordinates[axis][static_cast<std::size_t>(index)];
  }

  bool is_change(const GridIndex& lower, std::size_t axis) const {
    const std::int64_t column = std::min(lower[0] / PointBits::column_step, inside.columns - 1);
    const std::size_t word = inside.word_index(column, lower[1], lower[2]);
    return (scratch.edges.changes[axis][word] >> (lower[0] - column * PointBits::column_step) &
            1) != 0;
  }

  // Adds the edge that starts at `lower`, if the block owns it, if its ends are on one side, and if
  // the cut lies on it.
  void add_edge(const GridIndex& lower, std::size_t axis, double cut) {
    if (lower[axis] < 0 || lower[axis] >= grid.block.owned[axis]) return;
    if (lower[axis] + 1 >= grid.block.points[axis] || is_change(lower, axis)) return;
    const double low = coordinate(axis, lower[axis]), high = coordinate(axis, lower[axis] + 1);
    const double slack = tolerance::edge_end * (high - low);
    if (cut < low - slack || cut > high + slack) return;
    scratch.doubtful.push_back(
        {static_cast<std::uint32_t>(lower[2] * grid.block.owned[1] + lower[1]),
         static_cast<std::uint16_t>(lower[0]), static_cast<std::uint8_t>(axis)});
  }

  // Adds the edge of the line on which the cut lies, and the next edge if it lies near their common
  // end.
  void add_on_line(GridIndex line, std::size_t axis, double cut) {
    constexpr double near_end = 2 * tolerance::edge_end;
    const double position = (cut - grid.grid.origin[axis]) * grid.inverse_spacing -
                            static_cast<double>(grid.block.first[axis]);
    const double cell = std::floor(position);
    line[axis] = static_cast<std::int64_t>(cell);
    add_edge(line, axis, cut);
    if (position - cell < near_end) {
      --line[axis];
      add_edge(line, axis, cut);
    } else if (position - cell > 1 - near_end) {
      ++line[axis];
      add_edge(line, axis, cut);
    }
  }

  template <class Part, class IsKept>
  void search_sphere(Part&& part, double side, IsKept&& is_kept) {
    for_each_axis([&](auto axis) {
      meet_lines<axis()>(grid, part.sphere, side, part,
                         [&](const GridIndex& line, double cut, Vec3 direction) {
                           if (is_kept(direction)) add_on_line(line, axis(), cut);
                         });
    });
  }

  // Appends the edges near the patch of an arc that start in a row of points to the batch.
  template <std::size_t axis>
  void gather_row(const ArcFeature& arc, const AxisRange& x, std::int64_t y, std::int64_t z) {
    EdgeBatch& batch = scratch.batch;
    const Doubles doubles;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(doubles));
    const Vec3 center = arc.circle.center;
    const double spacing = grid.grid.spacing;
    for (std::int64_t i = x.begin; i < x.end; i += lanes) {
      const Points lower{load(grid.coordinates[0].data() + i), broadcast(coordinate(1, y)),
                         broadcast(coordinate(2, z))};
      const LaneAxes along(broadcast(axis));
      const LaneEdges edges(along, lower, along.of(lower) + broadcast(spacing), center);
      const auto is_off = misses_saddle(arc, features.probe_radius, spacing, edges);
      const auto may_cross =
          hn::AndNot(is_off, hn::FirstN(doubles, static_cast<std::size_t>(x.end - i)));
      if (hn::AllFalse(doubles, may_cross)) continue;
      for_each_lane(may_cross, [&](std::size_t lane) {
        append({i + static_cast<std::int64_t>(lane), y, z}, axis, batch);
      });
      if (batch.count + hn::Lanes(doubles) > EdgeBatch::capacity) meet_arc(arc);
    }
  }

  // Appends the edge that starts at `lower`, if its ends are on one side.
  void append(const GridIndex& lower, std::size_t axis, EdgeBatch& batch) const {
    if (is_change(lower, axis)) return;
    const std::size_t n = batch.count++;
    batch.x[n] = coordinate(0, lower[0]);
    batch.y[n] = coordinate(1, lower[1]);
    batch.z[n] = coordinate(2, lower[2]);
    batch.to[n] = coordinate(axis, lower[axis] + 1);
    batch.axis[n] = static_cast<double>(axis);
    batch.key[n] =
        static_cast<std::uint64_t>((lower[2] * grid.block.owned[1] + lower[1]) << 16 | lower[0]) *
            4 +
        axis;
  }

  void meet_arc(const ArcFeature& arc) {
    meet_saddle(
        arc, features.probe_radius, grid.grid.spacing, scratch.batch,
        [&](std::uint64_t key, double, Vec3) {
          scratch.doubtful.push_back({static_cast<std::uint32_t>(key >> 18),
                                      static_cast<std::uint16_t>(key >> 2),
                                      static_cast<std::uint8_t>(key % 4)});
          return false;
        },
        [](const auto&...) {});
  }
};

}  // namespace eses::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
