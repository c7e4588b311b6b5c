// What each block of a molecule costs, as CSV; for scripts/simulate.
//
//   print-block-costs FILE SPACING [BLOCK_SIZE]
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "eses/read_atoms.hpp"
#include "eses/run.hpp"

int main(int argc, char** argv) try {
  if (argc < 3 || argc > 4) {
    std::fputs("usage: print-block-costs FILE SPACING [BLOCK_SIZE]\n", stderr);
    return 2;
  }
  const eses::Molecule molecule(eses::read_atoms(argv[1]));
  eses::Parameters parameters;
  parameters.spacing = std::atof(argv[2]);
  parameters.margin = std::max(parameters.margin, parameters.spacing);
  parameters.block_size = argc > 3 ? std::atol(argv[3]) : eses::default_block_size;
  parameters.threads = 1;
  const eses::Plan plan = make_plan(molecule, parameters, eses::OutputChoice::none());
  const auto& size = plan.grid.size;
  fmt::print("# atoms {}\n# spacing {}\n# block_size {}\n# points {} {} {}\n# lower_z {}\n",
             molecule.atoms().size(), parameters.spacing, parameters.block_size, size[0], size[1],
             size[2], plan.grid.lower.z);
  fmt::print("bx,by,bz,seconds,crossings\n");
  const auto print = [&](const eses::SolvedBlock& block) {
    const auto& first = block.block().first;
    const auto index = [&](std::size_t axis) { return first[axis] / (parameters.block_size - 1); };
    fmt::print("{},{},{},{:.9f},{}\n", index(0), index(1), index(2), block.seconds(),
               block.crossings().size());
  };
  const eses::Summary summary = eses::compute(molecule, plan, {.progress = {}, .block = print});
  fmt::print("# patches_seconds {:.6f}\n", summary.seconds.patches);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "print-block-costs: {}\n", error.what());
  return 1;
}
