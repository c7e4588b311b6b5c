#pragma once
/// Sets of radii for the atoms of PDB and mmCIF files.

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "eses/atoms.hpp"
#include "input/residue_atoms.hpp"

namespace eses::detail {

/// The properties of an atom that determine its radius.
struct AtomIdentity {
  std::string_view residue;  ///< residue name, such as ALA
  std::string_view atom;     ///< atom name without blanks, such as CA
  std::string_view element;  ///< symbol, such as C or Zn
  bool is_hydrogen = false;  ///< hydrogen or deuterium
  /// The standard residue with the same atoms; the residue itself if there is none.
  std::string_view standard = standard_residue(residue);
};

/// A radius that a set has for an atom.
struct FoundRadius {
  double radius = 0;  ///< in angstrom
  /// Whether the set does not name the atom, and the radius belongs to its element.
  bool by_element = false;
};

struct RadiiSet {
  std::string name;
  /// Whether the radii belong to united atoms, which include hydrogens.
  bool is_united = false;
  /// Returns the radius of an atom that the set names, else nothing.
  std::function<std::optional<double>(const AtomIdentity& atom)> find_named;
  /// Returns the radius of the other atoms of an element.
  std::optional<double> (*find_by_element)(std::string_view element);
  bool is_from_file = false;  ///< whether it is not built in
  /// Whether the radius of an atom is its occupancy in the file. The set names all atoms.
  bool is_occupancy = false;
  /// Returns the class of an atom in the set. A set without this function has no classes.
  std::function<AtomClass(const AtomIdentity& atom)> find_class = {};

  /// Returns the class of an atom; none if the set has none.
  AtomClass class_of(const AtomIdentity& atom) const;
  /// Returns the radius of an atom, or nothing if there is none.
  std::optional<FoundRadius> find(const AtomIdentity& atom) const;
};

/// Maximum radius in a file, and of the option for atoms without a radius.
inline constexpr double max_set_radius = 1000;  // angstrom

/// Returns a built-in set, or nothing for other names. `protor+shannon` is protor with the radii of
/// ionic_radius.
std::optional<RadiiSet> named_radii_set(std::string_view name);

/// Returns the file that a name of radii means, which is FILE for `FILE+shannon`, unless there is a
/// file of this name; other names as they are.
std::string radii_file(const std::string& name);

/// Returns a built-in set, or reads a file in FreeSASA's configuration format, also with the radii
/// of ionic_radius for `FILE+shannon`.
RadiiSet find_radii_set(const std::string& name_or_file);

/// Parses a set of radii in FreeSASA's configuration format. The section `types:` has lines `TYPE
/// RADIUS polar|apolar`, and the section `atoms:` has lines `RESIDUE ATOM TYPE`, with ANY for all
/// residues. The line `name:` gives the name of the set. Atoms that are not listed get FreeSASA's
/// radius of their element. The radii belong to united atoms unless hydrogens are listed. Throws
/// Error with `file` and the line.
RadiiSet parse_radii_set(std::string_view text, std::string_view file);

}  // namespace eses::detail
