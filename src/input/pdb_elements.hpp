#pragma once
/// Elements of atoms of PDB and PQR files without element symbols, derived from names.

#include <span>
#include <string>
#include <string_view>

#include "eses/atoms.hpp"

namespace eses::detail {

/// Returns a residue name without the letter N or C by which Amber marks the first and the last
/// residue of a chain, as in NALA.
inline std::string_view without_end_letter(std::string_view residue) {
  const bool has_letter = residue.size() == 4 && (residue.front() == 'N' || residue.front() == 'C');
  return residue.substr(has_letter ? 1 : 0);
}

/// Returns whether a name is that of a standard amino acid or nucleotide, or its name in Amber,
/// CHARMM or GROMACS, such as HID or NALA.
bool is_named_polymer(std::string_view residue);

/// Returns whether an atom is the only one of its residue, as in the residues CA, FE2 and 3CO.
/// `is_polymer` tells whether the residue is an amino acid or nucleotide.
bool is_ion(std::string_view name, std::string_view residue, bool is_polymer);

/// Returns the element symbol, in capital letters, of an atom; empty if the columns of the name
/// decide: the symbol is right-justified in the first two of them. `name_columns` are the four
/// columns of the name. `is_left_aligned` tells whether all names begin in the first column.
std::string element_by_name(std::string_view name_columns, std::string_view residue,
                            bool is_polymer, bool is_left_aligned);

/// Completes the elements of labels from a PQR file: the symbol of the file in its usual spelling
/// or, if the file has none, the symbol by the names, as if all names began in the first column.
/// The element is empty if it is unknown.
void complete_elements(std::span<AtomLabel> labels);

}  // namespace eses::detail
