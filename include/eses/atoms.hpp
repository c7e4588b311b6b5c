#pragma once
/// @file
/// Atoms as spheres, and their names.

#include <cstdint>
#include <string>

#include "eses/vec3.hpp"

namespace eses {

/// Index of an atom, from 0, in the atoms that a function gets or returns. Those of a file are in
/// its order.
using AtomIndex = std::uint32_t;

/// A van der Waals sphere. Surface accepts only finite numbers.
struct Atom {
  Vec3 center;        ///< Centre, in angstrom.
  double radius = 0;  ///< Van der Waals radius, in angstrom; not negative.
};

/// The class of an atom in its set of radii.
enum class AtomClass : std::uint8_t {
  none,    ///< The set has none, so that the class follows from the element.
  polar,   ///< The set counts the atom as polar.
  apolar,  ///< The set counts the atom as apolar.
};

/// The names of an atom in its file, and its element. Missing names are empty. The copies of a
/// chain in an assembly are named A, A-2, A-3 and so on.
struct AtomLabel {
  std::string chain;           ///< Chain identifier, such as A.
  std::string residue;         ///< Residue name, such as ALA.
  std::string residue_number;  ///< Residue number with the insertion code, such as 52A.
  std::string atom_name;       ///< Atom name, such as CA.
  /// Element symbol, such as Cl; empty if it is unknown. If the file does not have it, it follows
  /// from the names as described in doc/input.md.
  std::string element = {};
  /// Class in the set of radii that was chosen for the file.
  AtomClass atom_class = AtomClass::none;
  /// Compares all members.
  friend bool operator==(const AtomLabel&, const AtomLabel&) = default;
};

}  // namespace eses
