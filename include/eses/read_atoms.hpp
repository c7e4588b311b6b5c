#pragma once
/// @file
/// Reading of atoms from xyzr, PQR, PDB and mmCIF files.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "eses/diagnostics.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// Format of an input file.
enum class AtomFormat {
  /// The format is given by the suffix: `.pqr` for PQR, `.pdb`, `.pdb1`, `.pdb2` and so on, and
  /// `.ent` for PDB, `.cif`, `.mmcif`, `.mcif` and `.pdbx` for mmCIF, also with an additional
  /// `.gz`. All other files are xyzr.
  automatic,
  /// One atom a line: `x y z r`. Further columns, blank lines and lines with `#` are ignored.
  xyzr,
  /// ATOM and HETATM records. The last two numbers, which an element symbol may follow, are charge
  /// and radius.
  pqr,
  /// ATOM and HETATM records in the columns of the Protein Data Bank. Radii are assigned from
  /// StructureOptions::radii.
  pdb,
  /// The category atom_site of PDBx/mmCIF. Radii are assigned from StructureOptions::radii.
  mmcif,
};

/// Returns whether StructureOptions apply to files of a format.
constexpr bool is_structure(AtomFormat format) {
  return format == AtomFormat::pdb || format == AtomFormat::mmcif;
}

/// Selection of the hydrogens of a PDB or mmCIF file.
enum class HydrogenChoice {
  by_radii,  ///< None if the radii belong to united atoms, which include hydrogens; all
             ///< otherwise.
  keep,      ///< All.
  drop,      ///< None.
};

/// Names of the chains of an mmCIF file.
enum class ChainNames {
  auth,   ///< Names of the authors (`auth_asym_id`), as in PDB files.
  label,  ///< Names of the PDB (`label_asym_id`), which differ for each ligand.
};

/// Selection and radii of the atoms of a PDB or mmCIF file.
struct StructureOptions {
  /// The set of radii: `protor`, `bondi`, `msms`, `naccess` or `oons`, or one of them with
  /// Shannon's radii of ions, such as `protor+shannon`; `occupancy` for the radii that the file has
  /// in place of occupancies; or the path of a file in FreeSASA's configuration format, also with
  /// `+shannon`.
  std::string radii = "protor";
  /// Radius of atoms that are not in the set, in angstrom. If it is empty, such atoms are an error.
  std::optional<double> unknown_radius;
  /// Number of the model to read; 0 for the first one. It also applies to PQR files.
  int model = 0;
  /// The alternate location to read, such as `A`; empty for the location with the highest occupancy
  /// in each residue.
  std::string altloc;
  bool with_waters = false;  ///< Whether water molecules are read.
  bool with_hetatm = true;   ///< Whether HETATM records other than water are read.
  HydrogenChoice hydrogens = HydrogenChoice::by_radii;  ///< Which hydrogens are read.
  std::vector<std::string> chains;                      ///< The chains to read; empty for all.
  /// A selection: chains such as `A+B`, `ligand:HEM`, `ligand`, or gemmi's syntax, such as
  /// `/1/A/10-20/CA`; empty for all atoms.
  std::string select;
  /// Identifier of the biological assembly to build; empty for the atoms of the file.
  std::string assembly;
  /// Names of the chains. ChainNames::label needs an mmCIF file.
  ChainNames chain_names = ChainNames::auth;
  /// Compares all options.
  friend bool operator==(const StructureOptions&, const StructureOptions&) = default;
};

/// Atoms of a PDB or mmCIF file with the same residue name and atom name, and thus the same radius.
struct RadiusSource {
  std::string residue;      ///< Residue name, such as HEM.
  std::string atom_name;    ///< Atom name, such as FE.
  std::string element;      ///< Element symbol, such as Fe; X if unknown.
  double radius = 0;        ///< Radius in angstrom.
  std::uint64_t count = 0;  ///< Number of atoms.
};

/// A biological assembly of a file that differs from the atoms that were read.
struct OtherAssembly {
  std::string id;               ///< Its identifier, for StructureOptions::assembly.
  std::uint64_t operators = 0;  ///< Number of its different operators.
  std::uint64_t atoms = 0;      ///< Number of the atoms that were read and that it contains.
};

/// Both names of a chain of an mmCIF file.
struct ChainName {
  std::string auth;   ///< Name of the authors (`auth_asym_id`).
  std::string label;  ///< Name of the PDB (`label_asym_id`).
  /// Compares both names.
  friend bool operator==(const ChainName&, const ChainName&) = default;
};

/// Report on the atoms of a PDB or mmCIF file that were read and left out. Unless said otherwise,
/// all counts are numbers of atoms before the operations of an assembly.
struct StructureReport {
  std::string radii;            ///< Name of the set of radii.
  std::string model;            ///< Number of the model that was read.
  std::uint64_t models = 0;     ///< Number of models in the file.
  std::string assembly;         ///< Identifier of the assembly; empty if none was built.
  std::uint64_t operators = 1;  ///< Number of different operators of the assembly.

