#pragma once
/// Sizes of the files of a run, before they are written.

#include <cstdint>

namespace eses::detail {

/// Sizes of the output files and of the scratch files during the run, in bytes. 0 for files that
/// are not written. The sizes of compressed files are estimates.
struct FileSizes {
  std::uint64_t box = 0;       ///< exact
  std::uint64_t grid = 0;      ///< upper bound
  std::uint64_t edges = 0;     ///< estimate
  std::uint64_t areas = 0;     ///< upper bound
  std::uint64_t residues = 0;  ///< estimate
  std::uint64_t atoms = 0;     ///< estimate
  std::uint64_t maps = 0;      ///< exact, except for compressed maps
  std::uint64_t mesh = 0;      ///< estimate

  std::uint64_t gzip_maps = 0;     ///< compressed maps, included in `maps`; estimate
  std::uint64_t mesh_scratch = 0;  ///< scratch files of the mesh; estimate
  /// Pieces of the mesh as numbers, which are in `text_scratch` if texts are written to chunks;
  /// estimate.
  std::uint64_t mesh_pieces = 0;
  /// Scratch files of the texts of chunks; 0 if texts are written in place. Estimate.
  std::uint64_t text_scratch = 0;

  /// Total size of the output files.
  std::uint64_t output() const {
    return box + grid + edges + areas + residues + atoms + maps + mesh;
  }
  /// Total size of the scratch files.
  std::uint64_t scratch() const { return mesh_scratch + text_scratch; }
};

}  // namespace eses::detail
