#pragma once
/// Sets of radii: which radius an atom of a PDB or mmCIF file has.

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace eses::detail {

/// An atom as sets of radii know it.
struct AtomIdentity {
  std::string_view residue;  ///< residue name, such as ALA
  std::string_view atom;     ///< atom name without blanks, such as CA
  std::string_view element;  ///< symbol, such as C or Zn
  bool is_hydrogen = false;  ///< hydrogen or deuterium
};

/// A radius that a set has for an atom.
struct FoundRadius {
  double radius = 0;  ///< in angstrom
  /// The set does not name the atom, and another table has given the radius of its element.
  bool by_element = false;
};

struct RadiiSet {
  std::string name;
  /// Radii are those of united atoms, which include hydrogens.
  bool is_united = false;
  /// The radius of an atom; nothing if there is none.
  std::function<std::optional<FoundRadius>(const AtomIdentity& atom)> find;
};

/// Names of the sets that are built in, for messages.
inline constexpr std::string_view named_radii = "protor, bondi or msms";

/// A set that is built in; nothing for other names.
std::optional<RadiiSet> named_radii_set(std::string_view name);

/// Reads a set from a text in FreeSASA's configuration format: the sections `types:` (lines `TYPE
/// RADIUS polar|apolar`) and `atoms:` (lines `RESIDUE ATOM TYPE`, ANY for all residues), and
/// `name:`. Atoms that it does not name have FreeSASA's radius of their element. The radii are
/// those of united atoms unless it names hydrogens. Throws Error with `file` and the line.
RadiiSet parse_radii_set(std::string_view text, std::string_view file);

}  // namespace eses::detail
