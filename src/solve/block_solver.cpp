#include "solve/block_solver.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses::detail {
namespace {

// Sets the bits of the points within `ion_radius` of a van der Waals sphere.
void cover_points(const SurfaceModel& surface, double ion_radius, BlockWorkspace& workspace,
                  PointBits& covered) {
  const Box& box = workspace.grid.box;
  std::vector<AtomIndex>& nearby = workspace.features.nearby;
  surface.tree().find_reaching(box, ion_radius + look_up_slack, nearby);
  if (nearby.empty())
    covered.reset_empty(workspace.grid.block.points);
  else
    fill_balls(workspace.grid, surface.atoms, nearby, ion_radius, covered);
}

// Sets the bits of all points.
void fill_all(const BlockGrid& grid, PointBits& bits) {
  bits.reset(grid.block.points);
  const std::int64_t rows = bits.size[1] * bits.size[2];
  for (std::int64_t column = 0; column < bits.columns; ++column)
    std::fill_n(bits.words.begin() + static_cast<std::ptrdiff_t>(bits.word_index(column, 0, 0)),
                rows, low_bits(bits.size[0] - column * PointBits::column_step));
}

// Adds the points of filled components to the inside points, and to those without ion access.
void fill_cavities(const SurfaceModel& surface, BlockWorkspace& workspace, BlockResult& result) {
  if (!surface.cavities->may_be_filled(workspace.grid.box)) return;
  PointBits filled;
  find_filled_points(surface, workspace.grid, workspace.features, workspace.filled, filled);
  const auto add_to = [&](PointBits& bits) {
    for (std::size_t w = 0; w < filled.words.size(); ++w) bits.words[w] |= filled.words[w];
  };
  add_to(result.inside);
  if (!workspace.extras.ion_radius) return;
  if (result.covered.words.empty()) result.covered.reset(workspace.grid.block.points);
  add_to(result.covered);
}

// Finds inside points and crossings, and adds these to the sums. Inside lengths are found for the
// edges that start at the `owned` points.
BlockResult find_crossings(const Patches& patches, const Grid& grid, const BlockBounds& block,
                           const GridIndex& owned, BlockWorkspace& workspace) {
  BlockResult result;
  result.block = block;
  const Stopwatch classifying;
  workspace.grid.reset(grid, block);
  if (workspace.extras.ion_radius)
    cover_points(patches.surface(), *workspace.extras.ion_radius, workspace, result.covered);
  const SurfaceModel& surface = patches.surface();
  if (surface.cavities &&
      !surface.cavities->may_be_kept(grown(workspace.grid.box, surface.probe_radius))) {
    fill_all(workspace.grid, result.inside);
    return result;
  }
  collect_features(patches, workspace.grid.box, workspace.features);
  if (workspace.features.balls.empty() && workspace.features.cavities == nullptr) {
    result.inside.reset_empty(block.points);
    return result;
  }
  classify_points(workspace.grid, workspace.features, workspace.classify, result.inside);
  if (workspace.features.cavities != nullptr) fill_cavities(surface, workspace, result);
  workspace.classify_seconds += classifying.seconds();
  const Stopwatch intersecting;
  result.crossings.swap(workspace.spare.crossings);
  result.row_begin.swap(workspace.spare.row_begin);
  workspace.intersect.finds_doubtful = workspace.extras.inside_fractions;
  intersect_edges(surface, workspace.grid, workspace.features, result.inside, workspace.intersect,
                  workspace.tally, result.crossings, result.row_begin);
  if (workspace.extras.inside_fractions)
    find_inside_fractions(workspace.grid, workspace.features, result.inside, result.crossings,
                          result.row_begin, owned, workspace.intersect, result.fractions);
  workspace.intersect_seconds += intersecting.seconds();
  return result;
}

// Moves the crossings that `block` does not own from `crossings` to `halo_crossings`. The result
// was computed for the same block with more owned points.
void split_off_halo_crossings(const BlockBounds& block, BlockResult& result) {
  const GridIndex wider = result.block.owned, owned = block.owned;
  result.block = block;
  if (wider == owned || result.row_begin.empty()) return;
  const std::vector<std::uint32_t> row_begin = std::move(result.row_begin);
  result.row_begin.clear();
  std::uint32_t kept = 0;
  for (std::int64_t z = 0; z < block.points[2]; ++z)
    for (std::int64_t y = 0; y < block.points[1]; ++y) {
      const bool is_owned = y < owned[1] && z < owned[2];
      if (is_owned) result.row_begin.push_back(kept);
      result.halo_row_begin.push_back(static_cast<std::uint32_t>(result.halo_crossings.size()));
      if (y >= wider[1] || z >= wider[2]) continue;
      const auto row = static_cast<std::size_t>(z * wider[1] + y);
      for (std::uint32_t c = row_begin[row]; c < row_begin[row + 1]; ++c) {
        const BlockCrossing crossing = result.crossings[c];
        if (is_owned && crossing.x < owned[0]) {
          result.crossings[kept++] = crossing;
        } else {
          result.halo_crossings.push_back(crossing);
        }
      }
    }
  result.crossings.resize(kept);
  result.row_begin.push_back(kept);
  result.halo_row_begin.push_back(static_cast<std::uint32_t>(result.halo_crossings.size()));
}

// Removes the halo crossings from the sums.
void remove_halo_crossings(const SurfaceModel& surface, const BlockResult& result,
                           BlockWorkspace& workspace) {
  const BlockGrid& grid = workspace.grid;
  const auto rows_y = static_cast<std::size_t>(result.block.points[1]);
  for (std::size_t row = 0; row + 1 < result.halo_row_begin.size(); ++row) {
    const double y = grid.coordinates[1][row % rows_y], z = grid.coordinates[2][row / rows_y];
    for (std::uint32_t c = result.halo_row_begin[row]; c < result.halo_row_begin[row + 1]; ++c) {
      const BlockCrossing& crossing = result.halo_crossings[c];
      workspace.tally.add_edge(surface, crossing, {grid.coordinates[0][crossing.x], y, z},
                               grid.inverse_spacing, -1);
    }
  }
}

}  // namespace

