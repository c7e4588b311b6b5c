#pragma once
/// @file
/// Computing the surface on a grid: in memory, block by block, or into files.
///
/// All functions take a Surface and a Grid. The results depend only on these and on
/// RunOptions::region, to the last bit. They do not depend on the number of threads or the block
/// size. Any valid grid may be used; atoms may be outside of it.
///
/// All functions throw std::invalid_argument
/// - if the grid has fewer than one or more than 2e9 points along an axis, more than 1e17 points, a
///   spacing that is not positive, or bounds that are not finite,
/// - if a number of RunOptions is out of its range,
/// - if the region is empty or not within the grid,
///
/// and MemoryLimitError if the available memory or RunOptions::max_memory does not suffice. They
/// may be called from several threads at the same time, also for the same Surface.

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "eses/check.hpp"
#include "eses/crossing.hpp"
#include "eses/grid.hpp"
#include "eses/outputs.hpp"
#include "eses/run_options.hpp"
#include "eses/summary.hpp"
#include "eses/surface.hpp"

namespace eses::detail {
struct BlockResult;
struct ResultBuilder;
}  // namespace eses::detail

#pragma GCC visibility push(default)
namespace eses {

/// Selection of the parts of a Result. Other parts need no memory.
struct ResultParts {
  bool inside = true;     ///< Result::inside, one byte for each point.
  bool crossings = true;  ///< Result::crossings, 88 bytes for each crossing.
  bool mesh = false;      ///< Result::mesh.
};

/// A triangle mesh of the surface. It has one vertex for each crossing, in the same order. A vertex
/// is at the position of its crossing. If the crossing coincides with a grid point, the vertex is
/// 1e-4 of the spacing away from that point. All lists of vertices have the same length, except
/// that `components` may be empty.
struct Mesh {
  std::vector<Vec3> vertices;         ///< Positions of the vertices, in angstrom.
  std::vector<Vec3> normals;          ///< Outward unit normals of the vertices.
  std::vector<AtomIndex> atoms;       ///< First adjacent atom of each vertex.
  std::vector<std::uint8_t> patches;  ///< Patch of each vertex: 1 convex, 2 saddle, 3 concave.
  /// Component of each vertex: 0 for the outside, otherwise the number of the cavity, from 1 in the
  /// order of Measures::cavities. Empty unless make_mesh was given the surface.
  std::vector<std::uint32_t> components;
  std::vector<std::uint64_t> crossings;  ///< Index of each vertex in Result::crossings.
  /// Indices of the vertices of each triangle, from 0, counterclockwise seen from outside.
  std::vector<std::array<std::uint64_t, 3>> faces;
};

/// The surface on a grid, in memory. After a move, the lists of the old object are empty, and
/// `is_inside` and `make_mesh` throw std::logic_error for it.
class Result {
 public:
  /// Makes a result from its data, for example in another process. `inside` and `crossings` are in
  /// the order of the functions of these names; without a value, the part was not chosen. The mesh
  /// is not chosen. Throws std::invalid_argument if the grid is not valid, if the region is empty
  /// or not within the grid, or if the points and crossings do not belong to a region of this grid.
  Result(Summary summary, const Grid& grid, const GridRegion& region,
         std::optional<std::vector<std::uint8_t>> inside,
         std::optional<std::vector<Crossing>> crossings);

  /// Area, volume and other totals.
  const Summary& summary() const { return summary_; }

  /// The area of the surface, in square angstrom.
  double area() const { return summary_.area; }

  /// The enclosed volume, in cubic angstrom.
  double volume() const { return summary_.volume; }

  /// The area of each atom, in square angstrom, by atom index.
  std::span<const double> atom_areas() const { return summary_.atom_areas; }

  /// The grid that was passed to compute.
  const Grid& grid() const { return grid_; }

  /// The points that were computed: the region of the options, or all points of the grid.
  const GridRegion& region() const { return region_; }

