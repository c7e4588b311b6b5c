#pragma once
/// Parameters, plan and callbacks of a run, as plain data.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "eses/grid.hpp"
#include "eses/outputs.hpp"
#include "eses/run_options.hpp"
#include "eses/summary.hpp"
#include "eses/surface.hpp"
#include "geometry/box.hpp"
#include "grid/tiling.hpp"

namespace eses::detail {

class SolvedBlock;

/// Parameters of a run.
struct Parameters {
  double probe_radius = 1.4;  ///< angstrom, `min_probe_radius` to `max_probe_radius`
  double spacing = 0.4;       ///< angstrom, > 0
  double margin = 0.8;        ///< angstrom, >= 0
  /// A custom grid. If it is set, the margin is ignored, and `spacing` must be that of the grid.
  std::optional<Grid> grid = {};
  /// Number of grid points on a side of a block, 2 to `max_block_size`. 0 means an automatic
  /// choice: `default_block_size`, flatter blocks for wide molecules, and smaller blocks for coarse
  /// grids or to satisfy `max_memory`.
  std::int64_t block_size = 0;
  /// Number of threads. 0 means all available processors, or fewer to satisfy `max_memory`.
  int threads = 0;
  /// Maximum resident memory of the process in bytes. 0 means all available memory.
  std::uint64_t max_memory = 0;
  std::int64_t verify = 0;  ///< number of points, and of edges, to verify; 0 to 1e7
  /// Restricts the computation to the grid points in this closed box (angstrom, finite) and the
  /// edges that start there. Indices and coordinates remain those of the whole grid.
  std::optional<Box> region = {};
  /// Restricts the computation to these blocks, as indices in the tiling of the whole grid. Must
  /// not be combined with `region`.
  std::optional<GridRegion> blocks = {};
};

/// The plan of a run, made before anything is allocated or written. A plan is valid only for the
/// atoms for which it was made; `run` and `compute` refuse other atoms.
struct Plan {
  Parameters parameters;
  Grid grid;
  BlockTiling tiling;                  ///< blocks of the whole grid, or of the chosen region
  int threads = 1;                     ///< >= 1
  std::int64_t blocks_ahead = 0;       ///< maximum number of blocks solved beyond the current layer
  std::array<double, 6> cut_depths{};  ///< see eses::detail::depths_inside
  double cut_depth = 0;  ///< see eses::detail::cut_depth; > 0 if the grid cuts the surface
  /// Estimate of the peak memory of the process, intended as an upper bound, if the process holds
  /// only the atoms before the run.
  std::uint64_t memory_bytes = 0;
  std::uint64_t box_file_bytes = 0;      ///< exact
  std::uint64_t grid_file_bytes = 0;     ///< upper bound
  std::uint64_t edge_file_bytes = 0;     ///< estimate
  std::uint64_t area_file_bytes = 0;     ///< upper bound
  std::uint64_t residue_file_bytes = 0;  ///< estimate
  std::uint64_t atom_file_bytes = 0;     ///< estimate
  std::uint64_t map_file_bytes = 0;      ///< exact, except for compressed maps
  std::uint64_t mesh_file_bytes = 0;     ///< estimate
  std::uint64_t map_scratch_bytes = 0;   ///< additional bytes on the disk for maps during the run
  std::uint64_t gzip_map_bytes = 0;      ///< compressed maps, part of map_file_bytes; estimate
  std::uint64_t mesh_scratch_bytes = 0;  ///< scratch files of the mesh during the run; estimate
  /// Scratch files of the texts of chunks during the run; 0 if texts are written in place.
  /// Estimate.
  std::uint64_t text_scratch_bytes = 0;
  bool gzip = false;  ///< whether text files are compressed; their sizes are then estimates
  /// Checksum of the centres and radii in input order, which identifies the atoms of the plan.
  std::uint64_t atoms_checksum = 0;
  /// Total size of the output files in bytes.
  std::uint64_t output_bytes() const {
    return box_file_bytes + grid_file_bytes + edge_file_bytes + area_file_bytes +
           residue_file_bytes + atom_file_bytes + map_file_bytes + mesh_file_bytes;
  }
};

/// Receives each block once, in unspecified order. See `Callbacks` for the calling threads. An
/// exception of the callback ends the run and is rethrown.
using SolvedBlockCallback = std::function<void(const SolvedBlock&)>;

/// Functions that a run calls; empty ones are not called. Any thread of the run may call them, but
/// no two calls happen at the same time, even of different functions.
struct Callbacks {
  ProgressCallback progress = {};
  SolvedBlockCallback block = {};
  /// Like `progress`, for the checks of the verification.
  ProgressCallback verification = {};
};

}  // namespace eses::detail
