#pragma once
/// @file
/// Computing the surface on a grid: in memory, block by block, or into files.
///
/// All functions take a Surface and a Grid. The results depend on these and on
/// RunOptions::region alone, to the last bit: not on the number of threads or the block size. A
/// grid made for another surface may be used, and so may any grid that is valid; atoms may be
/// outside of it.
///
/// All functions throw std::invalid_argument
/// - if the grid has fewer than one or more than 2e9 points along an axis, more than 1e17 points, a
///   spacing that is not positive, or bounds that are not finite,
/// - if a number of RunOptions is out of its range,
/// - if the region is empty or not within the grid,
///
/// and MemoryLimitError if memory cannot hold what is needed, or may not. They may be called by
/// several threads at a time, also for the same Surface.

#include <array>
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

namespace eses {

namespace detail {
class SolvedBlock;
struct ResultBuilder;
}  // namespace detail

/// The parts of a Result. What is not chosen takes no memory.
struct ResultParts {
  bool inside = true;     ///< Result::inside: a byte for each point.
  bool crossings = true;  ///< Result::crossings: 88 bytes for each crossing.
  bool mesh = false;      ///< Result::mesh.
};

/// A triangle mesh of the surface. It has one vertex for each crossing, in the same order. A vertex
/// is at its crossing, or 1e-4 of the spacing away from a grid point with which the crossing
/// coincides. All lists of vertices have the same length.
struct Mesh {
  std::vector<Vec3> vertices;         ///< Places of the vertices, in angstrom.
  std::vector<Vec3> normals;          ///< Outward unit normals of the vertices.
  std::vector<AtomIndex> atoms;       ///< First adjacent atom of each vertex.
  std::vector<std::uint8_t> patches;  ///< Patch of each vertex: 1 convex, 2 saddle, 3 concave.
  /// Indices of the vertices of each triangle, from 0, counterclockwise seen from outside.
  std::vector<std::array<std::uint64_t, 3>> faces;
};

/// The surface on a grid, in memory.
class Result {
 public:
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

  /// The mesh in the cells of the grid that have all their corners in the region, with the
  /// crossings of edges that have both ends in the region as vertices. None if ResultParts::mesh
  /// was not chosen.
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

/// Computes the surface on a grid and holds the result in memory. Throws as described at the top of
/// compute.hpp, VerificationError if RunOptions::verify finds faults, and what a callback throws.
Result compute(const Surface& surface, const Grid& grid, const RunOptions& options = {},
               const ResultParts& parts = {});

/// Makes the mesh of a result, the same that compute makes with ResultParts::mesh. Throws
/// std::invalid_argument if the result has no inside points or no crossings because ResultParts
/// left them out, and what `check` throws, which is called for every plane of the region.
Mesh make_mesh(const Result& result, const CheckCallback& check = {});

/// A part of the grid that has been solved. It is a view that is valid during the call that gets
/// it.
class Block {
 public:
  /// The points that this block and no other one has.
  const GridRegion& owned() const { return owned_; }

  /// All points that the block knows: those that it owns, and those that it shares with the next
  /// blocks along each axis.
  const GridRegion& points() const { return points_; }

  /// Returns whether a point, given by its indices in the grid, is inside the surface. Throws
  /// std::invalid_argument if the point is not in `points()`.
  bool is_inside(const GridIndex& point) const;

  /// One byte for each point of `owned()`, in the order of Result::inside.
  std::vector<std::uint8_t> owned_inside() const;

  /// The crossings of all edges whose lower ends the block owns, by lower end (z, then y, then x),
  /// then axis.
  std::span<const Crossing> crossings() const { return crossings_; }

  /// The time that it took to solve the block on one processor, in seconds.
  double seconds() const;

 private:
  friend struct detail::ResultBuilder;
  Block(const detail::SolvedBlock& solved, std::span<const Crossing> crossings);
  const detail::SolvedBlock* solved_;
  GridRegion owned_, points_;
  std::span<const Crossing> crossings_;
};

/// Receives a block. An exception that it throws ends the computation, which throws it on.
using BlockCallback = std::function<void(const Block& block)>;

/// Computes the surface on a grid and hands out every block once, in no particular order, as soon
/// as it is solved. The memory in use does not grow with the number of blocks. Each point and each
/// crossing belongs to exactly one block. The callback is called by any thread, but never by two at
/// the same time. Throws as described at the top of compute.hpp, std::invalid_argument if
/// `callback` is empty, VerificationError if RunOptions::verify finds faults, and what a callback
/// throws.
Summary for_each_block(const Surface& surface, const Grid& grid, const BlockCallback& callback,
                       const RunOptions& options = {});

/// Computes the surface on a grid and writes files, in memory that does not grow with their length.
/// The output directory and that of the mesh are created if they are missing, and locked against
/// other runs. The files get their names when all of them are complete, and older files of these
/// names are removed before; on failure there are none of them. If a file of the mesh is a symbolic
/// link, the file to which it leads is written.
///
/// Throws as described at the top of compute.hpp; std::invalid_argument also if the mesh or the map
/// has an unknown suffix, if text is chosen for a mesh that is not PLY, if the map's name is not a
/// plain file name, or if labels are missing that the outputs need; Error also if the disk has not
/// enough space, if a file cannot be written, if two of the files are the same one, or if another
/// run writes there; VerificationError, with no file written, if RunOptions::verify finds faults;
/// and what a callback throws.
Summary write_files(const Surface& surface, const Grid& grid,
                    const std::filesystem::path& directory, const Outputs& outputs = {},
                    const RunOptions& options = {});

/// The memory, disk space and division of a computation, estimated beforehand.
struct Estimate {
  std::uint64_t memory_bytes = 0;  ///< Peak of the process's memory; meant as an upper bound.
  int threads = 1;                 ///< Number of threads that will be used.
  GridIndex block_size{};          ///< Points along the sides of a block.
  GridIndex blocks{};              ///< Number of blocks along x, y and z.
  double crossings = 0;            ///< Expected number of crossings.
  /// How far the van der Waals spheres reach beyond the grid, in angstrom. Positive where the grid
  /// cuts the spheres, negative where it encloses all of them.
  double cut_depth = 0;
  std::uint64_t box_bytes = 0;    ///< Length of bounding_box.txt; exact.
  std::uint64_t grid_bytes = 0;   ///< Length of grid_info.txt; an upper bound unless gzipped.
  std::uint64_t edges_bytes = 0;  ///< Length of intersection_info.txt, about.
  std::uint64_t areas_bytes = 0;  ///< Length of partition_area.txt; an upper bound unless gzipped.
  std::uint64_t residues_bytes = 0;  ///< Length of residue_area.csv and chain_area.csv, about.
  std::uint64_t map_bytes = 0;       ///< Length of all maps; exact.
  std::uint64_t mesh_bytes = 0;      ///< Length of the mesh, about.
  std::uint64_t scratch_bytes = 0;   ///< Bytes on disk beside the files while they are made, about.

  /// Length of all files.
  std::uint64_t file_bytes() const {
    return box_bytes + grid_bytes + edges_bytes + areas_bytes + residues_bytes + map_bytes +
           mesh_bytes;
  }
};

/// Estimates what write_files would need with the same arguments, or with Outputs::none() what
/// for_each_block would need. Throws as write_files does, but computes and writes nothing.
Estimate estimate(const Surface& surface, const Grid& grid, const Outputs& outputs = {},
                  const RunOptions& options = {});

}  // namespace eses
