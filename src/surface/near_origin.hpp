#pragma once
/// Molecules far from the origin.
///
/// Large coordinates are rounded so much that it decides about placements that are close together.
/// The difference of a large coordinate and a whole number near it has no rounding error, so that
/// a molecule can be measured near the origin.

#include <span>

#include "eses/atoms.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// Returns the middle of the box around the centres.
Vec3 middle_of(std::span<const Atom> atoms);

/// Returns whether the middle of a molecule is far away from the origin: 1024 angstrom or more.
bool is_far_away(const Molecule& molecule);

/// A molecule near the origin.
struct MovedMolecule {
  Molecule molecule;
  Vec3 offset;  ///< from there to the position of the given molecule (angstrom)
};

/// Moves a molecule to the origin if it is far away; otherwise returns the molecule itself.
/// `threads` is the number of threads that build the spatial index.
MovedMolecule near_origin(const Molecule& molecule, int threads);

}  // namespace eses::detail
