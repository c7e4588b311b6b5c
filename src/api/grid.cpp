#include "eses/grid.hpp"

#include "eses/surface.hpp"
#include "grid/make_grid.hpp"
#include "grid/tiling.hpp"
#include "run/plan.hpp"

namespace eses {

Grid make_grid(const Surface& surface, const GridOptions& options) {
  return detail::plan_grid(detail::sphere_bounds(surface.atoms()), {.grid = options}).grid;
}

void validate(const Grid& grid) { detail::require_valid(grid); }

GridRegion points_in_box(const Grid& grid, Vec3 low, Vec3 high) {
  detail::require_valid(grid);
  return detail::points_between(grid, low, high);
}

GridRegion points_of_blocks(const Grid& grid, std::int64_t block_size, const BlockRange& blocks) {
  detail::require_valid(grid);
  return detail::make_tiling(grid, block_size).points_of_blocks(blocks);
}

}  // namespace eses
