#include "eses/grid.hpp"

#include "api/arguments.hpp"
#include "eses/surface.hpp"
#include "grid/make_grid.hpp"
#include "plan/plan.hpp"

namespace eses {

Grid make_grid(const Surface& surface, const GridOptions& options) {
  return detail::check_arguments([&] {
    const detail::Parameters parameters{.spacing = options.spacing, .margin = options.margin};
    return detail::plan_grid(detail::sphere_bounds(surface.atoms()), parameters).grid;
  });
}

GridRegion points_in_box(const Grid& grid, Vec3 low, Vec3 high) {
  return detail::check_arguments([&] {
    detail::require_valid(grid);
    return detail::points_between(grid, low, high);
  });
}

}  // namespace eses
