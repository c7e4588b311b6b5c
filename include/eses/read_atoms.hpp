#pragma once
/// @file
/// Reading atoms from xyzr, PQR, PDB and mmCIF files.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"

namespace eses {

/// Format of an input file.
enum class AtomFormat {
  /// The suffix decides: `.pqr` is PQR, `.pdb` and `.ent` are PDB, `.cif` and `.mmcif` are mmCIF,
  /// each also with `.gz` behind it; everything else is xyzr.
  automatic,
  /// One atom a line: `x y z r`. Further columns, blank lines and lines with `#` are ignored.
  xyzr,
  /// ATOM and HETATM records. The last two numbers, before an element symbol if there is one, are
  /// charge and radius.
  pqr,
  /// ATOM and HETATM records in the columns of the Protein Data Bank. Radii come from a set of
  /// radii.
  pdb,
  /// The category atom_site of PDBx/mmCIF. Radii come from a set of radii.
  mmcif,
};

/// Returns whether files of a format are read with StructureOptions.
constexpr bool is_structure(AtomFormat format) {
  return format == AtomFormat::pdb || format == AtomFormat::mmcif;
}

/// Which hydrogens of a PDB or mmCIF file are atoms of the surface.
enum class HydrogenChoice {
  by_radii,  ///< None if the radii are those of united atoms, which include hydrogens; else all.
  keep,      ///< All.
  drop,      ///< None.
};

/// Selection and radii of the atoms of a PDB or mmCIF file.
struct StructureOptions {
  /// A set of radii, `protor`, `bondi` or `msms`, or the path of a file in FreeSASA's configuration
  /// format.
  std::string radii = "protor";
  /// Radius of atoms for which the set has none, in angstrom. Without it such atoms are an error.
  std::optional<double> unknown_radius;
  /// The number of the model that is read; 0 for the first one. PQR files have models, too.
  int model = 0;
  /// The alternate location that is read, such as `A`; empty for that of the highest occupancy in
  /// each residue.
  std::string altloc;
  bool with_waters = false;  ///< Whether water molecules are read.
  bool with_hetatm = true;   ///< Whether HETATM records other than water are read.
  HydrogenChoice hydrogens = HydrogenChoice::by_radii;  ///< Which hydrogens are read.
  std::vector<std::string> chains;                      ///< The chains to read; empty for all.
  /// A selection in gemmi's syntax, such as `/1/A/10-20/CA`; empty for all atoms.
  std::string select;
  /// Identifier of the biological assembly to build; empty for the atoms of the file.
  std::string assembly;
  /// Compares all options.
  friend bool operator==(const StructureOptions&, const StructureOptions&) = default;
};

/// Atoms of a PDB or mmCIF file that share a residue name and an atom name, and so a radius.
struct RadiusSource {
  std::string residue;      ///< Residue name, such as HEM.
  std::string atom_name;    ///< Atom name, such as FE.
  std::string element;      ///< Element symbol, such as Fe; X if unknown.
  double radius = 0;        ///< Radius in angstrom.
  std::uint64_t count = 0;  ///< Number of atoms.
};

/// Report on the atoms of a PDB or mmCIF file that were read and left out. Unless said otherwise,
/// all counts are numbers of atoms before the operations of an assembly.
struct StructureReport {
  std::string radii;            ///< Name of the set of radii.
  std::string model;            ///< Number of the model that was read.
  std::uint64_t models = 0;     ///< Number of models in the file.
  std::string assembly;         ///< Identifier of the assembly; empty if none was built.
  std::uint64_t operators = 1;  ///< Number of operators of the assembly.

  std::uint64_t atom_records = 0;    ///< Read from ATOM records other than water.
  std::uint64_t hetatm_records = 0;  ///< Read from HETATM records other than water.
  std::uint64_t waters = 0;          ///< Read from water molecules.

  std::uint64_t dropped_chains = 0;     ///< Left out: of other chains.
  std::uint64_t dropped_selection = 0;  ///< Left out: not in the selection.
  std::uint64_t dropped_waters = 0;     ///< Left out: water.
  std::uint64_t dropped_hetatm = 0;     ///< Left out: HETATM records other than water.
  std::uint64_t dropped_hydrogens = 0;  ///< Left out: hydrogens.
  std::uint64_t dropped_altlocs = 0;    ///< Left out: other alternate locations.
  /// Left out of an assembly: images that coincide with their atom, as on axes of symmetry.
  std::uint64_t dropped_images = 0;

  /// Atoms whose radius the set has by their element alone, with the images of an assembly.
  std::vector<RadiusSource> by_element;
  /// Atoms with StructureOptions::unknown_radius, with the images of an assembly.
  std::vector<RadiusSource> unknown;
};

/// The atoms of a file.
struct AtomFile {
  std::vector<Atom> atoms;           ///< Atoms in the order of the file.
  std::vector<std::uint64_t> lines;  ///< Line number of each atom, from 1.
  std::vector<AtomLabel> labels;     ///< Names of each atom; empty for xyzr files.
  /// Report on a PDB or mmCIF file; empty for other formats.
  std::optional<StructureReport> structure = {};
};

/// Choices of read_atoms.
struct ReadOptions {
  AtomFormat format = AtomFormat::automatic;  ///< Format of the file.
  /// Whether labels are read; labels take more memory than atoms.
  bool with_labels = true;
  /// Bytes that the process may hold resident while it reads; 0 for no limit. A few MiB are allowed
  /// in any case.
  std::uint64_t max_memory = 0;
  /// Selection and radii of the atoms of a PDB or mmCIF file. Only the model applies to a PQR file.
  StructureOptions structure = {};
  /// Called while the file is read, at least once for each piece of it.
  CheckCallback check = {};
};

/// Reads the atoms of a file, which may be gzipped; `-` is standard input. Throws Error, which
/// names file, line and field, if the file cannot be read, holds no atom, has a field that is
/// missing, not a finite number or a negative radius, is of a format that is not read, takes more
/// memory than allowed, or has atoms for which there is no radius. The Error is a FileError if the
/// operating system refuses to open or read the file, and a MemoryLimitError if the memory does not
/// suffice.
AtomFile read_atoms(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads the atoms of a text in memory, with labels. `name` is the name of the text in messages;
/// AtomFormat::automatic means xyzr. Throws Error as read_atoms does.
AtomFile parse_atoms(std::string_view text, AtomFormat format = AtomFormat::automatic,
                     std::string_view name = "text", const StructureOptions& structure = {});

}  // namespace eses
