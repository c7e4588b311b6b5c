#pragma once
/// The request of a run, as plain data.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <variant>

#include "eses/check.hpp"
#include "eses/grid.hpp"
#include "eses/outputs.hpp"
#include "eses/read_atoms.hpp"
#include "eses/run_options.hpp"
#include "eses/summary.hpp"
#include "eses/surface.hpp"
#include "geometry/box.hpp"
#include "geometry/tiling.hpp"
#include "solve/block_solver.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// The part of a grid to compute: all of it, the points in a closed box (angstrom, finite), blocks
/// of the tiling of the whole grid, or a range of points; and the edges that start at these points.
/// Indices and coordinates still refer to the whole grid.
using GridPart = std::variant<std::monostate, Box, BlockRange, GridRegion>;

/// Maximum number of points, and of edges, to verify.
inline constexpr std::int64_t max_verify = 10'000'000;

/// The surface of a run. The solvent accessible surface is the van der Waals surface of atoms whose
/// radii are larger by the radius of the probe.
enum class SurfaceKind : std::uint8_t { ses, sas, vdw };

/// A surface with its short name, as in options, and its name in texts.
struct SurfaceName {
  std::string_view option, name;
};

/// The names in the order of SurfaceKind.
inline constexpr std::array surface_names{SurfaceName{"ses", "solvent excluded surface"},
                                          SurfaceName{"sas", "solvent accessible surface"},
                                          SurfaceName{"vdw", "van der Waals surface"}};

/// Returns the names of a surface.
constexpr const SurfaceName& names_of(SurfaceKind kind) {
  return surface_names[static_cast<std::size_t>(kind)];
}

/// Parameters of a run.
struct Parameters {
  /// `min_probe_radius` to `max_probe_radius` (angstrom), or 0 for the van der Waals surface.
  double probe_radius = 1.4;
  /// Whether the radii of the atoms are larger by that of a probe, and the probe radius is 0.
  bool has_grown_atoms = false;
  /// Options of the grid of ESES, or a custom grid.
  std::variant<GridOptions, Grid> grid = {};
  /// Number of grid points on a side of a block, 2 to `max_block_size`. 0 means an automatic
  /// choice: `default_block_size`, flatter blocks for wide molecules, and smaller blocks for coarse
  /// grids or to satisfy `max_memory`.
  std::int64_t block_size = 0;
  /// Number of threads. 0 means all available processors, or fewer to satisfy `max_memory`.
  int threads = 0;
  /// Maximum resident memory of the process in bytes. 0 means all available memory.
  std::uint64_t max_memory = 0;
  /// Resident memory in bytes that the process held before, to which `max_memory` does not apply.
  std::uint64_t memory_before = 0;
  std::int64_t verify = 0;  ///< number of points, and of edges, to verify; 0 to `max_verify`
  /// Whether to measure the whole surface in closed form, too. Only for a single process.
  bool exact = false;
  /// Maximum void of the cavities that are filled (cubic angstrom); none are filled without a
  /// value.
  std::optional<double> max_filled_void = {};
  GridPart part = {};
  /// Whether to compute grids of more than 1e10 points of which less than 1 % are near atoms.
  bool allow_far_atoms = false;

  /// The surface that the files name.
  SurfaceKind surface() const {
    if (probe_radius > 0) return SurfaceKind::ses;
    return has_grown_atoms ? SurfaceKind::sas : SurfaceKind::vdw;
  }

  bool has_custom_grid() const { return std::holds_alternative<Grid>(grid); }
};

/// An input file.
struct InputFile {
  std::filesystem::path path;
  AtomFormat format = AtomFormat::automatic;
  StructureOptions structure = {};  ///< options for PDB and mmCIF files
  /// Is added to the radii of all atoms (angstrom). The diagnostics are those of the radii without
  /// it.
  double added_radius = 0;
};

class Sink;

/// Memory that the caller of a run needs for the results, besides the memory of the run.
struct CallerMemory {
  double per_point = 0, per_crossing = 0;  ///< bytes
};

/// The share of a run that a process computes: number `index` of `count`, from 0.
struct Share {
  int index = 0, count = 1;
};

/// When the chunks that other runs have left are joined.
enum class Join : std::uint8_t {
  none,         ///< The run computes missing chunks.
  required,     ///< The run computes nothing. Missing chunks are an error.
  if_complete,  ///< Throws NotJoined if chunks are missing, or if another run uses the chunks.
};

/// Thrown for Join::if_complete.
struct NotJoined {};

/// A request: the choices of the user for a run.
struct Request {
  /// The atoms. A molecule in memory is computed by a single process.
  std::variant<InputFile, Molecule> atoms;
  Parameters parameters = {};
  Outputs outputs = {};
  std::filesystem::path output_directory = {};
  /// Whether to keep finished chunks on disk, and to continue from the chunks of an earlier run.
  bool resume = false;
  /// The share to compute alone. Its chunks are kept on disk; no output file is written.
  std::optional<Share> part = {};
  Join join = Join::none;
  bool dry_run = false;  ///< whether to create no files
  /// Receives the pieces in place of files, for maps in memory of a single process. Outlives the
  /// run; null if there are files.
  Sink* map_sink = nullptr;
  CallerMemory caller_memory = {};
  /// Called during the search for cavities, which is part of the plan.
  CheckCallback check = {};

  /// Whether finished chunks are kept if the run ends before the output files are complete.
  bool keeps_chunks() const { return resume || part || join != Join::none; }
  /// Whether cavities are filled, or the mesh has components.
  bool needs_cavities() const {
    const std::optional<MeshOptions>& mesh = outputs.mesh;
    return parameters.max_filled_void ||
           (mesh && (mesh->component || mesh->color == MeshColor::component));
  }
  /// Whether the cavities are searched. A dry run only has to know whether the component of the
  /// mesh exists, because it fails where the run would fail.
  bool searches_cavities() const {
    return needs_cavities() && (!dry_run || (outputs.mesh && outputs.mesh->component));
  }
};

/// Receives each block once, in unspecified order. See `Callbacks` for the calling threads. An
/// exception of the callback ends the run and is rethrown.
using SolvedBlockCallback = std::function<void(const BlockResult&)>;

/// Functions that a run calls; empty ones are not called. Any thread of the run may call them, but
/// no two calls happen at the same time, even of different functions.
struct Callbacks {
  /// Called once, when the output files and the checkpoint are locked.
  std::function<void()> locked = {};
  ProgressCallback progress = {};
  SolvedBlockCallback block = {};
  /// Like `progress`, for the checks of the verification.
  ProgressCallback verification = {};
};

}  // namespace eses::detail
