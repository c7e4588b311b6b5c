#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "eses/error.hpp"
#include "eses/run.hpp"
#include "io/eses_text.hpp"
#include "run/build_patches.hpp"
#include "run/parallel.hpp"
#include "run/resources.hpp"
#include "run/verifier.hpp"

namespace eses {
namespace {

constexpr double bytes_per_atom = 700;        // atom, tree, patches and their making
constexpr double bytes_per_thread = 4 << 20;  // text, features, scratch
constexpr double base_bytes = 8 << 20;        // program and libraries
constexpr double bytes_per_block = 600;       // the result of a block, less its contents
constexpr std::uint64_t area_line_bytes = 32;
// Past this, differences of squares have too few digits left for the tolerances.
constexpr double largest_probe_radius = 1000;  // angstrom
constexpr std::int64_t most_verified = 10'000'000;

// Surface of the spheres, of which molecules of n atoms leave about n^-0.2 exposed.
double estimated_area(std::span<const Atom> atoms) {
  double spheres = 0;
  for (const Atom& atom : atoms) spheres += 4 * std::numbers::pi * atom.radius * atom.radius;
  return spheres * std::pow(static_cast<double>(atoms.size()), -0.2);
}

// A surface crosses 1.5 edges on average where it has the area of a cell's face.
double estimated_crossings(std::span<const Atom> atoms, double spacing) {
  return 1.5 * estimated_area(atoms) / (spacing * spacing);
}

// Blocks in flight, and two layers of blocks: one that is being written, and what threads that find
// nothing left to write have solved of the next.
double estimated_memory(const Plan& plan, std::span<const Atom> atoms) {
  const auto side = static_cast<double>(std::min(
      plan.tiling.block_size, *std::max_element(plan.grid.size.begin(), plan.grid.size.end())));
  const double block_bits = side * side * std::ceil(side / 63) * 64;
  const double block_bytes = 5 * block_bits / 8 + 8 * side * side;
  const double planes = std::min(side, static_cast<double>(plan.grid.size[2]));
  const double layer_bits =
      static_cast<double>(plan.grid.size[0]) * static_cast<double>(plan.grid.size[1]) * planes;
  const double layer_share = std::min(1.0, 2 * planes / static_cast<double>(plan.grid.size[2]));
  const double crossings = estimated_crossings(atoms, plan.grid.spacing) * layer_share;
  const auto rows = static_cast<double>(plan.grid.size[0] + plan.grid.size[1] + plan.grid.size[2]);
  return base_bytes + bytes_per_atom * static_cast<double>(atoms.size()) +
         plan.threads * (bytes_per_thread + block_bytes) +
         2 * (layer_bits / 8 + bytes_per_block * static_cast<double>(plan.tiling.blocks[0]) *
                                   static_cast<double>(plan.tiling.blocks[1])) +
         crossings * sizeof(Crossing) + rows * 64 +
         Verifier::memory_bytes(plan, estimated_crossings(atoms, plan.grid.spacing));
}

void require(bool holds, const char* what, double value) {
  if (!holds) throw Error(fmt::format("{}, not {}", what, value));
}

void require_valid(const Parameters& p) {
  require(p.probe_radius > 0 && p.probe_radius <= largest_probe_radius,
          "the probe radius must be a positive number of at most 1000 angstrom", p.probe_radius);
  require(p.block_size >= 2 && p.block_size <= 4096,
          "the block size must be between 2 and 4096 points", static_cast<double>(p.block_size));
  require(p.verify >= 0 && p.verify <= most_verified,
          "the number of points to verify must be between 0 and 10000000",
          static_cast<double>(p.verify));
  require(p.threads >= 0, "the number of threads must not be negative", p.threads);
}

void require_enclosing_margin(const Plan& plan, const Parameters& p) {
  if (plan.cut_depth < 0 || p.margin >= 0.5 * p.spacing) return;
  throw Error(fmt::format(
      "a margin of {} angstrom is too small for a spacing of {}: the grid, whose number "
      "of points is truncated, would cut the surface; a margin of {} or more works",
      p.margin, p.spacing, p.spacing));
}

// No more threads than there is work for: blocks, or ranges of atoms.
int used_threads(const Plan& plan, const Parameters& p, std::size_t atoms) {
  const std::int64_t most = std::max(plan.tiling.block_count(), atom_range_count(atoms));
  const int wanted = p.threads > 0 ? p.threads : available_threads();
  return static_cast<int>(std::min<std::int64_t>(wanted, most));
}

}  // namespace

Plan make_plan(std::span<const Atom> atoms, const Parameters& parameters,
               const OutputChoice& outputs) {
  require_valid(parameters);
  Plan plan;
  plan.parameters = parameters;
  plan.grid = make_grid(atoms, parameters.spacing, parameters.margin);
  plan.tiling = make_tiling(plan.grid, parameters.block_size);
  plan.threads = used_threads(plan, parameters, atoms.size());
  plan.cut_depth = cut_depth(plan.grid, atoms);
  require_enclosing_margin(plan, parameters);
  if (outputs.grid) plan.grid_file_bytes = largest_grid_bytes(plan.grid.size);
  if (outputs.edges)
    plan.edge_file_bytes = typical_crossing_bytes * static_cast<std::uint64_t>(estimated_crossings(
                                                        atoms, parameters.spacing));
  if (outputs.areas) plan.area_file_bytes = area_line_bytes * atoms.size();
  const double memory = estimated_memory(plan, atoms);
  plan.memory_bytes = static_cast<std::uint64_t>(std::min(memory, 1e19));
  const std::uint64_t available = available_memory();
  if (memory > static_cast<double>(available))
    throw Error(fmt::format(
        "{:.3g} grid points in blocks of {} need about {:.3g} GB of memory, but {:.3g} GB are "
        "available; use a larger spacing or a smaller block size",
        static_cast<double>(plan.grid.point_count()), parameters.block_size, memory / 1e9,
        static_cast<double>(available) / 1e9));
  return plan;
}

}  // namespace eses
