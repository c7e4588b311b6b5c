// Compares the counting of points by words of bits with a test of each point and its six
// neighbours.

#include <vector>

#include "catch.hpp"
#include "run/layer.hpp"
#include "support/atom_sets.hpp"

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

PointCounts count_plainly(const GridPoints& points) {
  PointCounts counts;
  for_each_index(points.size, [&](const GridIndex& p) {
    const bool is_inside = points.at(p);
    bool is_irregular = false;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        GridIndex next = p;
        next[axis] += side;
        if (next[axis] < 0 || next[axis] >= points.size[axis]) continue;
        is_irregular = is_irregular || points.at(next) != is_inside;
      }
    counts.inside += is_inside;
    counts.inside_regular += is_inside && !is_irregular;
    counts.irregular += is_irregular;
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

BlockTiling tile(const GridIndex& size, std::int64_t block_size) {
  Grid grid;
  grid.size = size;
  return make_tiling(grid, block_size);
}

struct CutGrid {
  BlockTiling tiling;
  std::vector<Layer> layers;
  std::size_t blocks_without_words = 0;
};

CutGrid cut(const GridPoints& points, std::int64_t block_size, Random& random) {
  CutGrid result{tile(points.size, block_size), {}, 0};
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
    for (const BlockResult& block : layer.blocks)
      layer.inside.add(result.tiling, block.block, block.inside);
    result.layers.push_back(std::move(layer));
  }
  return result;
}

PointCounts count_all(const CutGrid& grid, Random& random) {
  PointCounts counts;
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
      const CutGrid grid = cut(points, block_size, random);
      blocks_without_words += grid.blocks_without_words;
      const PointCounts expected = count_plainly(points);
      INFO("block size " << block_size << ", grid " << size[0] << " x " << size[1] << " x "
                         << size[2]);
      const PointCounts counts = count_all(grid, random);
      CHECK(counts.inside == expected.inside);
      CHECK(counts.inside_regular == expected.inside_regular);
      CHECK(counts.irregular == expected.irregular);
    }
  CHECK(blocks_without_words > 20);
}

TEST_CASE("points of a grid that is one point thick are counted, too") {
  Random random(32);
  for (const GridIndex size : {GridIndex{1, 1, 1}, {1, 5, 70}, {70, 1, 5}, {5, 70, 1}, {64, 1, 1}})
    for (const std::int64_t block_size : {2, 64}) {
      const GridPoints points = random_points(size, 0.5, random);
      const CutGrid grid = cut(points, block_size, random);
      const PointCounts expected = count_plainly(points);
      INFO("block size " << block_size << ", grid " << size[0] << " x " << size[1] << " x "
                         << size[2]);
      const PointCounts counts = count_all(grid, random);
      CHECK(counts.inside == expected.inside);
      CHECK(counts.inside_regular == expected.inside_regular);
      CHECK(counts.irregular == expected.irregular);
    }
}

}  // namespace eses::detail::test
