#pragma once
/// Elements of atoms of PDB files without element symbols, derived from names.

#include <string>
#include <string_view>

namespace eses::detail {

/// Returns whether a residue is an amino acid or nucleotide, also by a name of Amber, CHARMM or
/// GROMACS, such as HID or NALA.
bool is_polymer_residue(std::string_view residue);

/// Returns whether an atom is the only one of its residue, as in the residues CA, FE2 and 3CO.
bool is_ion(std::string_view name, std::string_view residue);

/// Returns the element symbol, in capital letters, of an atom; empty if the columns of the name
/// decide: the symbol is right-justified in the first two of them. `name_columns` are the four
/// columns of the name. `is_left_aligned` tells whether all names begin in the first column.
std::string element_by_name(std::string_view name_columns, std::string_view residue,
                            bool is_left_aligned);

}  // namespace eses::detail
