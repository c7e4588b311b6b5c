// Prints area and volume of a molecule, and the atoms with the largest areas.
//
//   surface-of-file FILE [SPACING]

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <eses/eses.hpp>
#include <exception>
#include <numeric>
#include <vector>

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) {
    std::fputs("usage: surface-of-file FILE [SPACING]\n", stderr);
    return 2;
  }
  const eses::AtomFile file = eses::read_atoms(argv[1]);
  const eses::Surface surface(file, {.probe_radius = 1.4});
  const double spacing = argc > 2 ? std::atof(argv[2]) : 0.5;
  const eses::Grid grid = eses::make_grid(surface, {.spacing = spacing, .margin = 2 * spacing});
  const eses::Result result = eses::compute(surface, grid);

  std::printf("area %.6g square angstrom\nvolume %.6g cubic angstrom\n", result.area(),
              result.volume());
  std::vector<std::size_t> order(file.atoms.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto areas = result.atom_areas();
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return areas[a] > areas[b]; });
  order.resize(std::min<std::size_t>(order.size(), 5));
  for (const std::size_t atom : order)
    std::printf("atom in line %llu: %.4g square angstrom\n",
                static_cast<unsigned long long>(file.lines[atom]), areas[atom]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "surface-of-file: %s\n", error.what());
  return 1;
}