  /// One byte for each point of the region, 1 inside and 0 outside the surface. With the size
  /// (nx, ny, nz) of the region, the point `region().begin + (i, j, k)` has index
  /// `(k * ny + j) * nx + i`. Empty if ResultParts::inside was not chosen.
  std::span<const std::uint8_t> inside() const { return inside_; }

  /// Returns whether a point, given by its indices in the grid, is inside the surface. Throws
  /// std::invalid_argument if the point is not in the region, or if ResultParts::inside was not
  /// chosen.
  bool is_inside(const GridIndex& point) const;

  /// The crossings of all edges whose lower ends are in the region, by lower end (z, then y, then
  /// x), then axis. Empty if ResultParts::crossings was not chosen.
  std::span<const Crossing> crossings() const { return crossings_; }

  /// The parts of the result.
  const ResultParts& parts() const { return parts_; }

  /// The mesh in the grid cells that have all corners in the region. Its vertices are the crossings
  /// of edges that have both ends in the region. Empty if ResultParts::mesh was not chosen.
  const std::optional<Mesh>& mesh() const { return mesh_; }

 private:
  friend struct detail::ResultBuilder;
  Result() = default;
  Summary summary_;
  Grid grid_;
  GridRegion region_;
  ResultParts parts_;
  std::vector<std::uint8_t> inside_;
  std::vector<Crossing> crossings_;
  std::optional<Mesh> mesh_;
};

/// Computes the surface on a grid, with the result in memory. Throws the exceptions listed at the
/// top of compute.hpp, VerificationError if RunOptions::verify finds faults, and all exceptions of
/// callbacks.
Result compute(const Surface& surface, const Grid& grid, const RunOptions& options = {},
               const ResultParts& parts = {});

/// Does the same with the selection of parts first: `compute(surface, grid, {.mesh = true})`. It is
/// a template so that `{}` as the third argument means RunOptions.
template <std::same_as<ResultParts> Parts = ResultParts>
Result compute(const Surface& surface, const Grid& grid, const Parts& parts,
               const RunOptions& options = {}) {
  return compute(surface, grid, options, parts);
}

/// Returns the mesh of a result, which is equal to the mesh of compute with ResultParts::mesh.
/// Calls `check` for every plane of the region. Throws std::invalid_argument if ResultParts
/// excluded the inside points or the crossings, and all exceptions of `check`.
Mesh make_mesh(const Result& result, const CheckCallback& check = {});

/// Does the same with triangles of quality, as MeshOptions::quality describes. The vertices are
/// some of the crossings, in the same order; one whose crossing coincides with a grid point is 1e-6
/// of the spacing away from that point.
Mesh make_quality_mesh(const Result& result, const CheckCallback& check = {});

/// Returns the same mesh with Mesh::components. `surface` must be the one that the result was
/// computed from. All its cavities are found.
Mesh make_mesh(const Result& result, const Surface& surface, const CheckCallback& check = {});

/// Does the same with triangles of quality.
Mesh make_quality_mesh(const Result& result, const Surface& surface,
                       const CheckCallback& check = {});

/// A solved block of the grid. The object is a view, which is valid during the callback.
class Block {
 public:
  /// The points that this block owns. Each point of the grid is owned by exactly one block.
  const GridRegion& owned() const { return owned_; }

  /// All points of the block: the owned points, and the points shared with the next block along
  /// each axis.
  const GridRegion& points() const { return points_; }

  /// Returns whether a point, given by its indices in the grid, is inside the surface. Throws
  /// std::invalid_argument if the point is not in `points()`.
  bool is_inside(const GridIndex& point) const;

  /// One byte for each point of `owned()`, in the order of Result::inside.
  std::vector<std::uint8_t> owned_inside() const;

  /// The crossings of all edges whose lower ends are owned, by lower end (z, then y, then x), then
  /// axis.
  std::span<const Crossing> crossings() const { return crossings_; }

  /// The time to solve the block on one processor, in seconds.
  double seconds() const;

