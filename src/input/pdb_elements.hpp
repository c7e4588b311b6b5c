#pragma once
/// Elements of atoms of PDB and PQR files without element symbols, derived from names.

#include <span>
#include <string>
#include <string_view>

#include "eses/atoms.hpp"

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

/// Completes the elements of labels from a PQR file: the symbol of the file in its usual spelling
/// or, if the file has none, the symbol by the names, as if all names began in the first column.
/// The element is empty if it is unknown.
void complete_elements(std::span<AtomLabel> labels);

}  // namespace eses::detail
