#pragma once
/// Names of the atoms of amino acids and nucleotides.

#include <algorithm>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "eses/atoms.hpp"
#include "input/pdb_elements.hpp"
#include "input/text_fields.hpp"

namespace eses::detail {

/// Returns the standard residue with the same atoms other than hydrogen: HIS for its forms in force
/// fields, such as HIE, HSD and NHIE, and DA for DA5. Returns other names as they are.
std::string_view standard_residue(std::string_view residue);

/// Returns atoms, separated by blanks, at least one of which a residue with the name of a form has.
/// Without them it is another molecule: HSE is also homoserine, GUA is glutaric acid, and DGN is
/// D-glutamine. Empty if the name alone decides.
std::string_view telling_atoms(std::string_view residue);

/// Returns whether a residue is another molecule than the form of its name. `name_of` returns the
/// name of one of its atoms.
template <class Atoms, class NameOf>
bool is_other_molecule(std::string_view residue, const Atoms& atoms, NameOf&& name_of) {
  const std::string_view telling = telling_atoms(residue);
  return !telling.empty() && std::none_of(atoms.begin(), atoms.end(), [&](const auto& atom) {
    return has_word(telling, name_of(atom));
  });
}

/// Returns whether a residue is water. The names of the PDB hold in any case of letters. Other
/// names also belong to ligands, which have other atoms, and `W` to tungsten. `names_of` returns
/// the name and the element symbol of an atom.
template <class Atoms, class NamesOf>
bool is_water_residue(std::string_view residue, const Atoms& atoms, NamesOf&& names_of) {
  constexpr std::string_view waters = "HOH DOD WAT H2O";
  constexpr std::string_view ambiguous =
      "SOL TIP TIP2 TIP3 TIP4 TIP5 TP3 TP4 TP5 T3P T4P T5P SPC SPCE SPE OPC OP3";
  if (has_word(waters, upper_case(std::string(residue)))) return true;
  const bool is_bead = is_water_bead(residue);
  if (!is_bead && !has_word(ambiguous, residue)) return false;
  std::set<std::string> oxygens;  // names, because an oxygen may have alternate locations
  for (const auto& atom : atoms) {
    const std::pair<std::string, std::string> names = names_of(atom);
    if (names.second == "C" || names.second == "P") return false;
    if (names.second == "O")
      oxygens.insert(names.first);
    else if (is_bead)
      return false;
  }
  return is_bead || oxygens.size() == 1;
}

/// Returns whether a residue has a single atom, or only CA and CB, as in UNRES. `name_of` returns
/// the name of one of its atoms.
template <class Atoms, class NameOf>
bool is_trace(const Atoms& atoms, NameOf&& name_of) {
  return atoms.size() == 1 ||
         (atoms.size() == 2 && name_of(atoms[0]) == "CA" && name_of(atoms[1]) == "CB");
}

/// Returns the standard residue of a residue with these atoms; its own name if there is none.
std::string_view standard_residue(std::span<const AtomLabel> residue);

/// Returns the name of the PDB for an atom of a standard residue, such as OXT for the OT2 of CHARMM
/// and OP1 for the O1P of Amber. Returns other names as they are.
std::string standard_atom(std::string_view residue, std::string_view atom);

/// Returns whether a standard amino acid or nucleotide may have an atom other than hydrogen of this
/// name. True for all other residues.
bool may_have_atom(std::string_view residue, std::string_view atom);

/// Returns whether a name belongs to the backbone of amino acids or nucleotides.
bool is_backbone_atom(std::string_view atom);

}  // namespace eses::detail
