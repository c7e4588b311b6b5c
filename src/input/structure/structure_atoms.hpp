#pragma once
/// Atoms and residues of PDB and mmCIF files.

#include <algorithm>
#include <cstdint>
#include <gemmi/model.hpp>
#include <string>
#include <string_view>

#include "eses/vec3.hpp"
#include "input/residue_atoms.hpp"
#include "input/structure/parse_structure.hpp"

namespace eses::detail {

/// An atom of a gemmi::Model, or its image in an assembly.
struct StructureAtom {
  const gemmi::Atom* atom;
  const gemmi::Residue* residue;
  const std::string* chain;  ///< name of the chain or of its copy, such as A-2
  Vec3 center;
};

/// Returns the symbol of an element, such as Zn; X if it is unknown, and H for deuterium.
inline const char* symbol_of(gemmi::Element element) {
  return element == gemmi::El::D ? "H" : element.name();
}

inline std::uint64_t count_atoms(const gemmi::Model& model) {
  std::uint64_t count = 0;
  for (const gemmi::Chain& chain : model.chains)
    for (const gemmi::Residue& residue : chain.residues) count += residue.atoms.size();
  return count;
}

/// Marks residues of several atoms none of which is of a backbone, and other molecules than their
/// names say, before atoms are left out. UNK is also the name of any ligand, in files of Maestro
/// for example.
inline void mark_residues(gemmi::Model& model) {
  for (gemmi::Chain& chain : model.chains)
    for (gemmi::Residue& residue : chain.residues)
      if (is_other_molecule(residue.name, residue.atoms,
                            [](const gemmi::Atom& atom) { return std::string_view(atom.name); }))
        residue.flag = 'O';
      else if (residue.atoms.size() > 1 && residue.name != "UNK" &&
               is_polymer_residue(residue.name) &&
               std::none_of(
                   residue.atoms.begin(), residue.atoms.end(),
                   [](const gemmi::Atom& atom) { return is_backbone_atom(upper_case(atom.name)); }))
        residue.flag = 'S';
}

/// Returns whether mark_residues has found several atoms, but none of a backbone.
inline bool has_no_backbone(const gemmi::Residue& residue) { return residue.flag == 'S'; }
/// Returns the standard residue of a residue, by what mark_residues has found.
inline std::string_view standard_residue(const gemmi::Residue& residue) {
  return residue.flag == 'O' ? residue.name : standard_residue(residue.name);
}

inline bool is_hetatm(const gemmi::Residue& residue) { return residue.het_flag == 'H'; }

}  // namespace eses::detail
