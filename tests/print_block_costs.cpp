// Prints the costs of a molecule, its plan and each of its blocks as CSV, for
// scripts/benchmarks/simulate.
//
//   print-block-costs FILE SPACING [BLOCK_SIZE]
//
// Without a block size the plan chooses the sides of the blocks.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <utility>
#include <vector>

#include "support/atom_lists.hpp"
#include "support/run.hpp"

namespace {

// CPU time of the process since the start of the program.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3 || argc > 4) {
    std::fputs("usage: print-block-costs FILE SPACING [BLOCK_SIZE]\n", stderr);
    return 2;
  }
  std::vector<eses::Atom> atoms = eses::detail::test::read_atom_list(argv[1]);
  const double read = cpu_seconds();
  const eses::detail::Molecule molecule(std::move(atoms));
  const double prepared = cpu_seconds();
  eses::detail::Parameters parameters;
  eses::GridOptions grid;
  grid.spacing = std::atof(argv[2]);
  grid.margin = std::max(grid.margin, grid.spacing);
  parameters.grid = grid;
  if (argc > 3) parameters.block_size = std::atol(argv[3]);
  parameters.threads = 1;
  const eses::detail::Plan plan =
      eses::detail::test::make_plan(molecule, parameters, eses::Outputs::none());
  const double planned = cpu_seconds();
  fmt::print("# read_seconds {:.6f}\n# molecule_seconds {:.6f}\n# plan_seconds {:.6f}\n", read,
             prepared - read, planned - prepared);
  const auto& size = plan.grid.size;
  const auto& block_size = plan.tiling.block_size;
  fmt::print("# atoms {}\n# spacing {}\n# block_size {} {} {}\n# points {} {} {}\n# lower_z {}\n",
             molecule.atoms().size(), grid.spacing, block_size[0], block_size[1], block_size[2],
             size[0], size[1], size[2], plan.grid.origin.z);
  fmt::print("bx,by,bz,seconds,crossings\n");
  double solving = 0;
  const auto print = [&](const eses::detail::BlockResult& block) {
    const auto& first = block.block.first;
    const auto index = [&](std::size_t axis) { return first[axis] / (block_size[axis] - 1); };
    solving += block.seconds;
    fmt::print("{},{},{},{:.9f},{}\n", index(0), index(1), index(2), block.seconds,
               block.crossings.size());
  };
  const eses::Summary summary =
      eses::detail::test::compute(molecule, plan.parameters, {.progress = {}, .block = print});
  const auto& seconds = summary.seconds;
  // The run has one thread. The time that is left is that of sorting atoms into clusters.
  fmt::print("# patches_seconds {:.6f}\n# clusters_seconds {:.6f}\n", seconds.patches,
             std::max(0.0, seconds.blocks - seconds.patches - seconds.output - solving));
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "print-block-costs: {}\n", error.what());
  return 1;
}
