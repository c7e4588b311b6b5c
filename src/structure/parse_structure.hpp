#pragma once
/// The atoms of PDB and mmCIF texts that a run is to have, before they get radii.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "eses/check.hpp"
#include "eses/read_atoms.hpp"

namespace eses::detail {

struct StructureResidue {
  std::string chain;   ///< with the number of the copy in an assembly, such as A-2
  std::string name;    ///< such as ALA
  std::string number;  ///< with the insertion code
};

struct StructureAtom {
  Vec3 center;
  std::uint64_t line = 0;     ///< in the file, 1-based
  std::uint32_t residue = 0;  ///< index in SelectedStructure::residues
  std::uint32_t name = 0;     ///< index in SelectedStructure::atom_names
  std::uint8_t element = 0;   ///< atomic number; 0 if unknown
  bool is_hydrogen = false;   ///< hydrogen or deuterium
};

struct SelectedStructure {
  std::vector<StructureResidue> residues;
  std::vector<std::string> atom_names;  ///< each once
  /// In the order of the file; the copies of an assembly follow each other.
  std::vector<StructureAtom> atoms;
  StructureReport report;  ///< without radii
};

/// A text that is parsed.
struct StructureText {
  std::string_view text;
  std::string_view name;  ///< of the file, in messages
  AtomFormat format = AtomFormat::pdb;
  CheckCallback check = {};  ///< called from time to time if it is not empty
};

/// Parses a PDB or mmCIF text and selects atoms. Hydrogens are left out if `with_hydrogens` is
/// false, whatever `options` has. Calls `require_memory` with the bytes that are needed next.
/// Throws Error, which names file and line.
SelectedStructure parse_structure(const StructureText& text, const StructureOptions& options,
                                  bool with_hydrogens,
                                  const std::function<void(std::uint64_t bytes)>& require_memory);

/// Symbol of an element, such as Zn; X if it is unknown.
std::string_view element_symbol(std::uint8_t atomic_number);

}  // namespace eses::detail
