#pragma once
/// Residues with the same name and number.

#include <gemmi/model.hpp>

namespace eses::detail {

/// Splits residues in which an atom of the same name and alternate location repeats. gemmi makes
/// one residue of all residues of a chain with the same name and number, but in large files numbers
/// begin again after 9999.
void split_residues(gemmi::Structure& structure);

}  // namespace eses::detail
