// Compares the counting of points by words of bits with a test of each point and its six
// neighbours.

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "run/layer.hpp"
#include "support/atom_sets.hpp"
#include "system/parallel.hpp"

namespace eses::detail::test {
namespace {

// The points of a whole grid.
struct GridPoints {
  GridIndex size{};
  std::vector<bool> inside;  // x fastest, then y, then z

  bool at(const GridIndex& p) const {
    return inside[static_cast<std::size_t>((p[2] * size[1] + p[1]) * size[0] + p[0])];
  }
};

template <class Action>
void for_each_index(const GridIndex& size, Action&& action) {
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x) action(GridIndex{x, y, z});
}

// Points are random, except in a half space without any, so that blocks may be empty.
GridPoints random_points(const GridIndex& size, double density, Random& random) {
  GridPoints points{size, {}};
  const auto axis = random.integer(0, 2);
  const double share = random.uniform(0, 1);
  for_each_index(size, [&](const GridIndex& p) {
    const bool is_filled = static_cast<double>(p[axis]) >= share * static_cast<double>(size[axis]);
    points.inside.push_back(is_filled && random.chance(density));
  });
  return points;
}

// Neighbours before the region are not known.
RegionTotals count_plainly(const GridPoints& points, const GridRegion& region) {
  RegionTotals counts;
  for_each_index(region.size(), [&](GridIndex p) {
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += region.begin[axis];
    const bool is_inside = points.at(p);
    bool is_irregular = false;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        GridIndex next = p;
        next[axis] += side;
        if (next[axis] < region.begin[axis] || next[axis] >= points.size[axis]) continue;
        is_irregular = is_irregular || points.at(next) != is_inside;
      }
    counts.inside_points += is_inside;
    counts.inside_regular += is_inside && !is_irregular;
    counts.irregular_points += is_irregular;
  });
  return counts;
}

BlockResult make_block(const GridPoints& points, const BlockBounds& block, bool keeps_zeros) {
  BlockResult result;
  result.block = block;
  result.inside.reset(block.points);
  PointBits& inside = result.inside;
  bool is_empty = true;
  for_each_index(block.points, [&](const GridIndex& p) {
    if (!points.at({block.first[0] + p[0], block.first[1] + p[1], block.first[2] + p[2]})) return;
    is_empty = false;
    for (std::int64_t column = 0; column < inside.columns; ++column) {
      const std::int64_t bit = p[0] - column * PointBits::column_step;
      if (bit >= 0 && bit < PointBits::column_points)
        inside.words[inside.word_index(column, p[1], p[2])] |= std::uint64_t{1} << bit;
    }
  });
  if (is_empty && !keeps_zeros) inside.reset_empty(block.points);
  return result;
}

struct CutGrid {
  BlockTiling tiling;
  std::vector<Layer> layers;
  std::size_t blocks_without_words = 0;
};

CutGrid cut(const GridPoints& points, const GridRegion& region, std::int64_t block_size,
            Random& random) {
  Grid grid;
  grid.size = points.size;
  CutGrid result{make_tiling(grid, block_size, region), {}, 0};
  const GridIndex blocks = result.tiling.blocks;
  for (std::int64_t bz = 0; bz < blocks[2]; ++bz) {
    Layer layer;
    for (std::int64_t by = 0; by < blocks[1]; ++by)
      for (std::int64_t bx = 0; bx < blocks[0]; ++bx) {
        layer.blocks.push_back(
            make_block(points, result.tiling.block(bx, by, bz), random.chance(0.3)));
        result.blocks_without_words += layer.blocks.back().inside.words.empty();
      }
    layer.inside.reset(result.tiling, layer.blocks.front().block.points[2]);
    parallel_for(blocks[0] * blocks[1], 3, [&](std::int64_t index, int) {
      const BlockResult& block = layer.blocks[static_cast<std::size_t>(index)];
      layer.inside.add(result.tiling, block.block, block.inside);
    });
    result.layers.push_back(std::move(layer));
  }
  return result;
}

