#pragma once
/// Access to a surface, and checks of arguments, for several functions of the library.

#include <cstdint>
#include <span>
#include <stdexcept>

#include "eses/measure.hpp"
#include "eses/surface.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// A friend of the public Surface.
struct SurfaceAccess {
  static const Molecule& molecule(const eses::Surface& surface) { return *surface.molecule_; }
};

/// Throws std::logic_error for the points of a result that was moved from. Other results have
/// points.
inline void require_values(std::span<const std::uint8_t> inside) {
  if (inside.empty()) throw std::logic_error("the result was moved from; use the new one");
}

/// Throws std::invalid_argument if the probe radius or the number of threads is out of its range.
void require_valid(const MeasureOptions& options);

}  // namespace eses::detail
