#pragma once
/// Names of the atoms of amino acids and nucleotides.

#include <string_view>

namespace eses::detail {

/// Returns whether a standard amino acid or nucleotide, or its form in a force field such as HID,
/// may have an atom other than hydrogen of this name. True for all other residues.
bool may_have_atom(std::string_view residue, std::string_view atom);

/// Returns whether a name belongs to the backbone of amino acids or nucleotides.
bool is_backbone_atom(std::string_view atom);

}  // namespace eses::detail