RegionTotals count_all(const CutGrid& grid, Random& random) {
  RegionTotals counts;
  std::vector<std::uint64_t> below;
  for (const Layer& layer : grid.layers) {
    // The count is made in two parts, as threads make it.
    const std::int64_t rows = layer.owned_planes() * grid.tiling.region.size()[1];
    const auto middle =
        static_cast<std::int64_t>(random.integer(0, static_cast<std::size_t>(rows)));
    counts.add(count_points(grid.tiling, below, layer, {0, middle}));
    counts.add(count_points(grid.tiling, below, layer, {middle, rows}));
    const LayerBits::Row last = layer.inside.plane(layer.owned_planes() - 1);
    below.assign(last.begin(), last.end());
  }
  return counts;
}

// Returns the number of blocks without words.
std::size_t compare_counts(const GridPoints& points, const GridRegion& region,
                           std::int64_t block_size, Random& random) {
  const CutGrid grid = cut(points, region, block_size, random);
  const RegionTotals expected = count_plainly(points, region), counts = count_all(grid, random);
  CAPTURE(block_size, points.size, region.begin, region.end);
  CHECK(counts.inside_points == expected.inside_points);
  CHECK(counts.inside_regular == expected.inside_regular);
  CHECK(counts.irregular_points == expected.irregular_points);
  return grid.blocks_without_words;
}

}  // namespace

TEST_CASE("points are counted correctly however the grid is cut") {
  Random random(31);
  std::size_t blocks_without_words = 0;
  for (const std::int64_t block_size : {2, 3, 7, 64, 65, 66, 100, 130})
    for (int repetition = 0; repetition < 6; ++repetition) {
      // The last block of an axis may have only two points. Large blocks are cut thin.
      const std::size_t thin = block_size > 7 ? random.integer(0, 2) : 3;
      GridIndex size{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto blocks = static_cast<std::int64_t>(random.integer(1, block_size > 7 ? 2 : 3));
        const bool is_last_small = random.chance(0.4);
        size[axis] = axis == thin    ? 5
                     : is_last_small ? (blocks - 1) * (block_size - 1) + 2
                                     : blocks * (block_size - 1);
      }
      const double density = repetition % 3 == 0 ? 0.5 : repetition % 3 == 1 ? 0.03 : 0.97;
      const GridPoints points = random_points(size, density, random);
      blocks_without_words += compare_counts(points, {{}, size}, block_size, random);
    }
  CHECK(blocks_without_words > 20);
}

TEST_CASE("points of a grid that is one point thick are counted, too") {
  Random random(32);
  for (const GridIndex size : {GridIndex{1, 1, 1}, {1, 5, 70}, {70, 1, 5}, {5, 70, 1}, {64, 1, 1}})
    for (const std::int64_t block_size : {2, 64})
      compare_counts(random_points(size, 0.5, random), {{}, size}, block_size, random);
}

TEST_CASE("points of a region are counted with their neighbours in its halo") {
  Random random(33);
  for (const std::int64_t block_size : {2, 5, 17, 64, 65})
    for (int repetition = 0; repetition < 40; ++repetition) {
      GridRegion region;
      GridIndex size{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t longest = axis == 0 ? 150 : 12;
        region.begin[axis] = static_cast<std::int64_t>(random.integer(0, 3));
        // Rows of whole words are frequent.
        const std::size_t count = axis == 0 && random.chance(0.3) ? 64 * random.integer(1, 2)
                                                                  : random.integer(1, longest);
        region.end[axis] = region.begin[axis] + static_cast<std::int64_t>(count);
        size[axis] = region.end[axis] + static_cast<std::int64_t>(random.integer(0, 2));
      }
      compare_counts(random_points(size, 0.5, random), region, block_size, random);
    }
}

}  // namespace eses::detail::test
