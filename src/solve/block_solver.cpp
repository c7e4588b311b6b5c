#include "solve/block_solver.hpp"

#include "solve/stopwatch.hpp"

namespace eses {
namespace {

void add_to_tally(const Surface& surface, const BlockGrid& grid, const BlockResult& result,
                  Tally& tally) {
  tally.atom_shares.resize(surface.atoms.size());
  const std::int64_t rows_y = result.block.owned[1];
  for (std::size_t row = 0; row + 1 < result.row_begin.size(); ++row)
    for (std::uint32_t c = result.row_begin[row]; c < result.row_begin[row + 1]; ++c) {
      const Crossing& crossing = result.crossings[c];
      const auto r = static_cast<std::int64_t>(row);
      Vec3 point{grid.coordinates[0][crossing.x],
                 grid.coordinates[1][static_cast<std::size_t>(r % rows_y)],
                 grid.coordinates[2][static_cast<std::size_t>(r / rows_y)]};
      point[crossing.axis] = crossing.coordinate;
      tally.add(surface, crossing, point);
    }
}

}  // namespace

BlockResult solve_block(const Surface& surface, const Grid& grid, const Block& block,
                        BlockWorkspace& workspace) {
  BlockResult result;
  result.block = block;
  const Stopwatch classifying;
  workspace.grid.reset(grid, block);
  collect_features(surface, workspace.grid.box, workspace.features);
  if (workspace.features.balls.empty()) {
    result.inside.reset_empty(block.points);
    return result;
  }
  classify_points(workspace.grid, workspace.features, workspace.classify, result.inside);
  workspace.classify_seconds += classifying.seconds();
  const Stopwatch intersecting;
  intersect_edges(workspace.grid, workspace.features, result.inside, workspace.intersect,
                  result.crossings, result.row_begin);
  add_to_tally(surface, workspace.grid, result, workspace.tally);
  workspace.intersect_seconds += intersecting.seconds();
  return result;
}

}  // namespace eses
