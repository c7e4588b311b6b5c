#pragma once
/// Elements of atoms of PDB and PQR files without element symbols, derived from names. This header
/// is valid C++17, for the reason given in mmcif_text.cpp.

#include <string>
#include <string_view>
#include <vector>

namespace eses {
struct AtomLabel;
}

namespace eses::detail {

/// Returns the element symbol at the start of a text in its usual spelling, such as Cl for CL-;
/// empty if there is none.
std::string usual_spelling(std::string_view text);

/// Returns whether a symbol is X, which stands for an unknown element.
inline bool is_unknown_element(std::string_view symbol) { return symbol == "X" || symbol == "x"; }

/// Returns the element symbol, in its usual spelling, of an atom whose name is not in columns;
/// empty if it is unknown.
std::string symbol_by_name(std::string_view name, std::string_view residue);

/// Returns a residue name without the letter N or C by which Amber marks the first and the last
/// residue of a chain, as in NALA.
inline std::string_view without_end_letter(std::string_view residue) {
  const bool has_letter = residue.size() == 4 && (residue.front() == 'N' || residue.front() == 'C');
  return residue.substr(has_letter ? 1 : 0);
}

/// Returns whether a name is that of a standard amino acid or nucleotide, or its name in Amber,
/// CHARMM or GROMACS, such as HID or NALA.
bool is_named_polymer(std::string_view residue);

/// Returns whether four columns after the atom name are a residue name of four letters by itself,
/// such as NALA, HISD or TIP3, whatever the names of chains.
bool is_known_long_residue(std::string_view name);

/// Returns whether the four columns after the atom name are a residue name of four letters, and not
/// the name of a residue that the program knows and the first letter of a chain name.
bool is_long_residue(std::string_view name);

/// The names of a residue and its chain in the columns of a record.
struct ResidueColumns {
  std::string_view residue, chain;
  bool is_long = false;  ///< whether the name of the residue has four letters
};

/// Splits the columns 18 to 22 of an ATOM or HETATM record. `may_be_long` tells whether names of
/// four letters may occur, and `is_long_name` which names are. They begin in column 18 or, in some
/// files without chains, in column 19.
ResidueColumns split_residue(std::string_view record, bool may_be_long = true,
                             bool (*is_long_name)(std::string_view name) = is_long_residue);

/// An atom whose element is derived from its names.
struct NamedAtom {
  std::string_view name_columns;  ///< the four columns of the name, or the name alone
  std::string_view residue;
  bool is_polymer = false;  ///< whether the residue is an amino acid or nucleotide
  bool is_alone = false;    ///< whether the residue is known to have no other atom
  /// Whether all names of the file begin in the first column, so that columns mean nothing.
  bool is_left_aligned = true;
};

/// Returns whether a residue has the name of water in coarse-grained models, such as W in Martini.
/// It stands for several molecules.
bool is_water_bead(std::string_view residue);

/// Returns whether an atom is an ion: the only atom of the residues CA, FE2 and 3CO, an atom of the
/// residue ION, or an atom alone in its residue with a charge in its name, such as NA+.
bool is_ion(const NamedAtom& atom);

/// Returns the element symbol, in capital letters, of an atom; empty if the columns of the name
/// decide: the symbol is right-justified in the first two of them. Dummy atoms have the symbol X.
/// Beads of water are oxygen.
std::string element_by_name(const NamedAtom& atom);

/// Completes the elements of labels from a PQR file: the symbol of the file in its usual spelling
/// or, if the file has none, the symbol by the names, as if all names began in the first column.
/// The element is empty if it is unknown.
void complete_elements(std::vector<AtomLabel>& labels);

}  // namespace eses::detail
