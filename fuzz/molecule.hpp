#pragma once
/// Molecules made of bytes, so that degenerate ones are likely.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "compute/run.hpp"
#include "eses/atoms.hpp"

namespace eses::detail::fuzz {

struct Molecule {
  std::vector<Atom> atoms;  ///< 1 to 12
  Parameters parameters;    ///< one thread, a grid of 1000 points at most
};

/// Any bytes give a molecule. The first six set the parameters, the lattice and its frame, every
/// five more an atom: one on the lattice, one that touches another from without or within (itself
/// or with its SAS sphere), a duplicate, one that a probe at some lattice point touches, one whose
/// SAS sphere shares a circle with others, or a corner of a regular polygon. Sizes come from small
/// sets; some are off by a little. Bytes that lack are 0.
Molecule make_molecule(std::span<const std::uint8_t> bytes);

/// The molecule as an xyzr file whose comments tell the parameters.
std::string text_of(const Molecule& molecule);

}  // namespace eses::detail::fuzz
