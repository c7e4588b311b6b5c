#pragma once
/// Atoms and residues of PDB and mmCIF files.

#include <cstdint>
#include <gemmi/model.hpp>
#include <gemmi/resinfo.hpp>
#include <string>
#include <string_view>

#include "eses/vec3.hpp"
#include "input/pdb_elements.hpp"

namespace eses::detail {

/// An atom of a gemmi::Model, or its image in an assembly.
struct StructureAtom {
  const gemmi::Atom* atom;
  const gemmi::Residue* residue;
  const std::string* chain;  ///< name of the chain or of its copy, such as A-2
  Vec3 center;

  /// The line number in the file, which the readers store as the serial number.
  std::uint64_t line() const { return static_cast<std::uint64_t>(atom->serial); }
};

/// Returns the symbol of an element, such as Zn; X if it is unknown, and H for deuterium.
inline const char* symbol_of(gemmi::Element element) {
  return element == gemmi::El::D ? "H" : element.name();
}

/// Returns whether a residue is an amino acid or nucleotide, also a modified one, and also by a
/// name of Amber, CHARMM or GROMACS.
inline bool is_polymer_residue(std::string_view residue) {
  const auto& info = gemmi::find_tabulated_residue(std::string(without_end_letter(residue)));
  return info.is_amino_acid() || info.is_nucleic_acid() || is_named_polymer(residue);
}

inline std::uint64_t count_atoms(const gemmi::Model& model) {
  std::uint64_t count = 0;
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues) count += residue.atoms.size();
  return count;
}

inline bool is_hetatm(const gemmi::Residue& residue) { return residue.het_flag == 'H'; }

}  // namespace eses::detail
