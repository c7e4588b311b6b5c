#pragma once
/// The whole job: from atoms to ESES's files and a summary.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eses/grid.hpp"
#include "eses/mesh.hpp"
#include "eses/molecule.hpp"
#include "eses/solved_block.hpp"
#include "eses/tiling.hpp"

namespace eses {

/// Two corners of a box, in angstrom.
struct RegionBox {
  Vec3 low, high;
};

/// Bounds of the probe radius, angstrom. A probe that fits between spheres that graze each other is
/// known to the square root of the rounding error, 1e-7, and normals within 1e-5 need a hundredth
/// of the probe radius; above, differences of squares have too few digits left.
inline constexpr double least_probe_radius = 0.01, largest_probe_radius = 1000;

struct Parameters {
  double probe_radius = 1.4;  ///< angstrom, `least_probe_radius` to `largest_probe_radius`
  double spacing = 0.4;       ///< angstrom, > 0
  double margin = 0.8;        ///< angstrom, >= 0
  /// Grid points on a side of a block, 2 to `largest_block_size`; 0: `default_block_size`, or
  /// flatter blocks where the molecule is wide, or smaller ones to keep `max_memory`.
  std::int64_t block_size = 0;
  /// 0: all that the process may use, or less to keep `max_memory`.
  int threads = 0;
  /// Bytes that the process may hold resident; 0: what the machine has to give.
  std::uint64_t max_memory = 0;
  std::int64_t verify = 0;  ///< points, and as many edges, to check afterwards; 0 to 1e7
  /// Only the grid points in this closed box (angstrom, finite) are computed, and the edges that
  /// start there; indices and coordinates stay those of the whole grid.
  std::optional<RegionBox> region = {};
  /// The same for these blocks, as indices in the tiling of the whole grid; not with `region`.
  std::optional<GridRegion> blocks = {};
};

/// Which files are written.
struct OutputChoice {
  bool box = true;        ///< bounding_box.txt
  bool grid = true;       ///< grid_info.txt
  bool edges = true;      ///< intersection_info.txt
  bool areas = true;      ///< partition_area.txt
  bool residues = false;  ///< residue_area.csv and chain_area.csv
  bool gzip = false;      ///< each of the four text files as NAME.gz
  /// Name of a map of the inside, 1 inside and 0 outside: OpenDX if it ends with .dx, VTK image
  /// data if it ends with .vti; none if empty.
  std::string inside_map = {};
  std::optional<MeshChoice> mesh = {};

  static OutputChoice none() { return {false, false, false, false}; }
};

/// What a run is going to do, worked out before anything is allocated or written. It belongs to the
/// atoms it was made for: `run` and `compute` refuse any others.
struct Plan {
  Parameters parameters;
  Grid grid;
  BlockTiling tiling;             ///< of the whole grid or of the region that is asked for
  int threads = 1;                ///< >= 1
  std::int64_t blocks_ahead = 0;  ///< solved at most of the next layer while one is unwritten
  double cut_depth = 0;           ///< see eses::cut_depth; > 0 means that the surface is cut
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

struct PhaseSeconds {
  double blocks = 0;   ///< patches, classification, intersection and text of all blocks; wall clock
  double patches = 0;  ///< neighbours, arcs, probe placements; summed over threads
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
  double area = 0;                 ///< square angstrom
  std::vector<double> atom_areas;  ///< every atom's share of it, as in partition_area.txt
  double volume = 0;               ///< cubic angstrom
  std::int64_t inside_points = 0;
  std::int64_t convex = 0;   ///< crossings with one adjacent atom
  std::int64_t saddle = 0;   ///< with two
  std::int64_t concave = 0;  ///< with three
  double convex_area = 0;    ///< their shares of the area, square angstrom
  double saddle_area = 0;
  double concave_area = 0;
  std::int64_t edges() const { return convex + saddle + concave; }
  std::uint64_t bytes_written = 0;
  std::optional<MeshCounts> mesh;            ///< if there is one
  std::optional<Verification> verification;  ///< if it was asked for
  PhaseSeconds seconds;
};

/// Receives the number of blocks solved so far and of all blocks. It is also called when no block
/// has been added: while patches are built, rows are written and files are renamed. An exception
/// that it throws ends the run, which throws it on.
using ProgressCallback = std::function<void(std::int64_t done, std::int64_t total)>;

/// Functions that a run calls while it goes on; an empty one is not called. The calls come from any
/// thread of the run, but never two at the same time, whichever of the functions they are of.
struct Callbacks {
  ProgressCallback progress = {};
  BlockCallback block = {};
  /// Like `progress`, while the verification goes on: its checks so far out of all.
  ProgressCallback verification = {};
};

/// Grid, tiling, memory and bytes of output; what is left to it, block size, threads and blocks in
/// flight, it chooses so that `max_memory` and what memory is available are kept. Throws Error if a
/// parameter is out of its range, if the margin is so small that the grid would cut the surface
/// (see README), if a bound of the region is not finite, or if memory cannot hold what the run
/// needs, or may not.
Plan make_plan(const Molecule& molecule, const Parameters& parameters, const OutputChoice& outputs);

/// What the file systems of a plan's files have to give, and what goes there.
struct DiskSpace {
  struct Place {
    std::filesystem::path directory;
    std::uint64_t available = 0;  ///< bytes; the largest number if that cannot be told
    std::uint64_t expected = 0;   ///< bytes of files, and beside them while they are being made
  };
  /// The output directory; then that of the mesh, if it is in another file system.
  std::vector<Place> places;
};

/// The disk space for a plan's files in `directory` and that of the mesh, neither of which need
/// exist yet. Throws Error if those whose size is known do not fit.
DiskSpace require_disk_space(const Plan& plan, const OutputChoice& outputs,
                             const std::filesystem::path& directory);

/// Computes the surface and writes the chosen files into `directory`, which it locks against other
/// runs, and the mesh, for which it locks only that file, into its own directory; both are created
/// if missing. A symbolic link in the mesh's place stays, and the file to which it leads is
/// written. The files appear under their names
/// only when all of them are complete, the bounding box last, and older ones are removed before; on
/// failure none appears, nor if the verification that `plan.parameters` asks for finds a fault.
/// Throws Error on write failures, lack of disk space, if another run is writing there, and where
/// memory exceeds `max_memory` after all: the plan's figure is an estimate. Areas by residue need
/// the molecule's labels; without them that, too, throws Error. Before anything is written it
/// throws Error if the plan is of other atoms than `molecule` has, or has less than one thread.
Summary run(const Molecule& molecule, const Plan& plan, const OutputChoice& outputs,
            const std::filesystem::path& directory, const Callbacks& callbacks = {});

/// The same without any file; what is to be known about points and crossings, `callbacks.block`
/// gets. The plan is best made with `OutputChoice::none()`.
Summary compute(const Molecule& molecule, const Plan& plan, const Callbacks& callbacks = {});

}  // namespace eses
