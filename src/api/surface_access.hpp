#pragma once
/// Access to the data of a public Surface.

#include "eses/surface.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// A friend of the public Surface.
struct SurfaceAccess {
  static const Molecule& molecule(const eses::Surface& surface) { return *surface.molecule_; }
};

}  // namespace eses::detail
