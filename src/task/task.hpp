#pragma once
/// What a run is to do, as data: its parameters, its plan, and the functions that it calls.

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

struct Parameters {
  double probe_radius = 1.4;  ///< angstrom, `min_probe_radius` to `max_probe_radius`
  double spacing = 0.4;       ///< angstrom, > 0
  double margin = 0.8;        ///< angstrom, >= 0
  /// A grid that the user has chosen. Then the margin has no meaning, and the spacing is the
  /// grid's.
  std::optional<Grid> grid = {};
  /// Grid points on a side of a block, 2 to `max_block_size`; 0: `default_block_size`, or
  /// flatter blocks where the molecule is wide, or smaller ones to keep `max_memory`.
  std::int64_t block_size = 0;
  /// 0: all that the process may use, or less to keep `max_memory`.
  int threads = 0;
  /// Bytes that the process may hold resident; 0: what the machine has to give.
  std::uint64_t max_memory = 0;
  std::int64_t verify = 0;  ///< points, and as many edges, to check afterwards; 0 to 1e7
  /// Only the grid points in this closed box (angstrom, finite) are computed, and the edges that
  /// start there; indices and coordinates stay those of the whole grid.
  std::optional<Box> region = {};
  /// The same for these blocks, as indices in the tiling of the whole grid; not with `region`.
  std::optional<GridRegion> blocks = {};
};

/// What a run is going to do, worked out before anything is allocated or written. It belongs to the
/// atoms it was made for: `run` and `compute` refuse any others.
struct Plan {
  Parameters parameters;
  Grid grid;
  BlockTiling tiling;             ///< of the whole grid or of the region that is asked for
  int threads = 1;                ///< >= 1
  std::int64_t blocks_ahead = 0;  ///< solved at most of the next layer while one is unwritten
  /// How far the van der Waals spheres reach beyond each face of the grid, see
  /// eses::detail::depths_inside.
  std::array<double, 6> cut_depths{};
  double cut_depth = 0;  ///< see eses::detail::cut_depth; > 0 means that the surface is cut
  /// Estimate of the process's peak, meant as an upper bound, if it holds nothing but the atoms.
  std::uint64_t memory_bytes = 0;
  std::uint64_t box_file_bytes = 0;      ///< exact
  std::uint64_t grid_file_bytes = 0;     ///< upper bound
  std::uint64_t edge_file_bytes = 0;     ///< estimate
  std::uint64_t area_file_bytes = 0;     ///< upper bound
  std::uint64_t residue_file_bytes = 0;  ///< estimate
  std::uint64_t map_file_bytes = 0;      ///< exact
  std::uint64_t mesh_file_bytes = 0;     ///< estimate
  std::uint64_t map_scratch_bytes = 0;   ///< more that the map's file holds while it is being made
  std::uint64_t mesh_scratch_bytes = 0;  ///< beside the mesh while it is being made; estimate
  /// Pieces of texts that wait to be merged, beside the texts; 0 for `run`. Estimate.
  std::uint64_t text_scratch_bytes = 0;
  bool gzip = false;  ///< then the sizes of the text files are estimates
  /// Checksum of the centres and radii in their order, by which `run` knows the atoms again.
  std::uint64_t atoms_checksum = 0;
  std::uint64_t output_bytes() const {
    return box_file_bytes + grid_file_bytes + edge_file_bytes + area_file_bytes +
           residue_file_bytes + map_file_bytes + mesh_file_bytes;
  }
};

/// Receives every block once, in no particular order. See `Callbacks` for the threads that call it.
/// An exception that it throws ends the run, which throws it on.
using SolvedBlockCallback = std::function<void(const SolvedBlock&)>;

/// Functions that a run calls while it goes on; an empty one is not called. The calls come from any
/// thread of the run, but never two at the same time, whichever of the functions they are of.
struct Callbacks {
  ProgressCallback progress = {};
  SolvedBlockCallback block = {};
  /// Like `progress`, while the verification goes on: its checks so far out of all.
  ProgressCallback verification = {};
};

}  // namespace eses::detail
