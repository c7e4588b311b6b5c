// Computes the surface on a large grid in bounded memory: block by block, and into files.
//
//   large-grid FILE DIRECTORY [SPACING]

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <eses/eses.hpp>
#include <exception>

int main(int argc, char** argv) try {
  if (argc < 3 || argc > 4) {
    std::fputs("usage: large-grid FILE DIRECTORY [SPACING]\n", stderr);
    return 2;
  }
  const eses::Surface surface(eses::read_atoms(argv[1]));
  const double spacing = argc > 3 ? std::atof(argv[3]) : 0.5;
  const eses::Grid grid = eses::make_grid(surface, {.spacing = spacing, .margin = 2 * spacing});

  const eses::Outputs outputs{.grid = false, .gzip = true};
  const eses::RunOptions options{.max_memory = std::uint64_t{2} << 30};
  const eses::Estimate needs = eses::estimate(surface, grid, outputs, options);
  std::printf("about %.1f MB of memory and %.1f MB of files\n",
              static_cast<double>(needs.memory_bytes) / 1e6,
              static_cast<double>(needs.file_bytes()) / 1e6);

  std::int64_t concave = 0;
  const auto count_concave = [&concave](const eses::Block& block) {
    for (const eses::Crossing& crossing : block.crossings())
      if (crossing.atom_count == 3) ++concave;
  };
  eses::for_each_block(surface, grid, count_concave, options);
  std::printf("%lld crossings on concave patches\n", static_cast<long long>(concave));

  const eses::Summary summary = eses::write_files(surface, grid, argv[2], outputs, options);
  std::printf("area %.6g square angstrom, %lld crossings in files\n", summary.area,
              static_cast<long long>(summary.edges()));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "large-grid: %s\n", error.what());
  return 1;
}