double BlockResult::memory_bytes(const GridIndex& points, const BlockExtras& extras) {
  constexpr double allocator = 64;
  const double bit_sets = extras.ion_radius ? 2 : 1, edge_lists = extras.inside_fractions ? 2 : 1;
  return sizeof(BlockResult) + allocator +
         sizeof(std::uint64_t) * static_cast<double>(PointBits::word_count(points)) * bit_sets +
         sizeof(std::uint32_t) * static_cast<double>(points[1] * points[2]) * edge_lists;
}

double BlockResult::kept_crossing_bytes(const BlockExtras& extras) {
  return (extras.keeps_crossings ? sizeof(BlockCrossing) : 0) +
         (extras.inside_fractions ? list_growth * sizeof(InsideFractions::Edge) : 0);
}

double BlockWorkspace::memory_bytes(const SurfaceSurvey& survey, const Grid& grid,
                                    const BlockTiling& tiling, int threads) {
  // Undecided points, edges along three axes, and their ranks.
  constexpr double bytes_per_word = 4 * sizeof(std::uint64_t) + sizeof(std::uint32_t);
  const auto words =
      static_cast<double>(PointBits::word_count(tiling.block_with_halo(0, 0, 0).points));
  return threads * bytes_per_word * words +
         BlockFeatures::memory_bytes(survey, grid, tiling, threads);
}

void BlockWorkspace::recycle_crossings(BlockResult& result) {
  if (result.row_begin.empty()) return;
  spare.crossings.swap(result.crossings);
  spare.row_begin.swap(result.row_begin);
  spare.row_begin.clear();
}

BlockResult solve_block(const Patches& patches, const Grid& grid, const BlockBounds& block,
                        BlockWorkspace& workspace) {
  return find_crossings(patches, grid, block, block.owned, workspace);
}

BlockResult solve_block_for_mesh(const Patches& patches, const Grid& grid, const BlockBounds& block,
                                 const BlockBounds& wider, BlockWorkspace& workspace) {
  BlockResult result = find_crossings(patches, grid, wider, block.owned, workspace);
  split_off_halo_crossings(block, result);
  remove_halo_crossings(patches.surface(), result, workspace);
  return result;
}

}  // namespace eses::detail
