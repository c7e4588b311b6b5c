#pragma once
/// Names of the atoms of amino acids and nucleotides.

#include <string>
#include <string_view>

namespace eses::detail {

/// Returns the standard residue with the same atoms other than hydrogen: HIS for its forms in force
/// fields, such as HIE, HSD and NHIE, and DA for DA5. Returns other names as they are.
std::string_view standard_residue(std::string_view residue);

/// Returns the name of the PDB for an atom of a standard residue, such as OXT for the OT2 of CHARMM
/// and OP1 for the O1P of Amber. Returns other names as they are.
std::string standard_atom(std::string_view residue, std::string_view atom);

/// Returns whether a standard amino acid or nucleotide, or its form in a force field such as HID,
/// may have an atom other than hydrogen of this name. True for all other residues.
bool may_have_atom(std::string_view residue, std::string_view atom);

/// Returns whether a name belongs to the backbone of amino acids or nucleotides.
bool is_backbone_atom(std::string_view atom);

}  // namespace eses::detail
