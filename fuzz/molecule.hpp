#pragma once
/// Molecules made from bytes such that degenerate arrangements are likely.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "eses/atoms.hpp"
#include "run/request.hpp"

namespace eses::detail::fuzz {

struct Molecule {
  std::vector<Atom> atoms;  ///< 1 to 12
  Parameters parameters;    ///< one thread, a grid of at most 1000 points
};

/// Makes a molecule from any bytes; missing bytes count as 0. The first six bytes set the
/// parameters, the lattice and its frame. Every further five bytes add an atom of one of these
/// kinds: an atom on the lattice; an atom that touches another one from outside or inside, itself
/// or with its SAS sphere; a duplicate; an atom that touches a probe at a lattice point; an atom
/// whose SAS sphere shares a circle with others; or a corner of a regular polygon. Sizes are from
/// small sets. Some are changed by a small amount.
Molecule make_molecule(std::span<const std::uint8_t> bytes);

/// Writes the molecule as an xyzr file whose comments list the parameters.
std::string text_of(const Molecule& molecule);

}  // namespace eses::detail::fuzz
