#pragma once
/// Texts of PDB and mmCIF files, and what the readers make of them.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "eses/error.hpp"
#include "eses/read_atoms.hpp"
#include "support/sandbox.hpp"

namespace eses::detail::test {

namespace fs = std::filesystem;

/// Files of Debian packages, which may be missing.
inline const std::string freesasa_data = "/usr/share/freesasa/";
inline const std::string biopython_data = "/usr/share/doc/python-biopython-doc/Tests/PDB/";
/// A crystal structure.
inline const std::string crystal = ESES_TEST_DATA "/1a8o.cif.gz";

/// A record of a PDB file.
struct PdbAtom {
  std::string record = "ATOM", name = " CA ";
  char altloc = ' ';
  std::string residue = "ALA", chain = "A", number = "   1 ";
  double x = 0, y = 0, z = 0, occupancy = 1;
  std::string element = " C";
};

/// Returns the line of a record.
std::string line_of(const PdbAtom& a);

/// Returns the lines of an atom, a hydrogen, an atom of another chain, a ligand and a water.
std::string mixed_text();

/// REMARK 350 with an assembly of two copies of chain A.
extern const std::string dimer_remarks;

/// The head of the table of atoms of an mmCIF file.
extern const std::string mmcif_head;

/// Returns an mmCIF text with the chain A at (1, 2, 3), the chain B at (4, 5, 6), and an assembly
/// X with an operator expression. The operator R is a rotation around the z axis, T and the
/// numbers 1 to 3 are translations along x.
std::string text_with_assembly(const std::string& expression, const std::string& chains = "A,B");

AtomFile read_pdb(std::string_view text, const StructureOptions& options = {});
AtomFile read_mmcif(std::string_view text, const StructureOptions& options = {});
AtomFile read_structure(const fs::path& path, const StructureOptions& options = {});

/// Returns the message of the Error that an action throws; empty if it throws none.
std::string error_of(const auto& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Returns the message of the Error for a PDB text.
std::string pdb_error(std::string_view text, const StructureOptions& options = {});

using Names = std::vector<std::string>;

/// Returns the label of each atom, such as `A ALA 1 CA`.
Names names_of(const AtomFile& file);

/// Returns the elements of the atoms.
inline Names elements_of(const AtomFile& file) {
  Names elements;
  for (const AtomLabel& label : file.labels) elements.push_back(label.element);
  return elements;
}

/// Reads a PDB text with Bondi's radii.
inline AtomFile read_bondi(std::string_view text) {
  StructureOptions options;
  options.radii = "bondi";
  return read_pdb(text, options);
}

/// Returns the text of a gzipped or plain file.
std::string text_of(const fs::path& path);

/// Returns the coordinates in the columns of a PDB file.
std::string columns_of(const Vec3& at);

}  // namespace eses::detail::test