  std::uint64_t atom_records = 0;    ///< Atoms read from ATOM records, without water.
  std::uint64_t hetatm_records = 0;  ///< Atoms read from HETATM records, without water.
  std::uint64_t waters = 0;          ///< Atoms read from water molecules.

  std::uint64_t dropped_chains = 0;     ///< Atoms left out: other chains.
  std::uint64_t dropped_selection = 0;  ///< Atoms left out: not in the selection.
  std::uint64_t dropped_waters = 0;     ///< Atoms left out: water molecules.
  std::uint64_t dropped_hetatm = 0;     ///< Atoms left out: HETATM records, without water.
  std::uint64_t dropped_hydrogens = 0;  ///< Atoms left out: hydrogens.
  std::uint64_t dropped_altlocs = 0;    ///< Atoms left out: other alternate locations.
  /// Atoms left out: dummy atoms of occupancy 0 whose coordinates are all 9999 or more.
  std::uint64_t dropped_dummies = 0;
  std::uint64_t dropped_assembly = 0;  ///< Atoms left out: not in the assembly.
  /// Images left out of an assembly, as on axes of symmetry: images of HETATM records that coincide
  /// with an earlier image of the same atom to within 0.5 angstrom.
  std::uint64_t dropped_images = 0;

  /// Atoms with the radius of their element. The counts include the images of an assembly.
  std::vector<RadiusSource> by_element;
  /// Atoms with StructureOptions::unknown_radius. The counts include the images of an assembly.
  std::vector<RadiusSource> unknown;
  /// Atoms, other than those of amino acids, nucleotides and water, whose element follows from
  /// their names, because the file has none or another one for an ion.
  std::vector<RadiusSource> guessed_elements;
  /// The chains that are segments of a PDB file (columns 73 to 76), because the names of its chains
  /// are blank or the same for different segments.
  std::vector<std::string> segment_chains;
  /// StructureOptions::chain_names.
  ChainNames chain_names = ChainNames::auth;
  /// Both names of the chains of the atoms that were read, in their order; empty for PDB files and
  /// without `label_asym_id`.
  std::vector<ChainName> chains;
  /// The assemblies with several operators or without some of the atoms; empty if an assembly was
  /// built, or if the file is an assembly file of the PDB.
  std::vector<OtherAssembly> other_assemblies;
};

/// The atoms of a file.
struct AtomFile {
  std::vector<Atom> atoms;           ///< Atoms in the order of the file.
  std::vector<std::uint64_t> lines;  ///< Line number of each atom, from 1.
  std::vector<AtomLabel> labels;     ///< Names of each atom; empty for xyzr files.
  /// Charges of the atoms of PQR files and of some mmCIF files (NaN if unknown), or empty.
  std::vector<double> charges = {};
  /// Report on a PDB or mmCIF file; empty for other formats.
  std::optional<StructureReport> structure = {};
  /// The diagnostics that follow from the names of the atoms, one for each kind that occurs.
  /// Surface::diagnostics() has those that follow from centres and radii.
  std::vector<Diagnostic> diagnostics = {};
};

/// Options of read_atoms.
struct ReadOptions {
  AtomFormat format = AtomFormat::automatic;  ///< Format of the file.
  /// Whether labels and charges are read. They need more memory than atoms.
  bool with_labels = true;
  /// Limit of the resident memory of the process while it reads, in bytes; 0 for no limit. Reading
  /// may always add a few MiB.
  std::uint64_t max_memory = 0;
  /// Selection and radii of the atoms of a PDB or mmCIF file. Only the model applies to a PQR file.
  StructureOptions structure = {};
  /// Called while the file is read, at least once for each part of it.
  CheckCallback check = {};
};

/// Reads the atoms of a file, which may be gzipped; `-` is standard input.
///
/// Throws Error, with file, line and field, if the file cannot be read, contains no atoms, or has
/// an unsupported format; if a field is missing or not a finite number; if a radius is negative or
/// unknown; or if the memory limit is exceeded. The Error is a FileError if the operating system
/// refuses to open or read the file, and a MemoryLimitError if the available memory or the limit
/// does not suffice. Throws std::invalid_argument if StructureOptions::unknown_radius is not a
/// number from 0 to `max_coordinate`, if StructureOptions::model is negative, or if
/// StructureOptions::altloc has more than one character.
AtomFile read_atoms(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads the atoms of a text in memory, with labels and charges. `name` is the name of the text for
/// messages. AtomFormat::automatic means xyzr. Throws the exceptions of read_atoms.
AtomFile parse_atoms(std::string_view text, AtomFormat format = AtomFormat::automatic,
                     std::string_view name = "text", const StructureOptions& structure = {});

}  // namespace eses
#pragma GCC visibility pop
