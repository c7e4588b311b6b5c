#pragma once
/// @file
/// Options of a computation. Except for the region, they do not affect its results.

#include <cstdint>
#include <functional>
#include <optional>

#include "eses/grid.hpp"

namespace eses {

/// Receives the numbers of finished and of all units of work. If it throws an exception, the
/// computation ends and throws this exception.
using ProgressCallback = std::function<void(std::int64_t done, std::int64_t total)>;

/// Options of compute, for_each_block, write_files and estimate. All callbacks of a call, including
/// a BlockCallback, are called from any of its threads, but never two at the same time.
struct RunOptions {
  /// Number of threads; 0 for all available processors, or fewer to satisfy `max_memory`.
  int threads = 0;
  /// Number of grid points along the side of a block, 2 to 4096. Neighbouring blocks share their
  /// faces (Zhao et al., Commun. Inf. Syst. 18, 299, 2018, doi:10.4310/CIS.2018.v18.n4.a5). With 0,
  /// the planner chooses the size: 64, flatter blocks for wide molecules, and smaller blocks for
  /// coarse grids or to satisfy `max_memory`.
  std::int64_t block_size = 0;
  /// Limit of the resident memory that the computation adds to that of the process, in bytes; 0 for
  /// the available memory.
  std::uint64_t max_memory = 0;
  /// Number of points, and number of edges, to check against the definition of the surface after
  /// the computation; 0 to 1e7. Faults throw VerificationError.
  std::int64_t verify = 0;
  /// The points to compute, with the edges that start there; empty for all points. Indices and
  /// coordinates refer to the whole grid.
  std::optional<GridRegion> region = {};
  /// Called with the number of solved blocks: after each block, repeatedly during long blocks, and
  /// while a result in memory is sorted. Blocks of up to 256 points on a side take well below a
  /// second each. During a search for cavities, before the number of blocks is known, it is called
  /// with 0 and 1.
  ProgressCallback progress = {};
  /// Called with the number of finished checks of the verification.
  ProgressCallback verification_progress = {};
};

}  // namespace eses
