#pragma once
/// @file
/// Selection of output files.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace eses {

/// Colours of the vertices of a PLY, OBJ, VTP or glTF file.
enum class MeshColor {
  none,       ///< No colours.
  patch,      ///< Different colours for convex, saddle and concave patches.
  atom,       ///< A colour for the first adjacent atom.
  chain,      ///< A colour for the chain of the first adjacent atom; needs labels.
  potential,  ///< Red, white and blue for a potential; needs MeshOptions::potential.
  component,  ///< A colour for each cavity, and grey for the outer surface; see doc/cavities.md.
};

/// A map of an electrostatic potential, from which the vertices of a mesh get values and colours.
/// The values are interpolated linearly. The map is in memory during the whole run, with four bytes
/// for each value.
struct MeshPotential {
  /// OpenDX file with values in kT/e, such as those of APBS; may be compressed (.gz). It must
  /// contain all vertices, moved by `offset`.
  std::filesystem::path file;
  /// Distance from the vertex, outward along its normal, at which the value is taken; angstrom, at
  /// least 0.
  double offset = 0;
  /// End of the scale of colours, which begins at the negative value; kT/e, more than 0.
  double limit = 5;
};

/// A mesh file, or the pair of mesh files of MSMS.
struct MeshOptions {
  /// Path of the file. The suffix, in upper or lower case, determines the format: `.ply`, `.obj`,
  /// `.off`, `.vtp` (VTK XML), `.stl` or `.glb` (glTF). With `.vert` or `.face`, both files of MSMS
  /// are written, NAME.vert and NAME.face. doc/meshes.md describes the formats.
  std::filesystem::path file;
  MeshColor color = MeshColor::none;  ///< Colours, in PLY, OBJ, VTP and glTF files only.
  bool is_ascii = false;              ///< Whether a PLY file is text instead of binary.
  /// Whether triangles with small angles are removed or improved. Vertices are then a part of the
  /// crossings. doc/meshes.md describes the method.
  bool quality = false;
  /// A potential, only with MeshColor::potential. PLY and VTP files have its values, too.
  std::optional<MeshPotential> potential = {};
  /// Makes the mesh of one component alone: the void of a cavity, by its number from 1 in
  /// Measures::cavities, or with 0 the outer surface. Such a mesh is closed. The totals of the
  /// summary are those of the void, or of the outer surface. Needs a surface without filled
  /// cavities, and no other outputs.
  std::optional<std::uint32_t> component = {};
};

/// Maps of the dielectric for finite-difference Poisson-Boltzmann solvers, such as APBS with
/// `usemap diel`. They are three OpenDX files with the values at the midpoints of the grid edges
/// along x, y and z. The value of an edge is the harmonic mean `1 / (t / solute + (1 - t) /
/// solvent)`, where t is the fraction of the edge inside the surface. Each map has the size of the
/// grid, and an origin that is shifted by half a spacing along its axis. Values beyond the last
/// points of the grid are the dielectric of the solvent.
struct DielectricMaps {
  /// Prefix of the file names `PREFIXx.dx`, `PREFIXy.dx` and `PREFIXz.dx` in the output directory.
  /// With Outputs::gzip the names have the additional suffix .gz.
  std::string prefix;
  double solute = 2;       ///< Relative permittivity inside the surface, 1e-9 to 1e9.
  double solvent = 78.54;  ///< Relative permittivity outside the surface, 1e-9 to 1e9.
};

/// A map of ion accessibility, as APBS reads it with `usemap kappa`. A point is 1 if the centre of
/// an ion may be there: its distance from every atom is at least the sum of the radii of atom and
/// ion. Other points are 0.
struct IonAccessMap {
  /// Name of an OpenDX file in the output directory; it ends with .dx, or with .dx.gz if the file
  /// is to be compressed.
  std::string file;
  double ion_radius = 2;  ///< Radius of the ions, in angstrom; 0 to 1000.
};

/// Selection of the files that write_files writes. The four text files have the formats of ESES.
struct Outputs {
  bool box = true;    ///< bounding_box.txt: corners and size of the grid.
  bool grid = true;   ///< grid_info.txt: every grid point, 1 inside and -1 outside.
  bool edges = true;  ///< intersection_info.txt: every crossing.
  bool areas = true;  ///< partition_area.txt: the area of every atom.
  /// residue_area.csv and chain_area.csv: areas of residues and chains; need labels.
  bool residues = false;
  /// atoms.csv: names, element, radius and area of every atom. Without labels the names are empty.
  bool atoms = false;
  /// Whether the four text files and the maps of the dielectric are compressed, with the additional
  /// suffix .gz.
  bool gzip = false;
  /// File name, in the output directory, of a map with 1 inside and 0 outside. The suffix .dx gives
  /// OpenDX, .dx.gz compressed OpenDX, and .vti VTK image data. Empty for no map.
  std::string inside_map = {};
  std::optional<DielectricMaps> dielectric = {};  ///< Maps of the dielectric.
  std::optional<IonAccessMap> ion_access = {};    ///< A map of ion accessibility.
  std::optional<MeshOptions> mesh = {};           ///< A triangle mesh of the surface.

  /// Returns a selection without any file.
  static Outputs none() { return {false, false, false, false}; }
};

}  // namespace eses
