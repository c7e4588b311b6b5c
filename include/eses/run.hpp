#pragma once
/// The whole job: from atoms to ESES's files and a summary.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "eses/tiling.hpp"

namespace eses {

struct Parameters {
  double probe_radius = 1.4;     ///< angstrom, > 0
  double spacing = 0.4;          ///< angstrom, > 0
  double margin = 0.8;           ///< angstrom, >= 0
  std::int64_t block_size = 64;  ///< grid points on a side of a block, >= 2
  int threads = 0;               ///< 0: all that the process may use
  std::int64_t verify = 0;       ///< points, and as many edges, to check afterwards; 0 to 1e7
};

/// Which files are written.
struct OutputChoice {
  bool box = true;    ///< bounding_box.txt
  bool grid = true;   ///< grid_info.txt
  bool edges = true;  ///< intersection_info.txt
  bool areas = true;  ///< partition_area.txt
};

/// What a run is going to do, worked out before anything is allocated or written.
struct Plan {
  Parameters parameters;
  Grid grid;
  BlockTiling tiling;
  int threads = 1;
  double cut_depth = 0;               ///< see eses::cut_depth; > 0 means that the surface is cut
  std::uint64_t memory_bytes = 0;     ///< estimate of the peak
  std::uint64_t grid_file_bytes = 0;  ///< upper bound
  std::uint64_t edge_file_bytes = 0;  ///< estimate
  std::uint64_t area_file_bytes = 0;  ///< upper bound
  std::uint64_t output_bytes() const { return grid_file_bytes + edge_file_bytes + area_file_bytes; }
};

struct PhaseSeconds {
  double patches = 0;    ///< neighbours, arcs, probe placements; wall clock
  double blocks = 0;     ///< classification, intersection, text and writing; wall clock
  double classify = 0;   ///< summed over threads
  double intersect = 0;  ///< summed over threads
  double output = 0;     ///< text and writing, summed over threads
  double verify = 0;     ///< drawing and checking the sample; wall clock
  double total = 0;      ///< wall clock of the run
};

/// What a check of random points and edges against the definition of the surface has found.
struct Verification {
  std::int64_t points = 0;          ///< that were checked; fewer than asked for if there are fewer
  std::int64_t edges = 0;           ///< likewise
  std::vector<std::string> faults;  ///< a line for each, which names the point or edge
};

struct Summary {
  double area = 0;    ///< square angstrom
  double volume = 0;  ///< cubic angstrom
  std::int64_t inside_points = 0;
  std::int64_t convex = 0;   ///< crossings with one adjacent atom
  std::int64_t saddle = 0;   ///< with two
  std::int64_t concave = 0;  ///< with three
  std::int64_t edges() const { return convex + saddle + concave; }
  std::uint64_t bytes_written = 0;
  std::optional<Verification> verification;  ///< if it was asked for
  PhaseSeconds seconds;
};

/// Blocks solved so far out of all; called from one thread at a time. What it throws ends the run,
/// and is thrown on by it.
using ProgressCallback = std::function<void(std::int64_t done, std::int64_t total)>;

/// Grid, tiling, memory and bytes of output. Throws Error if a parameter is out of its range, if
/// the margin is so small that the grid would cut the surface (see README), or if memory cannot
/// hold what the run needs.
Plan make_plan(std::span<const Atom> atoms, const Parameters& parameters,
               const OutputChoice& outputs);

/// Computes the surface and writes the chosen files into `directory` (created if missing). The
/// files appear under their names only when all of them are complete; on failure none does, nor if
/// the verification that `plan.parameters` asks for finds a fault.
/// Throws Error on write failures and lack of disk space.
Summary run(std::span<const Atom> atoms, const Plan& plan, const OutputChoice& outputs,
            const std::filesystem::path& directory, const ProgressCallback& progress = {});

}  // namespace eses
