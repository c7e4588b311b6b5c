#pragma once
/// Parsing of PDB and mmCIF texts, and selection of atoms. Radii are assigned later.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "eses/check.hpp"
#include "eses/read_atoms.hpp"

namespace eses::detail {

struct StructureResidue {
  std::string chain;   ///< name of the chain or of its copy in an assembly, such as A-2
  std::string name;    ///< residue name, such as ALA
  std::string number;  ///< residue number with the insertion code
};

struct StructureAtom {
  Vec3 center;
  std::uint64_t line = 0;     ///< line number in the file, from 1
  std::uint32_t residue = 0;  ///< index in SelectedStructure::residues
  std::uint32_t name = 0;     ///< index in SelectedStructure::atom_names
  std::uint8_t element = 0;   ///< atomic number; 0 if unknown
  bool is_hydrogen = false;   ///< hydrogen or deuterium
};

struct SelectedStructure {
  std::vector<StructureResidue> residues;
  std::vector<std::string> atom_names;  ///< distinct names of atoms
  /// In the order of the file; the copies of an assembly follow each other.
  std::vector<StructureAtom> atoms;
  StructureReport report;  ///< all members except those about radii
};

/// The text of a PDB or mmCIF file.
struct StructureText {
  std::string_view text;
  std::string_view name;  ///< name of the file, for messages
  AtomFormat format = AtomFormat::pdb;
  /// Whether the name has the suffix of an assembly file of the PDB, such as .pdb1.
  bool is_assembly_file = false;
  CheckCallback check = {};  ///< called from time to time if it is not empty
};

/// Parses a PDB or mmCIF text and selects atoms. Removes hydrogens if `with_hydrogens` is false,
/// independently of `options`. Calls `require_memory` with the number of bytes before each large
/// allocation. Throws Error with file and line.
SelectedStructure parse_structure(const StructureText& text, const StructureOptions& options,
                                  bool with_hydrogens,
                                  const std::function<void(std::uint64_t bytes)>& require_memory);

/// Returns the symbol of an element, such as Zn; X if it is unknown.
std::string_view element_symbol(std::uint8_t atomic_number);

}  // namespace eses::detail
