// Computes two atoms on a grid, in memory and block by block, with the installed library.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <eses/eses.hpp>
#include <stdexcept>
#include <vector>

int main() {
  const std::vector<eses::Atom> atoms{{{0, 0, 0}, 1.7}, {{2.5, 0.3, 0}, 1.5}};
  const eses::Surface surface(atoms, {.probe_radius = 1.4});
  const eses::Grid grid = eses::make_grid(surface, {.spacing = 0.2, .margin = 0.8});

  std::int64_t inside = 0;
  double area = 0;
  const auto add_block = [&](const eses::Block& block) {
    const eses::GridRegion& owned = block.owned();
    for (std::int64_t z = owned.begin[2]; z < owned.end[2]; ++z)
      for (std::int64_t y = owned.begin[1]; y < owned.end[1]; ++y)
        for (std::int64_t x = owned.begin[0]; x < owned.end[0]; ++x)
          inside += block.is_inside({x, y, z}) ? 1 : 0;
    for (const eses::Crossing& crossing : block.crossings())
      area += std::fabs(crossing.normal[crossing.axis]) * grid.spacing * grid.spacing;
  };
  const eses::Summary summary = eses::for_each_block(surface, grid, add_block, {.block_size = 9});
  const eses::Result result = eses::compute(surface, grid);
  const auto dielectric = eses::compute_dielectric(surface, grid, {.solute = 2, .solvent = 78.54});
  const double first_along_x = dielectric[0].front();

  std::printf("%lld points inside, area %.6f\n", static_cast<long long>(inside), area);
  const bool agrees = inside == summary.inside_points && std::fabs(area - summary.area) < 1e-6 &&
                      result.area() == summary.area && result.volume() == summary.volume &&
                      static_cast<std::int64_t>(result.crossings().size()) == summary.edges() &&
                      first_along_x == 78.54;
  try {
    eses::make_grid(surface, {.spacing = -1});
  } catch (const std::invalid_argument&) {
    return agrees ? 0 : 1;
  }
  return 1;
}
