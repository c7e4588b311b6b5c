#pragma once
/// Atom sets close to degenerate ones: almost coincident, cospherical or tangent.

#include <cstdint>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "support/atom_sets.hpp"

namespace eses::detail::test {

struct NearDegenerateSet {
  std::string name;
  std::vector<Atom> atoms;
  double probe_radius = 0;  ///< angstrom
  double noise = 0;         ///< standard deviation of the displacement of each coordinate, angstrom
};

/// Makes an almost degenerate set: copies of a few atoms, or lattices, rings, polyhedra and shells
/// on or in which a probe almost fits. Noise of 1e-2 to 1e-14 angstrom displaces each atom.
NearDegenerateSet make_near_degenerate_set(std::uint64_t seed);

/// Makes a set whose cavities are almost degenerate: rings of 3 to 12 atoms that a probe just fits
/// into, lattices with windows that a probe just passes, or shells and chains with nearly equal
/// atoms. Offsets are 1e-13 to 1e-6 angstrom, which is also `noise`.
NearDegenerateSet make_near_cavity_set(std::uint64_t seed);

/// Moves all atoms by a vector.
std::vector<Atom> moved(std::vector<Atom> atoms, Vec3 by);

/// Returns the atoms, each followed by copies that are at most `apart` away along each axis.
std::vector<Atom> with_copies(const std::vector<Atom>& atoms, std::size_t copies, double apart,
                              Random& random);

}  // namespace eses::detail::test