 private:
  friend struct detail::ResultBuilder;
  Block(const detail::BlockResult& solved, std::span<const Crossing> crossings);
  const detail::BlockResult* solved_;
  GridRegion owned_, points_;
  std::span<const Crossing> crossings_;
};

/// Receives a block. If it throws an exception, the computation ends and throws this exception.
using BlockCallback = std::function<void(const Block& block)>;

/// Computes the surface on a grid and calls `callback` for each block, in unspecified order, as
/// soon as the block is solved. The memory does not grow with the number of blocks. Each point and
/// each crossing is owned by exactly one block. The callback is called from any thread, but never
/// from two at the same time. Throws the exceptions listed at the top of compute.hpp,
/// std::invalid_argument if `callback` is empty, VerificationError if RunOptions::verify finds
/// faults, and all exceptions of callbacks.
Summary for_each_block(const Surface& surface, const Grid& grid, const BlockCallback& callback,
                       const RunOptions& options = {});

/// Computes the surface on a grid and writes files. The memory does not grow with their length.
/// Creates the output directory and the directory of the mesh if they are missing, and locks them
/// against other runs. The files get their final names when all of them are complete. Older files
/// of these names are removed before. On failure, none of the files exists. If a mesh file is a
/// symbolic link, its target is written.
///
/// Throws the exceptions listed at the top of compute.hpp, and
/// - std::invalid_argument if the suffix of the mesh or of a map is unknown, if
///   MeshOptions::is_ascii is set for a mesh other than PLY, if the name of a map is not a plain
///   file name or its prefix is empty, or if the outputs need labels that are missing,
/// - Error if the disk space is insufficient, if a file cannot be written, if two of the files are
///   the same file, or if another run writes to a directory,
/// - VerificationError if RunOptions::verify finds faults; no file is written,
/// - all exceptions of callbacks.
Summary write_files(const Surface& surface, const Grid& grid,
                    const std::filesystem::path& directory, const Outputs& outputs = {},
                    const RunOptions& options = {});

/// Estimated memory, disk space and block division of a computation.
struct Estimate {
  std::uint64_t memory_bytes = 0;  ///< Peak memory of the process, intended as an upper bound.
  int threads = 1;                 ///< Number of threads that will be used.
  GridIndex block_size{};          ///< Points along the sides of a block.
  GridIndex blocks{};              ///< Number of blocks along x, y and z.
  double crossings = 0;            ///< Expected number of crossings.
  /// Maximum distance by which the van der Waals spheres extend beyond the grid, in angstrom.
  /// Negative if the grid encloses all spheres, and 0 if they reach its boundary up to rounding
  /// errors, where a mesh can be open.
  double cut_depth = 0;
  std::uint64_t box_bytes = 0;       ///< Size of bounding_box.txt; exact.
  std::uint64_t grid_bytes = 0;      ///< Size of grid_info.txt; an upper bound unless gzipped.
  std::uint64_t edges_bytes = 0;     ///< Size of intersection_info.txt; an estimate.
  std::uint64_t areas_bytes = 0;     ///< Size of partition_area.txt; an upper bound unless gzipped.
  std::uint64_t residues_bytes = 0;  ///< Size of residue_area.csv and chain_area.csv; an estimate.
  std::uint64_t atoms_bytes = 0;     ///< Size of atoms.csv; an estimate.
  std::uint64_t map_bytes = 0;       ///< Size of all maps; exact.
  std::uint64_t mesh_bytes = 0;      ///< Size of the mesh; an estimate.
  std::uint64_t scratch_bytes = 0;   ///< Additional disk space during the run; an estimate.

  /// Total size of all files, in bytes.
  std::uint64_t file_bytes() const {
    return box_bytes + grid_bytes + edges_bytes + areas_bytes + residues_bytes + atoms_bytes +
           map_bytes + mesh_bytes;
  }
};

/// Estimates the resources of write_files with the same arguments or, with Outputs::none(), those
/// of for_each_block. Throws the same exceptions as write_files, but computes and writes nothing.
Estimate estimate(const Surface& surface, const Grid& grid, const Outputs& outputs = {},
                  const RunOptions& options = {});

}  // namespace eses
#pragma GCC visibility pop
