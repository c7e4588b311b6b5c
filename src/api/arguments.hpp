#pragma once
/// Access to a surface, and checks of arguments, for several functions of the library.

#include "eses/measure.hpp"
#include "eses/surface.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// A friend of the public Surface.
struct SurfaceAccess {
  static const Molecule& molecule(const eses::Surface& surface) { return *surface.molecule_; }
};

/// Throws std::invalid_argument if the probe radius or the number of threads is out of its range.
void require_valid(const MeasureOptions& options);

}  // namespace eses::detail
