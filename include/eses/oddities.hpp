#pragma once
/// What can be odd in a set of atoms: valid, and computed exactly, but perhaps not what was meant.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "eses/atoms.hpp"

namespace eses {

enum class OddityKind : std::uint8_t {
  duplicate,     ///< same centre and radius as an earlier atom
  close,         ///< centre within 0.5 angstrom of an earlier atom's; both have a radius
  nested,        ///< larger than a hydrogen, and wholly inside another atom
  large_radius,  ///< above 4 angstrom
  small_radii,   ///< every radius is below 0.4 angstrom, as if in nanometres
  zero_radius,   ///< usual: hydrogens of some force fields
  nested_usual,  ///< usual: hydrogens, radius up to 1.4 angstrom, wholly inside another atom
};

inline constexpr std::size_t oddity_kinds = 7;

/// Whether files that are in order have that, too.
constexpr bool is_usual(OddityKind kind) { return kind >= OddityKind::zero_radius; }

/// Atoms that are odd in one way. An atom may be odd in several, but of a pair that is a duplicate
/// or close nothing else is said.
struct Oddity {
  struct Example {
    AtomIndex atom = 0;
    AtomIndex other =
        0;  ///< what it repeats, is close to or lies in; `atom` itself if there is none
  };
  static constexpr std::size_t most_examples = 5;

  OddityKind kind = OddityKind::duplicate;
  std::uint64_t count = 0;        ///< atoms
  std::vector<Example> examples;  ///< the first of them, ascending by `atom`
};

}  // namespace eses
