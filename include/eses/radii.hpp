#pragma once
/// @file
/// Van der Waals radii and polarity of named atoms.

#include <span>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/diagnostics.hpp"
#include "eses/vec3.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// The radius of an atom in a set of radii, and how it was found.
struct NamedRadius {
  double radius = 0;           ///< In angstrom; not a number if the set has no radius for the atom.
  std::string element;         ///< Element symbol, such as Cl; empty if unknown.
  bool is_by_element = false;  ///< Whether the set does not name the atom, only its element.
  bool is_element_by_name = false;         ///< Whether the element follows from the names.
  AtomClass atom_class = AtomClass::none;  ///< Class in the set.
};

/// The radii of atoms in a set.
struct NamedRadii {
  std::string set;          ///< Name of the set.
  bool are_united = false;  ///< Whether the radii belong to united atoms, which include hydrogens.
  std::vector<NamedRadius> atoms;  ///< One for each atom.
};

/// Finds the radii of atoms by their names and elements. `set` is StructureOptions::radii. An empty
/// element follows from the names, as for PQR files; deuterium (D) is hydrogen. Throws Error if the
/// set is unknown or its file cannot be read.
NamedRadii find_radii(std::span<const AtomLabel> atoms, const std::string& set = "protor");

/// Corrects elements that a program has derived from names, and adds those of ions that lack them.
/// An atom that is named as an ion and alone in its residue is an ion. Names tell the elements of
/// amino acids and nucleotides. In other residues, an element is replaced if the length of the
/// shortest bond contradicts it. For example, CL1 is not carbon if its shortest bond is longer than
/// 1.63 angstrom. Atoms without a residue name keep their elements. Consecutive atoms with the same
/// chain, residue and number belong to the same residue. Returns the atoms whose elements have
/// changed, ascending. Throws Error if the numbers of centres and labels differ.
std::vector<AtomIndex> correct_elements(std::span<const Vec3> centers, std::span<AtomLabel> labels);

/// Returns whether each atom belongs to a molecule of water, by the names in the PDB, in force
/// fields and, for beads, in coarse-grained models. Labels are those of correct_elements.
std::vector<bool> find_waters(std::span<const AtomLabel> atoms);

/// Returns the diagnostics one_atom_residue and foreign_residue of the residues of these atoms. The
/// residues may be parts, so a missing backbone is no diagnostic.
std::vector<Diagnostic> check_residues(std::span<const AtomLabel> atoms);

/// Returns whether each atom is polar. This is its class in the set of radii, if the label has one:
/// NACCESS takes sulfur, phosphorus and selenium for apolar, OONS the carbon of carbonyl and
/// carboxyl groups for polar, and files in FreeSASA's configuration format name the class of each
/// atom. Else carbon, boron, silicon, and halogens that are not alone in their residue are apolar.
/// All others are polar, as in ProtOr: nitrogen, oxygen, sulfur, phosphorus, selenium, and ions. A
/// hydrogen belongs to the class of the nearest other atom of its residue. The numbers of atoms and
/// labels are the same.
std::vector<bool> find_polar_atoms(std::span<const Atom> atoms, std::span<const AtomLabel> labels);

}  // namespace eses
#pragma GCC visibility pop
