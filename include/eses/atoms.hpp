#pragma once
/// Atoms as spheres.

#include <cstdint>

#include "eses/vec3.hpp"

namespace eses {

/// 0-based index of an atom in input order.
using AtomIndex = std::uint32_t;

/// A molecule accepts finite numbers only.
struct Atom {
  Vec3 center;        ///< angstrom
  double radius = 0;  ///< van der Waals radius, angstrom, >= 0
};

}  // namespace eses
