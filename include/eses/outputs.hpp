#pragma once
/// @file
/// The files that can be written.

#include <filesystem>
#include <optional>
#include <string>

namespace eses {

/// Colours of the vertices of a PLY file.
enum class MeshColor {
  none,   ///< No colours.
  patch,  ///< One colour each for convex, saddle and concave patches.
  atom,   ///< A colour for the first adjacent atom.
  chain,  ///< A colour for the chain of the first adjacent atom; needs labels.
};

/// A mesh file.
struct MeshOptions {
  /// Path of the file. The suffix is the format: `.ply` (binary), `.obj` or `.off`, in any case.
  std::filesystem::path file;
  MeshColor color = MeshColor::none;  ///< Colours, in PLY files only.
};

/// The files that write_files writes. The formats of the four text files are those of ESES.
struct Outputs {
  bool box = true;    ///< bounding_box.txt: corners and size of the grid.
  bool grid = true;   ///< grid_info.txt: every grid point with 1 inside, -1 outside.
  bool edges = true;  ///< intersection_info.txt: every crossing.
  bool areas = true;  ///< partition_area.txt: the area of every atom.
  /// residue_area.csv and chain_area.csv: areas of residues and chains; need labels.
  bool residues = false;
  bool gzip = false;  ///< Compresses the four text files, whose names then end with .gz.
  /// Name of a map in the output directory with 1 inside and 0 outside: OpenDX if it ends with .dx,
  /// VTK image data if it ends with .vti. Empty for no map.
  std::string inside_map = {};
  std::optional<MeshOptions> mesh = {};  ///< A triangle mesh of the surface.

  /// No file at all.
  static Outputs none() { return {false, false, false, false}; }
};

}  // namespace eses
