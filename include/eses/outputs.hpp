#pragma once
/// @file
/// The files that can be written.

#include <filesystem>
#include <optional>
#include <string>

namespace eses {

/// Colours of the vertices of a PLY or VTP file.
enum class MeshColor {
  none,   ///< No colours.
  patch,  ///< One colour each for convex, saddle and concave patches.
  atom,   ///< A colour for the first adjacent atom.
  chain,  ///< A colour for the chain of the first adjacent atom; needs labels.
};

/// A mesh in a file, or in MSMS's pair of files.
struct MeshOptions {
  /// Path of the file. The suffix, in upper or lower case, is the format: `.ply`, `.obj`, `.off`,
  /// `.vtp` (VTK XML PolyData), or `.vert` or `.face` for the two files NAME.vert and NAME.face
  /// of MSMS, which appear together or not at all. doc/meshes.md describes the formats.
  std::filesystem::path file;
  MeshColor color = MeshColor::none;  ///< Colours, in PLY and VTP files only.
  bool is_ascii = false;              ///< Writes a PLY file as text; it is binary otherwise.
};

/// Maps of the dielectric for finite-difference Poisson-Boltzmann solvers, such as APBS reads with
/// `usemap diel`: three OpenDX files with the values at the middles of the grid's edges along x, y
/// and z. An edge of which the share t lies inside the surface has the harmonic mean
/// `1 / (t / solute + (1 - t) / solvent)`; if the surface cuts it several times, t is the total of
/// all parts inside. Each map has the counts of the grid, and an origin that is shifted by half a
/// spacing along its axis; values beyond the last points of the grid are those of the solvent.
struct DielectricMaps {
  /// The files are `PREFIXx.dx`, `PREFIXy.dx` and `PREFIXz.dx` in the output directory, or
  /// `PREFIXx.dx.gz` and so on with Outputs::gzip.
  std::string prefix;
  double solute = 2;       ///< Relative permittivity inside the surface, 1e-9 to 1e9.
  double solvent = 78.54;  ///< Relative permittivity outside the surface, 1e-9 to 1e9.
};

/// A map of the points to which the centres of ions have access, as APBS reads it with
/// `usemap kappa`: 1 at points outside all spheres of the atoms' radius plus that of the ions, and
/// 0 at others.
struct IonAccessMap {
  /// Name of an OpenDX file in the output directory; it ends with .dx, or with .dx.gz if the file
  /// is to be compressed.
  std::string file;
  double ion_radius = 2;  ///< Radius of the ions, in angstrom; 0 to 1000.
};

/// The files that write_files writes. The formats of the four text files are those of ESES.
struct Outputs {
  bool box = true;    ///< bounding_box.txt: corners and size of the grid.
  bool grid = true;   ///< grid_info.txt: every grid point with 1 inside, -1 outside.
  bool edges = true;  ///< intersection_info.txt: every crossing.
  bool areas = true;  ///< partition_area.txt: the area of every atom.
  /// residue_area.csv and chain_area.csv: areas of residues and chains; need labels.
  bool residues = false;
  /// Compresses the four text files and the maps of the dielectric, whose names then end with .gz.
  bool gzip = false;
  /// Name of a map in the output directory with 1 inside and 0 outside: OpenDX if it ends with .dx,
  /// compressed OpenDX with .dx.gz, VTK image data with .vti. Empty for no map.
  std::string inside_map = {};
  std::optional<DielectricMaps> dielectric = {};  ///< Maps of the dielectric.
  std::optional<IonAccessMap> ion_access = {};    ///< A map of the access of ions.
  std::optional<MeshOptions> mesh = {};           ///< A triangle mesh of the surface.

  /// No file at all.
  static Outputs none() { return {false, false, false, false}; }
};

}  // namespace eses
