#pragma once
/// @file
/// Choices of a computation that its results do not depend on, but for the region.

#include <cstdint>
#include <functional>
#include <optional>

#include "eses/grid.hpp"

namespace eses {

/// Receives the number of units of work done so far, and of all. An exception that it throws ends
/// the computation, which throws it on.
using ProgressCallback = std::function<void(std::int64_t done, std::int64_t total)>;

/// Choices of compute, for_each_block, write_files and estimate. All callbacks of a call, also that
/// of for_each_block, are called by any of its threads, but never two at the same time.
struct RunOptions {
  /// Number of threads; 0 for all that the process may use, or fewer to keep `max_memory`.
  int threads = 0;
  /// Number of grid points along the side of a block, 2 to 4096. Neighbouring blocks share their
  /// faces (Zhao et al., Commun. Inf. Syst. 18, 299, 2018, doi:10.4310/CIS.2018.v18.n4.a5). 0
  /// chooses it: 64, or flatter blocks where the molecule is wide, or smaller ones to keep
  /// `max_memory`.
  std::int64_t block_size = 0;
  /// Bytes that the process may hold resident; 0 for the memory that is available.
  std::uint64_t max_memory = 0;
  /// Number of points, and as many edges, to check afterwards against the definition of the
  /// surface; 0 to 1e7. A fault throws VerificationError.
  std::int64_t verify = 0;
  /// The points to compute, and with them the edges that start there; all if there is none. Indices
  /// and coordinates stay those of the grid.
  std::optional<GridRegion> region = {};
  /// Called with the number of solved blocks; also called from time to time in between, and while a
  /// result in memory is put in order. Blocks of up to 256 points on a side take well below a
  /// second each.
  ProgressCallback progress = {};
  /// Called with the number of checks that the verification has done.
  ProgressCallback verification_progress = {};
};

}  // namespace eses
